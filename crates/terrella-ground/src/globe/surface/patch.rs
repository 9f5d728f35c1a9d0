//! Ground as triangles about local origins.

use crate::globe::blocks::Block;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A corner of a triangle of the ground.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GroundVertex {
    /// From the patch's origin, ITRF axes, metres.
    pub from_origin_m: Vec3,
    /// Height above the ellipsoid, metres.
    pub height_m: f32,
    /// Rise of the ground to the east and to the north, metres per metre.
    pub slope: Vec2,
}

/// Triangles over the vertices of a patch, counter-clockwise seen from above. Shared by all patches of one shape: who
/// keeps copies of them knows them by [`Arc::as_ptr`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangleList {
    /// Three numbers of vertices a triangle; triangles without area may be among them.
    pub triangles: Vec<u32>,
}

/// Ground about a local origin, so that single precision is enough for its vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// What it is known by from frame to frame, among the patches of its surface.
    pub key: u64,
    /// Grows by one with each change of what is below.
    pub revision: u64,
    /// Where vertices are measured from, ITRF metres.
    pub origin_itrf_m: DVec3,
    /// Vertices about the patch's origin.
    pub vertices: Vec<GroundVertex>,
    /// The vertices that differ from the revision before. Who has that one needs no others.
    pub changed: Vec<Range<u32>>,
    /// Indices of its triangles.
    pub indices: Arc<TriangleList>,
    /// The block that it lies in, where it lies in one alone.
    pub block: Option<Block>,
}

impl Patch {
    /// Whether there is nothing of it to draw.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty() || self.indices.triangles.is_empty()
    }
}
