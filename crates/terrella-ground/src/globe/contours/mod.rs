//! Approximate contours, and bicubic patches, after the paper of 2017. No GPU here.
//!
//! *Contours* (`ContourTree`) describe a DEM by a quadtree. Each node holds the best-fit plane of its samples and two parallel planes that
//! enclose them; a node whose slab is thin enough is a leaf. Contours are drawn by casting rays, on the GPU as in [`contour_cast`].
//! *Patches* are drawn without contours. They are bicubic, in Hermite form, and share one height and one tangent plane across every edge
//! and any difference of levels. The paper's q-Bézier form of them is measured by `measure::terrain`: q changes the control values of a
//! patch and not the surface.
//!
//! Two surfaces draw the whole Earth, chosen by the view. [`ContourSurface`] draws such patches as triangles. [`ContourPages`] draws small
//! trees of contours at which the GPU casts the ray of each pixel.
//! Trees and patches over one grid of any size are measured by `measure::terrain`.
//!
//! Everything is f64 about a local origin.

pub mod build;
pub mod cast;
pub mod dem;
mod gpu_layout;
pub mod hermite;
mod pages;
pub mod plane;
mod surface;
#[cfg(test)]
pub(crate) mod tests;
pub mod tree;

pub use gpu_layout::STACK;
pub use gpu_layout::{ContourNode, ContourRay, contour_cast};
pub use pages::{ContourPages, DrawnPage, MAX_NODES, Page, PageOptions, PagesDraw};
pub use surface::{ContourOptions, ContourSurface};
