//! Interface of a height tile source: elevation data of the Earth at several levels, each divided into tiles of equal degrees.
//!
//! Streaming and packs share only this interface. Level 0 is the finest. A level has twice as many tile columns as rows, and half as many as the next
//! finer level. Every tile has `side` × `side` samples without its border. Take a level with W = columns · side samples around the Earth, counted
//! eastwards and southwards over the whole level. Sample (i, j) represents the cell around longitude −180° + (i + ½)·360°/W and latitude 90° − (j +
//! ½)·360°/W. A coarser level's sample is the mean of the finer ones in its cell where those exist.

mod error;
mod held;
mod layout;
mod pyramid;
mod wants;

pub use error::HeightTileError;
pub(super) use held::HeldTile;
pub use layout::{HeightLayoutError, HeightTileKey, HeightTileLayout};
pub(super) use pyramid::{BESIDE, FEATHER, NONE, Node, TilePyramid, wider};
pub(super) use wants::{NearEye, Wants};

use super::HeightRange;
use super::samples::HeightSamples;

/// A source of height tiles, such as a pack on disk.
///
/// # Rules
///
/// - All tiles of the coarsest level exist. Any other tile may be absent: deep levels may cover one region only. A tile exists only if the tile of
///   the next coarser level over the same ground exists.
/// - Borders repeat the neighbours' samples of the same level, across the date line too. Bilinear interpolation therefore agrees on both sides of an
///   edge. Beside an absent tile, and beyond the poles, they may hold any finite height of the Earth.
/// - Results never change during the source's lifetime.
pub trait HeightTileSource: Send + Sync {
    /// Division of the Earth into tiles.
    fn layout(&self) -> HeightTileLayout;

    /// Lowest and highest height of a tile with its border, and of all finer tiles beneath it. `None` for an absent tile.
    /// Must return at once, without reading the tile, because frames call it. May be too wide, never too narrow.
    fn range_m(&self, key: HeightTileKey) -> Option<HeightRange>;

    /// Reads a tile: (side + 2 · border)² finite heights, rows from the north, each from the west, border included. Loader threads
    /// call this; it may take long. Call `cancelled` between steps; it returns true once the tile is no longer wanted.
    ///
    /// # Errors
    /// [`HeightTileError`]; the terrain is then drawn coarser there.
    fn read(
        &self,
        key: HeightTileKey,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError>;
}
