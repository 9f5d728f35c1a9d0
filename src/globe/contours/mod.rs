//! Approximate contours and q-Bézier patches, after the paper of 2017. No GPU here.
//!
//! Two descriptions of one DEM. *Contours* ([`ContourTree`]): a quadtree whose every node holds the best-fit plane of its
//! samples and two planes parallel to it that hold them between them; a node whose slab is thin enough is a leaf. They
//! are drawn by casting rays ([`ContourTree::cast`], or as a flat buffer, [`cast_flat`] and `shaders/common/contours.wgsl`).
//! *Patches* ([`PatchTree`]): bicubic q-Bézier patches within a tolerance of the samples that join with one height and
//! one tangent plane across every edge and any difference of levels.
//!
//! Both draw the whole Earth, chosen by the view: [`ContourSurface`] such patches as triangles, [`ContourPages`] small trees of
//! contours at which the GPU casts the ray of each pixel.
//!
//! Everything is f64 about a local origin. [`Denoise`] takes out single wrong heights first, if asked.

mod build;
mod cast;
mod dem;
mod denoise;
mod flat;
mod hermite;
mod joins;
mod keep;
mod pages;
mod patches;
mod plane;
pub mod qbernstein;
mod store;
mod surface;
mod threads;
mod tree;
mod wide;

#[cfg(test)]
mod tests;

pub use crate::elevation::{Denoise, Denoised};
pub use cast::{Hit, Ray};
pub use dem::{Dem, DemError, Frame, Half, MOST_SAMPLES, Span, quarters};
pub use flat::{FlatNode, FlatRay, STACK, cast_flat, pack_slope, unpack_normal};
pub use hermite::{Corner, Net, cubic, evaluate, net, restrict};
pub use joins::{Joins, evaluate_q};
pub use pages::{ContourPages, DrawnPage, MOST_NODES, Page, PageOptions, PagesDraw, slack_m};
pub use patches::{DEGREE, Leaf, PatchError, PatchOptions, PatchTree, QPatch};
pub use plane::{Contour, Support, eigen, fit, fit_points};
pub use store::{Storage, StoreError, morton_leaves};
pub use surface::{ContourOptions, ContourSurface};
pub use tree::{
    BudgetError, ContourTree, Node, TreeStats, corners_m, screen_error_px, world_error_m,
};
pub use wide::Wide;
