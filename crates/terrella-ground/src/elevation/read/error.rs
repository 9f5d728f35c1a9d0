//! Errors of reading heights: the file, the cause, what was expected and what to do.

use crate::elevation::GridError;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use terrella_files as files;

/// Why heights could not be read from a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeightFileError {
    /// A file could not be opened or read.
    #[error("{}: {source}; check that it is a file and its permissions", path.display())]
    Unreadable {
        path: PathBuf,
        source: std::io::Error,
    },
    /// A file began correctly and then broke.
    #[error("{}: truncated or damaged: {cause}; copy or make it again", path.display())]
    Damaged { path: PathBuf, cause: String },
    /// The file is not usable as it is.
    #[error("{}: {cause}; expected {expected}: {remedy}", path.display())]
    Rejected {
        path: PathBuf,
        /// What the file is or lacks.
        cause: String,
        /// Accepted alternatives.
        expected: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// A grid in a system that is not latitude and longitude of WGS84 or close to it.
    #[error(
        "{}: is in {crs}; expected latitudes and longitudes of WGS84: `gdalwarp -t_srs EPSG:4326 -r bilinear {} OUT.tif`",
        path.display(), path.display()
    )]
    OtherCoordinates {
        path: PathBuf,
        /// Its coordinate system, with the EPSG code if stated.
        crs: String,
    },
    /// Rows that do not run from west to east.
    #[error(
        "{}: is rotated or sheared; expected rows from west to east: `gdalwarp -t_srs EPSG:4326 -r bilinear {} OUT.tif`",
        path.display(), path.display()
    )]
    Rotated { path: PathBuf },
    /// Neither file nor sidecar states the position of the heights.
    #[error(
        "{}: has no bounds; define them in {}: write bounds = {{ south_deg = …, north_deg = …, west_deg = …, \
         east_deg = … }} and registration = \"cells\" or \"posts\" there", path.display(), sidecar.display()
    )]
    NoPlace { path: PathBuf, sidecar: PathBuf },
    /// Neither file nor sidecar states the unit of heights.
    #[error(
        "{}: does not state the unit of its elevations; define it in {}: write unit = \"metres\", \"feet\" or \
         \"us-survey-feet\" there, or for all files of the folder in its folder.toml", path.display(), sidecar.display()
    )]
    NoUnit { path: PathBuf, sidecar: PathBuf },
    /// File and sidecar contradict each other.
    #[error(
        "{}: has elevations in {of_file}, but its sidecar or folder.toml says {of_sidecar}; correct unit there",
        path.display()
    )]
    TwoUnits {
        path: PathBuf,
        of_file: &'static str,
        of_sidecar: &'static str,
    },
    #[error("{}:{line}: {cause}{}", path.display(), described_by(path))]
    Sidecar {
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong and what is expected.
        cause: String,
    },
    /// The heights do not form a grid.
    #[error("{}: {source}", path.display())]
    Grid {
        path: PathBuf,
        /// Why its grid is rejected.
        source: GridError,
    },
}

/// Why a file is read as a sidecar, which its name alone decides.
fn described_by(sidecar: &Path) -> &'static str {
    match sidecar
        .file_name()
        .is_some_and(|name| name == "folder.toml")
    {
        true => "",
        false => "; by its name it describes the elevation file beside it",
    }
}

/// Errors about one file.
#[derive(Clone, Debug)]
pub(super) struct FileContext(PathBuf);

impl FileContext {
    pub fn new(path: &Path) -> Self {
        Self(path.to_path_buf())
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    pub(super) fn unreadable(&self, source: std::io::Error) -> HeightFileError {
        HeightFileError::Unreadable {
            path: self.0.clone(),
            source,
        }
    }

    /// An error while reading; a premature end is damage.
    pub(super) fn reading(&self, source: std::io::Error) -> HeightFileError {
        match source.kind() {
            std::io::ErrorKind::UnexpectedEof => self.damaged("the file ends too early"),
            // Decoders of compressed data report damage this way.
            std::io::ErrorKind::InvalidData
            | std::io::ErrorKind::InvalidInput
            | std::io::ErrorKind::Other => self.damaged(source),
            _ => self.unreadable(source),
        }
    }

    pub(super) fn damaged(&self, cause: impl Display) -> HeightFileError {
        HeightFileError::Damaged {
            path: self.0.clone(),
            cause: files::cause(cause),
        }
    }

    pub(super) fn rejected(
        &self,
        cause: impl Display,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> HeightFileError {
        HeightFileError::Rejected {
            path: self.0.clone(),
            cause: files::cause(cause),
            expected: expected.into(),
            remedy: remedy.into(),
        }
    }

    pub(super) fn other_coordinates(&self, crs: impl Display) -> HeightFileError {
        HeightFileError::OtherCoordinates {
            path: self.0.clone(),
            crs: files::cause(crs),
        }
    }

    /// Reports why a projected grid is not warped.
    pub(super) fn unwarped(&self, cause: String) -> HeightFileError {
        self.rejected(
            cause,
            "projected heights of at most 268 million samples, near the middle of their projection",
            format!(
                "`gdalwarp -t_srs EPSG:4326 -r bilinear {} OUT.tif`",
                self.0.display()
            ),
        )
    }

    pub(super) fn rotated(&self) -> HeightFileError {
        HeightFileError::Rotated {
            path: self.0.clone(),
        }
    }

    pub(super) fn grid(&self, source: GridError) -> HeightFileError {
        HeightFileError::Grid {
            path: self.0.clone(),
            source,
        }
    }
}
