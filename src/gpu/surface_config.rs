//! How the surface is drawn.

use super::{AirTextures, PassFormat, SurfaceOutput};
use crate::plan::{SurfaceLight, SurfaceLightUniforms};
use terrella_ground::globe::{DrawKind, Shading};
use terrella_imagery::tile::MAP_LAYERS;

/// How the surface is drawn: what can change while the maps stay.
pub(crate) struct SurfaceConfig<'a> {
    pub shading: Shading,
    /// The chosen light on the surface.
    pub light: SurfaceLight,
    /// Which maps are used, of those that there are.
    pub shown: [bool; MAP_LAYERS],
    pub output: SurfaceOutput,
    pub anisotropy: u16,
    pub format: PassFormat,
    /// The air, if there is any.
    pub air: Option<&'a AirTextures>,
    /// In what form terrain is drawn, if it is and not the block sphere. The variant does not change.
    pub ground: Option<DrawKind<'a>>,
    /// Whether that has triangles that lie in several blocks. Nor does that.
    #[cfg(feature = "terrain")]
    pub crosses_blocks: bool,
    /// Whether the air's light is taken from vertices where that suffices.
    pub interpolates_air: bool,
    /// Whether city lights are points where the block sphere is drawn with whole maps, in place of their map.
    pub city_lights: bool,
    /// Whether edges of triangles are drawn alone.
    pub wireframe: bool,
}

impl SurfaceConfig<'_> {
    /// The chosen light as shaders read it.
    pub fn light_uniforms(&self) -> SurfaceLightUniforms {
        let mut light = self.light.uniforms();
        if self.output == SurfaceOutput::Truth && self.shading == Shading::Paper {
            // As the paper draws them: slopes as they are stored, clouds on the ground, but for a hair's breadth, as a ray along
            // the ground would go through their layer nowhere.
            (light.slope_gain, light.cloud_height) = (1.0, 1e-9);
        }
        light
    }
}
