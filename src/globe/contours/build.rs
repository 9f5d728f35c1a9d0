//! Building the tree of contours: the coarse nodes level by level, and then parts of the ground, each on the first thread that
//! is free. What is built depends on the heights alone, not on the threads.

use super::dem::{Dem, PART_CELLS, Span, cells, quarters};
use super::plane::{Contour, Support, fit, fit_points};
use super::threads::in_parts;
use super::tree::{BudgetError, ContourTree, Node, TreeStats, corners_m};
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Below this cosine to the vertical a plane is no ground: over a column it would rise a thousandfold.
const LEAST_COSINE: f64 = 1e-3;
/// Below this cosine a plane is taken only if its slab, measured upwards, is thinner than that of the level one: of a narrow
/// column with a cliff in it, it may reach far above and below all samples.
const STEEP_COSINE: f64 = 0.5;

/// A node as wide as a part, and all that is below it.
struct Part {
    /// The node first; numbers of nodes count from it.
    nodes: Vec<Node>,
    stats: TreeStats,
    /// How high what the part draws rises over the planes of the nodes above it, the nearest first, metres.
    over_m: Vec<f64>,
}

/// What all parts are built by.
struct Builder<'a> {
    dem: &'a Dem,
    tolerance_m: f64,
    /// Nodes so far, of all parts.
    count: AtomicU64,
    most: u64,
}

impl ContourTree {
    /// Builds the tree: a span is cut in quarters until its slab is not thicker than the tolerance (0: until single
    /// cells, unless flat to 10 μm). `progress` hears 0…1. Takes at most `budget_bytes`, in which each node counts twice: while
    /// parts are put together.
    pub fn build(
        dem: &Dem,
        tolerance_m: f64,
        budget_bytes: u64,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, BudgetError> {
        Self::build_on(1, dem, tolerance_m, budget_bytes, progress)
    }

    /// As [`Self::build`] on so many threads: the same tree to the last bit. Grids of up to 256 × 256 cells start none.
    pub fn build_on(
        threads: usize,
        dem: &Dem,
        tolerance_m: f64,
        budget_bytes: u64,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, BudgetError> {
        let refused = BudgetError {
            what: "a tree of contours",
            budget_bytes,
        };
        let builder = Builder {
            dem,
            tolerance_m: tolerance_m.max(1e-5),
            count: AtomicU64::new(0),
            most: (budget_bytes / (2 * size_of::<Node>() as u64)).min(u64::from(u32::MAX)),
        };
        let mut stats = TreeStats::default();
        let (mut nodes, roots) = builder.coarse(threads, &mut stats).ok_or(refused)?;
        let all = cells(dem.span());
        let small = roots.iter().map(|root| cells(nodes[*root].span));
        let mut done = all - small.sum::<u64>();
        let parts = in_parts(
            threads,
            roots.len(),
            |k| builder.part(&nodes, roots[k]),
            &mut |k| {
                done += cells(nodes[roots[k]].span);
                progress(0.95 * done as f32 / all as f32);
            },
        );
        if parts.iter().any(Option::is_none) {
            return Err(refused);
        }
        builder.raise_coarse(&mut nodes, &roots);
        nodes.reserve_exact(builder.count.into_inner() as usize - nodes.len());
        for (root, part) in roots.into_iter().zip(parts.into_iter().flatten()) {
            put(&mut nodes, root, part, &mut stats);
        }
        stats.nodes = nodes.len() as u64;
        stats.bytes = stats.nodes * size_of::<Node>() as u64;
        progress(1.0);
        Ok(Self {
            nodes,
            tolerance_m,
            stats,
        })
    }
}

impl Builder<'_> {
    /// Nodes wider than a part, and those that parts begin with, level by level; the numbers of the latter. `None` if they
    /// are too many.
    fn coarse(&self, threads: usize, stats: &mut TreeStats) -> Option<(Vec<Node>, Vec<usize>)> {
        let mut nodes: Vec<Node> = Vec::new();
        let mut roots = Vec::new();
        let mut level = vec![(self.dem.span(), 0)];
        while !level.is_empty() {
            let fitted = in_parts(
                threads,
                level.len(),
                |k| {
                    let (span, parent) = level[k];
                    let is_small = cells(span) <= PART_CELLS;
                    (
                        is_small,
                        self.node(span, parent, &mut Vec::new(), !is_small),
                    )
                },
                &mut |_| (),
            );
            self.add(fitted.len() as u64)?;
            let mut below = Vec::new();
            for (is_small, (node, upright)) in fitted {
                let index = nodes.len();
                nodes.push(node);
                stats.upright += u64::from(upright);
                if is_small {
                    roots.push(index);
                } else if let Some((spans, count)) = self.cut(&node) {
                    nodes[index].children = count as u32;
                    below.extend(spans[..count].iter().map(|span| (*span, index as u32)));
                } else {
                    self.note_leaf(&node, stats);
                }
            }
            // Children of nodes follow each other in the order of these.
            let mut first = nodes.len() as u32;
            let start = nodes.len() - level.len();
            for node in &mut nodes[start..] {
                if node.children > 0 {
                    node.first = first;
                    first += node.children;
                }
            }
            level = below;
        }
        Some((nodes, roots))
    }

    /// All that is below a node, with the node; `None` once there are too many.
    fn part(&self, coarse: &[Node], root: usize) -> Option<Part> {
        let mut stats = TreeStats::default();
        let mut scratch = Vec::new();
        let whole = cells(coarse[root].span) as usize;
        // As many as a full tree has; grids of odd sizes may take a few more.
        let mut nodes = Vec::with_capacity(whole + whole / 3 + 8);
        nodes.push(Node {
            parent: 0,
            ..coarse[root]
        });
        let mut next = 0;
        while next < nodes.len() {
            let node: Node = nodes[next];
            if let Some((spans, count)) = self.cut(&node) {
                self.add(count as u64)?;
                nodes[next].first = nodes.len() as u32;
                nodes[next].children = count as u32;
                for span in &spans[..count] {
                    let (child, upright) = self.node(*span, next as u32, &mut scratch, false);
                    stats.upright += u64::from(upright);
                    nodes.push(child);
                }
            } else {
                self.note_leaf(&node, &mut stats);
            }
            next += 1;
        }
        nodes.shrink_to_fit();
        let mut above = Vec::new();
        let mut at = root;
        while at > 0 {
            at = coarse[at].parent as usize;
            above.push(coarse[at].contour);
        }
        let mut over_m = vec![f64::NEG_INFINITY; above.len()];
        for k in 0..nodes.len() {
            let corners = corners_m(&self.dem.column(nodes[k].span), &nodes[k].contour);
            let mut at = k;
            loop {
                let node = &mut nodes[at];
                node.ceiling_m = node.ceiling_m.max(over(&node.contour, &corners));
                if at == 0 {
                    break;
                }
                at = node.parent as usize;
            }
            for (over_m, contour) in over_m.iter_mut().zip(&above) {
                *over_m = over_m.max(over(contour, &corners));
            }
        }
        // Nodes stand level by level: the last is among the deepest.
        stats.depth = above.len() as u32;
        let mut last = nodes.len() - 1;
        while last > 0 {
            last = nodes[last].parent as usize;
            stats.depth += 1;
        }
        Some(Part {
            nodes,
            stats,
            over_m,
        })
    }

    /// The quarters of a node that is too thick and can be cut.
    fn cut(&self, node: &Node) -> Option<([Span; 4], usize)> {
        quarters(node.span).filter(|_| node.contour.thickness_m() > self.tolerance_m)
    }

    /// Counts nodes; `None` if they are too many.
    fn add(&self, more: u64) -> Option<()> {
        let before = self.count.fetch_add(more, Ordering::Relaxed);
        (before + more <= self.most).then_some(())
    }

    fn note_leaf(&self, node: &Node, stats: &mut TreeStats) {
        let thick_m = node.contour.thickness_m();
        stats.leaves += 1;
        stats.thickest_m = stats.thickest_m.max(thick_m);
        stats.over += u64::from(thick_m > self.tolerance_m);
    }

    /// The node of a span, and whether its best plane stands upright. Samples of small spans are gathered in `scratch`; those
    /// of large ones are computed again and again.
    fn node(
        &self,
        span: Span,
        parent: u32,
        scratch: &mut Vec<DVec3>,
        is_large: bool,
    ) -> (Node, bool) {
        let dem = self.dem;
        let [west, east, south, north] = span;
        let samples = (south..=north).flat_map(|j| (west..=east).map(move |i| dem.point_m(i, j)));
        let mut contour = if is_large {
            fit(dem.up(), samples.clone())
        } else {
            scratch.clear();
            scratch.extend(samples.clone());
            fit_points(dem.up(), scratch)
        };
        let cosine = contour.normal.dot(dem.up());
        let mut upright = false;
        if cosine < STEEP_COSINE {
            let level = Contour {
                normal: dem.up(),
                support: Support::Point,
                ..contour
            }
            .over(samples);
            let thicker = contour.thickness_m() > cosine * level.thickness_m();
            upright = cosine < LEAST_COSINE || thicker;
            if upright {
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
        (node, upright)
    }

    /// Lets the ceilings of coarse nodes hold what those of them draw that no part begins with.
    fn raise_coarse(&self, nodes: &mut [Node], roots: &[usize]) {
        for k in 0..nodes.len() {
            if roots.binary_search(&k).is_ok() {
                continue;
            }
            let corners = corners_m(&self.dem.column(nodes[k].span), &nodes[k].contour);
            let mut at = k;
            loop {
                let node = &mut nodes[at];
                node.ceiling_m = node.ceiling_m.max(over(&node.contour, &corners));
                if at == 0 {
                    break;
                }
                at = node.parent as usize;
            }
        }
    }
}

/// Puts a part into its place.
fn put(nodes: &mut Vec<Node>, root: usize, part: Part, stats: &mut TreeStats) {
    // Number 1 of the part goes to the end.
    let moved = |index: u32| index + nodes.len() as u32 - 1;
    let (first, parent) = (moved(1), nodes[root].parent);
    let mut at = root;
    for over_m in part.over_m {
        at = nodes[at].parent as usize;
        nodes[at].ceiling_m = nodes[at].ceiling_m.max(over_m);
    }
    for (k, mut node) in part.nodes.into_iter().enumerate() {
        if node.children > 0 {
            node.first += first - 1;
        }
        if k == 0 {
            nodes[root] = Node { parent, ..node };
            continue;
        }
        node.parent = match node.parent {
            0 => root as u32,
            within => within + first - 1,
        };
        nodes.push(node);
    }
    stats.leaves += part.stats.leaves;
    stats.over += part.stats.over;
    stats.upright += part.stats.upright;
    stats.depth = stats.depth.max(part.stats.depth);
    stats.thickest_m = stats.thickest_m.max(part.stats.thickest_m);
}

/// How far corners rise over a plane, and a hair more than rounding, metres.
fn over(contour: &Contour, corners_m: &[DVec3; 4]) -> f64 {
    let rises = corners_m.map(|corner| contour.normal.dot(corner - contour.at_m));
    rises.into_iter().fold(f64::NEG_INFINITY, f64::max) + 1e-6
}

/// Distance to the farthest place that a sample of the span could have, metres.
pub(super) fn radius_m(dem: &Dem, [west, east, south, north]: Span, at_m: DVec3) -> f64 {
    let mut radius_m = 0.0f64;
    for (i, j) in [(west, south), (east, south), (west, north), (east, north)] {
        for height in [dem.range_m().low_m, dem.range_m().high_m] {
            radius_m = radius_m.max(dem.lifted_m(i, j, height).distance(at_m));
        }
    }
    radius_m
}
