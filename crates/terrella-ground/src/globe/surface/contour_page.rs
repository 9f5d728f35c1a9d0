//! Terrain as pages of contours: small trees of planes at which the GPU casts the ray of each pixel.

use crate::globe::blocks::Block;
use glam::DVec3;

/// Data that all pages of a view share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourPageSet {
    /// Largest number of pages, drawn or not.
    pub max_pages: u32,
    /// Angle of a pixel in the middle of the image, radians.
    pub pixel_rad: f64,
    /// A slab that fills at most this angle of a ray's cone, radians, counts as a leaf.
    pub cone: f64,
}

/// A page that is drawn.
#[derive(Clone, Copy, Debug)]
pub struct ContourPage<'a> {
    /// Slot number, less than [`ContourPageSet::max_pages`]. The page keeps it until another page takes the slot.
    pub slot: u32,
    /// Increases with each change of the slot's nodes.
    pub revision: u64,
    /// The block that contains the page.
    pub block: Block,
    /// Origin of positions, ITRF metres.
    pub origin_itrf_m: DVec3,
    /// The page's tree, in the shader's layout.
    pub nodes: &'a [u8],
    /// The prism that contains the drawn terrain: SW, SE, NW, NE below, then above, metres from the origin.
    pub corners_m: [DVec3; 8],
    /// Unit vectors east, north and up at the page's centre.
    pub axes: [DVec3; 3],
    /// How far the prism extends below the page's own ground, metres: down to the ground of any neighbour.
    pub skirt_m: f64,
    /// Extra width of the page's columns, metres, that covers rounding of the eye's position.
    pub slack_m: f64,
}
