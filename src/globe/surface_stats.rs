//! Numbers of a surface with relief.

/// Tiles of heights that are streamed; all zero of heights that are in memory as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeightTileStats {
    /// Tiles in memory.
    pub tiles: u32,
    /// Bytes of all heights in memory, the coarsest level's among them.
    pub bytes: u64,
    /// Tiles that are asked for and on their way.
    pub wanted: u32,
    /// Tiles that are asked for and that the budget has no room for: the ground stays coarser there.
    pub refused: u32,
    /// Tiles that were asked for and could not be read.
    pub unreadable: u32,
    /// How often a tile has come or gone since the start.
    pub changes: u64,
}

/// What a surface did for a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceStats {
    /// Patches to draw.
    pub patches: u32,
    /// Vertices of those.
    pub vertices: u32,
    /// Triangles of those, those without area included.
    pub triangles: u32,
    /// Places whose height was read anew.
    pub samples_read: u64,
    /// Bytes of vertices, indices, trees and tables held in memory.
    pub resident_bytes: u64,
    /// Largest vertical distance between what is drawn and the data, metres, where the surface knows a bound.
    pub error_m: Option<f64>,
    /// The same in pixels.
    pub error_px: Option<f64>,
}
