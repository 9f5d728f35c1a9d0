//! What can go wrong between an Earth and its picture in memory.

use crate::EarthError;
use crate::gpu::{ContextError, PictureError};
use terrella_imagery::ImageryError;

/// What can go wrong between an Earth and its picture in memory.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OffscreenError {
    /// The adapter.
    #[error(transparent)]
    Context(#[from] ContextError),
    #[error(transparent)]
    Earth(#[from] EarthError),
    /// The maps.
    #[error(transparent)]
    Imagery(#[from] ImageryError),
    /// Reading a picture back.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The picture is larger than the adapter draws.
    #[error(
        "a picture of {width} × {height} pixels exceeds the limit of {adapter}, {limit} pixels a side; \
         take a smaller size"
    )]
    TooLarge {
        width: u32,
        height: u32,
        adapter: String,
        limit: u32,
    },
    /// The picture needs more memory than this program takes.
    #[error(
        "a picture of {width} × {height} pixels with {samples} samples each needs {mib} MiB, more than the {limit_mib} \
         MiB allowed; take a smaller size, or samples = 1 in [output]"
    )]
    TooMuchMemory {
        width: u32,
        height: u32,
        /// Samples a pixel.
        samples: u32,
        /// What it would take, MiB.
        mib: u64,
        /// What is allowed, MiB.
        limit_mib: u64,
    },
    /// Truth that needs more memory than this program takes.
    #[error(
        "the truth layers of {width} × {height} pixels need {mib} MiB, more than the {limit_mib} MiB allowed; take a \
         smaller size"
    )]
    TruthTooLarge {
        width: u32,
        height: u32,
        /// What they would take, MiB.
        mib: u64,
        /// What is allowed, MiB.
        limit_mib: u64,
    },
    /// A view of which there is no picture.
    #[error(
        "this view cannot be rendered: its eye, projection or sky is not finite, its projection has no inverse, or its eye is \
         beyond 1e24 m"
    )]
    NoPicture,
    /// A buffer that the picture does not fit.
    #[error("a picture of {width} × {height} pixels has {needed} values, the buffer {got}")]
    Length {
        /// Width of the picture.
        width: u32,
        /// Height of the picture.
        height: u32,
        needed: usize,
        /// How many the buffer has.
        got: usize,
    },
    /// The device rejected the picture's textures.
    #[error(
        "{adapter} cannot hold a picture of {width} × {height} pixels: {cause}; take a smaller size"
    )]
    NoRoom {
        width: u32,
        height: u32,
        adapter: String,
        /// The device's words.
        cause: String,
    },
}
