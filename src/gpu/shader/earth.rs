//! Variants of the surface's shader.

use super::capability::ShaderCapability;
use super::variant::{SWITCH, ShaderVariant, TargetColor};
use crate::plan::{AirSide, LightEffect, LightEffects};

/// What the surface's shader is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct EarthVariant {
    /// How its mesh is made, and with it how a pixel's point of the surface is found.
    pub form: VertexForm,
    /// What the fragment stage writes.
    pub output: EarthOutput,
    /// Whether blocks that have tiles may be cut into parts with tiles of their own.
    pub parts: bool,
}

/// How the surface's mesh is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VertexForm {
    /// The block sphere on the ellipsoid, each block with tiles of its own if `tiles`.
    BlockLattice {
        /// Whether blocks have tiles.
        tiles: bool,
    },
    /// Patches of terrain.
    ReliefPatches(PatchTiles),
    /// A grid whose vertices the GPU makes; its triangles lie in several blocks.
    ProjectedGrid {
        /// Whether blocks have tiles.
        tiles: bool,
    },
    /// City lights, points that are drawn over the block sphere.
    CityPoints,
    /// No mesh: all of the sky, for clouds in it.
    Sky,
    /// Prisms behind which rays are cast at pages of contours. Each lies in one block.
    ContourPrisms {
        /// Whether blocks have tiles.
        tiles: bool,
        /// Whether the pass has a depth buffer: the shader says how deep a pixel lies.
        writes_depth: bool,
    },
}

/// What maps patches of relief are drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PatchTiles {
    /// Whole maps.
    None,
    /// Tiles of the one block that each patch lies in.
    OfOneBlock,
    /// Tiles of each block that a patch lies in.
    OfSeveralBlocks,
}

/// What the surface's pixels get.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EarthOutput {
    /// Where they look: no map is read.
    Geolocation,
    /// What is there, as numbers.
    Truth(TruthLayers),
    /// What that looks like.
    Picture(ShadingVariant, TargetColor),
}

/// How a picture is shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShadingVariant {
    /// Real light.
    Sunlit(SunlitLayers),
    /// As the paper prints it, in display values.
    Paper(PaperLayers),
}

/// What real light falls on and through, besides the day map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct SunlitLayers {
    /// Cloud cover.
    pub clouds: bool,
    /// The normal map.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
    /// Open water.
    pub water: bool,
    /// Of [`LightEffect::OF_SURFACE`]; without clouds they throw no shadows.
    pub effects: LightEffects,
    /// The Moon before the Sun.
    pub eclipse: bool,
    /// The air's light is looked up at vertices and interpolated, for an eye outside the air that looks at the block sphere.
    pub interpolated: bool,
    /// All of it is deep water, with the map of water.
    pub open_sea: bool,
    /// The air between the Sun, the ground and the eye, and where the eye is.
    pub air: Option<AirSide>,
}

/// The paper's layers besides the day map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct PaperLayers {
    /// Cloud cover.
    pub clouds: bool,
    /// The normal map.
    pub normals: bool,
    /// The air between the ground and the eye, and where the eye is. The paper's own is a picture over it.
    pub air: Option<AirSide>,
}

/// The maps that what is written as numbers is read from.
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

    /// The same while the Moon's shadow is in view; `None` where nothing knows of it. Then the Moon is new, and lights nothing.
    pub fn eclipsed(self) -> Option<Self> {
        self.with_sunlit(|layers| {
            Some(SunlitLayers {
                eclipse: true,
                effects: layers.effects.without(LightEffect::Moonlight),
                ..layers
            })
        })
    }

    /// The same without what shows by night alone, for ground by day; `None` where it has nothing of that.
    pub fn daylit(self) -> Option<Self> {
        self.with_sunlit(|layers| {
            let has_moonlight = layers.effects.has(LightEffect::Moonlight);
            let shows_by_night = layers.night_lights || has_moonlight;
            shows_by_night.then_some(SunlitLayers {
                night_lights: false,
                effects: layers.effects.without(LightEffect::Moonlight),
                ..layers
            })
        })
    }

    /// The same for cells by day whose light from and through the air is interpolated between their vertices; `None` of what has no such
    /// light, no such vertices, or a target that measures it.
    pub fn interpolated(self) -> Option<Self> {
        let is_shown = match self.output {
            EarthOutput::Picture(_, target) => target != TargetColor::Radiance,
            _ => false,
        };
        let has_vertices = matches!(self.form, VertexForm::BlockLattice { .. });
        let daylit = self.daylit().unwrap_or(self);
        let interpolated = daylit.with_sunlit(|layers| {
            (layers.air == Some(AirSide::Outside)).then_some(SunlitLayers {
                interpolated: true,
                ..layers
            })
        });
        interpolated.filter(|_| is_shown && has_vertices)
    }

    /// The same for cells of nothing but land and of nothing but open sea; `None` without a map of water.
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

    /// City lights as points over ground that is drawn so; `None` where it has no such lights, tiles, or another mesh than the block sphere.
    pub fn lights_as_points(self) -> Option<Self> {
        match (self.form, self.output) {
            (
                VertexForm::BlockLattice { tiles: false },
                EarthOutput::Picture(ShadingVariant::Sunlit(layers), target),
            ) if layers.night_lights => Some(Self::of_city_lights((layers, target))),
            _ => None,
        }
    }

    /// The clouds of what is drawn so in the sky, seen from below; `None` where there are none, or no eye is below them.
    pub fn clouds_overhead(self, eclipse: bool) -> Option<Self> {
        match self.output {
            EarthOutput::Picture(ShadingVariant::Sunlit(layers), target)
                if layers.clouds && layers.air != Some(AirSide::Outside) =>
            {
                let shown = LightEffects::of(&[LightEffect::Detail, LightEffect::Moonlight]);
                let layers = SunlitLayers {
                    clouds: true,
                    effects: layers.effects.and(shown),
                    eclipse,
                    air: layers.air,
                    ..SunlitLayers::default()
                };
                Some(Self {
                    form: VertexForm::Sky,
                    output: EarthOutput::Picture(ShadingVariant::Sunlit(layers), target),
                    ..self
                })
            }
            _ => None,
        }
    }

    /// The same without the map of city lights.
    pub fn without_night_map(self) -> Self {
        let without = self.with_sunlit(|layers| {
            Some(SunlitLayers {
                night_lights: false,
                ..layers
            })
        });
        without.unwrap_or(self)
    }

    /// City lights as points, behind what of these layers is before the ground.
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

    /// The same with other layers in real light; `None` where it has no such light, or there are none.
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

impl VertexForm {
    /// All that the surface is drawn by.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for tiles in SWITCH {
            all.push(Self::BlockLattice { tiles });
            all.push(Self::ProjectedGrid { tiles });
            all.extend(SWITCH.map(|writes_depth| Self::ContourPrisms {
                tiles,
                writes_depth,
            }));
        }
        use PatchTiles::{None, OfOneBlock, OfSeveralBlocks};
        all.extend([None, OfOneBlock, OfSeveralBlocks].map(Self::ReliefPatches));
        all
    }

    /// Whether blocks have tiles.
    pub fn has_tiles(self) -> bool {
        match self {
            Self::BlockLattice { tiles } | Self::ProjectedGrid { tiles } => tiles,
            Self::ContourPrisms { tiles, .. } => tiles,
            Self::ReliefPatches(tiles) => tiles != PatchTiles::None,
            Self::CityPoints | Self::Sky => false,
        }
    }

    /// Whether triangles that lie in several blocks are drawn with the tiles of each.
    pub fn has_per_block_tiles(self) -> bool {
        matches!(
            self,
            Self::ReliefPatches(PatchTiles::OfSeveralBlocks) | Self::ProjectedGrid { tiles: true }
        )
    }
}

impl EarthOutput {
    /// All of them, and of parts that have nothing to do with each other, not each with each.
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
                water: on(bits, 3),
                eclipse: on(bits, 4),
                interpolated: false,
                open_sea: false,
                effects: (5..)
                    .zip(effects)
                    .filter(|(bit, _)| on(bits, *bit))
                    .fold(LightEffects::NONE, |set, (_, effect)| set.with(*effect)),
                air,
            });
            layers
                .filter(|layers| layers.clouds || !layers.effects.has(CloudShadows))
                // It meets the clouds and the air, and nothing else of these.
                .filter(|l| {
                    let has = |effect| l.effects.has(effect);
                    !l.eclipse || l.water && l.normals && has(Detail) && !has(Moonlight)
                })
                // It meets clouds, land and moonlight.
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
        // Other tone curves with one set of layers.
        let bare = ShadingVariant::Sunlit(SunlitLayers::default());
        let usual = TargetColor::USUAL;
        let others = TargetColor::all().into_iter();
        let others = others.filter(|target| !usual.contains(target));
        let pictures = AirSide::OR_NONE
            .into_iter()
            .flat_map(|air| sunlit(air).chain(paper(air)))
            .flat_map(|shading| {
                // Nothing of moonlight, detail and eclipses meets the target: one is enough.
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

/// What city lights are drawn behind and to.
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
        // What parts are read by meets maps alone: outputs with all of them and with none.
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
        // Open sea has no slopes, and those without tiles are known.
        let open_sea = interpolated
            .iter()
            .filter(|variant| !variant.form.has_tiles());
        let mut open_sea: Vec<_> = open_sea.filter_map(|v| Some(v.of_one_kind()?.1)).collect();
        open_sea.sort_unstable();
        open_sea.dedup();
        let city_lights = outputs_of_city_lights().map(Self::of_city_lights);
        let mut overhead: Vec<_> = SWITCH
            .into_iter()
            .flat_map(|eclipse| all.iter().filter_map(move |v| v.clouds_overhead(eclipse)))
            .collect();
        overhead.sort_unstable();
        overhead.dedup();
        let all = all.into_iter().chain(interpolated);
        let all = all.chain(open_sea).chain(city_lights);
        all.chain(overhead).collect()
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
        // The paper has no lamps and no water.
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
        let mut conditions = vec![
            ("blocks", matches!(form, Form::BlockLattice { .. })),
            ("patches", matches!(form, Form::ReliefPatches(_))),
            ("grid", matches!(form, Form::ProjectedGrid { .. })),
            ("cast", matches!(form, Form::ContourPrisms { .. })),
            ("points", form == Form::CityPoints),
            ("overhead", form == Form::Sky),
            (
                "relief",
                !matches!(
                    form,
                    Form::BlockLattice { .. } | Form::CityPoints | Form::Sky
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
            ("water", layers.water),
            ("eclipse", layers.eclipse),
            ("interpolated", layers.interpolated),
            ("open_sea", layers.open_sea),
            ("air", layers.air.is_some()),
            ("inside", layers.air == Some(AirSide::Inside)),
            // The paper's display values, for a target of anything else.
            (
                "decode",
                is_paper && !matches!(target, Some(TargetColor::Display(_))),
            ),
        ];
        let effects = LightEffect::OF_SURFACE.iter();
        conditions.extend(effects.map(|effect| (effect.name(), layers.effects.has(*effect))));
        // What is measured is stored as it is.
        let target = target.unwrap_or(TargetColor::Radiance);
        conditions.extend(target.conditions());
        conditions
    }
}
