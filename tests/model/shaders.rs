//! Every shader variant compiles, its structs match Rust's, and a feature that is off is not in the text.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::mem::offset_of;
use terrella::globe::projected_grid::{GridLevel, GridUniforms};
use terrella::gpu::{
    AIR_SHADER, AirUniforms as AirFrame, EARTH_SHADER, FrameUniforms as Frame,
    PROJECTED_GRID_SHADER, ShaderVariant, TRACKS_SHADER, TrackUniforms as TrackFrame,
};

fn module(variant: &ShaderVariant) -> Result<naga::Module, String> {
    let source = variant.source().map_err(|e| e.to_string())?;
    let module = naga::front::wgsl::parse_str(&source).map_err(|e| e.emit_to_string(&source))?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| e.emit_to_string(&source))?;
    Ok(module)
}

/// All combinations of `features`.
fn variants(file: &'static str, features: &[&'static str]) -> Vec<ShaderVariant> {
    (0..1_u32 << features.len())
        .map(|bits| {
            let flags: Vec<_> = features
                .iter()
                .enumerate()
                .map(|(k, name)| (*name, bits >> k & 1 == 1))
                .collect();
            ShaderVariant::new(file, &flags)
        })
        .collect()
}

#[test]
fn every_variant_compiles() {
    let mut all = variants(
        EARTH_SHADER,
        &[
            "paper",
            "clouds",
            "normals",
            "night_lights",
            "water",
            "tiles",
            "air",
            "encode",
            "decode",
            "places",
            "relief",
        ],
    );
    all.extend(variants(
        AIR_SHADER,
        &["inside", "depth", "standard_z", "encode"],
    ));
    all.extend(variants(TRACKS_SHADER, &["marks", "fill", "encode"]));
    all.push(ShaderVariant::new(PROJECTED_GRID_SHADER, &[]));
    // The grid is relief of another vertex stage: with what reaches that stage or what it gives.
    let with = ["paper", "normals", "tiles", "air", "places"];
    all.extend(variants(EARTH_SHADER, &with).into_iter().map(|variant| {
        let on = variant.features.iter().map(|name| (*name, true));
        let on: Vec<_> = on.chain([("relief", true), ("grid", true)]).collect();
        ShaderVariant::new(EARTH_SHADER, &on)
    }));
    // Triangles that lie in several blocks, where these have tiles.
    let with = [
        "paper",
        "clouds",
        "normals",
        "night_lights",
        "water",
        "places",
        "grid",
    ];
    all.extend(variants(EARTH_SHADER, &with).into_iter().map(|variant| {
        let on = variant.features.iter().map(|name| (*name, true));
        let needs = [("relief", true), ("tiles", true), ("crossing", true)];
        let on: Vec<_> = on.chain(needs).collect();
        ShaderVariant::new(EARTH_SHADER, &on)
    }));
    // So are contours that rays are cast at, of another fragment stage too.
    let with = ["paper", "normals", "tiles", "air", "places", "depth"];
    all.extend(variants(EARTH_SHADER, &with).into_iter().map(|variant| {
        let on = variant.features.iter().map(|name| (*name, true));
        let on: Vec<_> = on.chain([("relief", true), ("cast", true)]).collect();
        ShaderVariant::new(EARTH_SHADER, &on)
    }));
    let failures: Vec<_> = all
        .iter()
        .filter_map(|variant| {
            module(variant)
                .err()
                .map(|error| format!("{}:\n{error}", variant.name()))
        })
        .collect();
    assert!(
        failures.is_empty(),
        "{} of {} variants:\n{}",
        failures.len(),
        all.len(),
        failures.join("\n")
    );
    println!("{} variants compiled", all.len());
}

#[test]
fn a_layer_that_is_off_is_not_in_the_shader() {
    let words = [
        ("clouds", ["cloud", "CLOUD"]),
        ("normals", ["slope_map", "NORMALS"]),
        ("night_lights", ["light_map", "LAMP_COLOR"]),
        ("water", ["water_map", "glint"]),
        ("tiles", ["placements", "block"]),
        ("air", ["sunlight", "table_"]),
        ("relief", ["origin_from_anchor_m", "height_m"]),
    ];
    let code = |source: String| -> String {
        source
            .lines()
            .map(|line| line.split("//").next().unwrap_or_default())
            .collect::<Vec<_>>()
            .join("\n")
    };
    let minimal = code(ShaderVariant::new(EARTH_SHADER, &[]).source().unwrap());
    let bindings = minimal.matches("@binding").count();
    assert_eq!(bindings, 3, "frame, sampler and day map:\n{minimal}");
    for (feature, names) in words {
        let with = code(
            ShaderVariant::new(EARTH_SHADER, &[(feature, true)])
                .source()
                .unwrap(),
        );
        let without = code(
            ShaderVariant::new(
                EARTH_SHADER,
                &[
                    "clouds",
                    "normals",
                    "night_lights",
                    "water",
                    "tiles",
                    "air",
                    "relief",
                ]
                .map(|f| (f, f != feature)),
            )
            .source()
            .unwrap(),
        );
        assert!(
            with.contains(names[0]),
            "{feature} on must be in the text, or this test cannot fail"
        );
        assert!(with.len() > minimal.len());
        for name in names {
            assert!(
                !without.contains(name),
                "{feature} is off but the shader mentions {name}"
            );
            assert!(
                !minimal.contains(name),
                "{feature} is off but the shader mentions {name}"
            );
        }
    }
}

#[test]
fn ground_of_patches_has_nothing_of_the_grid() {
    let text = |grid| {
        let features = [("relief", true), ("tiles", true), ("grid", grid)];
        ShaderVariant::new(EARTH_SHADER, &features)
            .source()
            .unwrap()
    };
    let bindings = |text: &str| text.matches("@binding(").count();
    let (with, without) = (text(true), text(false));
    for name in [
        "ground_point",
        "height_tiles",
        "GridUniforms",
        "vertex_index",
    ] {
        assert!(with.contains(name) && !without.contains(name), "{name}");
    }
    assert!(!with.contains("BlockVertex"), "no vertex buffer");
    // Comments name bindings by number only.
    assert_eq!(bindings(&with), bindings(&without) + 2);
}

#[test]
fn ground_of_patches_casts_no_rays() {
    let text = |cast, depth| {
        let features = [("relief", true), ("cast", cast), ("depth", depth)];
        ShaderVariant::new(EARTH_SHADER, &features)
            .source()
            .unwrap()
    };
    let (with, without) = (text(true, true), text(false, false));
    for name in ["contour_cast", "contour_nodes", "frag_depth", "discard"] {
        assert!(with.contains(name) && !without.contains(name), "{name}");
    }
    assert!(!with.contains("from_origin_m: vec3f,\n    @location(5) height_m"));
    assert!(!text(true, false).contains("frag_depth"), "no depth buffer");
}

#[test]
fn a_picture_s_shader_draws_no_places() {
    let text = |places| {
        let variant = ShaderVariant::new(EARTH_SHADER, &[("places", places)]);
        variant.source().unwrap()
    };
    let places = "vec4f(at.uv, at.center_uv)";
    assert!(text(true).contains(places) && !text(false).contains(places));
}

/// Lines, marks and fills: each has its own text and nothing of the others.
#[test]
fn a_kind_of_track_brings_no_other() {
    let text = |features: &[_]| {
        ShaderVariant::new(TRACKS_SHADER, features)
            .source()
            .unwrap()
    };
    let kinds = [
        (text(&[]), "struct Segment"),
        (text(&[("marks", true)]), "struct MarkInstance"),
        (text(&[("fill", true)]), "struct FillInstance"),
    ];
    for (k, (text, _)) in kinds.iter().enumerate() {
        for (other, (_, word)) in kinds.iter().enumerate() {
            assert_eq!(text.contains(word), k == other, "{word} in text {k}");
        }
    }
}

/// Member offsets and size of a struct as naga lays it out.
fn reflected(variant: &ShaderVariant, name: &str) -> (Vec<(String, usize)>, usize) {
    let module = module(variant).unwrap();
    let (_, ty) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name))
        .expect("struct in shader");
    let naga::TypeInner::Struct { members, span } = &ty.inner else {
        panic!("{name} is not a struct")
    };
    let members = members
        .iter()
        .map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize))
        .collect();
    (members, *span as usize)
}

#[test]
fn uniform_structs_match_the_shaders() {
    macro_rules! check {
        ($variant:expr, $ty:ident, [$($member:ident),* $(,)?]) => {{
            let (members, span) = reflected(&$variant, stringify!($ty));
            let ours = vec![$((stringify!($member).to_owned(), offset_of!($ty, $member))),*];
            // Padding stands only on the Rust side or on both; every named member must agree.
            let ours: Vec<_> = ours.into_iter().filter(|(name, _)| name != "padding").collect();
            let members: Vec<_> = members.into_iter().filter(|(name, _)| name != "padding").collect();
            assert_eq!(members, ours);
            assert_eq!(span, size_of::<$ty>(), "size of {}", stringify!($ty));
        }};
    }
    check!(
        ShaderVariant::new(EARTH_SHADER, &[]),
        Frame,
        [
            clip_from_eye,
            eye_scaled,
            above,
            sun_itrf,
            radius_m,
            corner_ray,
            polar_stretch,
            pixel_right,
            exposure,
            pixel_down,
            air_below
        ]
    );
    for features in [&[][..], &[("marks", true)], &[("fill", true)]] {
        check!(
            ShaderVariant::new(TRACKS_SHADER, features),
            TrackFrame,
            [frame, size_px, air_top, side]
        );
    }
    check!(
        ShaderVariant::new(AIR_SHADER, &[]),
        AirFrame,
        [
            clip_from_billboard,
            sun,
            eye_distance,
            top,
            eye_height,
            exposure,
            depth_rounding
        ]
    );
    let grid = ShaderVariant::new(PROJECTED_GRID_SHADER, &[]);
    check!(
        grid,
        GridLevel,
        [eye_cells, per_radian, period, size, padding]
    );
    check!(
        grid,
        GridUniforms,
        [
            forward, corner, middle, corner_rad, right, cell_area, screen_up, longer, eye_up,
            limb_rad, eye_normal, sin_limb, to_base_m, cos_limb, radii_m, base_m, eye_lon, low,
            step, samples, near_rad, far_rad, spread_rad, eye_lat, center_lat, center_uv, levels,
            slots
        ]
    );
}
