//! Approximate contours and q-Bézier patches, after the paper of 2017. No GPU here.

mod cast;
mod dem;
mod denoise;
mod hermite;
mod joins;
mod patches;
mod plane;
pub mod qbernstein;
mod store;
mod surface;
mod tree;
mod wide;

#[cfg(test)]
mod patch_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tree_tests;

pub use cast::{Hit, Ray};
pub use dem::{Dem, DemError, Frame, Half, MOST_SAMPLES, Span, quarters};
pub use denoise::{Denoise, Denoised};
pub use hermite::{Corner, Net, cubic, evaluate, net, restrict};
pub use joins::{Joins, evaluate_q};
pub use patches::{DEGREE, Leaf, PatchError, PatchOptions, PatchTree, QPatch};
pub use plane::{Contour, Support, eigen, fit, fit_points};
pub use store::{Storage, StoreError, morton_leaves, source_hash};
pub use surface::{ContourOptions, ContourSurface};
pub use tree::{
    BudgetError, ContourTree, Node, TreeStats, corners_m, screen_error_px, world_error_m,
};
pub use wide::Wide;
