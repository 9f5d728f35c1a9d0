//! What a source of height tiles is: heights of the Earth at several levels, each cut into tiles of equal degrees.
//!
//! This is all that streaming knows of a pack, and all that a pack knows of streaming. Level 0 is the finest. A level has
//! twice as many columns of tiles as rows, and half as many as the next finer one; every tile has `side` × `side` samples of
//! its own. Sample (i, j) of a level with W = columns · side samples round the Earth, counted eastwards and southwards over the
//! whole level, stands for the cell about longitude −180° + (i + ½)·360°/W and latitude 90° − (j + ½)·360°/W. A coarser level's
//! sample is the mean of the finer ones in its cell where those exist.

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

/// A source of height tiles: a pack on disk, say.
///
/// # Rules
///
/// - All tiles of the coarsest level exist. Of the others any may be absent: deep levels may cover one region only. A tile exists only
///   where the tile of the next coarser level over the same ground does.
/// - Borders repeat what the neighbours of the same level hold, round the date line too, so that bilinear interpolation agrees on
///   both sides of an edge. Beside a tile that is absent, and beyond the poles, they may hold any finite height of the Earth.
/// - Answers never change while the source lives.
pub trait HeightTileSource: Send + Sync {
    /// How the Earth is cut.
    fn layout(&self) -> HeightTileLayout;

    /// Lowest and highest height of a tile, its border included, and of everything finer beneath it; `None` where the tile is
    /// absent. Known without reading the tile, and answered at once: frames ask it. May be too wide, never too narrow.
    fn range_m(&self, key: HeightTileKey) -> Option<HeightRange>;

    /// Reads a tile: (side + 2 · border)² finite heights, rows from the north, each from the west, the border included. Called from
    /// loader threads; may take long. `cancelled` is asked between its steps and says when nobody wants the tile any more.
    ///
    /// # Errors
    /// [`HeightTileError`]; the heights are then drawn coarser.
    fn read(
        &self,
        key: HeightTileKey,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError>;
}
