//! The quadtree of contours over a DEM of any size.

use super::dem::{HalfSpace, Span};
use super::plane::Contour;
use glam::DVec3;

/// A tree that would not fit into its budget.
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
    /// Its plane and slab. All samples of the span lie inside.
    pub contour: Contour,
    /// Nothing drawn below this node rises over this signed distance from its plane, metres.
    pub ceiling_m: f64,
    /// Farthest sample from the centroid, metres.
    pub radius_m: f64,
    /// Samples that the node covers.
    pub span: Span,
    /// First of its children, which follow each other; 0 for a leaf.
    pub first: u32,
    /// Number of children.
    pub children: u32,
    pub parent: u32,
}

/// Counts of a tree's nodes, and what they come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStats {
    pub nodes: u64,
    /// Of those without children.
    pub leaves: u64,
    /// Leaves of one cell whose slab is still thicker than the tolerance.
    pub over: u64,
    /// Nodes whose best plane stands upright, or so steep that its slab reaches higher, and that took a level one.
    pub upright: u64,
    /// Longest way from the root.
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
    /// What its slabs were compared with, metres.
    pub tolerance_m: f64,
    /// Counts and bounds of its nodes.
    pub stats: TreeStats,
}

/// Where the plane halfway between the contours meets the four edges of its column, metres.
pub fn corners_m(column: &[HalfSpace; 4], contour: &Contour) -> [DVec3; 4] {
    let middle = 0.5 * (contour.low_m + contour.high_m);
    // About the centroid, so that nothing large cancels.
    let moved = |half: HalfSpace| (half.0, half.1 - half.0.dot(contour.at_m));
    [(0, 2), (1, 2), (0, 3), (1, 3)].map(|(a, b)| {
        let ((a, da), (b, db)) = (moved(column[a]), moved(column[b]));
        let n = contour.normal;
        let determinant = n.dot(a.cross(b));
        let p = n.cross(a) * db + b.cross(n) * da + a.cross(b) * middle;
        // Sides that are parallel to each other: a column without width, at a pole.
        if determinant.abs() > 1e-12 {
            contour.at_m + p / determinant
        } else {
            contour.at_m + n * middle
        }
    })
}
