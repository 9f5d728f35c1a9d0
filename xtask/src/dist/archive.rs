//! Archives that are identical byte for byte if their files are.

use crate::files::write_whole;
use anyhow::Context;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufReader, Read, Write};
use std::path::{Path, PathBuf};
use tar::{Builder, EntryType, Header};

/// Writes the files of a folder as a `.tar.gz`, all below a folder called `name`.
pub fn write(folder: &Path, name: &str, path: &Path) -> anyhow::Result<()> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    // The order of a directory listing depends on the file system.
    files.sort();
    write_whole(path, false, |file| {
        let packed = GzEncoder::new(file, Compression::best());
        let mut archive = Builder::new(packed);
        for file in &files {
            let inside = Path::new(name).join(file.strip_prefix(folder)?);
            append(&mut archive, file, &inside).with_context(|| file.display().to_string())?;
        }
        archive.into_inner()?.finish()?;
        Ok(())
    })
}

/// Adds a file or link without its owner and date.
fn append(archive: &mut Builder<impl Write>, file: &Path, inside: &Path) -> anyhow::Result<()> {
    let found = fs::symlink_metadata(file)?;
    let mut header = Header::new_gnu();
    header.set_mtime(0);
    header.set_uid(0);
    header.set_gid(0);
    if found.file_type().is_symlink() {
        header.set_entry_type(EntryType::Symlink);
        header.set_size(0);
        header.set_mode(0o777);
        archive.append_link(&mut header, inside, fs::read_link(file)?)?;
        return Ok(());
    }
    header.set_entry_type(EntryType::Regular);
    header.set_size(found.len());
    header.set_mode(if is_program(&found, file) {
        0o755
    } else {
        0o644
    });
    archive.append_data(&mut header, inside, File::open(file)?)?;
    Ok(())
}

#[cfg(unix)]
fn is_program(found: &fs::Metadata, _: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    found.permissions().mode() & 0o100 != 0
}

#[cfg(not(unix))]
fn is_program(_: &fs::Metadata, file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == "exe")
}

/// All files and links below a folder.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let entry = entry?;
        match entry.file_type()?.is_dir() {
            true => collect(&entry.path(), files)?,
            false => files.push(entry.path()),
        }
    }
    Ok(())
}

/// The SHA-256 of a file, in hexadecimal digits.
pub fn sha256(path: &Path) -> anyhow::Result<String> {
    let mut file = BufReader::new(File::open(path).with_context(|| path.display().to_string())?);
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let count = file.read(&mut buffer)?;
        match buffer.get(..count) {
            Some([]) | None => break,
            Some(bytes) => hash.update(bytes),
        }
    }
    let mut text = String::new();
    for byte in hash.finalize() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}
