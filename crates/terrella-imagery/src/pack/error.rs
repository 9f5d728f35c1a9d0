//! Errors of packs. Every message names the place, the error and the remedy.

use crate::ImageryError;
use crate::tile::{MapLayer, Storage, TileError, TileKey};
use std::fmt;
use std::path::{Path, PathBuf};

/// Most bytes of a manifest: all levels that every map can have, four of them cut into parts, in both storages take two thirds of it.
pub const MAX_MANIFEST_BYTES: u64 = 32 << 20;

/// Most commas and lines of a manifest, which no fewer values can have: the same take three quarters of it.
pub const MAX_MANIFEST_VALUES: usize = 1_500_000;

/// A key of a manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ManifestPlace {
    /// The manifest.
    pub path: PathBuf,
    /// Line of the file, from 1; `None` for a key that the file should have and has not.
    pub line: Option<usize>,
    /// The key with its enclosing tables: `layer.level.plain.bytes`.
    pub key: String,
}

impl fmt::Display for ManifestPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        write!(f, " {}", self.key)
    }
}

/// Errors of a pack.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum PackError {
    /// The path does not exist.
    #[error("{}: there is no such folder; give the folder of a pack, made by `terrella pack build`", path.display())]
    Missing {
        /// The path given.
        path: PathBuf,
    },
    /// The path is a file.
    #[error("{}: is not a folder; a pack is a folder with a pack.toml in it", path.display())]
    NotAFolder {
        /// The path given.
        path: PathBuf,
    },
    /// The building of the pack was broken off.
    #[error("{}: the pack is incomplete; run the same `terrella pack build` again to finish it", path.display())]
    Unfinished { path: PathBuf },
    /// A folder without a manifest.
    #[error("{}: is not a pack: there is no pack.toml in it; give the folder of a pack, made by `terrella pack build`", path.display())]
    NoManifest { path: PathBuf },
    /// A file or folder could not be read.
    #[error("{}: cannot be read: {source}; check the disk and the permissions", path.display())]
    Read {
        /// The path that could not be read.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The manifest is larger than any needs to be.
    #[error(
        "{}: is larger than {MAX_MANIFEST_BYTES} bytes or has more than {MAX_MANIFEST_VALUES} values, the most that a \
         manifest may have; is it a pack's?",
        path.display()
    )]
    TooLarge {
        /// The manifest.
        path: PathBuf,
    },
    /// The manifest is not UTF-8 text.
    #[error("{}:{line}: is not UTF-8 text; build the pack again", path.display())]
    NotUtf8 {
        /// The manifest.
        path: PathBuf,
        /// First bad line, from 1.
        line: usize,
    },
    /// The manifest is not TOML.
    #[error("{}:{line}: is not TOML: {message}, at {found}; build the pack again or correct the line", path.display())]
    Syntax {
        /// The manifest.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Error message of the TOML parser.
        message: String,
        /// The text there.
        found: String,
    },
    /// A key of the manifest is missing, unknown, or has a value that it may not have.
    #[error("{place}: {cause}")]
    Key {
        place: Box<ManifestPlace>,
        /// The error, and the required content.
        cause: String,
    },
    /// The pack does not keep its tiles that way.
    #[error("{}: has no {} tiles, only {has}; build the pack with them or choose the other storage", path.display(), storage.name())]
    NoStorage {
        path: PathBuf,
        storage: Storage,
        has: &'static str,
    },
    /// The pack does not hold a map.
    #[error("{}: has no {} map; build the pack with it or turn the layer off", path.display(), layer.name())]
    NoLayer { path: PathBuf, layer: MapLayer },
    /// The pack has no elevation data.
    #[error("{}: has no heights; build the pack with them (`terrella pack build --heights FILE`)", path.display())]
    NoHeights { path: PathBuf },
    /// The index of elevation tiles does not match the manifest.
    #[error("{}: {cause}; build the pack again", path.display())]
    HeightIndex { path: PathBuf, cause: String },
    /// Nothing is left of a block that is always drawn: its tiles of every level are bad.
    #[error("{}: no level of {block} can be read, of its coarsest: {source}", path.display())]
    BlockLost {
        path: PathBuf,
        /// The tile of the coarsest level.
        block: TileKey,
        source: TileError,
    },
    /// A map assembled from tiles is invalid.
    #[error("{}: the {} map: {source}", path.display(), layer.name())]
    Map {
        path: PathBuf,
        /// The map that is rejected.
        layer: MapLayer,
        /// Why it is rejected.
        source: ImageryError,
    },
}

impl PackError {
    /// The file or folder that is meant.
    pub fn path(&self) -> &Path {
        match self {
            Self::Missing { path }
            | Self::NotAFolder { path }
            | Self::Unfinished { path }
            | Self::NoManifest { path }
            | Self::Read { path, .. }
            | Self::TooLarge { path }
            | Self::NotUtf8 { path, .. }
            | Self::Syntax { path, .. }
            | Self::NoStorage { path, .. }
            | Self::NoLayer { path, .. }
            | Self::NoHeights { path }
            | Self::HeightIndex { path, .. }
            | Self::BlockLost { path, .. }
            | Self::Map { path, .. } => path,
            Self::Key { place, .. } => &place.path,
        }
    }

    /// The manifest's line, from 1, where there is one to name.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::NotUtf8 { line, .. } | Self::Syntax { line, .. } => Some(*line),
            Self::Key { place, .. } => place.line,
            _ => None,
        }
    }
}
