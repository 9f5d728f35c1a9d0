//! The draws of the surface, and what they cost.

use std::ops::Range;
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockGrid, BlockRow};

/// In place of a block's index: drawn with whole maps.
pub(crate) const WHOLE_MAP: u32 = 2 * BLOCK_COUNT;
/// With a block's index added: as much of what lies in several blocks as lies in that one, drawn with its tiles.
pub(crate) const PER_BLOCK_TILES: u32 = BLOCK_COUNT;

/// One indexed draw of the surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(feature = "terrain"), allow(dead_code))]
pub(crate) struct SurfaceDraw {
    /// The patch of ground that it is of, by its key; 0 where there are none.
    pub patch: u64,
    /// Its triangles, three indices each.
    pub indices: Range<u32>,
    /// Whose tiles it is drawn with, as shaders count: a block by its index, [`PER_BLOCK_TILES`] and that, or [`WHOLE_MAP`].
    pub drawn_as: u32,
    /// The block whose maps are bound; `None` for whole maps.
    pub block: Option<Block>,
}

/// Draw calls and triangles of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DrawCosts {
    pub draw_calls: u32,
    pub triangles: u32,
}

/// Where the triangles of northern, middle and southern blocks stand among the indices of a grid: in this order, none between them.
fn block_ranges(grid: &BlockGrid) -> [Range<u32>; 3] {
    let mut end = 0;
    [BlockRow::North, BlockRow::Middle, BlockRow::South].map(|kind| {
        let start = end;
        end += 3 * grid.triangles(kind);
        start..end
    })
}

/// Lists a draw for each of these blocks of the smooth ellipsoid.
pub(crate) fn draw_blocks(grid: &BlockGrid, blocks: &[Block], draws: &mut Vec<SurfaceDraw>) {
    let [north, middle, south] = block_ranges(grid);
    draws.extend(blocks.iter().map(|block| SurfaceDraw {
        patch: 0,
        indices: match block.kind() {
            BlockRow::North => north.clone(),
            BlockRow::Middle => middle.clone(),
            BlockRow::South => south.clone(),
        },
        drawn_as: block.index(),
        block: Some(*block),
    }));
}
