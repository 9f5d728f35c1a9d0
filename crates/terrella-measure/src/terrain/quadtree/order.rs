//! Order of a tree's nodes in memory.

use terrella_ground::globe::quadtree::Node;

/// Order of the groups of four children in a tree's array (section 2.4 of the paper). The root is first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Level by level, row by row: the plain order.
    Rows,
    /// Level by level along the Z curve: in a full tree child k of p is at 4p + k + 1.
    Morton,
    /// Level by level along the Hilbert curve: neighbours in the array are neighbours on the ground.
    Hilbert,
    /// The levels of even number first, then the odd ones (the paper's white and black trees), along the Z curve: in a full tree child k of p is at
    /// 4p + k + m, where m depends on the level alone.
    Interleaved,
    /// Each node before its children, as a search goes.
    #[default]
    DepthFirst,
}

impl Order {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Rows,
        Self::Morton,
        Self::Hilbert,
        Self::Interleaved,
        Self::DepthFirst,
    ];

    /// Sort key of a node's children; `None` if they keep the order of creation.
    pub(super) fn key(self, parent: Node) -> Option<u128> {
        let level = u128::from(parent.level);
        let (first, code) = match self {
            Self::Rows => (level, parent.y << 32 | parent.x),
            Self::Morton => (level, morton(parent.x, parent.y)),
            Self::Hilbert => (level, hilbert(parent)),
            // Children of an odd level are of an even one.
            Self::Interleaved => ((1 - level % 2) << 8 | level, morton(parent.x, parent.y)),
            Self::DepthFirst => return None,
        };
        Some(first << 64 | u128::from(code))
    }
}

/// Morton code: the bits of x and y interleaved, those of y first. Both below 2³².
pub fn morton(x: u64, y: u64) -> u64 {
    spread(x) | spread(y) << 1
}

/// Puts a zero before each of the lower 32 bits.
fn spread(value: u64) -> u64 {
    let mut v = value & 0xffff_ffff;
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        v = (v | v << shift) & mask;
    }
    v
}

/// Place of a square along the Hilbert curve of its level, from the north-western corner to the north-eastern.
pub fn hilbert(node: Node) -> u64 {
    let (mut x, mut y) = (node.x, node.y);
    let mut place = 0;
    for bit in (0..node.level).rev() {
        let (rx, ry) = (x >> bit & 1, y >> bit & 1);
        place = place << 2 | ((3 * rx) ^ ry);
        // The quarter is passed through mirrored, so that it begins where the one before ends.
        let mask = (1 << bit) - 1;
        (x, y) = (x & mask, y & mask);
        if ry == 0 {
            if rx == 1 {
                (x, y) = (mask - x, mask - y);
            }
            (x, y) = (y, x);
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn morton_codes_are_those_of_the_paper_s_figure() {
        let rows = [[0, 1, 4, 5], [2, 3, 6, 7], [8, 9, 12, 13], [10, 11, 14, 15]];
        for (y, row) in rows.iter().enumerate() {
            for (x, code) in row.iter().enumerate() {
                assert_eq!(morton(x as u64, y as u64), *code);
            }
        }
        assert_eq!(morton(u64::from(u32::MAX), 0), 0x5555_5555_5555_5555);
    }

    #[test]
    fn the_hilbert_curve_goes_from_neighbour_to_neighbour() {
        for level in 1..=6 {
            let side = 1_u64 << level;
            let mut squares: Vec<_> = (0..side * side)
                .map(|i| Node {
                    level,
                    x: i % side,
                    y: i / side,
                })
                .collect();
            squares.sort_by_key(|node| hilbert(*node));
            for (place, pair) in squares.windows(2).enumerate() {
                assert_eq!(hilbert(pair[0]), place as u64);
                let step = pair[0].x.abs_diff(pair[1].x) + pair[0].y.abs_diff(pair[1].y);
                assert_eq!(step, 1, "{pair:?}");
            }
        }
    }
}
