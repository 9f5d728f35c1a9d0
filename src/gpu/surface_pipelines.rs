//! The pipelines of the surface: made by any thread, without the surface that they are for.

use super::SurfaceOutput;
use super::maps::MapArrangement;
use super::mesh::MeshForm;
use super::shader::{
    EarthOutput, EarthVariant, PaperLayers, ShaderModule, ShaderVariant, ShadingVariant,
    SunlitLayers, TruthLayers,
};
use super::surface_config::SurfaceConfig;
use super::surface_view::SurfaceView;
use super::tiles::tiles_bytes;
use super::{PipelineDescription, ShaderError};
use crate::plan::{AirSide, FrameUniforms, LightEffect, LightEffects, SurfaceLightUniforms};
use terrella_ground::globe::Shading;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};

/// Makes pipelines for the surface that it comes from.
#[derive(Clone)]
pub(crate) struct SurfaceMaker {
    pub(super) mesh: MeshForm,
    pub(super) maps: [bool; MAP_LAYERS],
    pub(super) has_tiles: bool,
    /// Whether blocks with tiles may be cut into parts.
    pub(super) has_parts: bool,
}

/// What follows from a configuration.
pub(crate) struct SurfacePipelines {
    pub(super) maps: MapArrangement,
    /// One without air; else that of an eye outside of it, and that of an eye inside.
    pub(super) passes: Vec<SurfacePasses>,
    pub shader_bytes: u64,
}

/// How the surface is drawn from one side of the air.
pub(super) struct SurfacePasses {
    pub all: SurfacePass,
    /// Without what shows by night alone, if there is any: for blocks by day.
    pub daylit: Option<SurfacePass>,
    /// For frames that the Moon's shadow is in: made when the first of them comes.
    pub eclipsed: Option<SurfacePass>,
    /// What that is made of, if eclipses are drawn, and whether that was tried.
    pub eclipsed_variant: Option<EarthVariant>,
    is_eclipse_tried: bool,
    /// For cells by day that take the air's light from their vertices.
    pub interpolated: Option<SurfacePass>,
    /// For those of them where there is nothing but land, or nothing but open sea.
    pub land: Option<SurfacePass>,
    pub open_sea: Option<SurfacePass>,
}

pub(super) struct SurfacePass {
    pub variant: EarthVariant,
    pub pipeline: wgpu::RenderPipeline,
    /// Of group 0, which each view binds of its own.
    pub layout: wgpu::BindGroupLayout,
    shader_bytes: u64,
}

impl SurfacePipelines {
    /// Makes what frames with the Moon's shadow are drawn with from one side of the air, unless that was tried before.
    pub(super) fn make_eclipsed(
        &mut self,
        maker: &SurfaceMaker,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        side: usize,
    ) -> Result<(), ShaderError> {
        let Some(passes) = self.passes.get_mut(side) else {
            return Ok(());
        };
        if let Some(variant) = passes.eclipsed_variant
            && !std::mem::replace(&mut passes.is_eclipse_tried, true)
        {
            let pass = maker.pass(device, config, &self.maps, variant)?;
            self.shader_bytes += pass.shader_bytes;
            passes.eclipsed = Some(pass);
        }
        Ok(())
    }
}

impl SurfaceMaker {
    /// The same for the form of another view.
    pub fn for_view(&self, view: &SurfaceView) -> Self {
        Self {
            mesh: MeshForm::of(view.mesh(), self.has_tiles),
            ..self.clone()
        }
    }

    /// Makes what a configuration needs.
    pub fn make(
        &self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
    ) -> Result<SurfacePipelines, ShaderError> {
        let maps = MapArrangement::new(
            device,
            self.maps,
            config.shown,
            config.anisotropy,
            self.has_parts,
        );
        let sides = AirSide::of_air(config.air.is_some());
        let mut passes = Vec::with_capacity(sides.len());
        for &side in sides {
            let all = EarthVariant {
                form: self.mesh.vertex,
                output: output(&maps, config, side),
                parts: self.has_parts,
            };
            let pass = |variant| self.pass(device, config, &maps, variant);
            let eclipsed = all.eclipsed().filter(|_| config.light.eclipses);
            let interpolated = all.interpolated().filter(|_| config.interpolates_air);
            // Tiles show more than is known of whole maps.
            let of_one_kind = interpolated.filter(|_| !self.has_tiles);
            let (land, open_sea) = of_one_kind.and_then(EarthVariant::of_one_kind).unzip();
            passes.push(SurfacePasses {
                all: pass(all)?,
                daylit: all.daylit().map(pass).transpose()?,
                eclipsed: None,
                eclipsed_variant: eclipsed,
                is_eclipse_tried: false,
                interpolated: interpolated.map(pass).transpose()?,
                land: land.map(pass).transpose()?,
                open_sea: open_sea.map(pass).transpose()?,
            });
        }
        let drawn = passes.iter();
        let drawn = drawn.flat_map(|passes| {
            let others = passes.daylit.iter().chain(&passes.interpolated);
            let others = others.chain(&passes.land).chain(&passes.open_sea);
            std::iter::once(&passes.all).chain(others)
        });
        Ok(SurfacePipelines {
            shader_bytes: drawn.map(|pass| pass.shader_bytes).sum(),
            maps,
            passes,
        })
    }

    /// Makes what one variant of the shader is drawn with.
    fn pass(
        &self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        maps: &MapArrangement,
        variant: EarthVariant,
    ) -> Result<SurfacePass, ShaderError> {
        let shader = ShaderModule::new(device, &variant)?;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrella earth"),
            entries: &self.entries(config, &variant),
        });
        let pipeline = PipelineDescription {
            label: "terrella earth",
            bind_groups: Some(&[Some(&layout), Some(maps.layout())]),
            module: &shader.module,
            buffers: self.mesh.buffers,
            primitive: wgpu::PrimitiveState {
                front_face: wgpu::FrontFace::Ccw,
                cull_mode: Some(self.mesh.culled),
                polygon_mode: match config.wireframe {
                    false => wgpu::PolygonMode::Fill,
                    true => wgpu::PolygonMode::Line,
                },
                ..Default::default()
            },
            format: config.format,
            writes_depth: true,
            blend: None,
        }
        .create(device);
        Ok(SurfacePass {
            variant,
            pipeline,
            layout,
            shader_bytes: shader.bytes,
        })
    }

    /// Layout of group 0, in the order in which [`super::SurfaceDrawable::bind_view`] binds.
    fn entries(
        &self,
        config: &SurfaceConfig<'_>,
        variant: &EarthVariant,
    ) -> Vec<wgpu::BindGroupLayoutEntry> {
        let mut entries = vec![frame_entry()];
        if let Some((air, side)) = config.air.zip(variant.air()) {
            entries.extend(air.bindings(side).into_iter().map(|(entry, _)| entry));
            if config.shading == Shading::Sunlit {
                entries.push(air.sunlight_binding().0);
            }
        }
        entries.extend(self.has_tiles.then(|| tiles_entry(self.has_parts)));
        entries.extend(reads_light(variant).then(light_entry));
        entries.extend_from_slice(&self.mesh.entries);
        entries
    }
}

/// Layout of what a frame tells all shaders.
pub(super) fn frame_entry() -> wgpu::BindGroupLayoutEntry {
    let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
    super::uniform_entry(0, both, size_of::<FrameUniforms>())
}

/// Layout of where tiles lie.
pub(super) fn tiles_entry(has_parts: bool) -> wgpu::BindGroupLayoutEntry {
    super::uniform_entry(3, wgpu::ShaderStages::FRAGMENT, tiles_bytes(has_parts))
}

/// Layout of the surface's light.
pub(super) fn light_entry() -> wgpu::BindGroupLayoutEntry {
    let bytes = size_of::<SurfaceLightUniforms>();
    super::uniform_entry(12, wgpu::ShaderStages::VERTEX_FRAGMENT, bytes)
}

/// Whether a variant reads the surface's light.
pub(super) fn reads_light(variant: &EarthVariant) -> bool {
    variant.conditions_met().contains(&"surface_light")
}

/// What the pixels of a configuration get, the eye being on this side of the air.
fn output(maps: &MapArrangement, config: &SurfaceConfig<'_>, air: Option<AirSide>) -> EarthOutput {
    let clouds = maps.has(MapLayer::Clouds);
    let normals = maps.has(MapLayer::Normals);
    let effects = LightEffects::of(LightEffect::OF_SURFACE).and(config.light.effects());
    let shading = match config.shading {
        Shading::Paper => ShadingVariant::Paper(PaperLayers {
            clouds,
            normals,
            air,
        }),
        Shading::Sunlit => ShadingVariant::Sunlit(SunlitLayers {
            clouds,
            effects: match clouds {
                true => effects,
                false => effects.without(LightEffect::CloudShadows),
            },
            normals,
            night_lights: maps.has(MapLayer::NightLights),
            water: maps.has(MapLayer::Water),
            eclipse: false,
            interpolated: false,
            open_sea: false,
            air,
        }),
    };
    match config.output {
        SurfaceOutput::Color => EarthOutput::Picture(shading, config.format.target_color()),
        SurfaceOutput::Geolocation => EarthOutput::Geolocation,
        SurfaceOutput::Truth => EarthOutput::Truth(TruthLayers {
            clouds,
            normals,
            water: maps.has(MapLayer::Water),
        }),
    }
}
