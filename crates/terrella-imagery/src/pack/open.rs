//! Opening a pack: its folder and its manifest.

use super::error::{MAX_MANIFEST_BYTES, PackError};
use super::heights::HeightIndex;
use super::manifest::{MANIFEST_FILE, Manifest, tile_path};
use crate::tile::{Storage, TileKey};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use terrella_files as files;

/// Name of the file in a pack's folder by which the building goes on after it was broken off. It is there from the
/// first tile to the last, and the manifest only after it.
pub const JOURNAL_FILE: &str = "build.journal";

/// A pack on disk whose manifest was read and found good. Of its tiles nothing is known yet.
#[derive(Debug)]
pub struct Pack {
    dir: PathBuf,
    manifest: Manifest,
}

impl Pack {
    /// Reads the manifest of the pack in a folder.
    ///
    /// # Errors
    /// No folder, a folder that is no pack or one that is not finished, and whatever [`Manifest::from_toml`] rejects.
    pub fn open(dir: &Path) -> Result<Self, PackError> {
        let found = std::fs::metadata(dir).map_err(|source| match source.kind() {
            ErrorKind::NotFound => PackError::Missing { path: dir.into() },
            _ => PackError::Read {
                path: dir.into(),
                source,
            },
        })?;
        if !found.is_dir() {
            return Err(PackError::NotAFolder { path: dir.into() });
        }
        let path = dir.join(MANIFEST_FILE);
        let text = match read_text(&path) {
            Err(PackError::Read { source, .. }) if source.kind() == ErrorKind::NotFound => {
                let path = dir.into();
                return Err(if dir.join(JOURNAL_FILE).exists() {
                    PackError::Unfinished { path }
                } else {
                    PackError::NoManifest { path }
                });
            }
            text => text?,
        };
        Ok(Self {
            dir: dir.into(),
            manifest: Manifest::from_toml(&text, &path)?,
        })
    }

    /// The pack of a manifest's bytes, for a host that reads the files itself, as a web page does. `dir` is the folder or the address, for messages.
    ///
    /// # Errors
    /// Bytes that are too many or no text, and whatever [`Manifest::from_toml`] rejects.
    pub fn from_manifest(dir: &Path, bytes: Vec<u8>) -> Result<Self, PackError> {
        let path = dir.join(MANIFEST_FILE);
        if bytes.len() as u64 > MAX_MANIFEST_BYTES {
            return Err(PackError::TooLarge { path });
        }
        let text = text_of(&path, bytes)?;
        Ok(Self {
            dir: dir.into(),
            manifest: Manifest::from_toml(&text, &path)?,
        })
    }

    /// Its folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Its manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The index of its elevation data; `None` if it has none.
    ///
    /// # Errors
    /// An index that is missing or does not match the manifest.
    pub fn height_index(&self) -> Result<Option<HeightIndex>, PackError> {
        let entry = self.manifest.heights.as_ref();
        entry
            .map(|entry| HeightIndex::read(&self.dir, entry))
            .transpose()
    }

    /// The file of a tile; `None` for a level or a part that the manifest has not.
    pub fn tile_path(&self, storage: Storage, key: TileKey) -> Option<PathBuf> {
        let entry = self.manifest.layer(key.layer)?;
        let level = entry.levels.get(usize::from(key.level))?;
        if key.part >= level.shape.tiles_of_block() {
            return None;
        }
        let path = tile_path(storage, key.layer, level.shape, key.block(), key.part);
        Some(self.dir.join(path))
    }
}

/// A text file of at most [`MAX_MANIFEST_BYTES`].
fn read_text(path: &Path) -> Result<String, PackError> {
    let unreadable = |source| PackError::Read {
        path: path.into(),
        source,
    };
    let too_large = || PackError::TooLarge { path: path.into() };
    let bytes = files::read(path, MAX_MANIFEST_BYTES).map_err(unreadable)?;
    text_of(path, bytes.ok_or_else(too_large)?)
}

fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String, PackError> {
    String::from_utf8(bytes).map_err(|error| {
        let good = error
            .as_bytes()
            .iter()
            .take(error.utf8_error().valid_up_to());
        PackError::NotUtf8 {
            path: path.into(),
            line: good.filter(|byte| **byte == b'\n').count() + 1,
        }
    })
}
