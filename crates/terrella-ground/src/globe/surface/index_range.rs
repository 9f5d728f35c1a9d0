//! Ranges of triangle lists, each with the blocks that it may touch. Terrain in several blocks is drawn with the tiles of each. The ranges
//! avoid drawing all triangles each time.

use crate::globe::blocks::BlockSet;
use std::ops::Range;

/// Neighbouring triangles of a list, and the blocks that they may touch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexRange {
    /// Range of indices in the list.
    pub indices: Range<u32>,
    /// Blocks that the triangles may touch; possibly too many, never too few.
    pub blocks: BlockSet,
}

/// Calls `draw` with the ranges that may touch any of `blocks`; adjacent ranges are merged.
pub fn merged_ranges(ranges: &[IndexRange], blocks: BlockSet, mut draw: impl FnMut(Range<u32>)) {
    let mut open: Option<Range<u32>> = None;
    let near = ranges.iter().filter(|near| near.blocks.0 & blocks.0 != 0);
    for near in near {
        match &mut open {
            Some(range) if range.end == near.indices.start => range.end = near.indices.end,
            _ => {
                if let Some(range) = open.replace(near.indices.clone()) {
                    draw(range);
                }
            }
        }
    }
    if let Some(range) = open {
        draw(range);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_merged() {
        let range = |start: u32, blocks| IndexRange {
            indices: start..start + 3,
            blocks: BlockSet(blocks),
        };
        let ranges = [
            range(0, 1),
            range(3, 3),
            range(6, 2),
            range(9, 1),
            range(12, 4),
        ];
        let of = |blocks| {
            let mut found = Vec::new();
            merged_ranges(&ranges, BlockSet(blocks), |range| found.push(range));
            found
        };
        assert_eq!(of(1), [0..6, 9..12]);
        assert_eq!(of(2), std::iter::once(3..9).collect::<Vec<_>>());
        assert_eq!(of(5), [0..6, 9..15]);
        assert_eq!(of(8), []);
    }
}
