//! The quadtree of contours over a DEM of any size.

use super::dem::{HalfSpace, Span};
use super::plane::Contour;
use glam::DVec3;

/// A tree that does not fit into its budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} would take more than the {budget_bytes} bytes allowed; raise the budget or the tolerance"
)]
pub struct BudgetError {
    /// What was being built.
    pub what: &'static str,
    /// Bytes allowed.
    pub budget_bytes: u64,
}

/// A node: a span of samples between two parallel planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Its plane and slab. All samples of the span are inside.
    pub contour: Contour,
    /// Upper bound of the signed distance of drawn terrain below this node from its plane, metres.
    pub ceiling_m: f64,
    /// Distance of the farthest sample from the centroid, metres.
    pub radius_m: f64,
    /// Samples that the node covers.
    pub span: Span,
    /// First child; the children are consecutive. 0 for a leaf.
    pub first: u32,
    /// Number of children.
    pub children: u32,
    pub parent: u32,
}

/// Counts and sizes of a tree's nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStats {
    pub nodes: u64,
    /// Number of nodes without children.
    pub leaves: u64,
    /// Leaves of one cell whose slab is still thicker than the tolerance.
    pub over: u64,
    /// Nodes that use a level plane, because the best one is upright, or so steep that its slab is higher.
    pub upright: u64,
    /// Longest path from the root.
    pub depth: u32,
    /// Thickest slab of a leaf, metres.
    pub thickest_m: f64,
    /// Memory, bytes.
    pub bytes: u64,
}

/// Contours of a DEM.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourTree {
    /// The root first, children after their parent.
    pub nodes: Vec<Node>,
    /// Tolerance for the slabs, metres.
    pub tolerance_m: f64,
    /// Counts and bounds of its nodes.
    pub stats: TreeStats,
}

/// Intersections of the plane halfway between the contours with the four edges of its column, metres.
pub fn corners_m(column: &[HalfSpace; 4], contour: &Contour) -> [DVec3; 4] {
    let middle = 0.5 * (contour.low_m + contour.high_m);
    // Relative to the centroid, so that nothing large cancels.
    let moved = |half: HalfSpace| (half.0, half.1 - half.0.dot(contour.at_m));
    [(0, 2), (1, 2), (0, 3), (1, 3)].map(|(a, b)| {
        let ((a, da), (b, db)) = (moved(column[a]), moved(column[b]));
        let n = contour.normal;
        let determinant = n.dot(a.cross(b));
        let p = n.cross(a) * db + b.cross(n) * da + a.cross(b) * middle;
        // Parallel sides: a column without width, at a pole.
        if determinant.abs() > 1e-12 {
            contour.at_m + p / determinant
        } else {
            contour.at_m + n * middle
        }
    })
}
