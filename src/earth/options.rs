//! Options that are fixed when an Earth is made.

use super::{
    Appearance, DiagnosticOptions, EarthError, GroundOptions, Quality, SurfaceLight, TileOptions,
};
use crate::gpu::{
    DepthBuffer, Development, MapError, MapUploader, PassFormat, SurfaceOutput, TargetColor,
    UploadedMaps, check_size, stores_light,
};
use std::sync::Arc;
use terrella_ground::air::{AirOptions, Atmosphere};
use terrella_ground::globe::{Figure, Shading, Subdivision, Visibility};
use terrella_ground::light::{Bloom, Exposure, Grade, Tone};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{CityLights, EarthLayers, GroundKinds, MapAlbedo, MapGroundKinds};

/// Options that are fixed when an Earth is made.
#[derive(Clone, Debug)]
pub struct EarthOptions {
    /// The maps. A layer that is `None` has no cost.
    pub layers: EarthLayers,
    /// Maps that are already on the GPU. They replace those of `layers` that have no texels ([`Self::upload`]). Earths made with clones of these
    /// options share them.
    pub uploaded: UploadedMaps,
    /// Tiles of a pack, drawn in place of the whole maps of the same layers as they arrive; `None` draws whole maps only and costs nothing.
    /// `layers` must be the pack's coarsest maps. `subdivision` must be automatic or at least [`super::TILED_SUBDIVISION`], or block edges may be
    /// visible at grazing views.
    pub tiles: Option<TileOptions>,
    /// City lights as points: [`CityLights::load`]. They replace the map of night lights where [`SurfaceLight::detail`] is on and the block sphere
    /// is drawn with whole maps. `None` draws the map and costs nothing. With [`Pipelines::WhenNeeded`] their pipeline is made when a view first
    /// has dark places.
    pub city_lights: Option<Arc<CityLights>>,
    /// Terrain; `None` draws the smooth ellipsoid at no cost.
    pub ground: Option<GroundOptions>,
    /// Figure of the Earth: WGS84 or the paper's sphere.
    pub figure: Figure,
    /// Cells per block edge; by default as many as the limb needs in each frame.
    pub subdivision: Subdivision,
    /// How blocks are culled.
    pub visibility: Visibility,
    /// Shading of the ground: physical sunlight, or as printed in the paper.
    pub shading: Shading,
    /// Options of the light on the surface.
    pub light: SurfaceLight,
    /// The atmosphere, or none.
    pub atmosphere: Atmosphere,
    /// Contents of the atmosphere.
    pub air: AirOptions,
    /// Texture format of the host's colour target.
    ///
    /// A float format (`Rgba16Float`, `Rgba32Float`, `Rg11b10Ufloat`) gets scene-referred linear light: a diffuse white sheet that faces the Sun in
    /// space is 1. Neither `exposure` nor `tone` is applied; both are then the host's task. All other formats get displayable colour: exposed,
    /// tone-mapped, and dithered for 8 bits. It is linear for sRGB formats, which the hardware encodes, and sRGB-encoded otherwise. On these
    /// formats the air beside the ground is blended over existing pixels in displayed values. The paper's shading and tracks are display values on
    /// 8-bit targets and the same values in linear light on others. With [`Development::AfterPass`] the format is a float format and gets light
    /// multiplied by the exposure.
    pub color_format: wgpu::TextureFormat,
    /// Samples a pixel of the host's pass.
    pub samples: u32,
    /// Depth buffer of the host's pass.
    pub depth: DepthBuffer,
    /// Largest number of samples for filtering a map at a grazing view, 1…16; 1 is trilinear. A software adapter always filters trilinearly: each
    /// sample costs it time, and Mesa's returns wrong texels at the limb. The default of 8 is therefore not measured by the pages in `docs/`, which
    /// use software adapters; `terrella bench` measures it on others.
    pub anisotropy: u16,
    /// Exposure. The paper's shading uses display values, which it does not affect; it does affect the atmosphere.
    pub exposure: Exposure,
    /// Where exposed light is developed for display: in the host's pass, or after it by a [`crate::Developer`] with the same `tone`.
    pub development: Development,
    /// Tone curve of exposed light. A measured response needs [`Development::AfterPass`].
    pub tone: Tone,
    /// Bloom of light that is developed after the pass.
    pub bloom: Bloom,
    /// White balance and grain. Either needs [`Development::AfterPass`].
    pub grade: Grade,
    /// When pipelines are created.
    pub pipelines: Pipelines,
    /// Diagnostic output for measurements and for inspecting meshes.
    pub diagnostics: DiagnosticOptions,
}

/// When an Earth creates its pipelines: about ten, of which an image needs two or three.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pipelines {
    /// At creation: no frame waits for a pipeline.
    #[default]
    AtOnce,
    /// When a frame first needs them, in [`Earth::prepare`](super::Earth::prepare), for programs that render few images.
    /// [`Earth::check_pipelines`](super::Earth::check_pipelines) returns their errors.
    WhenNeeded,
    /// As [`Pipelines::WhenNeeded`], but a frame does not wait for those that only make it faster: it is drawn without them until
    /// [`Earth::make_next_pipeline`](super::Earth::make_next_pipeline) creates them. For devices that compile in the thread that draws, like WebGL2.
    Gradually,
}

impl EarthOptions {
    /// Defaults for an image of [`crate::gpu::FrameTargets`] with these maps.
    pub fn new(layers: EarthLayers) -> Self {
        Self {
            layers,
            uploaded: UploadedMaps::default(),
            tiles: None,
            city_lights: None,
            ground: None,
            figure: Figure::default(),
            subdivision: Subdivision::default(),
            visibility: Visibility::default(),
            shading: Shading::default(),
            light: SurfaceLight::default(),
            atmosphere: Atmosphere::default(),
            air: AirOptions::default(),
            color_format: crate::gpu::FrameTargets::COLOR,
            samples: 1,
            depth: crate::gpu::FrameTargets::REVERSED_DEPTH,
            anisotropy: 8,
            exposure: Exposure::default(),
            development: Development::default(),
            tone: Tone::default(),
            bloom: Bloom::default(),
            grade: Grade::NONE,
            pipelines: Pipelines::default(),
            diagnostics: DiagnosticOptions::default(),
        }
    }

    /// Accumulates light in the pass and develops it after it, if the shading is physical. The paper's shading, in display values, is drawn to the
    /// `shown` format directly. For passes of a [`crate::ScaledTarget::of_pass`].
    pub fn develop_after_pass(&mut self, shown: wgpu::TextureFormat) {
        (self.development, self.color_format) = match self.shading {
            Shading::Sunlit => (Development::AfterPass, crate::gpu::ScaledTarget::LIGHT),
            Shading::Paper => (Development::InPass, shown),
        };
    }

    /// Format of the pass that the Earth is drawn in.
    pub fn pass_format(&self) -> PassFormat {
        PassFormat {
            color: self.color_format,
            further: self.diagnostics.output.further_targets(),
            samples: self.samples,
            depth: self.depth,
            development: self.development,
            tone: self.tone,
            bloom: self.bloom,
            grade: self.grade,
        }
    }

    /// Uploads the maps and frees their texels: `layers` then holds descriptions only
    /// ([`without_texels`](terrella_imagery::LayerImage::without_texels)), and `uploaded` the maps. For programs that make several Earths from one
    /// set of maps, or that keep their options: all later clones, and all Earths on this device, share one copy on the GPU and keep none in memory.
    /// Earlier clones keep their copies.
    ///
    /// # Errors
    /// The first map whose texels do not fit its description, or that the device rejects; maps before it are uploaded.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(), MapError> {
        for layer in MapLayer::ALL {
            let image = self.layers.get_mut(layer);
            let Some(image) = image.filter(|image| image.has_texels()) else {
                continue;
            };
            image.check()?;
            check_size(device, layer, image)?;
            let uploader = MapUploader::new(device, queue, self.shading);
            let described = image.clone().given_to(&uploader, layer);
            self.uploaded.add(uploader.finish()?);
            *image = described;
        }
        Ok(())
    }

    /// Replaces maps by others that are on the GPU: `layers` describes them without their texels.
    pub fn replace_uploaded(&mut self, layers: EarthLayers, maps: UploadedMaps) {
        self.layers.replace(layers);
        self.uploaded.add(maps);
    }

    /// The map's contribution to the light of the air.
    pub(crate) fn map_albedo(&self, layer: MapLayer) -> Option<MapAlbedo> {
        let image = self.layers.get(layer)?;
        match image.has_texels() {
            true => MapAlbedo::of(layer, image),
            false => Some(self.uploaded.get(layer)?.albedo.as_deref()?.clone()),
        }
    }

    /// Kinds of the ground cells according to one map.
    pub(crate) fn map_kinds(&self, layer: MapLayer) -> Option<Arc<MapGroundKinds>> {
        let image = self.layers.get(layer)?;
        match image.has_texels() {
            true => MapGroundKinds::of(layer, image).map(Arc::new),
            false => self.uploaded.get(layer)?.kinds.clone(),
        }
    }

    /// Cells that have only land or only open sea according to its maps. `None` with tiles or terrain, or if the air's light is not interpolated.
    pub(crate) fn ground_kinds(&self) -> Option<Arc<GroundKinds>> {
        let is_used = self.interpolates_air()
            && self.atmosphere == Atmosphere::Billboard
            && self.tiles.is_none()
            && self.ground.is_none();
        let kinds = || {
            let water = self.map_kinds(MapLayer::Water)?;
            let day = self.map_kinds(MapLayer::Day)?;
            Some(Arc::new(GroundKinds::of_parts(&water, &day)))
        };
        is_used.then(kinds).flatten()
    }

    /// The part of the options that can be changed while the Earth is drawn, besides quality and maps.
    pub fn appearance(&self) -> Appearance {
        Appearance {
            ground: self.ground.clone(),
            light: self.light,
            air: self.air,
        }
    }

    /// Whether the air's light may be interpolated between vertices, and sunlight left out in deep night, where the difference is invisible: in
    /// displayed images with physical light.
    pub(crate) fn interpolates_air(&self) -> bool {
        let diagnostics = self.diagnostics;
        self.shading == Shading::Sunlit
            && diagnostics.output == SurfaceOutput::Color
            && !diagnostics.per_pixel_air
            && self.pass_format().target_color() != TargetColor::Radiance
    }

    /// Checks that this device can draw an Earth with these options, as far as possible before anything is created.
    pub(crate) fn check(&self, device: &wgpu::Device) -> Result<(), EarthError> {
        self.exposure.check().map_err(EarthError::Exposure)?;
        self.appearance().check()?;
        if !(1..=16).contains(&self.anisotropy) {
            return Err(EarthError::Anisotropy(self.anisotropy));
        }
        let lines = wgpu::Features::POLYGON_MODE_LINE;
        if self.diagnostics.wireframe && !device.features().contains(lines) {
            return Err(EarthError::NoLines);
        }
        let is_truth = self.diagnostics.output == SurfaceOutput::Truth;
        if is_truth && (self.color_format, self.samples) != (SurfaceOutput::TRUTH[0], 1) {
            return Err(EarthError::TruthTarget {
                format: self.color_format,
                samples: self.samples,
            });
        }
        let is_developed = self.development == Development::AfterPass;
        if is_developed && !(stores_light(self.color_format) && self.shading == Shading::Sunlit) {
            return Err(EarthError::Development {
                format: self.color_format,
                shading: self.shading,
            });
        }
        // In passes that store light the tone curve is the host's.
        let is_shown = !stores_light(self.color_format);
        if let Some(response) = self.tone.response().filter(|_| is_shown) {
            return Err(EarthError::Response(response.name()));
        }
        if let Some((name, value, [low, high])) = self.grade.fault() {
            return Err(EarthError::Grade {
                name,
                value,
                low,
                high,
            });
        }
        if is_shown && (self.grade.white_balance.is_some() || self.grade.grain.strength > 0.0) {
            return Err(EarthError::GradeInPass);
        }
        if !Bloom::STRENGTH.contains(&self.bloom.strength) {
            return Err(EarthError::Bloom(self.bloom.strength));
        }
        let limit = device.limits().max_texture_dimension_2d;
        for layer in MapLayer::ALL {
            let Some(image) = self.layers.get(layer) else {
                continue;
            };
            match self.uploaded.fitting(layer, image, (device, self.shading)) {
                Some(uploaded) => {
                    uploaded?;
                    continue;
                }
                None => image.check()?,
            }
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
            scale: 1.0,
        }
    }
}
