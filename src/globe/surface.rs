//! What every surface with relief answers: patches of ground, ready for the GPU. No GPU here.

use super::blocks::Block;
use super::contours::PagesDraw;
use super::projected_grid::{Frame, HeightTiles};
pub use super::surface_stats::SurfaceStats;
use crate::elevation::Elevation;
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3, Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// Where the eye is and what it sees of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundView {
    /// The eye, ITRF metres.
    pub eye_itrf_m: DVec3,
    /// Takes eye-relative ITRF metres to clip space, z in 0…w.
    pub clip_from_eye: DMat4,
    /// Angle of a pixel in the middle of the picture, radians.
    pub pixel_rad: f64,
    /// Most pixels of the picture by which the drawn ground may differ from its data; 0 asks for all there is.
    pub tolerance_px: f64,
}

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
pub struct Indices {
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
    /// Its vertices.
    pub vertices: Vec<GroundVertex>,
    /// The vertices that differ from the revision before. Who has that one needs no others.
    pub changed: Vec<Range<u32>>,
    /// Its triangles.
    pub indices: Arc<Indices>,
    /// The block that it lies in, where it lies in one alone.
    pub block: Option<Block>,
}

/// A grid whose vertices the GPU makes itself, by `shaders/earth/vertex/projected_grid.wgsl`.
#[derive(Clone, Copy, Debug)]
pub struct GridDraw<'a> {
    /// The grid of the last view; `None` where nothing shows.
    pub frame: Option<&'a Frame>,
    /// Its heights. As many slots as ever.
    pub tiles: &'a HeightTiles,
    /// Its triangles over the numbers of grid points. The same in each frame, in the order of [`grid_parts`].
    ///
    /// [`grid_parts`]: super::projected_grid::grid_parts
    pub indices: &'a Indices,
}

/// In what form a surface hands over what is drawn.
#[derive(Clone, Copy, Debug)]
pub enum GroundForm<'a> {
    /// As patches of triangles: [`Surface::visit`].
    Patches,
    /// As a grid whose vertices the GPU makes.
    Grid(GridDraw<'a>),
    /// As pages of contours that the GPU casts rays at.
    Pages(PagesDraw<'a>),
}

/// A way to draw ground that has relief.
pub trait Surface: Send {
    /// As scene files name it.
    fn name(&self) -> &'static str;

    /// Chooses, and builds where needed, what the view needs. Allocates nothing in steady state, and never waits.
    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats;

    /// Hands over each patch of the last view, near ones first where that is known; none in another form.
    fn visit(&self, draw: &mut dyn FnMut(&Patch));

    /// Whether it has patches that lie in several blocks, to be drawn with the tiles of each of them. The same answer all its
    /// life.
    fn crosses_blocks(&self) -> bool {
        false
    }

    /// In what form it is drawn: the same variant all its life.
    fn form(&self) -> GroundForm<'_> {
        GroundForm::Patches
    }
}
