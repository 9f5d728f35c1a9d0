//! The tree over one elevation grid of any size.

use super::order::Order;
use crate::terrain::workers::Workers;
use terrella_ground::globe::quadtree::{Node, leaf_error};

/// Which squares are merged for good. Neither changes the surface at any post.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Merge {
    /// None: a full tree.
    None,
    /// Those whose posts are all of one height, as in the paper.
    Equal,
    /// Those that their four triangles meet at every post, whatever finer neighbours put into their edges: slopes too.
    #[default]
    Flat,
}

/// How a tree is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeOptions {
    /// Which squares are merged.
    pub merge: Merge,
    /// Order of the nodes in memory.
    pub order: Order,
    /// Threads that build, 1 or more.
    pub threads: usize,
    /// Memory limit of elevations and nodes together, bytes.
    pub max_bytes: usize,
}

impl Default for TreeOptions {
    fn default() -> Self {
        Self {
            merge: Merge::default(),
            order: Order::default(),
            threads: 2,
            max_bytes: 512 << 20,
        }
    }
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TreeError {
    /// The grid has no post.
    #[error("a grid of {columns} × {rows} heights has no tree; each must be from 1 to 32 769")]
    Size {
        /// Posts from west to east.
        columns: usize,
        /// Posts from north to south.
        rows: usize,
    },
    /// Heights do not fill the grid.
    #[error("there are {given} heights for a grid of {columns} × {rows}")]
    Heights {
        given: usize,
        /// Posts from west to east.
        columns: usize,
        /// Posts from north to south.
        rows: usize,
    },
    /// A height is no number.
    #[error("the height in column {column} of row {row} is not finite")]
    NotFinite {
        /// From the west, from 0.
        column: usize,
        /// From the north, from 0.
        row: usize,
    },
    /// The tree would be too large.
    #[error(
        "the tree may take {needed} bytes, and {most} are allowed; take a smaller grid or allow more"
    )]
    TooLarge {
        /// Bytes it may take.
        needed: usize,
        /// Bytes allowed.
        most: usize,
    },
}

/// Most posts of a side: 2¹⁵ + 1.
pub const MAX_POSTS: usize = (1 << 15) + 1;

/// Marks in place of the first child.
pub(super) const LEAF: u32 = u32::MAX;
/// The square is of 2 × 2 cells, which have no nodes.
pub(super) const CELLS: u32 = u32::MAX - 1;
/// The square is outside the grid.
pub(super) const ABSENT: u32 = u32::MAX - 2;

/// Data of a square of two steps or more.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TreeNode {
    /// The first of four, or a mark.
    pub(super) children: u32,
    /// e_max: largest of its five midpoint errors and of those below, metres. Infinite where the square is not all on the grid.
    pub midpoints_m: f32,
    /// Upper bound of any post's deviation from it as a leaf, metres; at least that of its children. As above.
    pub bound_m: f32,
    /// Lowest height, metres.
    pub low_m: f32,
    /// Highest height.
    pub high_m: f32,
    /// Least and largest rise from a post to the next one east, metres.
    pub(super) east_m: [f32; 2],
    /// The same to the next one south.
    pub(super) south_m: [f32; 2],
}

impl TreeNode {
    const ABSENT: Self = Self {
        children: ABSENT,
        midpoints_m: 0.0,
        bound_m: 0.0,
        low_m: f32::INFINITY,
        high_m: f32::NEG_INFINITY,
        east_m: [f32::INFINITY, f32::NEG_INFINITY],
        south_m: [f32::INFINITY, f32::NEG_INFINITY],
    };
}

/// The posts that a tree is built over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posts<'a> {
    /// From west to east.
    pub columns: usize,
    /// From north to south.
    pub rows: usize,
    /// Heights, metres, the north-western first, row by row.
    pub heights_m: &'a [f32],
    /// Between neighbouring posts, metres.
    pub spacing_m: f64,
}

/// An unfull quadtree over an elevation grid. The grid may have any size: the tree is that of the next power of two, and squares outside are
/// absent.
#[derive(Clone, Debug, PartialEq)]
pub struct GridQuadtree {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) spacing_m: f64,
    pub(super) order: Order,
    pub(super) heights_m: Vec<f32>,
    pub(super) nodes: Vec<TreeNode>,
}

/// Levels from the root to the cells, 1 or more.
pub(super) fn levels(columns: usize, rows: usize) -> u8 {
    let cells = columns.max(rows).saturating_sub(1).max(2);
    cells.next_power_of_two().trailing_zeros() as u8
}

/// Input of the construction.
struct Builder<'a> {
    columns: usize,
    rows: usize,
    levels: u8,
    merge: Merge,
    heights_m: &'a [f32],
    /// Level whose subtrees are built on their own.
    split_level: u8,
}

/// A node, and those below it with their first as 0.
type Subtree = (TreeNode, Vec<TreeNode>);

impl GridQuadtree {
    /// Builds the tree. `progress` receives the completed fraction, 0…1, on this thread.
    ///
    /// # Errors
    /// A size of 0 or above [`MAX_POSTS`], elevations that are not finite or too few, or a tree that exceeds the memory limit.
    pub fn build(
        posts: Posts<'_>,
        options: &TreeOptions,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, TreeError> {
        let Posts {
            columns,
            rows,
            heights_m,
            spacing_m,
        } = posts;
        if !(1..=MAX_POSTS).contains(&columns) || !(1..=MAX_POSTS).contains(&rows) {
            return Err(TreeError::Size { columns, rows });
        }
        if heights_m.len() != columns * rows {
            return Err(TreeError::Heights {
                given: heights_m.len(),
                columns,
                rows,
            });
        }
        if let Some(at) = heights_m.iter().position(|height| !height.is_finite()) {
            return Err(TreeError::NotFinite {
                column: at % columns,
                row: at / columns,
            });
        }
        // A node to every four cells, a third more above them, and absent ones along the edges; twice, while they are
        // put in order.
        let nodes = (columns / 2 + 1) * (rows / 2 + 1) * 4 / 3 + 8 * (columns + rows);
        let needed = 4 * heights_m.len() + 2 * nodes * size_of::<TreeNode>();
        if needed > options.max_bytes {
            return Err(TreeError::TooLarge {
                needed,
                most: options.max_bytes,
            });
        }
        let levels = levels(columns, rows);
        let split_level = 3.min(levels - 1);
        let builder = Builder {
            columns,
            rows,
            levels,
            merge: options.merge,
            heights_m,
            split_level,
        };
        let mut subtrees = builder.subtrees(&Workers::new(options.threads), progress);
        let mut below = Vec::new();
        let root = builder.node(
            Node {
                level: 0,
                x: 0,
                y: 0,
            },
            &mut subtrees,
            &mut below,
        );
        let nodes = in_order(root, below, options.order);
        progress(1.0);
        Ok(Self {
            columns,
            rows,
            spacing_m,
            order: options.order,
            heights_m: heights_m.to_vec(),
            nodes,
        })
    }

    /// Posts from west to east and from north to south.
    pub fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    /// Between neighbouring posts, metres.
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m
    }

    /// Heights, the north-western first, row by row, metres.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    pub fn cells(&self) -> usize {
        (self.columns - 1) * (self.rows - 1)
    }

    /// Nodes, absent ones included.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Bytes of heights and nodes.
    pub fn resident_bytes(&self) -> usize {
        4 * self.heights_m.capacity() + self.nodes.capacity() * size_of::<TreeNode>()
    }

    /// Levels from the root to the cells.
    pub fn levels(&self) -> u8 {
        levels(self.columns, self.rows)
    }

    pub(super) fn height_m(&self, column: usize, row: usize) -> f64 {
        f64::from(self.heights_m[row * self.columns + column])
    }
}

impl Builder<'_> {
    /// The subtrees of the split level, by column and row; none if that is the root's.
    fn subtrees(&self, workers: &Workers, progress: &mut dyn FnMut(f32)) -> Vec<Option<Subtree>> {
        if self.split_level == 0 {
            return Vec::new();
        }
        let side = 1 << self.split_level;
        let count = side * side;
        let mut finished = 0;
        workers.map(
            count,
            |index| {
                let mut below = Vec::new();
                let node = Node {
                    level: self.split_level,
                    x: (index % side) as u64,
                    y: (index / side) as u64,
                };
                let root = self.node(node, &mut [], &mut below);
                Some((root, below))
            },
            &mut |_| {
                finished += 1;
                progress(finished as f32 / (count + 1) as f32);
            },
        )
    }

    fn height(&self, column: usize, row: usize) -> f64 {
        f64::from(self.heights_m[row * self.columns + column])
    }

    /// The node of a square; those below it are put at the end of `below`. Subtrees that are built already are taken.
    fn node(
        &self,
        node: Node,
        subtrees: &mut [Option<Subtree>],
        below: &mut Vec<TreeNode>,
    ) -> TreeNode {
        if node.level == self.split_level {
            let index = (node.y << self.split_level | node.x) as usize;
            if let Some(subtree) = subtrees.get_mut(index).and_then(Option::take) {
                return append(subtree, below);
            }
        }
        let square = node.square(self.levels);
        let (x, y, size) = (square.x as usize, square.y as usize, square.size as usize);
        if x + 1 >= self.columns || y + 1 >= self.rows {
            return TreeNode::ABSENT;
        }
        let is_inside = x + size < self.columns && y + size < self.rows;
        let mut out = if size == 2 {
            self.cells(x, y)
        } else {
            let first = below.len();
            below.extend([TreeNode::ABSENT; 4]);
            let mut out = TreeNode {
                children: first as u32,
                ..TreeNode::ABSENT
            };
            for k in 0..4 {
                let child = self.node(node.child(k), subtrees, below);
                below[first + usize::from(k)] = child;
                out.midpoints_m = out.midpoints_m.max(child.midpoints_m);
                out.bound_m = out.bound_m.max(child.bound_m);
                out.low_m = out.low_m.min(child.low_m);
                out.high_m = out.high_m.max(child.high_m);
                out.east_m = joined(out.east_m, child.east_m);
                out.south_m = joined(out.south_m, child.south_m);
            }
            out
        };
        if !is_inside {
            (out.midpoints_m, out.bound_m) = (f32::INFINITY, f32::INFINITY);
            return out;
        }
        let own = leaf_error(|i, j| self.height(i, j), x, y, size);
        out.midpoints_m = out.midpoints_m.max(rounded_up(own.midpoints));
        out.bound_m = out.bound_m.max(rounded_up(own.bound));
        let is_merged = match self.merge {
            Merge::None => false,
            Merge::Equal => out.low_m == out.high_m,
            // The rounding term is never 0 if the error is not.
            Merge::Flat => out.bound_m == 0.0,
        };
        if is_merged {
            if out.children < ABSENT {
                below.truncate(out.children as usize);
            }
            out.children = LEAF;
        }
        out
    }

    /// The node over up to 2 × 2 cells.
    fn cells(&self, x: usize, y: usize) -> TreeNode {
        let mut out = TreeNode {
            children: CELLS,
            ..TreeNode::ABSENT
        };
        let (x1, y1) = ((x + 2).min(self.columns - 1), (y + 2).min(self.rows - 1));
        for j in y..=y1 {
            for i in x..=x1 {
                let height = self.height(i, j) as f32;
                out.low_m = out.low_m.min(height);
                out.high_m = out.high_m.max(height);
                if i < x1 {
                    let rise = self.height(i + 1, j) as f32 - height;
                    out.east_m = joined(out.east_m, [rise, rise]);
                }
                if j < y1 {
                    let rise = self.height(i, j + 1) as f32 - height;
                    out.south_m = joined(out.south_m, [rise, rise]);
                }
            }
        }
        out
    }
}

fn joined(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn rounded_up(value: f64) -> f32 {
    let single = value as f32;
    if f64::from(single) < value {
        single.next_up()
    } else {
        single
    }
}

/// Puts a subtree's nodes at the end of others. Answers its root.
fn append((root, nodes): Subtree, below: &mut Vec<TreeNode>) -> TreeNode {
    let offset = below.len() as u32;
    let moved = |mut node: TreeNode| {
        if node.children < ABSENT {
            node.children += offset;
        }
        node
    };
    below.extend(nodes.into_iter().map(moved));
    moved(root)
}

/// All nodes in an order, the root first.
fn in_order(root: TreeNode, below: Vec<TreeNode>, order: Order) -> Vec<TreeNode> {
    // As built: each group of four, and all that is below its first, before all that is below its second.
    let mut groups = Vec::with_capacity(below.len() / 4);
    let mut stack = vec![(
        Node {
            level: 0,
            x: 0,
            y: 0,
        },
        root.children,
    )];
    while let Some((node, first)) = stack.pop() {
        if first >= ABSENT {
            continue;
        }
        groups.push((order.key(node).unwrap_or(u128::from(first)), first));
        for k in 0..4 {
            let child = &below[first as usize + usize::from(k)];
            stack.push((node.child(k), child.children));
        }
    }
    groups.sort_unstable();
    let mut place = vec![0; below.len() / 4];
    for (rank, (_, first)) in groups.iter().enumerate() {
        place[*first as usize / 4] = 1 + 4 * rank as u32;
    }
    let moved = |mut node: TreeNode| {
        if node.children < ABSENT {
            node.children = place[node.children as usize / 4];
        }
        node
    };
    let mut nodes = Vec::with_capacity(1 + below.len());
    nodes.push(moved(root));
    for (_, first) in &groups {
        let group = &below[*first as usize..*first as usize + 4];
        nodes.extend(group.iter().map(|node| moved(*node)));
    }
    nodes
}
