//! Errors of an Earth that renders into memory.

use crate::EarthError;
use crate::gpu::{ContextError, PictureError};
use terrella_imagery::ImageryError;

/// Why an Earth could not be rendered into memory.
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
    /// Reading an image back.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The image has no pixels.
    #[error("a picture of {width} × {height} pixels is empty; width and height must be at least 1")]
    Empty {
        /// Width of the image.
        width: u32,
        /// Height of the image.
        height: u32,
    },
    /// The image is larger than the adapter supports.
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
    /// The image needs more memory than this program allows.
    #[error(
        "a picture of {width} × {height} pixels with {samples} samples each needs {mib} MiB, more than the {limit_mib} \
         MiB allowed; take a smaller size, or samples = 1 in [output]"
    )]
    TooMuchMemory {
        width: u32,
        height: u32,
        /// Samples a pixel.
        samples: u32,
        /// Memory required, MiB.
        mib: u64,
        /// Memory allowed, MiB.
        limit_mib: u64,
    },
    /// The truth layers need more memory than this program allows.
    #[error(
        "the truth layers of {width} × {height} pixels need {mib} MiB, more than the {limit_mib} MiB allowed; take a \
         smaller size"
    )]
    TruthTooLarge {
        width: u32,
        height: u32,
        /// Memory required, MiB.
        mib: u64,
        /// Memory allowed, MiB.
        limit_mib: u64,
    },
    /// A view that has no image.
    #[error(
        "this view cannot be rendered: its eye, projection or sky is not finite, its projection has no inverse, or its eye is \
         beyond 1e24 m"
    )]
    NoPicture,
    /// The length of a buffer does not match the image.
    #[error("a picture of {width} × {height} pixels has {needed} values, the buffer {got}")]
    Length {
        /// Width of the image.
        width: u32,
        /// Height of the image.
        height: u32,
        needed: usize,
        /// Length of the buffer.
        got: usize,
    },
    /// The device rejected the image's textures.
    #[error(
        "{adapter} cannot hold a picture of {width} × {height} pixels: {cause}; take a smaller size"
    )]
    NoRoom {
        width: u32,
        height: u32,
        adapter: String,
        /// Error message of the device.
        cause: String,
    },
}
