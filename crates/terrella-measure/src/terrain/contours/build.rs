//! Building a tree of contours on threads: the coarse nodes level by level, and then parts of the ground, each on the first
//! thread that is free.

use crate::terrain::workers::{PART_CELLS, Workers};
use terrella_ground::globe::contours::build::{TreeBuilder, raise};
use terrella_ground::globe::contours::dem::{Dem, cells};
use terrella_ground::globe::contours::tree::{
    BudgetError, ContourTree, Node, TreeStats, corners_m,
};

/// A node as wide as a part, and all that is below it.
struct Subtree {
    /// The node first; numbers of nodes count from it.
    nodes: Vec<Node>,
    stats: TreeStats,
    /// The nodes above it, the nearest first, with ceilings over what the part draws.
    ancestors: Vec<Node>,
}

/// As [`ContourTree::build`], on several threads: the same tree to the last bit for any number of them. Grids of up to 256 × 256 cells, which start
/// none, give the tree of [`ContourTree::build`]. `progress` receives 0…1.
///
/// # Errors
/// A tree that exceeds the memory limit.
pub fn build_on(
    threads: usize,
    dem: &Dem,
    tolerance_m: f64,
    budget_bytes: u64,
    progress: &mut dyn FnMut(f32),
) -> Result<ContourTree, BudgetError> {
    let rejected = BudgetError {
        what: "a tree of contours",
        budget_bytes,
    };
    let builder = TreeBuilder::new(dem, tolerance_m, budget_bytes);
    let workers = Workers::new(threads);
    let mut stats = TreeStats::default();
    let coarse = coarse(&builder, &workers, &mut stats);
    let (mut nodes, roots) = coarse.ok_or(rejected)?;
    let all = cells(dem.span());
    let small = roots.iter().map(|root| cells(nodes[*root].span));
    let mut done = all - small.sum::<u64>();
    let parts = workers.map(
        roots.len(),
        |k| part(&builder, &nodes, roots[k]),
        &mut |k| {
            done += cells(nodes[roots[k]].span);
            progress(0.95 * done as f32 / all as f32);
        },
    );
    let parts: Vec<Subtree> = parts.into_iter().collect::<Option<_>>().ok_or(rejected)?;
    // What is drawn of coarse nodes that no part begins with.
    for k in 0..nodes.len() {
        if roots.binary_search(&k).is_err() {
            let corners = corners_m(&dem.column(nodes[k].span), &nodes[k].contour);
            raise(&mut nodes, k, &corners);
        }
    }
    let more = parts.iter().map(|part| part.nodes.len() - 1).sum();
    nodes.reserve_exact(more);
    for (root, part) in roots.into_iter().zip(parts) {
        put(&mut nodes, root, part, &mut stats);
    }
    stats.nodes = nodes.len() as u64;
    stats.bytes = stats.nodes * size_of::<Node>() as u64;
    progress(1.0);
    Ok(ContourTree {
        nodes,
        tolerance_m,
        stats,
    })
}

/// Nodes wider than a part, and those that parts begin with, level by level; the numbers of the latter. `None` if they
/// are too many.
fn coarse(
    builder: &TreeBuilder<'_>,
    workers: &Workers,
    stats: &mut TreeStats,
) -> Option<(Vec<Node>, Vec<usize>)> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut roots = Vec::new();
    let mut level = vec![(builder.dem.span(), 0)];
    while !level.is_empty() {
        let fitted = workers.map(
            level.len(),
            |k| {
                let (span, parent) = level[k];
                let is_small = cells(span) <= PART_CELLS;
                let mut samples = Vec::new();
                let scratch = is_small.then_some(&mut samples);
                (is_small, builder.node(span, parent, scratch))
            },
            &mut |_| (),
        );
        builder.take(fitted.len() as u64)?;
        let mut below = Vec::new();
        for (is_small, (node, is_upright)) in fitted {
            let index = nodes.len();
            nodes.push(node);
            stats.upright += u64::from(is_upright);
            if is_small {
                roots.push(index);
            } else if let Some((spans, count)) = builder.cut(&node) {
                nodes[index].children = count as u32;
                below.extend(spans[..count].iter().map(|span| (*span, index as u32)));
            } else {
                stats.add_leaf(&node, builder.tolerance_m);
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
fn part(builder: &TreeBuilder<'_>, coarse: &[Node], root: usize) -> Option<Subtree> {
    let mut ancestors = Vec::new();
    let mut at = root;
    while at > 0 {
        at = coarse[at].parent as usize;
        ancestors.push(coarse[at]);
    }
    let (nodes, stats) = builder.subtree(coarse[root], &mut ancestors)?;
    Some(Subtree {
        nodes,
        stats,
        ancestors,
    })
}

/// Puts a part into its place.
fn put(nodes: &mut Vec<Node>, root: usize, part: Subtree, stats: &mut TreeStats) {
    // Number 1 of the part goes to the end.
    let moved = |index: u32| index + nodes.len() as u32 - 1;
    let (first, parent) = (moved(1), nodes[root].parent);
    let mut at = root;
    for ancestor in part.ancestors {
        at = nodes[at].parent as usize;
        nodes[at].ceiling_m = nodes[at].ceiling_m.max(ancestor.ceiling_m);
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
