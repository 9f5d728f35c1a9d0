//! Contours and rays over whole grids.

mod denoise;
pub mod ground;
mod trees;
