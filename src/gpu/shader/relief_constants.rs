//! Constants that terrain shaders and Rust share.

use super::value::Value::{self, F32, U32};
use terrella_ground::globe::contours::STACK;
use terrella_ground::globe::projected_grid as grid;

/// Number of slots in a row of the atlas of elevation tiles.
pub(crate) const ATLAS_COLUMNS: u32 = 16;

/// All of them by name.
pub(super) const RELIEF: &[(&str, Value)] = &[
    // The projected grid's windows of elevation tiles.
    ("GRID_LEVELS", U32(grid::LEVELS as u32)),
    ("GRID_WINDOW_TILES", U32(grid::WINDOW_TILES as u32)),
    ("GRID_TILE_CELLS", U32(grid::TILE_CELLS)),
    ("GRID_TILE_TEXELS", U32(grid::TILE_SAMPLES)),
    ("GRID_SHARPER", F32(grid::SHARPER)),
    ("ATLAS_COLUMNS", U32(ATLAS_COLUMNS)),
    ("NO_SLOT", U32(grid::NO_SLOT)),
    // Contours for ray casting.
    ("CONTOUR_STACK", U32(STACK as u32)),
];
