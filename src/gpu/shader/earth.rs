//! Variants of the surface's shader.

use super::capability::ShaderCapability;
use super::variant::{SWITCH, ShaderVariant, TargetColor};
use super::vertex_form::VertexForm;
use crate::plan::{AirSide, DetailScales, LightEffect, LightEffects};

/// Variant of the surface's shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct EarthVariant {
    /// How the mesh is made, which also determines how a pixel's surface point is found.
    pub form: VertexForm,
    /// What the fragment stage writes.
    pub output: EarthOutput,
    /// Whether blocks with tiles may be cut into parts, each with its own tiles.
    pub parts: bool,
}

/// Output of the surface's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EarthOutput {
    /// Geolocation: no map is read.
    Geolocation,
    /// Ground truth as numbers.
    Truth(TruthLayers),
    /// The shaded image.
    Picture(ShadingVariant, TargetColor),
}

/// Shading of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShadingVariant {
    /// Physical light.
    Sunlit(SunlitLayers),
    /// As printed in the paper, in display values.
    Paper(PaperLayers),
}

/// Layers under physical light besides the day map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct SunlitLayers {
    /// Cloud cover.
    pub clouds: bool,
    /// The normal map.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
    /// Points draw the city lights; of the map only what air scatters is left.
    pub lamps_as_points: bool,
    /// Open water.
    pub water: bool,
    /// The effects of [`LightEffect::OF_SURFACE`]; without clouds there are no cloud shadows.
    pub effects: LightEffects,
    /// The Moon in front of the Sun.
    pub eclipse: bool,
    /// The air's light is sampled at vertices and interpolated, for an eye outside the air that looks at the block sphere.
    pub interpolated: bool,
    /// Without sunlight, for ground in deep night and an eye outside the air.
    pub night: bool,
    /// Everything is deep water; the map of water is present.
    pub open_sea: bool,
    /// The scales of synthetic detail that pixels can show, with [`LightEffect::Detail`].
    pub scales: DetailScales,
    /// The side of the air that the eye is on; `None` without air.
    pub air: Option<AirSide>,
}

/// The paper's layers besides the day map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct PaperLayers {
    /// Cloud cover.
    pub clouds: bool,
    /// The normal map.
    pub normals: bool,
    /// The side of the air that the eye is on; `None` without air. The paper's own air is an image drawn over it.
    pub air: Option<AirSide>,
}

/// The maps that ground truth is read from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct TruthLayers {
    /// Cloud cover.
    pub clouds: bool,
    /// The normal map.
    pub normals: bool,
    /// Open water.
    pub water: bool,
}

impl EarthVariant {
    /// The side of the air that the eye is on; `None` without air.
    pub fn air(&self) -> Option<AirSide> {
        match self.output {
            EarthOutput::Geolocation | EarthOutput::Truth(_) => None,
            EarthOutput::Picture(ShadingVariant::Sunlit(layers), _) => layers.air,
            EarthOutput::Picture(ShadingVariant::Paper(layers), _) => layers.air,
        }
    }

    /// The variant for frames with the Moon's shadow; `None` if it has no light that the shadow affects. The Moon is then new and gives no light.
    pub fn eclipsed(self) -> Option<Self> {
        self.with_sunlit(|layers| {
            Some(SunlitLayers {
                eclipse: true,
                effects: layers.effects.without(LightEffect::Moonlight),
                ..layers
            })
        })
    }

    /// The variant for ground in daylight, without layers that are visible only at night; `None` if it has no such layers.
    pub fn daylit(self) -> Option<Self> {
        self.with_sunlit(|layers| {
            let has_moonlight = layers.effects.has(LightEffect::Moonlight);
            let shows_by_night = layers.night_lights || has_moonlight;
            shows_by_night.then_some(SunlitLayers {
                night_lights: false,
                lamps_as_points: false,
                effects: layers.effects.without(LightEffect::Moonlight),
                ..layers
            })
        })
    }

    /// The variant for ground in deep night, without sunlight; `None` for an eye in the air, without air, with the Moon's shadow, or for a target for
    /// measurements.
    pub fn by_night(self) -> Option<Self> {
        let night = self.with_sunlit(|layers| {
            let has_night = layers.air == Some(AirSide::Outside) && !layers.eclipse;
            has_night.then_some(SunlitLayers {
                night: true,
                ..layers
            })
        });
        night.filter(|_| self.is_shown())
    }

    /// Whether the output is an image for display.
    fn is_shown(&self) -> bool {
        match self.output {
            EarthOutput::Picture(_, target) => target != TargetColor::Radiance,
            _ => false,
        }
    }

    /// The variant for cells in daylight that interpolates the light from and through the air between vertices; `None` if it has no such light, no
    /// such vertices, or a target for measurements.
    pub fn interpolated(self) -> Option<Self> {
        let has_vertices = matches!(self.form, VertexForm::BlockLattice { .. });
        let daylit = self.daylit().unwrap_or(self);
        let interpolated = daylit.with_sunlit(|layers| {
            (layers.air == Some(AirSide::Outside)).then_some(SunlitLayers {
                interpolated: true,
                ..layers
            })
        });
        interpolated.filter(|_| self.is_shown() && has_vertices)
    }

    /// The variants for cells that have only land and only open sea; `None` without a map of water.
    pub fn of_one_kind(self) -> Option<(Self, Self)> {
        let land = self.with_sunlit(|layers| {
            layers.water.then_some(SunlitLayers {
                water: false,
                ..layers
            })
        })?;
        let open_sea = self.with_sunlit(|layers| {
            Some(SunlitLayers {
                open_sea: true,
                normals: false,
                ..layers
            })
        })?;
        Some((land, open_sea))
    }

    /// The variant for pixels that show only these scales of synthetic detail; `None` without any.
    pub fn with_scales(self, scales: DetailScales) -> Option<Self> {
        self.with_sunlit(|layers| {
            let has_detail = layers.effects.has(LightEffect::Detail);
            has_detail.then_some(SunlitLayers { scales, ..layers })
        })
    }

    /// The variant of city lights as points over ground of this variant; `None` if it has no such lights, has tiles, or has a mesh other than the
    /// block sphere.
    pub fn lights_as_points(self) -> Option<Self> {
        match (self.form, self.output) {
            (
                VertexForm::BlockLattice { tiles: false },
                EarthOutput::Picture(ShadingVariant::Sunlit(layers), target),
            ) if layers.night_lights => Some(Self::of_city_lights((layers, target))),
            _ => None,
        }
    }

    /// The variant of this variant's clouds in the sky, seen from below; `None` if there are no clouds or the eye cannot be below them.
    pub fn clouds_overhead(self, eclipse: bool) -> Option<Self> {
        self.clouds_by_the_eye(VertexForm::Sky, eclipse)
    }

    /// The variant of this variant's clouds around an eye within them; `None` if there are no clouds or the eye cannot be within them.
    pub fn clouds_around(self, eclipse: bool) -> Option<Self> {
        self.clouds_by_the_eye(VertexForm::Around, eclipse)
    }

    fn clouds_by_the_eye(self, form: VertexForm, eclipse: bool) -> Option<Self> {
        let effects = [LightEffect::Detail, LightEffect::Moonlight];
        self.clouds_beside_ground(form, AirSide::Outside, &effects)?
            .with_sunlit(|layers| Some(SunlitLayers { eclipse, ..layers }))
    }

    /// The variant of this variant's clouds above the edge of the ground; `None` if there are no clouds or the eye is in the air.
    pub fn clouds_at_limb(self) -> Option<Self> {
        let effects = [
            LightEffect::Detail,
            LightEffect::DirectionalReflectance,
            LightEffect::Moonlight,
        ];
        self.clouds_beside_ground(VertexForm::Limb, AirSide::Inside, &effects)
    }

    /// The variant of this variant's clouds alone, without an eclipse, with those of these effects that it has; `None` if there are no clouds or
    /// the eye is where they are not seen.
    fn clouds_beside_ground(
        self,
        form: VertexForm,
        unseen_from: AirSide,
        effects: &[LightEffect],
    ) -> Option<Self> {
        let clouds = self.with_sunlit(|layers| {
            let is_seen = layers.clouds && layers.air != Some(unseen_from);
            is_seen.then_some(SunlitLayers {
                clouds: true,
                effects: layers.effects.and(LightEffects::of(effects)),
                air: layers.air,
                ..SunlitLayers::default()
            })
        });
        clouds.map(|clouds| Self { form, ..clouds })
    }

    /// The variant of ground under points of light; `None` if there are none over this variant.
    pub fn below_points(self) -> Option<Self> {
        self.lights_as_points()?;
        self.with_sunlit(|layers| {
            Some(SunlitLayers {
                lamps_as_points: true,
                ..layers
            })
        })
    }

    /// City lights as points, behind the layers that lie in front of the ground.
    fn of_city_lights((layers, target): (SunlitLayers, TargetColor)) -> Self {
        let detail = LightEffects::NONE.with(LightEffect::Detail);
        let layers = SunlitLayers {
            clouds: layers.clouds,
            night_lights: true,
            effects: layers.effects.and(detail),
            air: layers.air,
            ..SunlitLayers::default()
        };
        Self {
            form: VertexForm::CityPoints,
            output: EarthOutput::Picture(ShadingVariant::Sunlit(layers), target),
            parts: false,
        }
    }

    /// The variant with other layers under physical light; `None` if it has no such light or `layers` is `None`.
    fn with_sunlit(
        self,
        change: impl FnOnce(SunlitLayers) -> Option<SunlitLayers>,
    ) -> Option<Self> {
        match self.output {
            EarthOutput::Picture(ShadingVariant::Sunlit(layers), target) => Some(Self {
                output: EarthOutput::Picture(ShadingVariant::Sunlit(change(layers)?), target),
                ..self
            }),
            _ => None,
        }
    }
}

impl EarthOutput {
    /// All of them. Independent parts are not combined exhaustively.
    pub fn all() -> Vec<Self> {
        use LightEffect::{CloudShadows, Detail, DirectionalReflectance, Moonlight};
        let none = LightEffects::NONE;
        let on = |bits: u32, bit: u32| bits >> bit & 1 == 1;
        let effects = LightEffect::OF_SURFACE;
        let sunlit = |air| {
            let layers = (0..32 << effects.len()).map(move |bits| SunlitLayers {
                clouds: on(bits, 0),
                normals: on(bits, 1),
                night_lights: on(bits, 2),
                lamps_as_points: false,
                water: on(bits, 3),
                eclipse: on(bits, 4),
                interpolated: false,
                night: false,
                open_sea: false,
                scales: DetailScales::Both,
                effects: (5..)
                    .zip(effects)
                    .filter(|(bit, _)| on(bits, *bit))
                    .fold(LightEffects::NONE, |set, (_, effect)| set.with(*effect)),
                air,
            });
            layers
                .filter(|layers| layers.clouds || !layers.effects.has(CloudShadows))
                // It interacts only with clouds and air.
                .filter(|l| {
                    let has = |effect| l.effects.has(effect);
                    !l.eclipse || l.water && l.normals && has(Detail) && !has(Moonlight)
                })
                // It interacts with clouds, land and moonlight.
                .filter(|l| {
                    let beside = l.water && l.normals && l.night_lights;
                    !l.effects.has(DirectionalReflectance) || beside && l.effects.has(Detail)
                })
                .map(ShadingVariant::Sunlit)
        };
        let paper = |air| {
            (0..4).map(move |bits| {
                ShadingVariant::Paper(PaperLayers {
                    clouds: on(bits, 0),
                    normals: on(bits, 1),
                    air,
                })
            })
        };
        // Other tone curves with only one set of layers.
        let bare = ShadingVariant::Sunlit(SunlitLayers::default());
        let usual = TargetColor::USUAL;
        let others = TargetColor::all().into_iter();
        let others = others.filter(|target| !usual.contains(target));
        let pictures = AirSide::OR_NONE
            .into_iter()
            .flat_map(|air| sunlit(air).chain(paper(air)))
            .flat_map(|shading| {
                // Moonlight, detail and eclipses do not interact with the target: one target is enough.
                let targets = usual.into_iter().take(match shading {
                    ShadingVariant::Sunlit(layers)
                        if layers.eclipse || layers.effects.without(CloudShadows) != none =>
                    {
                        1
                    }
                    ShadingVariant::Sunlit(_) | ShadingVariant::Paper(_) => usual.len(),
                });
                targets.map(move |target| Self::Picture(shading, target))
            })
            .chain(others.map(|target| Self::Picture(bare, target)));
        let truths = (0..8).map(|bits| {
            Self::Truth(TruthLayers {
                clouds: on(bits, 0),
                normals: on(bits, 1),
                water: on(bits, 2),
            })
        });
        std::iter::once(Self::Geolocation)
            .chain(truths)
            .chain(pictures)
            .collect()
    }
}

/// Layers and targets of city lights.
fn outputs_of_city_lights() -> impl Iterator<Item = (SunlitLayers, TargetColor)> {
    let layers = SWITCH.into_iter().flat_map(|clouds| {
        AirSide::OR_NONE.map(|air| SunlitLayers {
            clouds,
            air,
            effects: LightEffects::NONE.with(LightEffect::Detail),
            ..SunlitLayers::default()
        })
    });
    layers.flat_map(|layers| TargetColor::USUAL.map(|target| (layers, target)))
}

impl ShaderVariant for EarthVariant {
    const ENTRY: &'static str = "earth.wgsl";

    fn all() -> Vec<Self> {
        let outputs = EarthOutput::all();
        let forms = VertexForm::all();
        let whole = forms.iter().flat_map(|&form| {
            outputs.iter().map(move |&output| Self {
                form,
                output,
                parts: false,
            })
        });
        // Parts only interact with maps: outputs with all maps and with none.
        let reads_all = |output: &EarthOutput| match output {
            EarthOutput::Picture(ShadingVariant::Sunlit(layers), target) => {
                let all = layers.clouds
                    && layers.normals
                    && layers.night_lights
                    && layers.water
                    && layers.effects.has(LightEffect::CloudShadows);
                let bare = *layers == SunlitLayers::default();
                (all || bare) && *target == TargetColor::USUAL[0]
            }
            EarthOutput::Picture(ShadingVariant::Paper(_), target) => {
                *target == TargetColor::USUAL[0]
            }
            EarthOutput::Truth(_) | EarthOutput::Geolocation => true,
        };
        let outputs: Vec<_> = outputs.iter().copied().filter(reads_all).collect();
        let with_parts = forms.iter().filter(|form| form.has_tiles());
        let cut = with_parts.flat_map(|&form| {
            outputs.iter().map(move |&output| Self {
                form,
                output,
                parts: true,
            })
        });
        let all: Vec<Self> = whole.chain(cut).collect();
        let interpolated = all.iter().filter(|variant| variant.daylit().is_none());
        let interpolated: Vec<_> = interpolated.filter_map(|v| v.interpolated()).collect();
        // Open sea has no slopes, and cells are classified only without tiles.
        let open_sea = interpolated
            .iter()
            .filter(|variant| !variant.form.has_tiles());
        let mut open_sea: Vec<_> = open_sea.filter_map(|v| Some(v.of_one_kind()?.1)).collect();
        open_sea.sort_unstable();
        open_sea.dedup();
        let below_points: Vec<_> = all.iter().filter_map(|v| v.below_points()).collect();
        let city_lights = outputs_of_city_lights().map(Self::of_city_lights);
        let by_the_eye = SWITCH.into_iter().flat_map(|eclipse| {
            all.iter().flat_map(move |variant| {
                let overhead = variant.clouds_overhead(eclipse);
                overhead.into_iter().chain(variant.clouds_around(eclipse))
            })
        });
        let at_limb: Vec<_> = all.iter().filter_map(|v| v.clouds_at_limb()).collect();
        let eclipsed = at_limb.iter().filter_map(|v| v.eclipsed());
        let mut beside: Vec<_> = by_the_eye.chain(eclipsed).collect();
        beside.extend(at_limb);
        beside.sort_unstable();
        beside.dedup();
        let all: Vec<_> = all.into_iter().chain(interpolated).collect();
        // Scales of detail interact with maps: the variants with these are enough.
        let has_maps = |layers: &SunlitLayers| layers.clouds && layers.normals && layers.water;
        let with_maps = |v: &Self| v.with_sunlit(|layers| Some(layers).filter(has_maps));
        let lit_by_points: Vec<_> = below_points.iter().filter_map(with_maps).collect();
        let with_maps: Vec<_> = all.iter().filter_map(with_maps).collect();
        // So it is for those without sunlight.
        let by_night = with_maps.iter().chain(&lit_by_points);
        let by_night: Vec<_> = by_night.filter_map(|v| v.by_night()).collect();
        let few_scales = [DetailScales::Coarse, DetailScales::None].into_iter();
        let few_scales = few_scales
            .flat_map(|scales| with_maps.iter().filter_map(move |v| v.with_scales(scales)));
        let all = all.into_iter().chain(few_scales).chain(open_sea);
        let all = all.chain(below_points).chain(city_lights);
        all.chain(beside).chain(by_night).collect()
    }

    fn needs(&self) -> Vec<ShaderCapability> {
        match self.form {
            VertexForm::ContourPrisms { .. } => vec![ShaderCapability::StorageBuffers],
            _ => Vec::new(),
        }
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        use VertexForm as Form;
        let form = self.form;
        let (shading, target) = match self.output {
            EarthOutput::Geolocation | EarthOutput::Truth(_) => (None, None),
            EarthOutput::Picture(shading, target) => (Some(shading), Some(target)),
        };
        // The paper has no city lights and no water.
        let layers = match self.output {
            EarthOutput::Picture(ShadingVariant::Sunlit(layers), _) => layers,
            EarthOutput::Picture(ShadingVariant::Paper(layers), _) => SunlitLayers {
                clouds: layers.clouds,
                normals: layers.normals,
                air: layers.air,
                ..Default::default()
            },
            EarthOutput::Truth(layers) => SunlitLayers {
                clouds: layers.clouds,
                normals: layers.normals,
                water: layers.water,
                ..Default::default()
            },
            EarthOutput::Geolocation => SunlitLayers::default(),
        };
        let is_paper = matches!(shading, Some(ShadingVariant::Paper(_)));
        let is_sunlit = matches!(shading, Some(ShadingVariant::Sunlit(_)));
        let is_truth = matches!(self.output, EarthOutput::Truth(_));
        let has_detail = layers.effects.has(LightEffect::Detail);
        let mut conditions = vec![
            ("blocks", matches!(form, Form::BlockLattice { .. })),
            ("patches", matches!(form, Form::ReliefPatches(_))),
            ("grid", matches!(form, Form::ProjectedGrid { .. })),
            ("cast", matches!(form, Form::ContourPrisms { .. })),
            ("points", form == Form::CityPoints),
            ("overhead", form == Form::Sky),
            ("around", form == Form::Around),
            ("limb", form == Form::Limb),
            (
                "beside_ground",
                matches!(form, Form::Sky | Form::Around | Form::Limb),
            ),
            (
                "relief",
                !matches!(
                    form,
                    Form::BlockLattice { .. }
                        | Form::CityPoints
                        | Form::Sky
                        | Form::Around
                        | Form::Limb
                ),
            ),
            (
                "depth",
                matches!(
                    form,
                    Form::ContourPrisms {
                        writes_depth: true,
                        ..
                    }
                ),
            ),
            ("tiles", form.has_tiles()),
            ("per_block_tiles", form.has_per_block_tiles()),
            ("parts", self.parts),
            ("picture", shading.is_some()),
            ("geolocation", self.output == EarthOutput::Geolocation),
            ("truth", is_truth),
            ("sunlit", is_sunlit),
            ("paper", is_paper),
            (
                "surface_light",
                is_sunlit
                    && (layers.clouds || layers.normals || layers.night_lights || layers.water)
                    || is_truth && (layers.clouds || layers.normals),
            ),
            ("clouds", layers.clouds),
            ("normals", layers.normals),
            ("night_lights", layers.night_lights),
            ("lamps_as_points", layers.lamps_as_points),
            ("water", layers.water),
            ("eclipse", layers.eclipse),
            ("interpolated", layers.interpolated),
            ("night", layers.night),
            ("open_sea", layers.open_sea),
            (
                "coarse_scale",
                has_detail && layers.scales != DetailScales::None,
            ),
            (
                "fine_scale",
                has_detail && layers.scales == DetailScales::Both,
            ),
            ("air", layers.air.is_some()),
            ("inside", layers.air == Some(AirSide::Inside)),
            // The paper's display values, for a target that stores something else.
            (
                "decode",
                is_paper && !matches!(target, Some(TargetColor::Display(_))),
            ),
        ];
        let effects = LightEffect::OF_SURFACE.iter();
        conditions.extend(effects.map(|effect| (effect.name(), layers.effects.has(*effect))));
        // Measured values are stored unchanged.
        let target = target.unwrap_or(TargetColor::Radiance);
        conditions.extend(target.conditions());
        conditions
    }
}
