//! Serialized trees in a folder: whole files with checksums, or none.

use std::fmt::Display;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_play::{OutputError, PendingFile};

/// Extension of the files.
const EXTENSION: &str = "tree";

/// A folder of serialized trees; without one nothing is read or written.
pub(super) struct Cache {
    folder: Option<PathBuf>,
    /// Larger files are not read.
    max_bytes: u64,
}

impl Cache {
    /// Makes the folder and tries whether files can be made in it.
    pub fn open(folder: Option<&Path>, max_bytes: u64) -> Result<Self, OutputError> {
        if let Some(folder) = folder {
            if folder.exists() && !folder.is_dir() {
                return Err(OutputError::InTheWay {
                    path: folder.into(),
                    found: "a file",
                });
            }
            std::fs::create_dir_all(folder).map_err(|source| OutputError::Write {
                path: folder.into(),
                source,
            })?;
            PendingFile::create(&folder.join("try.tree"), "trees", EXTENSION)?;
        }
        Ok(Self {
            folder: folder.map(Path::to_owned),
            max_bytes,
        })
    }

    fn path(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{name}.{EXTENSION}")))
    }

    /// The tree of that name as `read` finds it in the file. `None` where there is no such file, and, with a warning that names
    /// it, where it cannot be used: it is to be built.
    pub fn load<T, E: Display>(
        &self,
        name: &str,
        read: impl FnOnce(&[u8]) -> Result<T, E>,
    ) -> Option<T> {
        let path = self.path(name)?;
        let refused = |why: &dyn Display| {
            tracing::warn!(
                "{}: {why}: this is done now, and the file is replaced",
                path.display()
            );
            None
        };
        match self.bytes(&path) {
            Ok(Some(bytes)) => match read(&bytes) {
                Ok(tree) => Some(tree),
                Err(error) => refused(&error),
            },
            Ok(None) => None,
            Err(error) => refused(&format_args!("{error}; build it again")),
        }
    }

    /// What a file holds; `None` where there is none.
    fn bytes(&self, path: &Path) -> std::io::Result<Option<Vec<u8>>> {
        let max = self.max_bytes;
        match files::read(path, max) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Ok(None) => {
                let what = format!("it has more than the {max} bytes that are allowed");
                Err(std::io::Error::other(what))
            }
            read => read,
        }
    }

    /// Writes a tree under its name, in place of what was there.
    pub fn store(&self, name: &str, bytes: impl FnOnce() -> Vec<u8>) -> Result<(), OutputError> {
        let Some(path) = self.path(name) else {
            return Ok(());
        };
        PendingFile::create(&path, "trees", EXTENSION)?.write_whole(&bytes())
    }
}
