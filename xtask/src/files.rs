//! Files that get their final names only when complete.

use anyhow::Context;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

/// Writes a file beside its final path, then renames it: after an error the previous file is unchanged. `is_program` makes it executable.
pub fn write_whole(
    path: &Path,
    is_program: bool,
    write: impl FnOnce(&mut File) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let shown = || path.display().to_string();
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let mut file = tempfile::Builder::new()
        .prefix(".terrella-")
        .suffix(".partial")
        .tempfile_in(folder)
        .with_context(shown)?;
    write(file.as_file_mut()).with_context(shown)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = if is_program { 0o755 } else { 0o644 };
        fs::set_permissions(file.path(), fs::Permissions::from_mode(mode)).with_context(shown)?;
    }
    #[cfg(not(unix))]
    let _ = is_program;
    file.as_file().sync_all().with_context(shown)?;
    file.persist(path).with_context(shown)?;
    Ok(())
}

/// Writes bytes.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_whole(path, false, |file| Ok(file.write_all(bytes)?))
}

/// Copies a file.
pub fn copy_whole(from: &Path, to: &Path, is_program: bool) -> anyhow::Result<()> {
    let mut source = File::open(from).with_context(|| from.display().to_string())?;
    write_whole(to, is_program, |file| {
        std::io::copy(&mut source, file)?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_leaves_the_file_that_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/a");
        write_bytes(&path, b"old").unwrap();
        let failed = write_whole(&path, false, |file| {
            file.write_all(b"ne")?;
            anyhow::bail!("the disk is full")
        });
        let message = format!("{:#}", failed.unwrap_err());
        assert!(message.contains("new") && message.contains("the disk is full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        write_bytes(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        let names = fs::read_dir(path.parent().unwrap()).unwrap();
        assert_eq!(names.count(), 1);
    }
}
