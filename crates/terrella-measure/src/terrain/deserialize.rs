//! What the readers of trees share.

use super::qbernstein::QError;

/// Bytes that are no patches, or no contours.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DeserializeError {
    /// Not this format, or another version of it.
    #[error("it is not in this format (version 1); build it again")]
    Format,
    /// The checksum does not fit.
    #[error("it is damaged: its checksum does not fit; build it again")]
    Checksum,
    /// Made from other heights or options.
    #[error("it was made from other heights or options; build it again")]
    Stale,
    /// A number that cannot be.
    #[error("it says {what}, which cannot be; build it again")]
    Content {
        /// What is said.
        what: &'static str,
    },
    /// Larger than allowed.
    #[error("it needs {bytes} bytes of memory; {budget} are allowed; allow more")]
    Budget {
        /// Needed.
        bytes: u64,
        /// Allowed.
        budget: u64,
    },
    /// q out of range.
    #[error(transparent)]
    Basis(#[from] QError),
}

/// The number at the beginning of the bytes, which are enough.
pub(super) fn read_u32(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

/// See [`read_u32`].
pub(super) fn read_f64(bytes: &[u8]) -> f64 {
    let mut eight = [0; 8];
    eight.copy_from_slice(&bytes[..8]);
    f64::from_le_bytes(eight)
}
