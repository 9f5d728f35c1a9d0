//! How the surface is drawn.

use super::{GpuLayer, PassFormat, SurfaceOutput};
use crate::globe::{DrawKind, Shading};
use crate::imagery::tile::MAP_LAYERS;

/// How the surface is drawn: what can change while the maps stay.
pub(crate) struct SurfaceConfig<'a> {
    pub shading: Shading,
    /// Which maps are used, of those that there are.
    pub shown: [bool; MAP_LAYERS],
    pub output: SurfaceOutput,
    pub anisotropy: u16,
    pub format: PassFormat,
    /// The air's sunlight table, if there is air and the shading uses it.
    pub sunlight: Option<&'a GpuLayer>,
    /// In what form ground with relief is drawn, if it is and not the block sphere. The variant does not change.
    pub ground: Option<DrawKind<'a>>,
    /// Whether that has triangles that lie in several blocks. Nor does that.
    pub crosses_blocks: bool,
    /// Whether edges of triangles are drawn alone.
    pub wireframe: bool,
}
