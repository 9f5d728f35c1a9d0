//! Building a tree of contours. The result depends on the heights alone.

use super::dem::{Dem, Span, cells, quarters};
use super::plane::{Contour, Support, fit, fit_points};
use super::tree::{BudgetError, ContourTree, Node, TreeStats, corners_m};
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Below this cosine to the vertical a plane is not usable as ground: over a column it would rise a thousandfold.
const MIN_COSINE: f64 = 1e-3;
/// Below this cosine a plane is used only if its slab, measured upwards, is thinner than that of the level plane. In a narrow column with a
/// cliff it may extend far above and below all samples.
const STEEP_COSINE: f64 = 0.5;

impl ContourTree {
    /// Builds the tree: a span is cut in quarters until its slab is not thicker than the tolerance. A tolerance of 0 cuts down to single
    /// cells, unless they are flat to 10 μm. Uses at most `budget_bytes`, in which each node counts twice while it is put in place.
    ///
    /// # Errors
    /// A tree beyond the budget.
    pub fn build(dem: &Dem, tolerance_m: f64, budget_bytes: u64) -> Result<Self, BudgetError> {
        let builder = TreeBuilder::new(dem, tolerance_m, budget_bytes);
        let (nodes, mut stats) = builder.whole().ok_or(BudgetError {
            what: "a tree of contours",
            budget_bytes,
        })?;
        stats.nodes = nodes.len() as u64;
        stats.bytes = stats.nodes * size_of::<Node>() as u64;
        Ok(Self {
            nodes,
            tolerance_m,
            stats,
        })
    }
}

/// Shared state for fitting nodes. Threads may share it.
pub struct TreeBuilder<'a> {
    pub dem: &'a Dem,
    /// The given tolerance, or 10 μm if that is larger.
    pub tolerance_m: f64,
    /// Number of nodes so far, of all threads.
    nodes: AtomicU64,
    max_nodes: u64,
}

impl<'a> TreeBuilder<'a> {
    /// See [`ContourTree::build`].
    pub fn new(dem: &'a Dem, tolerance_m: f64, budget_bytes: u64) -> Self {
        Self {
            dem,
            tolerance_m: tolerance_m.max(1e-5),
            nodes: AtomicU64::new(0),
            max_nodes: (budget_bytes / (2 * size_of::<Node>() as u64)).min(u64::from(u32::MAX)),
        }
    }

    /// The nodes over all samples; `None` if there are too many.
    fn whole(&self) -> Option<(Vec<Node>, TreeStats)> {
        self.take(1)?;
        let (root, is_upright) = self.node(self.dem.span(), 0, Some(&mut Vec::new()));
        let (nodes, mut stats) = self.subtree(root, &mut [])?;
        stats.upright += u64::from(is_upright);
        Some((nodes, stats))
    }

    /// A node and everything below it, numbered from the node, which is its own parent; `None` once there are too many. The ceilings of its
    /// `ancestors`, the nearest first, are raised over all terrain that the leaves draw.
    pub fn subtree(&self, root: Node, ancestors: &mut [Node]) -> Option<(Vec<Node>, TreeStats)> {
        let mut stats = TreeStats::default();
        let mut scratch = Vec::new();
        let whole = cells(root.span) as usize;
        // The number of a full tree; grids of odd sizes may need a few more.
        let mut nodes = Vec::with_capacity(whole + whole / 3 + 8);
        nodes.push(Node { parent: 0, ..root });
        let mut next = 0;
        while next < nodes.len() {
            let node: Node = nodes[next];
            if let Some((spans, count)) = self.cut(&node) {
                self.take(count as u64)?;
                nodes[next].first = nodes.len() as u32;
                nodes[next].children = count as u32;
                for span in &spans[..count] {
                    let (child, is_upright) = self.node(*span, next as u32, Some(&mut scratch));
                    stats.upright += u64::from(is_upright);
                    nodes.push(child);
                }
            } else {
                stats.add_leaf(&node, self.tolerance_m);
            }
            next += 1;
        }
        nodes.shrink_to_fit();
        for k in 0..nodes.len() {
            let corners = corners_m(&self.dem.column(nodes[k].span), &nodes[k].contour);
            raise(&mut nodes, k, &corners);
            for ancestor in &mut *ancestors {
                ancestor.raise_over(&corners);
            }
        }
        // Nodes are ordered level by level: the last is among the deepest.
        stats.depth = ancestors.len() as u32;
        let mut last = nodes.len() - 1;
        while last > 0 {
            last = nodes[last].parent as usize;
            stats.depth += 1;
        }
        Some((nodes, stats))
    }

    /// The quarters of a node that is too thick and can be cut.
    pub fn cut(&self, node: &Node) -> Option<([Span; 4], usize)> {
        quarters(node.span).filter(|_| node.contour.thickness_m() > self.tolerance_m)
    }

    /// Takes nodes from the budget; `None` if there are too many.
    pub fn take(&self, more: u64) -> Option<()> {
        let before = self.nodes.fetch_add(more, Ordering::Relaxed);
        (before + more <= self.max_nodes).then_some(())
    }

    /// The node of a span, and whether its best plane is upright. Samples are collected in `scratch`. Without it they are computed
    /// repeatedly, for spans that are too large to hold.
    pub fn node(&self, span: Span, parent: u32, scratch: Option<&mut Vec<DVec3>>) -> (Node, bool) {
        let dem = self.dem;
        let [west, east, south, north] = span;
        let samples = (south..=north).flat_map(|j| (west..=east).map(move |i| dem.point_m(i, j)));
        let mut contour = match scratch {
            Some(scratch) => {
                scratch.clear();
                scratch.extend(samples.clone());
                fit_points(dem.up(), scratch)
            }
            None => fit(dem.up(), samples.clone()),
        };
        let cosine = contour.normal.dot(dem.up());
        let mut is_upright = false;
        if cosine < STEEP_COSINE {
            let level = Contour {
                normal: dem.up(),
                support: Support::Point,
                ..contour
            }
            .over(samples);
            let thicker = contour.thickness_m() > cosine * level.thickness_m();
            is_upright = cosine < MIN_COSINE || thicker;
            if is_upright {
                contour = level;
            }
        }
        let node = Node {
            contour,
            ceiling_m: contour.high_m,
            radius_m: radius_m(dem, span, contour.at_m),
            span,
            first: 0,
            children: 0,
            parent,
        };
        (node, is_upright)
    }
}

/// Raises the ceilings of a node and of all its ancestors over drawn corners.
pub fn raise(nodes: &mut [Node], mut at: usize, corners_m: &[DVec3; 4]) {
    loop {
        nodes[at].raise_over(corners_m);
        if at == 0 {
            break;
        }
        at = nodes[at].parent as usize;
    }
}

impl Node {
    /// Raises the ceiling over corners, with a margin that exceeds rounding.
    fn raise_over(&mut self, corners_m: &[DVec3; 4]) {
        let Contour { normal, at_m, .. } = self.contour;
        let rises = corners_m.map(|corner| normal.dot(corner - at_m));
        let highest_m = rises.into_iter().fold(f64::NEG_INFINITY, f64::max) + 1e-6;
        self.ceiling_m = self.ceiling_m.max(highest_m);
    }
}

impl TreeStats {
    /// Counts a leaf, compared with the tolerance of its tree.
    pub fn add_leaf(&mut self, leaf: &Node, tolerance_m: f64) {
        let thick_m = leaf.contour.thickness_m();
        self.leaves += 1;
        self.thickest_m = self.thickest_m.max(thick_m);
        self.over += u64::from(thick_m > tolerance_m);
    }
}

/// Distance to the farthest possible position of a sample of the span, metres.
pub fn radius_m(dem: &Dem, [west, east, south, north]: Span, at_m: DVec3) -> f64 {
    let mut radius_m = 0.0f64;
    for (i, j) in [(west, south), (east, south), (west, north), (east, north)] {
        for height in [dem.range_m().low_m, dem.range_m().high_m] {
            radius_m = radius_m.max(dem.lifted_m(i, j, height).distance(at_m));
        }
    }
    radius_m
}
