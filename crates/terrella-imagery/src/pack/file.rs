//! A file of a pack: what it must be, and its bytes where it is that.

use crate::tile::TileError;
use std::io::{ErrorKind, Read};
use std::path::Path;
use terrella_files as files;

/// Length and checksum of a tile's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileFile {
    /// Its length.
    pub bytes: u64,
    /// The first 16 bytes of its BLAKE3 hash.
    pub checksum: [u8; 16],
}

impl TileFile {
    /// Of these contents.
    pub fn of(contents: &[u8]) -> Self {
        let mut checksum = [0; 16];
        checksum.copy_from_slice(&blake3::hash(contents).as_bytes()[..16]);
        Self {
            bytes: contents.len() as u64,
            checksum,
        }
    }
}

/// An error once a reading is no longer wanted.
pub(super) fn unless(cancelled: &dyn Fn() -> bool) -> Result<(), TileError> {
    if cancelled() {
        Err(TileError::Cancelled)
    } else {
        Ok(())
    }
}

/// The bytes of a file, which must match the manifest exactly.
///
/// They are read once, hashed and decoded from memory: even if the file changes meanwhile, they either match the manifest or are rejected. The
/// caller has bounded the length.
pub(super) fn read_whole(
    path: &Path,
    file: TileFile,
    cancelled: &dyn Fn() -> bool,
) -> Result<Vec<u8>, TileError> {
    let unreadable = |source| TileError::Unreadable {
        path: path.into(),
        source,
    };
    let corrupt = |cause: String| TileError::Corrupt {
        path: path.into(),
        cause,
    };
    unless(cancelled)?;
    let opened = files::open(path).map_err(|source| match source.kind() {
        // A path that is not a file will never be a tile: no retries.
        ErrorKind::IsADirectory | ErrorKind::InvalidInput => corrupt(source.to_string()),
        _ => unreadable(source),
    })?;
    unless(cancelled)?;
    // One byte more shows that the file has grown.
    let mut bytes = Vec::with_capacity(file.bytes as usize + 1);
    opened
        .take(file.bytes + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    check_length(&bytes, file).map_err(corrupt)?;
    unless(cancelled)?;
    check_sum(&bytes, file).map_err(corrupt)?;
    Ok(bytes)
}

/// The error of a file's bytes that do not match the manifest.
pub(super) fn check(bytes: &[u8], file: TileFile) -> Result<(), String> {
    check_length(bytes, file)?;
    check_sum(bytes, file)
}

fn check_length(bytes: &[u8], file: TileFile) -> Result<(), String> {
    let (found, expected) = (bytes.len() as u64, file.bytes);
    if found > expected {
        return Err(format!("it is longer than {expected} bytes"));
    }
    if found < expected {
        return Err(format!("it has {found} bytes instead of {expected}"));
    }
    Ok(())
}

fn check_sum(bytes: &[u8], file: TileFile) -> Result<(), String> {
    if TileFile::of(bytes) == file {
        Ok(())
    } else {
        Err("its checksum does not match the manifest".into())
    }
}
