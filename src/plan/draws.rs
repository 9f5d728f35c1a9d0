//! The draws of the surface, and what they cost.

use std::ops::Range;
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockGrid, BlockRow};

/// In place of a block's index: drawn with whole maps.
pub(crate) const WHOLE_MAP: u32 = 2 * BLOCK_COUNT;
/// With a block's index added: as much of what lies in several blocks as lies in that one, drawn with its tiles.
pub(crate) const PER_BLOCK_TILES: u32 = BLOCK_COUNT;

/// Most indices that are listed cell by cell; blocks beyond are drawn whole.
pub(crate) const LISTED_INDICES: usize = 6 * 48 * 48 * 16;

/// One indexed draw of the surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(not(feature = "terrain"), allow(dead_code))]
pub(crate) struct SurfaceDraw {
    /// The patch of ground that it is of, by its key; where there are none, the place of its block among those of the plan.
    pub patch: u64,
    /// Its triangles, three indices each.
    pub indices: Range<u32>,
    /// Whether these stand among [`super::FramePlan::cells`], and not among those of the mesh.
    pub is_listed: bool,
    /// How much its light needs.
    pub light: DrawLight,
    /// Whose tiles it is drawn with, as shaders count: a block by its index, [`PER_BLOCK_TILES`] and that, or [`WHOLE_MAP`].
    pub drawn_as: u32,
    /// The block whose maps are bound; `None` for whole maps.
    pub block: Option<Block>,
}

/// How much the light of a draw needs; the least of two serves both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum DrawLight {
    /// All that there is, by day and by night.
    Everything,
    /// Nothing that shows by night alone.
    Daylit,
    /// By day, and the air's light may be interpolated between vertices.
    Interpolated,
    /// The same where there is nothing but land.
    Land,
    /// The same where there is nothing but open sea.
    OpenSea,
}

impl DrawLight {
    pub const ALL: [Self; 5] = [
        Self::Everything,
        Self::Daylit,
        Self::Interpolated,
        Self::Land,
        Self::OpenSea,
    ];
}

/// Draw calls and triangles of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DrawCosts {
    pub draw_calls: u32,
    pub triangles: u32,
}

/// Where the triangles of northern, middle and southern blocks stand among the indices of a grid: in this order, none between them.
pub(super) fn block_ranges(grid: &BlockGrid) -> [Range<u32>; 3] {
    let mut end = 0;
    [BlockRow::North, BlockRow::Middle, BlockRow::South].map(|kind| {
        let start = end;
        end += 3 * grid.triangles(kind);
        start..end
    })
}

/// The triangles of a whole block, of these ranges.
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
