//! Files that outlast a power failure.
//!
//! A file that is renamed to its final name is whole for other programs, not for the disk: data may reach the disk after the name does, and
//! the name after all else. So data are synced before the rename, and the folder after it. [`replace`] is how this program ends every file
//! that it writes under another name first.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Gives a complete file its final name, replacing an existing file. Both survive a power failure.
///
/// # Errors
/// Error of the system. The file then has its old name, unless only the folder could not be synced.
pub fn replace(from: &Path, to: &Path) -> io::Result<()> {
    sync_file(from)?;
    fs::rename(from, to)?;
    sync_folder_of(to)
}

/// Syncs a complete file of any origin.
///
/// # Errors
/// Error of the system; a full disk may be detected only here.
pub fn sync_file(path: &Path) -> io::Result<()> {
    // Windows syncs only what may be written to.
    File::options().write(true).open(path)?.sync_data()
}

/// Syncs the directory of a path.
///
/// # Errors
/// Error of the system. A file system that cannot sync folders is not an error.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => sync_folder(folder),
        _ => sync_folder(Path::new(".")),
    }
}

fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(not(unix)) {
        return Ok(());
    }
    // A folder may be writable and not readable.
    let Ok(opened) = File::open(folder) else {
        return Ok(());
    };
    match opened.sync_all() {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}

/// Creates a folder and its missing parents. Their names survive a power failure.
///
/// # Errors
/// Error of the system.
pub fn make_folders(folder: &Path) -> io::Result<()> {
    let missing: Vec<PathBuf> = folder
        .ancestors()
        .take_while(|path| !path.as_os_str().is_empty() && !path.exists())
        .map(Path::to_owned)
        .collect();
    fs::create_dir_all(folder)?;
    missing
        .iter()
        .rev()
        .try_for_each(|made| sync_folder_of(made))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_replaces_another_and_a_missing_one_replaces_none() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path().join("a/b");
        make_folders(&folder).expect("made");
        make_folders(&folder).expect("there already");
        let (from, to) = (folder.join(".part"), folder.join("whole"));
        fs::write(&to, b"old").expect("writes");
        replace(&from, &to).expect_err("nothing to rename");
        assert_eq!(fs::read(&to).expect("reads"), b"old");
        fs::write(&from, b"new").expect("writes");
        replace(&from, &to).expect("renames");
        assert_eq!(fs::read(&to).expect("reads"), b"new");
        assert!(!from.exists());
    }

    /// A file name without a folder refers to the working directory.
    #[test]
    fn a_bare_name_has_a_folder() {
        sync_folder_of(Path::new("Cargo.toml")).expect("the folder of the package");
    }
}
