//! Statistics of a terrain surface.

/// Counts and errors of a surface for a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceStats {
    /// Patches to draw.
    pub patches: u32,
    /// Vertices of the patches.
    pub vertices: u32,
    /// Triangles of the patches, including those without area.
    pub triangles: u32,
    /// Height samples read for this view.
    pub samples_read: u64,
    /// Bytes of vertices, indices, trees and tables held in memory.
    pub resident_bytes: u64,
    /// Largest vertical distance between drawn terrain and the data, metres, if the surface has a bound for it.
    pub error_m: Option<f64>,
    /// The same in pixels.
    pub error_px: Option<f64>,
}
