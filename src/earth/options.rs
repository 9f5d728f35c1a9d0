//! What is fixed when an Earth is made, and what can be wrong with it.

use super::{DiagnosticOptions, GroundOptions, TileOptions};
use crate::air::Atmosphere;
use crate::globe::{Figure, Shading, Subdivision, SubdivisionError, Visibility};
use crate::gpu::{DepthBuffer, ShaderError};
use crate::imagery::tile::MapLayer;
use crate::imagery::{EarthLayers, ImageryError};

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
    /// The figure.
    pub figure: Figure,
    /// Cells per block edge.
    pub subdivision: Subdivision,
    /// Which blocks are drawn.
    pub visibility: Visibility,
    /// How they are shaded.
    pub shading: Shading,
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
    /// Format of the colour target.
    pub color_format: wgpu::TextureFormat,
    /// Sample count of the pass.
    pub samples: u32,
    /// Depth buffer of the pass.
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

/// What can be wrong with the options.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EarthError {
    /// Subdivision outside 1…48.
    #[error(transparent)]
    Subdivision(#[from] SubdivisionError),
    /// Settings of ground with relief.
    #[cfg(feature = "terrain")]
    #[error(transparent)]
    Surface(#[from] crate::globe::SurfaceError),
    /// Exposure below 0 or not finite.
    #[error("exposure is {0}; it must be a finite number, 0 or more")]
    Exposure(f32),
    /// A map is larger than the device takes.
    #[error(
        "the {layer} map is {width} × {height}; this device takes at most {limit} pixels a side"
    )]
    TooLarge {
        /// Which map.
        layer: &'static str,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A map does not hold what it says.
    #[error(transparent)]
    Layer(#[from] ImageryError),
    /// A shader file is at fault.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A source of tiles has a map that the Earth is not drawn with.
    #[error(
        "there are tiles of the {0} map but no whole map of it among the layers; add it or leave its tiles out"
    )]
    NoWholeMap(&'static str),
    /// Tiles are compressed and the device does not read them.
    #[error(
        "the tiles are BC-compressed and the device was opened without TEXTURE_COMPRESSION_BC; \
         open it with that feature, or have the tiles decoded (PackTiles::new with decode = true)"
    )]
    NoBc,
    /// Triangles' edges are wanted and the device does not draw lines.
    #[error(
        "edges of triangles are wanted and the device was opened without POLYGON_MODE_LINE; \
         open it with that feature, or on another adapter (terrella doctor lists them) if this one has it not"
    )]
    NoLines,
    /// Edges of triangles are wanted of ground that has none.
    #[error(
        "contours that rays are cast at have no triangles whose edges could be drawn; leave out the wireframe, or draw \
         contours as patches (drawn = \"patches\" under [earth.contours] in a scene)"
    )]
    NoEdges,
    /// The textures do not fit into the device's memory.
    #[error(
        "the device has no room for {mib} MiB of maps and tiles: {cause}; \
         give a smaller texture budget (texture_mb under [earth] in a scene)"
    )]
    NoRoom {
        /// What was asked for.
        mib: u64,
        /// The device's words.
        cause: String,
    },
    /// A shader or pipeline was refused by the device, for instance for a colour format it cannot draw to.
    #[error("the device refused the Earth's pipelines: {0}")]
    Refused(String),
}
