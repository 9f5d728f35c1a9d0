//! The draws of the surface, and their cost.

use std::ops::Range;
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockGrid, BlockRow};

/// Replaces a block's index: drawn with whole maps.
pub(crate) const WHOLE_MAP: u32 = 2 * BLOCK_COUNT;
/// Added to a block's index: of triangles that span several blocks, draws only the part inside this block, with its tiles.
pub(crate) const PER_BLOCK_TILES: u32 = BLOCK_COUNT;

/// Limit of indices that are listed cell by cell; further blocks are drawn whole.
pub(crate) const LISTED_INDICES: usize = 6 * 48 * 48 * 16;

/// One indexed draw of the surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(feature = "terrain"), allow(dead_code))]
pub(crate) struct SurfaceDraw {
    /// Key of its terrain patch; without terrain, the position of its block in the plan.
    pub patch: u64,
    /// Its triangles, three indices each.
    pub indices: Range<u32>,
    /// Whether these indices are in [`super::FramePlan::cells`] instead of the mesh.
    pub is_listed: bool,
    /// The light that it needs.
    pub light: DrawLight,
    /// Imagery, as shaders encode it: a block's index, [`PER_BLOCK_TILES`] plus that, or [`WHOLE_MAP`].
    pub drawn_as: u32,
    /// The block whose maps are bound; `None` for whole maps.
    pub block: Option<Block>,
}

/// The light that a draw needs; the lesser of two values serves both draws. Only whole blocks have `Night`, which is not compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum DrawLight {
    /// All layers, by day and by night.
    Everything,
    /// Without layers that are visible only at night.
    Daylit,
    /// In daylight, and the air's light may be interpolated between vertices.
    Interpolated,
    /// As `Interpolated`, where there is only land.
    Land,
    /// As `Interpolated`, where there is only open sea.
    OpenSea,
    /// Without sunlight.
    Night,
}

impl DrawLight {
    pub const ALL: [Self; 6] = [
        Self::Everything,
        Self::Daylit,
        Self::Interpolated,
        Self::Land,
        Self::OpenSea,
        Self::Night,
    ];
}

/// Draw calls and triangles of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DrawCosts {
    pub draw_calls: u32,
    pub triangles: u32,
}

/// Index ranges of the triangles of northern, middle and southern blocks in a grid: contiguous, in this order.
pub(super) fn block_ranges(grid: &BlockGrid) -> [Range<u32>; 3] {
    let mut end = 0;
    [BlockRow::North, BlockRow::Middle, BlockRow::South].map(|kind| {
        let start = end;
        end += 3 * grid.triangles(kind);
        start..end
    })
}

/// The triangles of a whole block, from these ranges.
pub(super) fn whole_range(ranges: &[Range<u32>; 3], block: Block) -> Range<u32> {
    let [north, middle, south] = ranges;
    match block.kind() {
        BlockRow::North => north.clone(),
        BlockRow::Middle => middle.clone(),
        BlockRow::South => south.clone(),
    }
}

/// Lists a draw for each of these blocks of the smooth ellipsoid.
pub(crate) fn draw_blocks(grid: &BlockGrid, blocks: &[Block], draws: &mut Vec<SurfaceDraw>) {
    let ranges = block_ranges(grid);
    draws.extend((0..).zip(blocks).map(|(place, block)| SurfaceDraw {
        patch: place,
        indices: whole_range(&ranges, *block),
        is_listed: false,
        light: DrawLight::Everything,
        drawn_as: block.index(),
        block: Some(*block),
    }));
}
