//! What is fixed when an Earth is made.

use super::{DiagnosticOptions, EarthError, GroundOptions, Quality, TileOptions};
use crate::air::Atmosphere;
use crate::globe::{Figure, Shading, Subdivision, Visibility};
use crate::gpu::DepthBuffer;
use crate::imagery::EarthLayers;
use crate::imagery::tile::MapLayer;

/// What is fixed when an Earth is made.
#[derive(Clone, Debug)]
pub struct EarthOptions {
    /// The maps. A layer that is `None` costs nothing.
    pub layers: EarthLayers,
    /// Tiles of a pack, drawn in place of the whole maps of the same layers as they arrive; `None` draws whole maps
    /// only and costs nothing. `layers` must be the pack's coarsest maps, `subdivision` automatic or at least [`super::TILED_SUBDIVISION`] if
    /// nothing is to be seen of block edges at grazing views.
    pub tiles: Option<TileOptions>,
    /// Ground with relief; `None` draws the smooth ellipsoid and costs nothing.
    pub ground: Option<GroundOptions>,
    /// Figure of the Earth: WGS84 or the paper's sphere.
    pub figure: Figure,
    /// Cells per block edge; by default as many as the limb needs in each picture.
    pub subdivision: Subdivision,
    /// The rule by which blocks are culled.
    pub visibility: Visibility,
    /// The light on the ground: real sunlight, or as printed in the paper.
    pub shading: Shading,
    /// The air, or none of it.
    pub atmosphere: Atmosphere,
    /// Texture format of the host's colour target.
    pub color_format: wgpu::TextureFormat,
    /// Samples a pixel of the host's pass.
    pub samples: u32,
    /// Depth buffer of the host's pass.
    pub depth: DepthBuffer,
    /// Most samples that a map is filtered with at a grazing view, 1…16; 1 is trilinear. A software adapter always
    /// filters trilinearly: each sample costs it time, and Mesa's returns wrong texels at the limb.
    pub anisotropy: u16,
    /// What a white sheet that faces the Sun in space is drawn with, 0 or more; the target's white is 1. The paper's shading
    /// works in display values and is not touched by it, the air is.
    pub exposure: f32,
    /// What is drawn for measuring and for looking at meshes, in place of pictures.
    pub diagnostics: DiagnosticOptions,
}

impl EarthOptions {
    /// The defaults for a picture of [`crate::gpu::FrameTargets`] with these maps.
    pub fn new(layers: EarthLayers) -> Self {
        Self {
            layers,
            tiles: None,
            ground: None,
            figure: Figure::default(),
            subdivision: Subdivision::default(),
            visibility: Visibility::default(),
            shading: Shading::default(),
            atmosphere: Atmosphere::default(),
            color_format: crate::gpu::FrameTargets::COLOR,
            samples: 1,
            depth: crate::gpu::FrameTargets::REVERSED_DEPTH,
            anisotropy: 8,
            exposure: 1.4,
            diagnostics: DiagnosticOptions::default(),
        }
    }

    /// Whether this device can draw an Earth with these options, as far as that can be said before anything is made.
    pub(super) fn check(&self, device: &wgpu::Device) -> Result<(), EarthError> {
        if !(self.exposure.is_finite() && self.exposure >= 0.0) {
            return Err(EarthError::Exposure(self.exposure));
        }
        let lines = wgpu::Features::POLYGON_MODE_LINE;
        if self.diagnostics.wireframe && !device.features().contains(lines) {
            return Err(EarthError::NoLines);
        }
        let limit = device.limits().max_texture_dimension_2d;
        for layer in MapLayer::ALL {
            let Some(image) = self.layers.get(layer) else {
                continue;
            };
            image.check()?;
            let (width, height) = (image.width, image.height);
            if width.max(height) > limit {
                return Err(EarthError::TooLarge {
                    layer: layer.name(),
                    width,
                    height,
                    limit,
                });
            }
        }
        match &self.tiles {
            Some(tiles) if !tiles.can_be_read_by(device) => Err(EarthError::NoBc),
            _ => Ok(()),
        }
    }
}

impl Quality {
    /// The quality of an Earth that is made with these options.
    pub fn of(options: &EarthOptions) -> Self {
        Self {
            subdivision: options.subdivision,
            anisotropy: options.anisotropy,
            samples: options.samples,
            texel_px: options.tiles.as_ref().map_or(1.0, TileOptions::texel_px),
            maps: MapLayer::ALL.map(|layer| options.layers.get(layer).is_some()),
            atmosphere: options.atmosphere,
        }
    }
}
