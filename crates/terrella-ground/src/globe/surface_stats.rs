//! Numbers of a surface with relief.

/// What a surface did for a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceStats {
    /// Patches to draw.
    pub patches: u32,
    /// Vertices of those.
    pub vertices: u32,
    /// Triangles of those, those without area included.
    pub triangles: u32,
    /// Places whose height was read again.
    pub samples_read: u64,
    /// Bytes of vertices, indices, trees and tables held in memory.
    pub resident_bytes: u64,
    /// Largest vertical distance between what is drawn and the data, metres, where the surface knows a bound.
    pub error_m: Option<f64>,
    /// The same in pixels.
    pub error_px: Option<f64>,
}
