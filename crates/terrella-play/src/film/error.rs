//! Why a folder of frames is rejected.

use std::path::PathBuf;
use terrella::Hdr;

/// Why frames cannot be written to a folder, or not these.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum FilmError {
    /// The folder holds something already.
    #[error("{}: is not empty; choose another folder, give --resume to resume the film in it, or --overwrite to replace frames in it", path.display())]
    NotEmpty { path: PathBuf },
    /// The folder holds something, and no film.
    #[error("{}: there is no film to resume: it contains files but no frames.json; choose another folder, or give --overwrite to replace frames in it", path.display())]
    NoFilm { path: PathBuf },
    /// The folder holds frames of another film.
    #[error("{}: holds frames of another film: {differences}; choose another folder, or give --overwrite to render all frames again", path.display())]
    OtherFilm {
        path: PathBuf,
        /// The differences, as text.
        differences: String,
    },
    /// The page of a folder cannot be understood.
    #[error("{}: {problem}; choose another folder, or give --overwrite to render all frames again", path.display())]
    BadPage { path: PathBuf, problem: String },
    /// Another run writes to the folder.
    #[error("{}: another run is writing frames to this folder; wait until it ends, or give each run its own folder (frames are numbered by their position in the film, so the folders can be merged)", path.display())]
    Busy { path: PathBuf },
    /// Frames that the film does not have.
    #[error("there are no frames {wanted}: the frames of the film are 0 to {}", frame_count.saturating_sub(1))]
    NoSuchFrames {
        /// The requested range.
        wanted: String,
        frame_count: u64,
    },
    /// A scene that is drawn in display colours, and settings that average light.
    #[error("{}: --format png16, exr, pq and hlg, --alpha, --supersample and --shutter write linear light, and {what} have none; {remedy}, or omit those options", scene.display())]
    NoLight {
        scene: PathBuf,
        what: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// An overlay in display colours over images that are scene-referred light or transparent.
    #[error("{}: --format exr and --alpha have no room for {what}, which have display colours; {remedy}, or omit these options", scene.display())]
    NoOverlay {
        scene: PathBuf,
        what: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// A peak luminance for a format without one.
    #[error(
        "--peak is for --format pq: other formats have the peak of their display, and HLG always 1000 cd/m²; omit it, or choose --format pq"
    )]
    PeakWithoutPq,
    /// A peak luminance that is no number of the range.
    #[error("--peak: {peak_cd_m2} cd/m² is not from {} to {}; most displays have 1000", Hdr::PEAKS_CD_M2.start(), Hdr::PEAKS_CD_M2.end())]
    Peak { peak_cd_m2: f64 },
    /// Transparent space and high dynamic range.
    #[error(
        "--alpha has no meaning for light that is brighter than white; omit it, or choose --format exr, which keeps alpha and all light"
    )]
    HdrAlpha,
    /// A file that makes the film what it is cannot be read.
    #[error("{}: {source}; the film depends on this file, so it must be readable", path.display())]
    Input {
        path: PathBuf,
        source: std::io::Error,
    },
}
