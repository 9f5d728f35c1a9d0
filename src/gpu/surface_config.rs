//! How the surface is drawn.

use super::{AirTextures, PassFormat, SurfaceOutput};
use crate::plan::SurfaceLightUniforms;
use terrella_ground::globe::{DrawKind, Shading};
use terrella_imagery::tile::MAP_LAYERS;

/// How the surface is drawn: what can change while the maps stay.
pub(crate) struct SurfaceConfig<'a> {
    pub shading: Shading,
    /// The chosen light on the surface.
    pub light: SurfaceLightUniforms,
    pub cloud_shadows: bool,
    pub moonlight: bool,
    pub eclipses: bool,
    pub detail: bool,
    /// Which maps are used, of those that there are.
    pub shown: [bool; MAP_LAYERS],
    pub output: SurfaceOutput,
    pub anisotropy: u16,
    pub format: PassFormat,
    /// The air, if there is any.
    pub air: Option<&'a AirTextures>,
    /// In what form ground with relief is drawn, if it is and not the block sphere. The variant does not change.
    pub ground: Option<DrawKind<'a>>,
    /// Whether that has triangles that lie in several blocks. Nor does that.
    #[cfg(feature = "terrain")]
    pub crosses_blocks: bool,
    /// Whether edges of triangles are drawn alone.
    pub wireframe: bool,
}
