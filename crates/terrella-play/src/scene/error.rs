//! Errors of scenes. Every message states the place (file, line, key), the problem and the remedy.

use std::fmt;
use std::path::{Path, PathBuf};
pub(super) use terrella_files::excerpt as printable;

/// Maximum size of a scene file, bytes. A scene with every key and long comments is a hundredth of
/// it.
pub(super) const MAX_FILE_BYTES: u64 = 1 << 20;

/// Location of a key in a scene file, present or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyLocation {
    /// The scene file.
    pub path: PathBuf,
    /// Line of the file, from 1; `None` for a default that the file does not give.
    pub line: Option<usize>,
    /// The table's name; empty for keys outside any table.
    pub table: String,
    /// The key; empty for a whole table.
    pub key: String,
}

impl fmt::Display for KeyLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        if !self.table.is_empty() {
            write!(f, " [{}]", printable(&self.table))?;
        }
        if !self.key.is_empty() {
            write!(f, " {}", printable(&self.key))?;
        }
        Ok(())
    }
}

/// Why a scene is rejected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum SceneError {
    /// The file could not be opened or read.
    #[error("{}: cannot be read: {source}; give the path of a scene file such as {}, or of an orbit file", path.display(), example().display())]
    Read {
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The path is a folder.
    #[error("{}: is a folder; give the path of a scene file in it", path.display())]
    Folder { path: PathBuf },
    /// The file exceeds the maximum size of a scene.
    #[error(
        "{}: is larger than {MAX_FILE_BYTES} bytes, the most that a scene may have; is it a scene file?",
        path.display()
    )]
    TooLarge { path: PathBuf },
    /// The file is packed.
    #[error("{}: is packed by {packing}; unpack it first", path.display())]
    Packed {
        path: PathBuf,
        /// The program that unpacks it.
        packing: &'static str,
    },
    /// The file is empty, and its name is not that of a scene.
    #[error("{}: is empty; give a scene file or an orbit file", path.display())]
    Empty { path: PathBuf },
    /// The file is not UTF-8 text.
    #[error("{}:{line}: is not UTF-8 text; save it as UTF-8", path.display())]
    NotUtf8 {
        path: PathBuf,
        /// First bad line, from 1.
        line: usize,
    },
    /// The text is not TOML.
    #[error("{}:{line}:{column}: is not TOML: {message}, at {found}{remedy}", path.display())]
    Syntax {
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// Expectation of the TOML reader.
        message: String,
        /// The text there.
        found: String,
        /// The remedy after a semicolon, if the mistake is a common one; else empty.
        remedy: String,
    },
    /// A key or table that no scene has.
    #[error("{place}: {remedy}")]
    Unknown {
        place: Box<KeyLocation>,
        /// The nearest known name, or all known names.
        remedy: String,
    },
    /// A required key is missing.
    #[error("{place}: {remedy}")]
    Missing {
        /// On the line of the first key that the table has.
        place: Box<KeyLocation>,
        /// The purpose of the key, and its syntax.
        remedy: String,
    },
    /// A file that is not a scene, and whose name does not suggest one.
    #[error(
        "{scene}; nor is it an orbit file: two-line elements, OMM, OEM, OPM, CZML, SP3, an ephemeris of STK, or CSV with columns epoch_utc, x_km, y_km, z_km"
    )]
    Neither { scene: Box<SceneError> },
    /// A value of the wrong type, out of range, or in conflict with another.
    #[error("{place} = {value}: {remedy}")]
    Value {
        place: Box<KeyLocation>,
        /// The value as written, or the default.
        value: String,
        /// The accepted values, and the reason if it is not obvious.
        remedy: String,
    },
}

impl SceneError {
    /// The scene file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Read { path, .. }
            | Self::Folder { path }
            | Self::TooLarge { path }
            | Self::Packed { path, .. }
            | Self::Empty { path }
            | Self::NotUtf8 { path, .. }
            | Self::Syntax { path, .. } => path,
            Self::Unknown { place, .. }
            | Self::Missing { place, .. }
            | Self::Value { place, .. } => &place.path,
            Self::Neither { scene } => scene.path(),
        }
    }

    /// The line of the file, from 1, if known.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Read { .. }
            | Self::Folder { .. }
            | Self::TooLarge { .. }
            | Self::Packed { .. }
            | Self::Empty { .. } => None,
            Self::NotUtf8 { line, .. } | Self::Syntax { line, .. } => Some(*line),
            Self::Unknown { place, .. }
            | Self::Missing { place, .. }
            | Self::Value { place, .. } => place.line,
            Self::Neither { scene } => scene.line(),
        }
    }
}

/// A scene that exists: one that was installed with this program, or one of the repository's.
fn example() -> PathBuf {
    let program = std::env::current_exe().ok();
    let bin = program.as_deref().and_then(Path::parent);
    let installed = bin.map(|bin| bin.join("../share/terrella/config/iss.toml"));
    let installed = installed.and_then(|path| path.canonicalize().ok());
    installed.unwrap_or_else(|| "config/iss.toml".into())
}
