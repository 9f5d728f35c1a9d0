//! Shaders by naga: every legal variant compiles, for every backend and within its limits; structs and constants are Rust's;
//! what is off is not in the text.

mod backends;
#[path = "../common/backends.rs"]
mod compile;
mod constants;
mod limits;
mod precedence;
mod structs;

use compile::compiled;
use naga::valid::ModuleInfo;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;
use terrella::Tone;
use terrella::internals::gpu::{
    AirVariant, AirViewVariant, BloomVariant, CelestialVariant, DevelopVariant, EarthOutput,
    EarthVariant, GlowVariant, MapFadeVariant, PaperLayers, PatchTiles, SHADER_FILES,
    ShaderCapability, ShaderText, ShaderVariant, ShadingVariant, SunlitLayers, TargetColor,
    TracksVariant, TruthLayers, UpscaleVariant, VertexForm,
};
use terrella::internals::plan::{AirSide, DetailScales, LightEffect, LightEffects};
use terrella_files::parallel;

/// A legal variant of any shader, validated.
pub struct Shader {
    pub name: String,
    pub needs: Vec<ShaderCapability>,
    pub text: ShaderText,
    pub module: naga::Module,
    pub info: ModuleInfo,
}

impl Shader {
    fn new(variant: &impl ShaderVariant) -> Result<Self, String> {
        let text = variant.source().map_err(|error| error.to_string())?;
        let place = |location: Option<naga::SourceLocation>| match location {
            Some(at) => {
                let (file, line) = text.origins[at.line_number as usize - 1];
                format!("shaders/{file}:{line}")
            }
            None => "somewhere".into(),
        };
        let (module, info) = compiled(&text.text)
            .map_err(|(location, error)| format!("{}:\n{error}", place(location)))?;
        Ok(Self {
            name: variant.name(),
            needs: variant.needs(),
            text,
            module,
            info,
        })
    }
}

/// Of each so many variants one is sampled. A prime: variants are listed by nested loops over choices of two to five.
const SAMPLED: usize = 53;

/// Calls a function for the variants of all shaders, and returns its results.
macro_rules! for_all_shaders {
    ($of:ident) => {
        [
            $of::<EarthVariant>(),
            $of::<AirVariant>(),
            $of::<AirViewVariant>(),
            $of::<GlowVariant>(),
            $of::<CelestialVariant>(),
            $of::<TracksVariant>(),
            $of::<MapFadeVariant>(),
            $of::<UpscaleVariant>(),
            $of::<BloomVariant>(),
            $of::<DevelopVariant>(),
        ]
    };
}

/// A sample of a shader's legal variants that has every line of the shader: each variant with a line that none before it has, and one of each
/// [`SAMPLED`].
fn sample<V: ShaderVariant + Sync>() -> Vec<V> {
    let all = V::all();
    let origins = parallel::map(all.len(), |n| all[n].source().map(|text| text.origins));
    let mut seen = BTreeSet::new();
    let mut is_sampled = |(n, origins): (usize, Result<Vec<_>, _>)| {
        let before = seen.len();
        let is_bad = origins.map(|lines| seen.extend(lines)).is_err();
        is_bad || seen.len() > before || n.is_multiple_of(SAMPLED)
    };
    let chosen: Vec<_> = origins
        .into_iter()
        .enumerate()
        .map(&mut is_sampled)
        .collect();
    let all = all.into_iter().zip(chosen);
    all.filter_map(|(variant, is_chosen)| is_chosen.then_some(variant))
        .collect()
}

fn count<V: ShaderVariant>() -> usize {
    V::all().len()
}

fn built<V: ShaderVariant + Sync>() -> Vec<Result<Shader, String>> {
    let sample = sample::<V>();
    parallel::map(sample.len(), |n| {
        Shader::new(&sample[n]).map_err(|error| format!("{}: {error}", sample[n].name()))
    })
}

/// A sample of the legal variants of all shaders, and the errors of the illegal ones.
static SAMPLE: LazyLock<(Vec<Shader>, Vec<String>)> = LazyLock::new(|| {
    let (mut shaders, mut failures) = (Vec::new(), Vec::new());
    for shader in for_all_shaders!(built).into_iter().flatten() {
        match shader {
            Ok(shader) => shaders.push(shader),
            Err(failure) => failures.push(failure),
        }
    }
    (shaders, failures)
});

/// A sample of the legal variants of all shaders, in which every line of every shader is.
pub fn sampled_shaders() -> &'static [Shader] {
    hold(&SAMPLE.1);
    &SAMPLE.0
}

/// The failures of all legal variants of a shader, none of which is held longer than it takes.
fn failures<V: ShaderVariant + Sync>() -> Vec<String> {
    let all = V::all();
    let failures = parallel::map(all.len(), |n| match Shader::new(&all[n]) {
        Ok(shader) => {
            let unused = constants::unused_in(&shader)
                .map(|name| format!("{} declares {name} and does not use it", shader.name));
            backends::failures_of(&shader)
                .into_iter()
                .chain(unused)
                .collect()
        }
        Err(error) => vec![format!("{}: {error}", all[n].name())],
    });
    failures.concat()
}

#[test]
#[ignore = "minutes: all legal variants, of which the suite takes a sample"]
fn every_legal_variant_compiles_for_every_backend() {
    hold(&for_all_shaders!(failures).concat());
}

/// Fails with the given errors, if any.
pub fn hold(failures: &[String]) {
    assert!(
        failures.is_empty(),
        "{} failures:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

#[test]
fn every_sampled_variant_compiles() {
    let all = sampled_shaders();
    let names: BTreeSet<_> = all.iter().map(|shader| &shader.name).collect();
    assert_eq!(
        names.len(),
        all.len(),
        "each variant once, with a name of its own"
    );
    let legal: usize = for_all_shaders!(count).iter().sum();
    println!("{} of {legal} variants compiled", all.len());
    assert!(all.len() < legal / 4, "a sample that saves no time");
}

/// A file that is not listed would not be embedded; one that no variant has would be dead.
#[test]
fn every_file_is_in_some_variant() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut on_disk = BTreeSet::new();
    let mut folders = vec![folder.clone()];
    while let Some(at) = folders.pop() {
        for entry in std::fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(&folder).unwrap().to_str().unwrap();
                on_disk.insert(name.replace('\\', "/"));
            }
        }
    }
    let listed: BTreeSet<_> = SHADER_FILES
        .iter()
        .map(|(name, _)| name.to_string())
        .collect();
    assert_eq!(on_disk, listed);
    let mut used: BTreeSet<String> = BTreeSet::new();
    for shader in sampled_shaders() {
        used.extend(shader.text.origins.iter().map(|(file, _)| file.to_string()));
    }
    // The player's own, which have no variants.
    assert!(used.insert("craft.wgsl".to_owned()));
    assert!(used.insert("craft_model.wgsl".to_owned()));
    assert_eq!(used, listed);
}

/// All that switch the surface.
const EFFECTS: LightEffects = LightEffects::of(LightEffect::OF_SURFACE);

const LAYERS: SunlitLayers = SunlitLayers {
    clouds: true,
    normals: true,
    night_lights: true,
    lamps_as_points: false,
    water: true,
    effects: EFFECTS,
    eclipse: true,
    interpolated: false,
    night: false,
    open_sea: false,
    scales: DetailScales::Both,
    air: Some(AirSide::Outside),
};

fn sunlit(form: VertexForm, layers: SunlitLayers) -> EarthVariant {
    EarthVariant {
        form,
        output: EarthOutput::Picture(ShadingVariant::Sunlit(layers), TargetColor::Radiance),
        parts: false,
    }
}

const BLOCKS: VertexForm = VertexForm::BlockLattice { tiles: false };
const PATCHES: VertexForm = VertexForm::ReliefPatches(PatchTiles::None);

/// The text without comments.
fn code(variant: EarthVariant) -> String {
    let source = variant.source().unwrap().text;
    let lines = source
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_layer_that_is_off_is_not_in_the_shader() {
    let none = SunlitLayers::default();
    let minimal = code(sunlit(BLOCKS, none));
    let bindings = minimal.matches("@binding").count();
    assert_eq!(bindings, 3, "frame, sampler and day map:\n{minimal}");
    let everything = VertexForm::ReliefPatches(PatchTiles::OfOneBlock);
    let tiles = VertexForm::BlockLattice { tiles: true };
    let all = |without: SunlitLayers| sunlit(everything, without);
    let detail_alone = sunlit(
        BLOCKS,
        SunlitLayers {
            effects: LightEffects::of(&[LightEffect::Detail]),
            ..none
        },
    );
    let cases = [
        (
            ["cloud_map", "cover_at"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    clouds: true,
                    ..none
                },
            ),
            all(SunlitLayers {
                clouds: false,
                effects: EFFECTS.without(LightEffect::CloudShadows),
                ..LAYERS
            }),
        ),
        (
            ["LOWEST_SHADOW", "cloud_shadow"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    clouds: true,
                    effects: LightEffects::of(&[LightEffect::CloudShadows]),
                    ..none
                },
            ),
            all(SunlitLayers {
                effects: EFFECTS.without(LightEffect::CloudShadows),
                ..LAYERS
            }),
        ),
        (
            ["slope_map", "NORMALS"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    normals: true,
                    ..none
                },
            ),
            all(SunlitLayers {
                normals: false,
                ..LAYERS
            }),
        ),
        (
            ["light_map", "LAMP_COLOR"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    night_lights: true,
                    ..none
                },
            ),
            all(SunlitLayers {
                night_lights: false,
                ..LAYERS
            }),
        ),
        (
            ["water_map", "glint"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    water: true,
                    ..none
                },
            ),
            all(SunlitLayers {
                water: false,
                ..LAYERS
            }),
        ),
        (
            ["frame.moon_itrf", "air.moon_light"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    effects: LightEffects::of(&[LightEffect::Moonlight]),
                    ..none
                },
            ),
            all(SunlitLayers {
                effects: EFFECTS.without(LightEffect::Moonlight),
                ..LAYERS
            }),
        ),
        (
            ["frame.shadow", "air.shadow"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    eclipse: true,
                    interpolated: false,
                    open_sea: false,
                    ..none
                },
            ),
            all(SunlitLayers {
                eclipse: false,
                interpolated: false,
                open_sea: false,
                ..LAYERS
            }),
        ),
        (
            ["land_tile", "uneven"],
            detail_alone,
            all(SunlitLayers {
                effects: EFFECTS.without(LightEffect::Detail),
                ..LAYERS
            }),
        ),
        (
            ["COARSE_TILES", "FINE_TILES"],
            detail_alone,
            all(SunlitLayers {
                scales: DetailScales::None,
                ..LAYERS
            }),
        ),
        (
            ["FINE_TURN *", "FINE_TILES"],
            sunlit(BLOCKS, LAYERS),
            all(SunlitLayers {
                scales: DetailScales::Coarse,
                ..LAYERS
            }),
        ),
        (
            ["placements", "block"],
            sunlit(tiles, none),
            sunlit(PATCHES, LAYERS),
        ),
        (
            ["sunlight", "table_"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    air: LAYERS.air,
                    ..none
                },
            ),
            all(SunlitLayers {
                air: None,
                ..LAYERS
            }),
        ),
        (
            ["lamps_apart", "value_noise"],
            sunlit(
                BLOCKS,
                SunlitLayers {
                    night_lights: true,
                    effects: LightEffects::of(&[LightEffect::Detail]),
                    ..none
                },
            ),
            sunlit(
                BLOCKS,
                SunlitLayers {
                    lamps_as_points: true,
                    night_lights: true,
                    ..none
                },
            ),
        ),
        (
            ["origin_from_anchor_m", "height_m"],
            sunlit(PATCHES, none),
            sunlit(tiles, LAYERS),
        ),
    ];
    for (names, with, without) in cases {
        let (with_name, without_name) = (with.name(), without.name());
        let (with, without) = (code(with), code(without));
        assert!(
            with.contains(names[0]),
            "{with_name} must have {}, or this test cannot fail",
            names[0]
        );
        assert!(with.len() > minimal.len());
        for name in names {
            assert!(!without.contains(name), "{without_name} mentions {name}");
            assert!(!minimal.contains(name), "the minimum mentions {name}");
        }
    }
}

#[test]
fn ground_of_patches_has_nothing_of_the_grid() {
    let none = SunlitLayers::default();
    let with = code(sunlit(VertexForm::ProjectedGrid { tiles: true }, none));
    let patches = PatchTiles::OfSeveralBlocks;
    let without = code(sunlit(VertexForm::ReliefPatches(patches), none));
    for name in ["grid_point", "height_tiles", "GridUniforms", "vertex_index"] {
        assert!(with.contains(name) && !without.contains(name), "{name}");
    }
    for name in ["PatchVertex", "BlockInstance"] {
        assert!(
            !with.contains(name) && without.contains(name),
            "no vertex buffer: {name}"
        );
    }
    let bindings = |text: &str| text.matches("@binding(").count();
    assert_eq!(bindings(&with), bindings(&without) + 2);
}

#[test]
fn ground_of_patches_casts_no_rays() {
    let cast = |writes_depth| {
        let tiles = false;
        let form = VertexForm::ContourPrisms {
            tiles,
            writes_depth,
        };
        code(sunlit(form, SunlitLayers::default()))
    };
    let (with, without) = (cast(true), code(sunlit(PATCHES, SunlitLayers::default())));
    for name in ["contour_cast", "contour_nodes", "frag_depth", "discard"] {
        assert!(with.contains(name) && !without.contains(name), "{name}");
    }
    assert!(!with.contains("PatchVertex") && without.contains("PatchVertex"));
    assert!(!cast(false).contains("frag_depth"), "no depth buffer");
}

#[test]
fn a_picture_s_shader_draws_no_geolocation() {
    let geolocation = EarthVariant {
        form: BLOCKS,
        output: EarthOutput::Geolocation,
        parts: false,
    };
    let written = "vec4f(at.uv, at.center_uv)";
    assert!(code(geolocation).contains(written));
    assert!(!code(geolocation).contains("day_map"), "no map is read");
    assert!(!code(sunlit(BLOCKS, LAYERS)).contains(written));
}

/// A truth variant has its maps and no light; an image variant has nothing of truth.
#[test]
fn truth_has_no_light_and_light_no_truth() {
    let truth = |layers| {
        code(EarthVariant {
            form: BLOCKS,
            output: EarthOutput::Truth(layers),
            parts: false,
        })
    };
    let all = truth(TruthLayers {
        clouds: true,
        normals: true,
        water: true,
    });
    let none = truth(TruthLayers::default());
    for name in ["cloud_map", "slope_map", "water_map", "surface_light"] {
        assert!(all.contains(name) && !none.contains(name), "{name}");
    }
    let picture = code(sunlit(BLOCKS, LAYERS));
    for name in ["day_map", "sun_on_top", "glint", "value_noise"] {
        assert!(!all.contains(name) && picture.contains(name), "{name}");
    }
    for name in ["range_m", "TRUTH_LAND", "marks"] {
        assert!(none.contains(name) && !picture.contains(name), "{name}");
    }
}

#[test]
fn the_paper_has_no_light_of_ours() {
    let layers = PaperLayers {
        clouds: true,
        normals: true,
        air: None,
    };
    let paper = EarthVariant {
        form: BLOCKS,
        output: EarthOutput::Picture(
            ShadingVariant::Paper(layers),
            TargetColor::Display(Tone::Neutral),
        ),
        parts: false,
    };
    for name in [
        "struct Light",
        "displayed",
        "dither",
        "fresnel",
        "encode_srgb",
        "decode_srgb",
    ] {
        assert!(!code(paper).contains(name), "{name}");
    }
}

/// A float target gets light: nothing of how it is shown is in its shader, but the exposure where it is developed after the pass. Else there
/// is one curve at most.
#[test]
fn a_target_of_light_is_not_exposed() {
    let layers = SunlitLayers::default();
    let text = |target| {
        code(EarthVariant {
            form: BLOCKS,
            output: EarthOutput::Picture(ShadingVariant::Sunlit(layers), target),
            parts: false,
        })
    };
    let curves = ["fn camera", "fn neutral", "fn filmic", "fn agx"];
    for target in TargetColor::all() {
        let text = text(target);
        let is_exposed = target != TargetColor::Radiance;
        assert_eq!(text.contains("* exposure"), is_exposed, "{target:?}");
        let is_shown = target.tone().is_some();
        assert_eq!(text.contains("fn dither"), is_shown, "{target:?}");
        let found = curves.iter().filter(|curve| text.contains(**curve)).count();
        let wanted = target.tone().is_some_and(|tone| tone != Tone::Linear);
        assert_eq!(found, usize::from(wanted), "{target:?}");
        let encodes = matches!(target, TargetColor::Display(_));
        assert_eq!(text.contains("encode_srgb"), encodes, "{target:?}");
    }
}

/// The last pass has what is on, and nothing of the rest.
#[test]
fn development_has_what_is_on_alone() {
    for variant in DevelopVariant::all() {
        let text = variant.source().unwrap().text;
        for (word, is_on) in [
            ("fn responded", variant.measured),
            ("ResponseSamples", variant.measured),
            ("mat3x3f(grade", variant.balanced),
            ("fn grain_noise", variant.grained),
            ("GradeUniforms", variant.is_graded()),
        ] {
            assert_eq!(text.contains(word), is_on, "{}: {word}", variant.name());
        }
    }
}

/// From outside the air tables are read, from inside the sky view; neither has the other's bindings.
#[test]
fn an_eye_on_one_side_of_the_air_has_nothing_of_the_other() {
    let of = |air| {
        let layers = SunlitLayers {
            air: Some(air),
            // Its octaves are a loop.
            effects: EFFECTS.without(LightEffect::Detail),
            // It looks along the ray for the shadow.
            eclipse: false,
            interpolated: false,
            open_sea: false,
            ..LAYERS
        };
        code(sunlit(BLOCKS, layers))
    };
    let (outside, inside) = (of(AirSide::Outside), of(AirSide::Inside));
    for name in ["scattering_table", "through_table", "acos(cosine)"] {
        assert!(outside.contains(name) && !inside.contains(name), "{name}");
    }
    for name in ["black_view", "view_column", "limb_tangent"] {
        assert!(inside.contains(name) && !outside.contains(name), "{name}");
    }
    for name in ["for (", "AIR_SCALE_HEIGHT"] {
        let is_there = outside.contains(name) || inside.contains(name);
        assert!(!is_there, "no marching for each pixel, no relief: {name}");
    }
}

/// Lines, marks and fills: each has its own text and nothing of the others.
#[test]
fn a_kind_of_track_brings_no_other() {
    let structs = [
        "struct Segment",
        "struct MarkInstance",
        "struct FillInstance",
        "struct TriangleInstance",
    ];
    for variant in TracksVariant::all() {
        let text = variant.source().unwrap().text;
        let own = structs.iter().filter(|name| text.contains(*name));
        assert_eq!(own.count(), 1, "{}", variant.name());
        // Both kinds of lines have the first.
        let of_kind = structs[(variant.kind as usize).saturating_sub(1)];
        assert!(text.contains(of_kind), "{}", variant.name());
    }
}
