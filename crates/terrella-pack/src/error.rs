//! Why a pack could not be built, with the file, the cause and the remedy.

use std::path::PathBuf;
use terrella_ground::elevation::HeightFileError;
use terrella_ground::elevation::spool::SpoolError;
use terrella_imagery::tile::MapLayer;

/// Why a pack could not be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum BuildError {
    /// A map could not be opened or read.
    #[error("{}: {source}; check that it is a file and its permissions", path.display())]
    Unreadable {
        path: PathBuf,
        source: std::io::Error,
    },
    /// A map cannot be used as it is.
    #[error("{}: {cause}; {advice}", path.display())]
    Source {
        path: PathBuf,
        /// The error in the file.
        cause: String,
        /// The remedy.
        advice: String,
    },
    /// A map began well and then broke.
    #[error("{}: truncated or damaged: {cause}; copy or make it again", path.display())]
    Damaged {
        path: PathBuf,
        /// The decoder's words.
        cause: String,
    },
    /// A ladder of levels that cannot be.
    #[error("--pixels {}={pixels}: {cause}", layer.name())]
    Pixels {
        /// Map whose levels were requested.
        layer: MapLayer,
        /// The requested levels, as written.
        pixels: String,
        /// The error, and the allowed values.
        cause: String,
    },
    /// An option that cannot be.
    #[error("{option}: {cause}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The error, and the allowed values.
        cause: String,
    },
    /// Not enough memory allowed.
    #[error(
        "--memory {allowed_mb}: the {} map needs {needed_mb} MB at least; allow that much or give a ladder \
         with fewer pixels", layer.name()
    )]
    Memory {
        /// Map that does not fit.
        layer: MapLayer,
        /// Memory allowed, megabytes.
        allowed_mb: u64,
        /// Memory required, megabytes.
        needed_mb: u64,
    },
    /// Heights could not be read.
    #[error(transparent)]
    Heights(#[from] HeightFileError),
    /// Not enough memory to read elevation data in parts.
    #[error(
        "--memory {allowed_mb}: {} has {columns} x {rows} heights and needs {needed_mb} MB at least to be read part by part; allow \
         that much or write it in tiles (`gdal_translate -co TILED=YES -co BIGTIFF=IF_SAFER IN OUT.tif`)", path.display()
    )]
    HeightsMemory {
        path: PathBuf,
        /// Samples of a row.
        columns: u32,
        rows: u32,
        /// Memory allowed, megabytes.
        allowed_mb: u64,
        /// Memory required, megabytes.
        needed_mb: u64,
    },
    /// No room for the scratch file through which elevation data is read.
    #[error(
        "{}: heights that do not fit into --memory are kept there while their tiles are made, {needed_mb} MB, and {free_mb} MB are \
         free; make room or allow more memory, then run the same command again to go on", path.display()
    )]
    ScratchRoom {
        path: PathBuf,
        /// Space required, megabytes.
        needed_mb: u64,
        /// Space available, megabytes.
        free_mb: u64,
    },
    /// A scratch file could not be written or read.
    #[error(
        "{}: {source}; heights that do not fit into --memory are kept there while their tiles are made: make room or allow more \
         memory, then run the same command again to go on", path.display()
    )]
    Scratch {
        path: PathBuf,
        source: std::io::Error,
    },
    /// The folder holds something that is not a pack.
    #[error("{}: holds {found}, which no pack has; give an empty folder or a new name", path.display())]
    NotEmpty {
        /// Folder that was to be written to.
        path: PathBuf,
        /// A name that was found there.
        found: String,
    },
    /// The folder holds a finished pack.
    #[error("{}: is a finished pack; add --restart to throw it away and build again", path.display())]
    Finished { path: PathBuf },
    /// The folder holds a build with other maps or options.
    #[error(
        "{}: holds an unfinished pack of other maps or options; repeat them to go on with it, or add --restart to \
         throw it away", path.display()
    )]
    OtherBuild { path: PathBuf },
    /// Another process builds there.
    #[error("{}: another build is writing there; wait for it or give another folder", path.display())]
    Busy { path: PathBuf },
    /// A file of the pack could not be written.
    #[error(
        "{}: {source}; make room or correct the permissions, then run the same command again to go on",
        path.display()
    )]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    /// The machine cannot start threads.
    #[error("no threads for encoding: {0}; end other programs and try again")]
    Threads(String),
    /// Stopped on request.
    #[error("stopped; run the same command again to go on")]
    Cancelled,
}

impl From<SpoolError> for BuildError {
    fn from(error: SpoolError) -> Self {
        match error {
            SpoolError::Heights(error) => Self::Heights(error),
            SpoolError::Scratch { path, source } => Self::Scratch { path, source },
            SpoolError::NoRoom {
                path,
                needed_bytes,
                free_bytes,
            } => Self::ScratchRoom {
                path,
                needed_mb: needed_bytes.div_ceil(1_000_000),
                free_mb: free_bytes / 1_000_000,
            },
            SpoolError::Stopped => Self::Cancelled,
        }
    }
}
