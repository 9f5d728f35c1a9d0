//! Where the files of a set of maps are: in a folder, or in memory under the names that they would have there.

use super::error::ImageryError;
use super::map_file::{MAX_FILE_BYTES, MapFile, read_file};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The files of a set of maps.
#[derive(Clone, Copy, Debug)]
pub enum MapFolder<'a> {
    /// A folder on disk.
    Disk(&'a Path),
    /// Contents of files by their names in such a folder: for programs without a file system, as in a web page.
    Memory(&'a HashMap<String, Vec<u8>>),
}

impl<'a> From<&'a Path> for MapFolder<'a> {
    fn from(dir: &'a Path) -> Self {
        Self::Disk(dir)
    }
}

impl<'a> From<&'a HashMap<String, Vec<u8>>> for MapFolder<'a> {
    fn from(files: &'a HashMap<String, Vec<u8>>) -> Self {
        Self::Memory(files)
    }
}

impl<'a> MapFolder<'a> {
    /// Name of a file in messages.
    pub(super) fn path(self, name: &str) -> PathBuf {
        match self {
            Self::Disk(dir) => dir.join(name),
            Self::Memory(_) => name.into(),
        }
    }

    pub(super) fn has(self, name: &str) -> bool {
        match self {
            Self::Disk(dir) => dir.join(name).exists(),
            Self::Memory(files) => files.contains_key(name),
        }
    }

    /// The first of these names that it has a file of.
    pub(super) fn first<'n>(self, names: &[&'n str]) -> Option<&'n str> {
        names.iter().copied().find(|name| self.has(name))
    }

    /// The bytes of a map's file; `layer` is what messages call the map.
    pub(super) fn read(
        self,
        name: &str,
        layer: &'static str,
    ) -> Result<Cow<'a, [u8]>, ImageryError> {
        let files = match self {
            Self::Disk(dir) => return Ok(read_file(&dir.join(name), layer)?.into()),
            Self::Memory(files) => files,
        };
        let contents = files.get(name).ok_or_else(|| ImageryError::Missing {
            path: name.into(),
            layer,
        })?;
        if contents.len() as u64 > MAX_FILE_BYTES {
            return Err(ImageryError::FileTooLarge {
                path: name.into(),
                bytes: contents.len() as u64,
                limit: MAX_FILE_BYTES,
            });
        }
        Ok(contents.into())
    }

    /// Width in a file's header, texels; `None` if it has none.
    pub(super) fn width(self, name: &str) -> Option<u32> {
        match self {
            Self::Disk(dir) => MapFile::width(&dir.join(name)),
            Self::Memory(files) => MapFile::width_of(files.get(name)?),
        }
    }
}
