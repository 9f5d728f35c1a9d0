//! What can be wrong with a tile of heights.

use super::HeightTileKey;
use std::error::Error;
use std::sync::Arc;

#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeightTileError {
    /// Nobody wanted it any more.
    #[error("{0} was cancelled")]
    Cancelled(HeightTileKey),
    /// The source has no such tile.
    #[error("{0} is not in the source; its range should have said so")]
    Absent(HeightTileKey),
    /// It could not be read.
    #[error("{key} cannot be read: {cause}")]
    Unreadable {
        key: HeightTileKey,
        /// Why, with the file and what to do about it.
        cause: Arc<dyn Error + Send + Sync>,
    },
    /// It was read and is none.
    #[error("{key} is not an elevation tile: {what}; build the pack again")]
    Unsound { key: HeightTileKey, what: String },
}
