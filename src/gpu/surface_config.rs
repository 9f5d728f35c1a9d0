//! Configuration of the surface.

use super::{AirTextures, PassFormat, SurfaceOutput};
use crate::plan::{SurfaceLight, SurfaceLightUniforms};
use terrella_ground::globe::{DrawKind, Shading};
use terrella_imagery::tile::MAP_LAYERS;

/// Configuration of the surface: everything that can change while the maps stay.
pub(crate) struct SurfaceConfig<'a> {
    pub shading: Shading,
    /// Options of the light on the surface.
    pub light: SurfaceLight,
    /// Which of the existing maps are used.
    pub shown: [bool; MAP_LAYERS],
    pub output: SurfaceOutput,
    pub anisotropy: u16,
    pub format: PassFormat,
    /// The air, if there is any.
    pub air: Option<&'a AirTextures>,
    /// How terrain is drawn, if it replaces the block sphere. The variant does not change.
    pub ground: Option<DrawKind<'a>>,
    /// Whether its triangles span several blocks. This does not change either.
    #[cfg(feature = "terrain")]
    pub crosses_blocks: bool,
    /// Whether the air's light is interpolated between vertices where that suffices.
    pub interpolates_air: bool,
    /// Whether frames are drawn without the pipelines that only make them faster, until these are created.
    pub is_gradual: bool,
    /// Whether frames are drawn without the scales of synthetic detail that they cannot show, with pipelines of their own.
    pub leaves_out_scales: bool,
    /// Whether city lights are points instead of a map where the block sphere is drawn with whole maps.
    pub city_lights: bool,
    /// Whether only edges of triangles are drawn.
    pub wireframe: bool,
}

impl SurfaceConfig<'_> {
    /// Uniforms of the surface's light.
    pub fn light_uniforms(&self) -> SurfaceLightUniforms {
        let mut light = self.light.uniforms();
        if self.output == SurfaceOutput::Truth && self.shading == Shading::Paper {
            // As in the paper: slopes as stored, and clouds on the ground. They are raised by a tiny amount, as a ray along the ground would never
            // cross their layer otherwise.
            (light.slope_gain, light.cloud_height) = (1.0, 1e-9);
        }
        light
    }
}
