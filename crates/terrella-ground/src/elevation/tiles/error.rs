//! Errors of elevation tiles.

use super::HeightTileKey;
use std::error::Error;
use std::sync::Arc;

#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeightTileError {
    /// The tile was no longer wanted.
    #[error("{0} was cancelled")]
    Cancelled(HeightTileKey),
    /// The source has no such tile.
    #[error("{0} is not in the source; its range should have said so")]
    Absent(HeightTileKey),
    /// It could not be read.
    #[error("{key} cannot be read: {cause}")]
    Unreadable {
        key: HeightTileKey,
        /// The cause, with the file and the remedy.
        cause: Arc<dyn Error + Send + Sync>,
    },
    /// It was read and is invalid.
    #[error("{key} is not an elevation tile: {what}; build the pack again")]
    Unsound { key: HeightTileKey, what: String },
}
