//! The pipelines of the surface: created on any thread, without access to the surface.

use super::SurfaceOutput;
use super::city_lights::CityPoints;
use super::detail_tiles::DetailTiles;
use super::maps::MapArrangement;
use super::mesh::MeshForm;
use super::pass_kind::PassKind;
use super::shader::{
    EarthOutput, EarthVariant, PaperLayers, ShaderModule, ShaderVariant, ShadingVariant,
    SunlitLayers, TruthLayers, VertexForm,
};
use super::situation::Situation;
use super::surface_config::SurfaceConfig;
use super::surface_view::SurfaceView;
use super::tiles::tiles_bytes;
use super::{ErrorScope, PipelineDescription, ShaderError};
use crate::plan::{
    AirSide, DetailScales, DrawLight, FramePlan, FrameUniforms, LightEffect, LightEffects,
    SurfaceLightUniforms,
};
use terrella_files::parallel;
use terrella_ground::globe::Shading;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};

/// Creates pipelines for one surface.
#[derive(Clone)]
pub(crate) struct SurfaceMaker {
    pub(super) mesh: MeshForm,
    pub(super) maps: [bool; MAP_LAYERS],
    pub(super) has_tiles: bool,
    /// Whether blocks with tiles may be cut into parts.
    pub(super) has_parts: bool,
}

/// The pipelines of a configuration, created on first use or all at once.
pub(crate) struct SurfacePipelines {
    pub(super) maps: MapArrangement,
    /// By side of the air — one without air; otherwise one for an eye outside it and one for an eye inside — and by [`DetailScales`].
    sides: Vec<[SurfacePasses; DetailScales::ALL.len()]>,
    /// Whether frames leave out scales of detail.
    leaves_out_scales: bool,
    /// Whether kinds that only save time are replaced until they are created.
    is_gradual: bool,
}

/// How the surface is drawn in one situation, by [`PassKind`].
type SurfacePasses = [Slot; PassKind::COUNT];

/// A pass that may be needed.
#[derive(Default)]
struct Slot {
    /// `None` if it would equal another pass, or cannot be created.
    variant: Option<EarthVariant>,
    pass: Option<SurfacePass>,
}

pub(super) struct SurfacePass {
    pub variant: EarthVariant,
    pub pipeline: wgpu::RenderPipeline,
    /// Layout of group 0, which each view binds itself.
    pub layout: wgpu::BindGroupLayout,
}

impl SurfacePipelines {
    /// Number of sides of the air.
    pub(super) fn sides(&self) -> usize {
        self.sides.len()
    }

    /// The situation of a plan over maps with texels of at most this size, equatorial radii.
    pub(super) fn situation(&self, plan: &FramePlan, largest_texel: f64) -> Situation {
        let scales = match self.leaves_out_scales {
            true => DetailScales::of_pixels(plan.least_pixel, largest_texel),
            false => DetailScales::Both,
        };
        Situation::of(plan, scales)
    }

    fn slots(&self, at: Situation) -> Option<&SurfacePasses> {
        Some(&self.sides.get(at.side)?[at.scales as usize])
    }

    /// The kind of draw for this light in a situation, or its replacement.
    pub(super) fn kind_of(
        &self,
        at: Situation,
        light: DrawLight,
        has_moon_shadow: bool,
    ) -> PassKind {
        let may_wait = |kind: PassKind| self.is_gradual && kind.only_saves_time();
        first_kind(light, has_moon_shadow, |kind| {
            self.has(at, kind) && (self.pass(at, kind).is_some() || !may_wait(kind))
        })
    }

    /// The same when all kinds are created.
    pub(super) fn best_kind_of(
        &self,
        at: Situation,
        light: DrawLight,
        has_moon_shadow: bool,
    ) -> PassKind {
        first_kind(light, has_moon_shadow, |kind| self.has(at, kind))
    }

    /// Whether there is such a pass, created or not.
    pub(super) fn has(&self, at: Situation, kind: PassKind) -> bool {
        let slots = self.slots(at);
        slots.is_some_and(|slots| slots[kind as usize].variant.is_some())
    }

    /// Whether there is such a pass in any situation.
    pub(super) fn draws(&self, kind: PassKind) -> bool {
        self.variants().any(|(other, _)| other == kind)
    }

    /// Whether a pass reads the tile of synthetic detail.
    pub(super) fn read_detail_tiles(&self) -> bool {
        self.variants()
            .any(|(_, variant)| reads_detail_tiles(&variant))
    }

    /// A pass that was created.
    pub(super) fn pass(&self, at: Situation, kind: PassKind) -> Option<&SurfacePass> {
        self.slots(at)?[kind as usize].pass.as_ref()
    }

    /// Creates a missing pass. After a failure it is not tried again: another kind replaces it.
    pub(super) fn make_pass(
        &mut self,
        maker: &SurfaceMaker,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        (at, kind): (Situation, PassKind),
    ) -> Result<(), ShaderError> {
        let side = self.sides.get_mut(at.side);
        let slot = side.map(|side| &mut side[at.scales as usize][kind as usize]);
        if let Some(slot) = slot
            && slot.pass.is_none()
            && let Some(variant) = slot.variant.take()
        {
            slot.pass = Some(maker.pass(device, config, &self.maps, variant)?);
            slot.variant = Some(variant);
        }
        Ok(())
    }

    /// Removes a pass that the device rejected: another kind replaces it.
    pub(super) fn give_up(&mut self, (at, kind): (Situation, PassKind)) {
        if let Some(side) = self.sides.get_mut(at.side) {
            side[at.scales as usize][kind as usize] = Slot::default();
        }
    }

    /// Creates missing passes, several at a time.
    ///
    /// # Errors
    /// The first error. Errors of the device go to the calling thread's error scope.
    pub(super) fn make_passes(
        &mut self,
        maker: &SurfaceMaker,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        wanted: impl Iterator<Item = (Situation, PassKind)>,
    ) -> Result<(), ShaderError> {
        let mut missing: Vec<(Situation, PassKind, EarthVariant)> = Vec::new();
        for (at, kind) in wanted {
            let slot = self.slots(at).map(|slots| &slots[kind as usize]);
            let is_listed = missing.iter().any(|(s, k, _)| (*s, *k) == (at, kind));
            if let Some(slot) = slot.filter(|slot| slot.pass.is_none() && !is_listed)
                && let Some(variant) = slot.variant
            {
                missing.push((at, kind, variant));
            }
        }
        if parallel::HAS_THREADS {
            let maps = &self.maps;
            let made = parallel::map(missing.len(), |place| {
                // Error scopes are per thread.
                let rejections = ErrorScope::open(device, wgpu::ErrorFilter::Validation);
                let pass = maker.pass(device, config, maps, missing[place].2).ok();
                let rejected = rejections.error();
                pass.filter(|_| rejected.is_none())
            });
            for ((at, kind, _), pass) in missing.iter().zip(made) {
                self.sides[at.side][at.scales as usize][*kind as usize].pass = pass;
            }
        }
        // Passes that failed, or could not be created in parallel, are created here, where errors are checked.
        let mut missing = missing.into_iter();
        missing.try_for_each(|(at, kind, _)| self.make_pass(maker, device, config, (at, kind)))
    }

    /// Creates the pass that is needed in any case.
    pub fn make_one(
        &mut self,
        maker: &SurfaceMaker,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
    ) -> Result<(), ShaderError> {
        let first = Situation {
            side: 0,
            scales: DetailScales::Both,
        };
        self.make_pass(maker, device, config, (first, PassKind::Everything))
    }

    /// Creates all missing passes.
    pub fn make_all(
        &mut self,
        maker: &SurfaceMaker,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
    ) -> Result<(), ShaderError> {
        let all =
            Situation::all(self.sides.len()).flat_map(|at| PassKind::ALL.map(|kind| (at, kind)));
        self.make_passes(maker, device, config, all)
    }

    /// All variants for the first side of the air, with all scales of detail.
    pub(super) fn variants(&self) -> impl Iterator<Item = (PassKind, EarthVariant)> {
        let slots = self.sides.first().into_iter().flat_map(|side| &side[0]);
        let kinds = PassKind::ALL.into_iter().zip(slots);
        kinds.filter_map(|(kind, slot)| Some((kind, slot.variant?)))
    }

    /// Total length of the WGSL that the driver gets, with all scales of detail, bytes.
    pub(super) fn shader_bytes(&self) -> u64 {
        let slots = self.sides.iter().flat_map(|side| &side[0]);
        let texts = slots.filter_map(|slot| slot.variant?.source().ok());
        texts.map(|source| source.text.len() as u64).sum()
    }
}

/// The first kind of draw for this light that is usable.
fn first_kind(
    light: DrawLight,
    has_moon_shadow: bool,
    is_usable: impl Fn(PassKind) -> bool,
) -> PassKind {
    let mut kind = PassKind::of(light, has_moon_shadow);
    while !is_usable(kind)
        && let Some(instead) = kind.instead()
    {
        kind = instead;
    }
    kind
}

impl SurfaceMaker {
    /// The same maker for the mesh of another view.
    pub fn for_view(&self, view: &SurfaceView) -> Self {
        Self {
            mesh: MeshForm::of(view.mesh(), self.has_tiles),
            ..self.clone()
        }
    }

    /// The passes of a configuration, with no pipeline created yet.
    pub fn plan(&self, device: &wgpu::Device, config: &SurfaceConfig<'_>) -> SurfacePipelines {
        let maps = MapArrangement::new(
            device,
            self.maps,
            config.shown,
            config.anisotropy,
            self.has_parts,
        );
        let sides = AirSide::of_air(config.air.is_some()).iter();
        let sides = sides.map(|&side| {
            let output = output(&maps, config, side);
            let mut all = EarthVariant {
                form: self.mesh.vertex,
                output,
                parts: self.has_parts,
            };
            let city_lights = all.lights_as_points().filter(|_| config.city_lights);
            if city_lights.is_some() {
                all = all.below_points().unwrap_or(all);
            }
            let interpolated = all.interpolated().filter(|_| config.interpolates_air);
            // Cells are classified for whole maps only; tiles show more.
            let of_one_kind = interpolated.filter(|_| !self.has_tiles);
            let of_one_kind = of_one_kind.and_then(EarthVariant::of_one_kind);
            let variants = PassKind::ALL.map(|kind| match kind {
                PassKind::Everything => Some(all),
                PassKind::Daylit => all.daylit(),
                PassKind::Night => all.by_night(),
                PassKind::Interpolated => interpolated,
                PassKind::Land => of_one_kind.map(|(land, _)| land),
                PassKind::OpenSea => of_one_kind.map(|(_, open_sea)| open_sea),
                PassKind::Eclipsed => all.eclipsed().filter(|_| config.light.eclipses),
                PassKind::CityLights => city_lights,
                PassKind::CloudsOverhead => all.clouds_overhead(config.light.eclipses),
                PassKind::CloudsAround => all.clouds_around(config.light.eclipses),
                PassKind::CloudsAtLimb => all.clouds_at_limb(),
                PassKind::EclipsedCloudsAtLimb => all
                    .clouds_at_limb()
                    .and_then(EarthVariant::eclipsed)
                    .filter(|_| config.light.eclipses),
            });
            DetailScales::ALL.map(|scales| {
                let is_used = scales == DetailScales::Both || config.leaves_out_scales;
                variants.map(|variant| Slot {
                    variant: variant
                        .filter(|_| is_used)
                        .map(|variant| variant.with_scales(scales).unwrap_or(variant)),
                    pass: None,
                })
            })
        });
        SurfacePipelines {
            sides: sides.collect(),
            leaves_out_scales: config.leaves_out_scales,
            is_gradual: config.is_gradual,
            maps,
        }
    }

    /// Creates the pass of one variant of the shader.
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
        let mut description = PipelineDescription {
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
        };
        if variant.form == VertexForm::CityPoints {
            description.buffers = &CityPoints::BUFFERS;
            description.primitive = CityPoints::PRIMITIVE;
            description.writes_depth = false;
            description.blend = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        }
        if matches!(
            variant.form,
            VertexForm::Sky | VertexForm::Around | VertexForm::Limb
        ) {
            description.buffers = &[];
            description.primitive = wgpu::PrimitiveState::default();
            description.writes_depth = false;
            description.blend = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        }
        let pipeline = description.create(device);
        Ok(SurfacePass {
            variant,
            pipeline,
            layout,
        })
    }

    /// Layout of group 0, in the order in which [`super::SurfaceDrawable`] binds it.
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
        if reads_detail_tiles(variant) {
            entries.extend(DetailTiles::entries());
        }
        entries.extend_from_slice(&self.mesh.entries);
        entries
    }
}

/// Layout of the frame's uniforms, for all shaders.
pub(super) fn frame_entry() -> wgpu::BindGroupLayoutEntry {
    let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
    super::uniform_entry(0, both, size_of::<FrameUniforms>())
}

/// Layout of the uniforms that place tiles.
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

/// Whether a variant reads the tile of synthetic detail.
pub(super) fn reads_detail_tiles(variant: &EarthVariant) -> bool {
    variant
        .conditions_met()
        .contains(&LightEffect::Detail.name())
}

/// Shader output of a configuration, for an eye on this side of the air.
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
            lamps_as_points: false,
            water: maps.has(MapLayer::Water),
            eclipse: false,
            interpolated: false,
            night: false,
            open_sea: false,
            scales: DetailScales::Both,
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
