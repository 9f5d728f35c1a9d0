//! Approximate contours and q-Bézier patches, after the paper of 2017. No GPU here.

mod cast;
mod dem;
mod plane;
pub mod qbernstein;
mod tree;
mod wide;

pub use cast::{Hit, Ray};
pub use dem::{Dem, DemError, Frame, Half, MOST_SAMPLES, Span};
pub use plane::{Contour, Support, eigen, fit, fit_points};
pub use tree::{
    BudgetError, ContourTree, Node, TreeStats, corners_m, screen_error_px, world_error_m,
};
pub use wide::Wide;

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tree_tests;
