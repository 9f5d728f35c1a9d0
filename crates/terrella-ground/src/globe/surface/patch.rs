//! Terrain as triangles about local origins.

use crate::globe::blocks::Block;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A vertex of the terrain's triangles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GroundVertex {
    /// Offset from the patch's origin, ITRF axes, metres.
    pub from_origin_m: Vec3,
    /// Height above the ellipsoid, metres.
    pub height_m: f32,
    /// Rise of the ground to the east and to the north, metres per metre.
    pub slope: Vec2,
}

/// Triangles over the vertices of a patch, counter-clockwise seen from above. All patches of one shape share a list; holders of copies
/// identify it by [`Arc::as_ptr`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangleList {
    /// Three vertex indices a triangle; triangles without area may be among them.
    pub triangles: Vec<u32>,
}

/// Terrain about a local origin, so that single precision is enough for its vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Key that identifies the patch from frame to frame, unique in its surface.
    pub key: u64,
    /// Increases by one with each change of the fields below.
    pub revision: u64,
    /// Origin of the vertices, ITRF metres.
    pub origin_itrf_m: DVec3,
    /// Vertices about the patch's origin.
    pub vertices: Vec<GroundVertex>,
    /// Vertices that differ from the previous revision. A holder of that revision needs no others.
    pub changed: Vec<Range<u32>>,
    /// Indices of the triangles.
    pub indices: Arc<TriangleList>,
    /// The block that contains the patch, if a single one does.
    pub block: Option<Block>,
}

impl Patch {
    /// Whether the patch has nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty() || self.indices.triangles.is_empty()
    }
}
