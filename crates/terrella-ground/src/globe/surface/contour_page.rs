//! Ground as pages of contours: small trees of planes that the GPU casts the ray of each pixel at.

use crate::globe::blocks::Block;
use glam::DVec3;

/// What all pages of a view have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourPageSet {
    /// Most pages that there will be, drawn or not.
    pub max_pages: u32,
    /// Angle of a pixel in the middle of the picture, radians.
    pub pixel_rad: f64,
    /// Radians of a ray's cone that a slab may fill and count as a leaf.
    pub cone: f64,
}

/// A page that is drawn.
#[derive(Clone, Copy, Debug)]
pub struct ContourPage<'a> {
    /// Its number, less than [`ContourPageSet::max_pages`]; it stays its own until another page takes it.
    pub slot: u32,
    /// Grows with each change of the nodes of its slot.
    pub revision: u64,
    /// The block that it lies in.
    pub block: Block,
    /// Where positions are measured from, ITRF metres.
    pub origin_itrf_m: DVec3,
    /// Its tree, as the shader reads it.
    pub nodes: &'a [u8],
    /// The prism that holds what is drawn: SW, SE, NW, NE below, then above, metres from the origin.
    pub corners_m: [DVec3; 8],
    /// Unit vectors east, north and up in its middle.
    pub axes: [DVec3; 3],
    /// How far its prism reaches down below its own ground, metres: to that of any neighbour.
    pub skirt_m: f64,
    /// How much wider its columns are for what rounding of the eye's place leaves, metres.
    pub slack_m: f64,
}
