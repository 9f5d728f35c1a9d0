//! Which leaves of a tree a view is drawn with, and their triangles.

use super::tree::{ABSENT, CELLS, GridQuadtree, LEAF, TreeNode};
use glam::DVec3;
use terrella_ground::globe::quadtree::{
    Cut, Domain, Node, Point, SplitRule, among, child_among, ring,
};

/// Which error of a node a view looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorMetric {
    /// The paper's rule: the largest of five midpoint errors, of the node and below. The drawn error may be larger.
    Midpoints,
    /// Most that any post is off by.
    #[default]
    Bound,
}

/// An eye over a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeView {
    /// The eye, metres: east and north of the north-western post (so north is negative over the grid), and up.
    pub eye_m: DVec3,
    /// When a leaf is divided. [`SplitRule::Tolerance`] and [`SplitRule::Full`] look at the next two.
    pub split_rule: SplitRule,
    /// Angle of a pixel, radians.
    pub pixel_rad: f64,
    /// Pixels by which the drawn ground may differ from its data.
    pub tolerance_px: f64,
    /// Which error counts.
    pub metric: ErrorMetric,
    /// Leave out what faces away with every face.
    pub is_culled: bool,
}

/// The leaves of a view. Kept from view to view, it takes no new memory.
#[derive(Clone, Debug, Default)]
pub struct SelectedLeaves {
    /// A bit to each node of the tree: it is divided.
    split: Vec<u64>,
    leaves: Vec<Node>,
    stack: Vec<(Node, u32)>,
    culled: usize,
    error_m: f64,
}

impl SelectedLeaves {
    /// Leaves to draw, cells among them.
    pub fn leaves(&self) -> &[Node] {
        &self.leaves
    }

    /// Leaves and larger squares that were left out because they face away.
    pub fn culled(&self) -> usize {
        self.culled
    }

    /// Largest error of a leaf to draw, metres.
    pub fn error_m(&self) -> f64 {
        self.error_m
    }

    fn is_split(&self, index: u32) -> bool {
        self.split[index as usize / 64] >> (index % 64) & 1 == 1
    }
}

/// A tree as a view divides it.
struct Divided<'a> {
    tree: &'a GridQuadtree,
    selected: &'a SelectedLeaves,
}

impl Cut for Divided<'_> {
    type Place = u32;

    fn domain(&self) -> Domain {
        Domain {
            columns: 1,
            rows: 1,
            is_globe: false,
        }
    }

    fn root(&self, _node: Node) -> u32 {
        0
    }

    fn is_split(&self, index: u32) -> bool {
        index != CELL && self.selected.is_split(index)
    }

    fn child(&self, _node: Node, index: u32, k: u8) -> Option<u32> {
        if index == CELL {
            return None;
        }
        match self.tree.nodes[index as usize].children {
            CELLS => Some(CELL),
            LEAF | ABSENT => None,
            first => Some(first + u32::from(k)),
        }
    }
}

/// Marks a cell, which has no node.
const CELL: u32 = u32::MAX;

impl GridQuadtree {
    /// Selects the leaves of a view: from the root down, a square is subdivided while the rule requires it and there is something below.
    pub fn select(&self, view: &TreeView, selected: &mut SelectedLeaves) {
        selected.split.clear();
        selected.split.resize(self.nodes.len().div_ceil(64), 0);
        selected.leaves.clear();
        (selected.culled, selected.error_m) = (0, 0.0);
        let root = Node {
            level: 0,
            x: 0,
            y: 0,
        };
        selected.stack.clear();
        selected.stack.push((root, 0));
        while let Some((node, index)) = selected.stack.pop() {
            if index == CELL {
                self.select_cell(view, node, selected);
                continue;
            }
            let known = &self.nodes[index as usize];
            if known.children == ABSENT {
                continue;
            }
            let bounds = self.bounds(node, known);
            if view.is_culled && faces_away(view.eye_m, bounds, known, self.spacing_m) {
                selected.culled += 1;
                continue;
            }
            let error_m = f64::from(match view.metric {
                ErrorMetric::Midpoints => known.midpoints_m,
                ErrorMetric::Bound => known.bound_m,
            });
            let (low, high) = bounds;
            let distance_m = view.eye_m.distance(view.eye_m.clamp(low, high));
            // A square that is not all on the grid has no error, and is no leaf.
            let is_divided = known.children != LEAF
                && (known.bound_m.is_infinite()
                    || view.is_exceeded(error_m, distance_m, high.x - low.x));
            if !is_divided {
                selected.error_m = selected.error_m.max(f64::from(known.bound_m));
                selected.leaves.push(node);
                continue;
            }
            selected.split[index as usize / 64] |= 1 << (index % 64);
            for k in (0..4).rev() {
                let below = match known.children {
                    CELLS => CELL,
                    first => first + u32::from(k),
                };
                selected.stack.push((node.child(k), below));
            }
        }
    }

    /// A cell, if it is on the grid and may be seen.
    fn select_cell(&self, view: &TreeView, node: Node, selected: &mut SelectedLeaves) {
        if node.x as usize + 1 >= self.columns || node.y as usize + 1 >= self.rows {
            return;
        }
        if view.is_culled && self.cell_faces_away(view.eye_m, node) {
            selected.culled += 1;
        } else {
            selected.leaves.push(node);
        }
    }

    /// The triangles of the leaves, three numbers of posts each (row × columns + column), counter-clockwise seen from above.
    pub fn triangles(&self, selected: &SelectedLeaves, out: &mut Vec<u32>) {
        out.clear();
        let levels = self.levels();
        let divided = Divided {
            tree: self,
            selected,
        };
        let post = |(x, y): Point| (y as usize * self.columns + x as usize) as u32;
        let mut points = Vec::with_capacity(64);
        let root = Node {
            level: 0,
            x: 0,
            y: 0,
        };
        // Leaves are in the order of this traversal; omitted ones are skipped.
        let mut leaves = selected.leaves.iter().copied().peekable();
        let mut stack = Vec::with_capacity(64);
        stack.push(among(&divided, (root, 0)));
        while let Some(square) = stack.pop() {
            let (node, index) = square.at;
            if divided.is_split(index) {
                let children = (0..4).rev();
                stack.extend(children.filter_map(|k| child_among(&divided, &square, k)));
                continue;
            }
            if leaves.peek() != Some(&node) {
                continue;
            }
            leaves.next();
            if node.level == levels {
                out.extend(self.cell(node).as_flattened());
                continue;
            }
            let center = post(node.square(levels).center());
            ring(&divided, &square, levels, &mut points);
            for (i, a) in points.iter().enumerate() {
                let b = points[(i + 1) % points.len()];
                out.extend([center, post(*a), post(b)]);
            }
        }
    }

    /// All cells, nothing merged and nothing left out: what the tree is compared with.
    pub fn all_triangles(&self, out: &mut Vec<u32>) {
        out.clear();
        let level = self.levels();
        for y in 0..self.rows as u64 - 1 {
            for x in 0..self.columns as u64 - 1 {
                out.extend(self.cell(Node { level, x, y }).as_flattened());
            }
        }
    }

    /// A post, metres east, north and up.
    pub fn post_m(&self, post: u32) -> DVec3 {
        let (column, row) = (post as usize % self.columns, post as usize / self.columns);
        DVec3::new(
            column as f64 * self.spacing_m,
            row as f64 * -self.spacing_m,
            self.height_m(column, row),
        )
    }

    /// The two triangles of a cell. They share the diagonal through the middle of the square of four cells, so that they lie inside the triangles
    /// of that.
    fn cell(&self, node: Node) -> [[u32; 3]; 2] {
        let nw = (node.y as usize * self.columns + node.x as usize) as u32;
        let sw = nw + self.columns as u32;
        let (ne, se) = (nw + 1, sw + 1);
        if (node.x ^ node.y) & 1 == 0 {
            [[nw, sw, se], [nw, se, ne]]
        } else {
            [[nw, sw, ne], [ne, sw, se]]
        }
    }

    fn cell_faces_away(&self, eye_m: DVec3, node: Node) -> bool {
        self.cell(node).iter().all(|corners| {
            let [a, b, c] = corners.map(|post| self.post_m(post));
            (b - a).cross(c - a).dot(eye_m - a) < 0.0
        })
    }

    /// The box about a node, metres.
    fn bounds(&self, node: Node, known: &TreeNode) -> (DVec3, DVec3) {
        let square = node.square(self.levels());
        let end = |at: u64, posts: usize| at.min(posts as u64 - 1) as f64 * self.spacing_m;
        let low = DVec3::new(
            end(square.x, self.columns),
            -end(square.y + square.size, self.rows),
            f64::from(known.low_m),
        );
        let high = DVec3::new(
            end(square.x + square.size, self.columns),
            -end(square.y, self.rows),
            f64::from(known.high_m),
        );
        (low, high)
    }
}

impl TreeView {
    /// Whether a node must be subdivided.
    fn is_exceeded(&self, error_m: f64, distance_m: f64, side_m: f64) -> bool {
        let per_px = 1.0 / (self.pixel_rad * self.tolerance_px);
        match self.split_rule {
            // (1) e_max·λ > d
            SplitRule::Tolerance => error_m * per_px > distance_m,
            SplitRule::Paper { lambda } => error_m * lambda > distance_m,
            // (2) k·l·L·λ·e_max / (2 tan(α/2)·d·ε) > 1
            SplitRule::Full { k } => {
                let side_px = side_m / (distance_m * self.pixel_rad);
                error_m > 0.0 && k * side_px * error_m * per_px > distance_m
            }
        }
    }
}

/// Whether no face that can be drawn of a node turns to the eye, whichever leaves it is drawn with.
///
/// A face that rises by p to the east and by q to the south has the normal (−p, q, 1) in (east, north, up), and turns away
/// where that times (eye − point) is negative. A leaf's triangle rises along its outer edge by a mean of the rises between
/// posts, so within their bounds. Across, from the edge to the centre, it is the mean of rises along a path of posts, plus
/// what the edge's own rise differs from theirs: so within the bounds widened by the spread of the other ones.
fn faces_away(eye_m: DVec3, (low, high): (DVec3, DVec3), known: &TreeNode, spacing_m: f64) -> bool {
    let [east, south] = [known.east_m, known.south_m].map(|rise| rise.map(f64::from));
    let (east_spread, south_spread) = (east[1] - east[0], south[1] - south[0]);
    let p = [east[0] - south_spread, east[1] + south_spread].map(|rise| rise / spacing_m);
    let q = [south[0] - east_spread, south[1] + east_spread].map(|rise| rise / spacing_m);
    // eye − point, lowest and highest.
    let (from, to) = (eye_m - high, eye_m - low);
    let most = |[a, b]: [f64; 2], c: f64, d: f64| (a * c).max(a * d).max(b * c).max(b * d);
    let most_east = most(p.map(|rise| -rise), from.x, to.x);
    let most_north = most(q, from.y, to.y);
    // Rounding never makes a face away of one that is seen edge on.
    let slack = 1e-9 * (most_east.abs() + most_north.abs() + to.z.abs());
    most_east + most_north + to.z < -slack
}
