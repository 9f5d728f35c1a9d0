//! Why a folder of frames is rejected.

use std::path::PathBuf;

/// Why frames cannot be written to a folder, or not these.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum FilmError {
    /// The folder holds something already.
    #[error("{}: is not empty; choose another folder, give --resume to go on with the film in it, or --overwrite to replace frames in it", path.display())]
    NotEmpty { path: PathBuf },
    /// The folder holds something, and no film.
    #[error("{}: there is no film to go on with: it holds files and no frames.json; choose another folder, or give --overwrite to replace frames in it", path.display())]
    NoFilm { path: PathBuf },
    /// The folder holds frames of another film.
    #[error("{}: holds frames of another film: {differences}; choose another folder, or give --overwrite to draw all frames again", path.display())]
    OtherFilm {
        path: PathBuf,
        /// What is different, in words.
        differences: String,
    },
    /// The page of a folder cannot be understood.
    #[error("{}: {problem}; choose another folder, or give --overwrite to draw all frames again", path.display())]
    BadPage { path: PathBuf, problem: String },
    /// Another run writes to the folder.
    #[error("{}: another run is writing frames to this folder; wait for its end, or give each run a folder of its own (frames are numbered by their place in the film, so that folders can be joined)", path.display())]
    Busy { path: PathBuf },
    /// Frames that the film does not have.
    #[error("there are no frames {wanted}: the film has {frame_count} frames, from 0 to {}", frame_count.saturating_sub(1))]
    NoSuchFrames {
        /// The range asked for.
        wanted: String,
        frame_count: u64,
    },
    /// A scene that is drawn in display colours, and settings that average light.
    #[error("{}: --format png16 and exr, --alpha, --supersample and --shutter make pictures of light, and {what} have none; {remedy}, or leave those options out", scene.display())]
    NoLight {
        scene: PathBuf,
        what: &'static str,
        /// What the user can do about it.
        remedy: &'static str,
    },
    /// A file that makes the film what it is cannot be read.
    #[error("{}: {source}; the film's pictures come from this file, so --resume must compare it", path.display())]
    Input {
        path: PathBuf,
        source: std::io::Error,
    },
}
