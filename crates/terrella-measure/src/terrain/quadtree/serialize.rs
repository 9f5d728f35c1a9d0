//! A tree as bytes, for a file beside its data.

use super::order::Order;
use super::tree::{
    ABSENT, CELLS, GridQuadtree, LEAF, MAX_POSTS, Posts, TreeError, TreeNode, TreeOptions, levels,
};

/// What the bytes begin with; the last two are the version.
const MAGIC: [u8; 16] = *b"terrella tree 02";
/// Magic, source, columns, rows, spacing, order, nodes.
const HEADER: usize = 16 + 32 + 4 + 4 + 8 + 4 + 4;
/// BLAKE3 of all before it.
const CHECKSUM: usize = 32;

/// Takes what a slice begins with.
fn take<'a>(bytes: &mut &'a [u8], count: usize) -> Result<&'a [u8], TreeError> {
    let (head, rest) = bytes
        .split_at_checked(count)
        .ok_or(TreeError::Bytes("they end too early"))?;
    *bytes = rest;
    Ok(head)
}

fn take_u32(bytes: &mut &[u8]) -> Result<u32, TreeError> {
    let four = take(bytes, 4)?;
    Ok(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

fn take_f32(bytes: &mut &[u8]) -> Result<f32, TreeError> {
    Ok(f32::from_bits(take_u32(bytes)?))
}

impl GridQuadtree {
    /// Which heights and options a tree is made from.
    pub fn source_hash(posts: Posts<'_>, options: &TreeOptions) -> [u8; 32] {
        let mut hash = blake3::Hasher::new();
        for side in [posts.columns, posts.rows] {
            hash.update(&(side as u64).to_le_bytes());
        }
        hash.update(&posts.spacing_m.to_le_bytes());
        hash.update(&[options.merge as u8, options.order as u8]);
        hash.update(bytemuck::cast_slice(posts.heights_m));
        *hash.finalize().as_bytes()
    }

    /// All of the tree, little-endian, with its version and a BLAKE3 checksum. `source` is what [`Self::source_hash`] said.
    pub fn to_bytes(&self, source: &[u8; 32]) -> Vec<u8> {
        let node_bytes = size_of::<TreeNode>() * self.nodes.len();
        let mut out = Vec::with_capacity(HEADER + 4 * self.heights_m.len() + node_bytes + CHECKSUM);
        out.extend(MAGIC);
        out.extend(source);
        out.extend((self.columns as u32).to_le_bytes());
        out.extend((self.rows as u32).to_le_bytes());
        out.extend(self.spacing_m.to_le_bytes());
        let order = Order::ALL.iter().position(|order| *order == self.order);
        out.extend((order.unwrap_or(0) as u32).to_le_bytes());
        out.extend((self.nodes.len() as u32).to_le_bytes());
        out.extend(
            self.heights_m
                .iter()
                .flat_map(|height| height.to_le_bytes()),
        );
        for node in &self.nodes {
            out.extend(node.children.to_le_bytes());
            let numbers = [node.midpoints_m, node.bound_m, node.low_m, node.high_m];
            let rises = node.east_m.into_iter().chain(node.south_m);
            out.extend(numbers.into_iter().chain(rises).flat_map(f32::to_le_bytes));
        }
        let checksum = blake3::hash(&out);
        out.extend(checksum.as_bytes());
        out
    }

    /// The tree that [`Self::to_bytes`] wrote, if it takes at most `max_bytes`.
    ///
    /// # Errors
    /// Bytes of another version, too few, too many, damaged, or that describe no tree; a tree of another source or above
    /// the budget.
    pub fn from_bytes(
        bytes: &[u8],
        source: &[u8; 32],
        max_bytes: usize,
    ) -> Result<Self, TreeError> {
        if bytes.len() > max_bytes.saturating_add(HEADER + CHECKSUM) {
            return Err(TreeError::TooLarge {
                needed: bytes.len(),
                most: max_bytes,
            });
        }
        let rest = &mut &*bytes;
        if take(rest, MAGIC.len())? != MAGIC {
            return Err(TreeError::Bytes("they are not those of this version"));
        }
        let body = bytes
            .len()
            .checked_sub(CHECKSUM)
            .ok_or(TreeError::Bytes("they end too early"))?;
        if *blake3::hash(&bytes[..body]).as_bytes() != bytes[body..] {
            return Err(TreeError::Bytes("the checksum is another one"));
        }
        if take(rest, source.len())? != source {
            return Err(TreeError::Stale);
        }
        let (columns, rows) = (take_u32(rest)? as usize, take_u32(rest)? as usize);
        let spacing_m =
            f64::from_bits(u64::from(take_u32(rest)?) | u64::from(take_u32(rest)?) << 32);
        let order = *Order::ALL
            .get(take_u32(rest)? as usize)
            .ok_or(TreeError::Bytes("the order is unknown"))?;
        let count = take_u32(rest)? as usize;
        let is_sound = (1..=MAX_POSTS).contains(&columns)
            && (1..=MAX_POSTS).contains(&rows)
            && spacing_m.is_finite();
        if !is_sound {
            return Err(TreeError::Bytes("sizes do not fit"));
        }
        // Nothing is allocated before the sizes fit the bytes that are there.
        let needed = 4 * columns * rows + size_of::<TreeNode>() * count;
        if rest.len() != needed + CHECKSUM {
            return Err(TreeError::Bytes("sizes do not fit"));
        }
        let heights_m = (0..columns * rows)
            .map(|_| take_f32(rest))
            .collect::<Result<Vec<_>, _>>()?;
        let nodes = (0..count)
            .map(|_| {
                Ok(TreeNode {
                    children: take_u32(rest)?,
                    midpoints_m: take_f32(rest)?,
                    bound_m: take_f32(rest)?,
                    low_m: take_f32(rest)?,
                    high_m: take_f32(rest)?,
                    east_m: [take_f32(rest)?, take_f32(rest)?],
                    south_m: [take_f32(rest)?, take_f32(rest)?],
                })
            })
            .collect::<Result<Vec<_>, TreeError>>()?;
        if heights_m.iter().any(|height| !height.is_finite()) || !is_tree(&nodes, columns, rows) {
            return Err(TreeError::Bytes("the nodes are no tree"));
        }
        Ok(Self {
            columns,
            rows,
            spacing_m,
            order,
            heights_m,
            nodes,
        })
    }
}

/// Whether every node but the root is the child of exactly one, and squares are marked as the size of the grid wants it.
fn is_tree(nodes: &[TreeNode], columns: usize, rows: usize) -> bool {
    let levels = levels(columns, rows);
    let mut is_met = vec![false; nodes.len()];
    let mut stack = vec![(0_usize, 0_u64, 0_u64, 0_u8)];
    let mut met = 0;
    while let Some((index, x, y, level)) = stack.pop() {
        let Some(node) = nodes.get(index) else {
            return false;
        };
        if std::mem::replace(&mut is_met[index], true) {
            return false;
        }
        met += 1;
        let size = 1_u64 << (levels - level);
        let is_absent = x * size + 1 >= columns as u64 || y * size + 1 >= rows as u64;
        let is_inside = (x + 1) * size < columns as u64 && (y + 1) * size < rows as u64;
        // A square with a bound that is no number, or one that is never a leaf but looks like one, would be drawn wrongly.
        let is_sound = match node.children {
            ABSENT => is_absent,
            LEAF => !is_absent && is_inside,
            CELLS => !is_absent && level + 1 == levels,
            _ => !is_absent && level + 1 < levels,
        };
        let is_partial_whole = !is_absent && !is_inside && node.bound_m.is_finite();
        if !is_sound || is_partial_whole || node.bound_m.is_nan() || node.midpoints_m.is_nan() {
            return false;
        }
        if node.children < ABSENT {
            for k in 0..4_u64 {
                let child = node.children as usize + k as usize;
                stack.push((child, 2 * x + (k & 1), 2 * y + (k >> 1), level + 1));
            }
        }
    }
    met == nodes.len()
}
