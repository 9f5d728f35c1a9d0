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

/// Heights of a tile as they are stored.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightSamples {
    /// Metres.
    F32(Vec<f32>),
    /// Metres are offset + scale × value. Samples that two tiles share must come to the same metres in both, to the last bit: best is
    /// one scale and offset for all tiles of a source.
    I16 {
        /// Steps.
        values: Vec<i16>,
        /// Metres at step 0; finite.
        offset_m: f64,
        /// Metres a step; finite and above 0.
        scale_m: f64,
    },
}

impl HeightSamples {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::I16 { values, .. } => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A sample, metres.
    #[inline]
    pub(crate) fn at_m(&self, n: usize) -> f64 {
        match self {
            Self::F32(values) => f64::from(values[n]),
            Self::I16 {
                values,
                offset_m,
                scale_m,
            } => offset_m + scale_m * f64::from(values[n]),
        }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> u64 {
        match self {
            Self::F32(values) => size_of_val(values.as_slice()) as u64,
            Self::I16 { values, .. } => size_of_val(values.as_slice()) as u64,
        }
    }
}

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
