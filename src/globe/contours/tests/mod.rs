//! Contours, rays and patches over whole grids.

pub mod ground;
mod patches;
mod trees;
