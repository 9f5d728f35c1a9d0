//! Triangles that lie in several blocks, drawn with the tiles of each.

use super::shader::{PER_BLOCK_TILES, WHOLE_MAP};
use std::ops::Range;
use terrella_ground::globe::{Block, BlockSet, IndexRange, merged_ranges};

/// How triangles that lie in several blocks are drawn where some of these have tiles: each range of them as what, and with the
/// tiles of which block.
pub(super) fn draws_of(
    ranges: &[IndexRange],
    tiled: BlockSet,
    mut draw: impl FnMut(u32, Option<Block>, Range<u32>),
) {
    let all = ranges.iter().fold(0, |all, near| all | near.blocks.0);
    let mut left = all & tiled.0;
    while left != 0 {
        let index = left.trailing_zeros();
        let block = Block::of_index(index);
        merged_ranges(ranges, BlockSet(1 << index), |range| {
            draw(PER_BLOCK_TILES + index, Some(block), range);
        });
        left &= left - 1;
    }
    merged_ranges(ranges, BlockSet(!tiled.0), |range| {
        draw(WHOLE_MAP, None, range)
    });
}
