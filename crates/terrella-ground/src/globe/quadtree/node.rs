//! Squares of a dyadic grid, their neighbours, and the ring of points that a leaf is drawn from.
//!
//! Rows count southwards. A tree implements [`Cut`], which defines the squares that are currently divided. The rules that keep edges closed
//! depend on that alone, so that the tree over one grid and the forest over the Earth share them.

/// A square of a dyadic grid: level 0 has the roots, level n + 1 has twice the columns and rows of level n.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node {
    /// Number of halvings of the root.
    pub level: u8,
    /// Column, eastwards.
    pub x: u64,
    /// Row, southwards.
    pub y: u64,
}

impl Node {
    /// Child `k` in Morton order: north-west, north-east, south-west, south-east.
    pub fn child(self, k: u8) -> Self {
        Self {
            level: self.level + 1,
            x: 2 * self.x + u64::from(k & 1),
            y: 2 * self.y + u64::from(k >> 1),
        }
    }

    /// All four children, in Morton order.
    pub fn children(self) -> [Self; 4] {
        [0, 1, 2, 3].map(|k| self.child(k))
    }

    /// The square that this is a quarter of; `None` for a root.
    pub fn parent(self) -> Option<Self> {
        Some(Self {
            level: self.level.checked_sub(1)?,
            x: self.x / 2,
            y: self.y / 2,
        })
    }

    /// The child that contains a finer node, and its index.
    pub fn child_towards(self, node: Self) -> (Self, u8) {
        let next = node.ancestor(self.level + 1);
        (next, (next.x & 1) as u8 | ((next.y & 1) as u8) << 1)
    }

    /// The ancestor at a level; the node itself at its own level.
    pub fn ancestor(self, level: u8) -> Self {
        let up = self.level.saturating_sub(level);
        Self {
            level: self.level - up,
            x: self.x >> up,
            y: self.y >> up,
        }
    }

    /// Extent of the node in points, with `depth` halvings to the finest point.
    pub fn square(self, depth: u8) -> Square {
        let shift = depth - self.level;
        Square {
            x: self.x << shift,
            y: self.y << shift,
            size: 1 << shift,
        }
    }
}

/// A position on the finest points of a grid.
pub type Point = (u64, u64);

/// A node's extent in points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Square {
    /// Its western column.
    pub x: u64,
    /// Its northern row.
    pub y: u64,
    /// Distance to the eastern column and to the southern row.
    pub size: u64,
}

impl Square {
    /// The point in the middle; needs a size of 2 or more.
    pub fn center(self) -> Point {
        (self.x + self.size / 2, self.y + self.size / 2)
    }
}

/// A side of a square, in the order in which a ring runs: counter-clockwise seen from above, from the north-west.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Southwards along the western edge.
    West,
    /// Eastwards along the southern edge.
    South,
    /// Northwards along the eastern edge.
    East,
    /// Westwards along the northern edge.
    North,
}

impl Side {
    /// All four sides, in the order of the ring.
    pub const ALL: [Self; 4] = [Self::West, Self::South, Self::East, Self::North];

    /// The neighbour's two children that touch this side, in the order of the ring.
    fn touching(self) -> [u8; 2] {
        match self {
            Self::West => [1, 3],
            Self::South => [0, 1],
            Self::East => [2, 0],
            Self::North => [3, 2],
        }
    }
}

/// Number of roots, and whether the last column's eastern neighbour is the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Domain {
    /// Roots from west to east.
    pub columns: u64,
    /// Roots from north to south.
    pub rows: u64,
    /// Whether the grid closes around the Earth. All points of its first row are then one, and so are those of its last.
    pub is_globe: bool,
}

impl Domain {
    /// Whether two squares share a point, also across the date line; not whether they meet only at a pole.
    pub fn is_beside(&self, a: Node, b: Node) -> bool {
        let depth = a.level.max(b.level);
        let (a, b) = (a.square(depth), b.square(depth));
        let columns = self.columns << depth;
        let is_near = |a: u64, a_size: u64, b: u64, b_size: u64| a <= b + b_size && b <= a + a_size;
        let is_beside = is_near(a.x, a.size, b.x, b.size)
            || self.is_globe && is_near(a.x + columns, a.size, b.x, b.size)
            || self.is_globe && is_near(a.x, a.size, b.x + columns, b.size);
        is_near(a.y, a.size, b.y, b.size) && is_beside
    }

    /// Whether two squares end at the same pole.
    pub fn shares_pole(&self, a: Node, b: Node) -> bool {
        let is_northernmost = |node: Node| node.y == 0;
        let is_southernmost = |node: Node| node.y + 1 == self.rows << node.level;
        self.is_globe
            && (is_northernmost(a) && is_northernmost(b)
                || is_southernmost(a) && is_southernmost(b))
    }

    /// Whether two squares share a point, also across the date line and at the poles.
    pub fn is_adjacent(&self, a: Node, b: Node) -> bool {
        self.is_beside(a, b) || self.shares_pole(a, b)
    }

    /// The square of the same level across a side; `None` at the end of the grid and at a pole.
    pub fn neighbour(&self, node: Node, side: Side) -> Option<Node> {
        let (columns, rows) = (self.columns << node.level, self.rows << node.level);
        let (x, y) = match side {
            Side::North => (node.x, node.y.checked_sub(1)?),
            Side::South => (node.x, node.y + 1),
            Side::East => (node.x + 1, node.y),
            Side::West if self.is_globe => ((node.x + columns - 1) % columns, node.y),
            Side::West => (node.x.checked_sub(1)?, node.y),
        };
        let x = if self.is_globe { x % columns } else { x };
        (x < columns && y < rows).then_some(Node { x, y, ..node })
    }

    /// The unique coordinates of a point: the eastern end equals the western one, and a pole is one point.
    pub fn point(&self, (x, y): Point, depth: u8) -> Point {
        if !self.is_globe {
            return (x, y);
        }
        if y == 0 || y == self.rows << depth {
            return (0, y);
        }
        (x % (self.columns << depth), y)
    }
}

/// The squares of a tree that are currently divided. A `Place` is where the tree stores a square.
pub trait Cut {
    /// Direct reference to a stored square.
    type Place: Copy;

    /// The roots.
    fn domain(&self) -> Domain;

    /// Where a root is stored.
    fn root(&self, node: Node) -> Self::Place;

    /// Whether the square stored there is divided.
    fn is_split(&self, place: Self::Place) -> bool;

    /// Where child `k` of a square is stored; `None` if its children are not in memory.
    fn child(&self, node: Node, place: Self::Place, k: u8) -> Option<Self::Place>;
}

/// A square and where it is stored.
pub type Kept<P> = (Node, P);

/// A square with its neighbours, in the order of [`Side::ALL`]. A neighbour is of the same level, or a larger leaf; there is none where the
/// grid ends.
#[derive(Clone, Copy, Debug)]
pub struct Among<P> {
    /// The square.
    pub at: Kept<P>,
    /// Its neighbours.
    pub beside: [Option<Kept<P>>; 4],
}

/// The square, or the leaf that contains it.
fn find<C: Cut>(cut: &C, node: Node) -> Kept<C::Place> {
    let mut at = node.ancestor(0);
    let mut place = cut.root(at);
    while at.level < node.level && cut.is_split(place) {
        let (next, k) = at.child_towards(node);
        let Some(below) = cut.child(at, place, k) else {
            break;
        };
        (at, place) = (next, below);
    }
    (at, place)
}

/// A square with its neighbours, searched from the roots (the paper's search for neighbours of another parent).
pub fn among<C: Cut>(cut: &C, at: Kept<C::Place>) -> Among<C::Place> {
    let domain = cut.domain();
    let beside = Side::ALL.map(|side| Some(find(cut, domain.neighbour(at.0, side)?)));
    Among { at, beside }
}

/// A child with its neighbours: two are its siblings, and two are found from the neighbours of its parent.
pub fn child_among<C: Cut>(cut: &C, parent: &Among<C::Place>, k: u8) -> Option<Among<C::Place>> {
    let (node, place) = parent.at;
    let child = (node.child(k), cut.child(node, place, k)?);
    let mut beside = [None; 4];
    for ((side, beside), outer) in Side::ALL.into_iter().zip(&mut beside).zip(parent.beside) {
        // Across a vertical edge the column changes, across a horizontal one the row.
        let (bit, inner) = match side {
            Side::West => (1, 1),
            Side::East => (1, 0),
            Side::North => (2, 2),
            Side::South => (2, 0),
        };
        let across = k ^ bit;
        *beside = if k & bit == inner {
            Some((node.child(across), cut.child(node, place, across)?))
        } else {
            outer.map(|(outer, place)| {
                let is_deeper = outer.level == node.level && cut.is_split(place);
                let below = is_deeper.then(|| cut.child(outer, place, across)).flatten();
                below.map_or((outer, place), |below| (outer.child(across), below))
            })
        };
    }
    Some(Among { at: child, beside })
}

/// The points that a leaf is drawn with, counter-clockwise from its north-western corner: its corners, and on each edge every point of
/// finer leaves beyond it. Neighbours are searched level by level (section 2.2.2 of the paper). The paper moves the finer side's points
/// onto the coarser edge. Here the coarser side inserts them instead. Both sides then have the same points with the heights of the data,
/// and no T-junction is left. Any two levels may meet.
///
/// Points are normalised by [`Domain::point`]. Adjacent points of the ring that are the same (at a pole) are both returned.
pub fn ring<C: Cut>(cut: &C, leaf: &Among<C::Place>, depth: u8, out: &mut Vec<Point>) {
    out.clear();
    let domain = cut.domain();
    let Square { x, y, size } = leaf.at.0.square(depth);
    let corners = [(x, y), (x, y + size), (x + size, y + size), (x + size, y)];
    for ((side, corner), beside) in Side::ALL.into_iter().zip(corners).zip(leaf.beside) {
        out.push(domain.point(corner, depth));
        if let Some(beyond) = beside
            && beyond.0.level == leaf.at.0.level
        {
            along(cut, &domain, beyond, side, depth, out);
        }
    }
}

/// Appends the points that divided squares beyond a side have on it, without the ends.
fn along<C: Cut>(
    cut: &C,
    domain: &Domain,
    (beyond, place): Kept<C::Place>,
    side: Side,
    depth: u8,
    out: &mut Vec<Point>,
) {
    if beyond.level >= depth || !cut.is_split(place) {
        return;
    }
    let [first, second] = side.touching();
    if let Some(below) = cut.child(beyond, place, first) {
        along(cut, domain, (beyond.child(first), below), side, depth, out);
    }
    let Square { x, y, size } = beyond.square(depth);
    let half = size / 2;
    let middle = match side {
        Side::West => (x + size, y + half),
        Side::South => (x + half, y),
        Side::East => (x, y + half),
        Side::North => (x + half, y + size),
    };
    out.push(domain.point(middle, depth));
    if let Some(below) = cut.child(beyond, place, second) {
        along(cut, domain, (beyond.child(second), below), side, depth, out);
    }
}
