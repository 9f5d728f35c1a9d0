//! Pixels of a cube, compared with an independent projection and shading.

use super::*;
use crate::backends::compile_for_every_backend;
use crate::offscreen::OffscreenRenderer;
use crate::scene::Scene;
use pipelines::ModelShader;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fs;
use std::mem::offset_of;
use std::path::Path;
use std::time::Duration;
use terrella::OffscreenEarth;
use terrella::frames::Epoch;
use terrella::internals::gpu::TargetColor;
use uniforms::ModelMaterial;

#[path = "tests_parts.rs"]
mod parts;

/// Half the side of the cube, metres.
const HALF_M: f64 = 1.0;
const SIZE: (u32, u32) = (96, 64);
const FOV_RAD: f64 = 0.4;

/// A cube about the origin as a GLB.
fn cube(material: Value) -> Vec<u8> {
    let (buffer, document) = cube_parts(material);
    glb(&document, &buffer)
}

fn cube_parts(material: Value) -> (Vec<u8>, Value) {
    let mut buffer = Vec::new();
    for corner in 0..8 {
        for axis in 0..3 {
            let side = if corner >> axis & 1 == 1 {
                HALF_M
            } else {
                -HALF_M
            };
            buffer.extend((side as f32).to_le_bytes());
        }
    }
    // Corners by bits x, y, z; counter-clockwise from outside.
    for face in [
        [1, 3, 7, 5],
        [0, 4, 6, 2],
        [2, 6, 7, 3],
        [0, 1, 5, 4],
        [4, 5, 7, 6],
        [0, 2, 3, 1],
    ] {
        for at in [0, 1, 2, 0, 2, 3] {
            let corner: u16 = face[at];
            buffer.extend(corner.to_le_bytes());
        }
    }
    let document = json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "Cube", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [material],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 72},
        ],
        "buffers": [{"byteLength": buffer.len()}],
    });
    (buffer, document)
}

fn glb(document: &Value, buffer: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    let word = |file: &mut Vec<u8>, n: usize| file.extend((n as u32).to_le_bytes());
    word(&mut file, 2);
    word(&mut file, 28 + text.len() + buffer.len());
    word(&mut file, text.len());
    file.extend(b"JSON");
    file.extend(&text);
    word(&mut file, buffer.len());
    file.extend(b"BIN\0");
    file.extend(buffer);
    file
}

/// An image of a cube in low orbit over the equator: its light, and its inputs.
struct Seen {
    light: Vec<[f32; 4]>,
    pose: CraftPose,
    view: EyeView,
    sun: DVec3,
    disc: EarthDisc,
}

/// `eye_m` is where the eye is from the cube, in the axes of the craft; it looks at the middle.
fn seen(material: Value, keys: &str, hour: u8, eye_m: DVec3) -> Seen {
    seen_model(&cube(material), keys, hour, eye_m)
}

/// The same of the file of another model.
fn seen_model(file: &[u8], keys: &str, hour: u8, eye_m: DVec3) -> Seen {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("cube.glb"), file).expect("writes");
    let text = format!(
        "[time]\nstart = \"2018-03-20T{hour:02}:00:00Z\"\nduration_s = 10\n[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\n\
         model = \"cube.glb\"\n{keys}\n[camera]\nmode = \"chase\"\n[sky]\nstars = false\nsun = false\nmoon = false\n"
    );
    let scene = Scene::from_toml(&text, &folder.path().join("a.toml")).expect("a scene");
    let epoch: Epoch = scene.time.start;
    let flight = Flight::open(scene).expect("opens");
    let gpu = OffscreenEarth::open_gpu(None).expect("an adapter");
    let options = flight.uploaded_options(&gpu).expect("maps");
    let mut renderer = OffscreenRenderer::open_for_light(gpu, options, SIZE).expect("opens");
    renderer.show_models(&flight).expect("a model");
    let aspect = renderer.aspect();
    let moment = flight.at(epoch, aspect).expect("known");
    let pose = moment.craft.expect("the chase camera looks at it");
    let offset = pose.itrf_from_craft * eye_m;
    let forward = -offset.normalize();
    let up = pose.itrf_from_craft * DVec3::NEG_Z;
    let up = (up - up.dot(forward) * forward).normalize();
    let view = EyeView::itrf(pose.position_itrf_m + offset, forward, up, FOV_RAD, aspect);
    // With the scene's own camera the pose is that of the followed satellite; with another the layer computes it.
    let shot = Moment {
        view,
        craft: None,
        ..moment
    };
    renderer.draw_complete(&shot, Duration::ZERO);
    let albedo = renderer.earth().neighbourhood_albedo();
    let albedo = albedo.texels(&[true; MAP_LAYERS]);
    let (sun, ellipsoid) = (moment.sky.sun_itrf, flight.ellipsoid());
    Seen {
        disc: EarthDisc::seen_from(pose.position_itrf_m, ellipsoid, sun, &albedo),
        light: renderer.read_light().expect("reads"),
        pose,
        view,
        sun,
    }
}

impl Seen {
    /// The ray of a place on the picture, pixels, in the axes of the craft: from the eye, not of unit length.
    fn ray(&self, x_px: f64, y_px: f64) -> (DVec3, DVec3) {
        let (eye_itrf_m, _) = self.view.to_itrf();
        let craft_from_itrf = self.pose.itrf_from_craft.transpose();
        let eye = craft_from_itrf * (eye_itrf_m - self.pose.position_itrf_m);
        let forward = -eye.normalize();
        let right = forward.cross(DVec3::NEG_Z).normalize();
        let up = right.cross(forward);
        let (width, height) = (f64::from(SIZE.0), f64::from(SIZE.1));
        let half = (0.5 * FOV_RAD).tan();
        let x = (2.0 * x_px / width - 1.0) * half * width / height;
        let y = (1.0 - 2.0 * y_px / height) * half;
        (eye, forward + x * right + y * up)
    }

    /// First intersection of the ray with the cube, and the normal there.
    fn meets(&self, x_px: f64, y_px: f64, half_m: f64) -> Option<(DVec3, DVec3)> {
        let (eye, ray) = self.ray(x_px, y_px);
        let (mut enter, mut leave, mut normal) = (f64::NEG_INFINITY, f64::INFINITY, DVec3::ZERO);
        for axis in 0..3 {
            let near = (-half_m * ray[axis].signum() - eye[axis]) / ray[axis];
            let far = (half_m * ray[axis].signum() - eye[axis]) / ray[axis];
            if near > enter {
                enter = near;
                normal = DVec3::ZERO;
                normal[axis] = -ray[axis].signum();
            }
            leave = leave.min(far);
        }
        (enter < leave).then(|| (eye + enter * ray, normal))
    }

    /// Pixels that the cube fills by the middle of a face, or not at all; those at its edges are left out.
    fn inner(&self, half_m: f64) -> Vec<(usize, Option<(DVec3, DVec3)>)> {
        let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let near = pixels.filter_map(|(x, y)| {
            let (x_px, y_px) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let middle = self.meets(x_px, y_px, half_m);
            let of = |hit: Option<(DVec3, DVec3)>| hit.map(|(_, normal)| normal);
            let around = [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)];
            let is_inner = around
                .iter()
                .all(|(dx, dy)| of(self.meets(x_px + dx, y_px + dy, half_m)) == of(middle));
            is_inner.then_some(((y * SIZE.0 + x) as usize, middle))
        });
        near.collect()
    }
}

fn lamp() -> Value {
    json!({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [1, 0, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 100.0}}})
}

/// The cube shines red: where it is, and nowhere else.
#[test]
fn a_cube_covers_the_pixels_that_its_projection_does() {
    for (eye_m, keys, half_m) in [
        (DVec3::new(9.0, -5.0, 7.0), "", HALF_M),
        (
            DVec3::new(-8.0, 2.0, -9.0),
            "model_scale = 1.5",
            1.5 * HALF_M,
        ),
        (
            DVec3::new(6_000.0, -3_000.0, -2_000.0),
            "model_scale = 500",
            500.0 * HALF_M,
        ),
    ] {
        let seen = seen(lamp(), keys, 12, eye_m);
        let mut covered = 0;
        for (at, hit) in seen.inner(half_m) {
            let is_red = seen.light[at][0] > 50.0;
            assert_eq!(is_red, hit.is_some(), "{eye_m} {at}: {:?}", seen.light[at]);
            covered += u32::from(is_red);
        }
        assert!(covered > 300, "{covered} pixels");
    }
}

/// At 300 km a cube of two metres is a hundredth of a pixel; it is drawn at the least length of its key.
#[test]
fn from_afar_a_model_is_as_long_as_its_key_says() {
    let eye_m = DVec3::new(-300_000.0, 1.0, -1.0);
    let count = |keys: &str| {
        let seen = seen(lamp(), keys, 12, eye_m);
        let is_red = |texel: &&[f32; 4]| texel[0] > 50.0 && texel[1] < 5.0;
        seen.light.iter().filter(is_red).count()
    };
    assert_eq!(count(""), 0);
    let side_px = (count("model_length_px = 20") as f64).sqrt();
    // 20 pixels at its middle; of its near side, half a length before that, more.
    let half_m = 10.0 / (0.5 * f64::from(SIZE.1) / (0.5 * FOV_RAD).tan()) * -eye_m.x;
    let near_px = 20.0 * -eye_m.x / (-eye_m.x - half_m);
    assert!((side_px - near_px).abs() < 1.0, "{side_px} {near_px}");
}

/// Appendix B of the glTF specification in its own notation, with G = 1/(1 + Λ(V) + Λ(L)) (Heitz 2014, equation 99); light of a white
/// sheet is 1.
fn sunlit(base: f64, roughness: f64, n: DVec3, v: DVec3, l: DVec3) -> f64 {
    let a2 = roughness.powi(4);
    let h = (v + l).normalize();
    let tan2 = |w: DVec3| 1.0 / n.dot(w).powi(2) - 1.0;
    let lambda = |w: DVec3| ((1.0 + a2 * tan2(w)).sqrt() - 1.0) / 2.0;
    // D = 1/(π α² cos⁴ (1 + tan²/α²)²).
    let d = 1.0 / (PI * a2 * n.dot(h).powi(4) * (1.0 + tan2(h) / a2).powi(2));
    let g = 1.0 / (1.0 + lambda(v) + lambda(l));
    let f = 0.04 + 0.96 * (1.0 - v.dot(h)).powi(5);
    let specular = f * d * g / (4.0 * n.dot(v) * n.dot(l));
    let diffuse = (1.0 - f) * base / PI;
    PI * (diffuse + specular) * n.dot(l)
}

#[test]
fn each_face_has_the_light_of_the_formulas() {
    // The eye sees three faces of which some are towards the Sun and some are not.
    let (mut lit, mut dark) = (0, 0);
    for (roughness, eye_m) in [
        (1.0, DVec3::new(9.0, -5.0, -7.0)),
        (0.5, DVec3::new(-9.0, 6.0, 7.0)),
    ] {
        let material = json!({"pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "roughnessFactor": roughness,
        }});
        let seen = seen(material, "model_axes = \"body\"", 10, eye_m);
        let craft_from_itrf = seen.pose.itrf_from_craft.transpose();
        let l = craft_from_itrf * seen.sun;
        let down = (craft_from_itrf * -seen.pose.position_itrf_m).normalize();
        for (at, hit) in seen.inner(HALF_M) {
            let Some((place, n)) = hit else { continue };
            let v = (eye_m - place).normalize();
            let sun = match n.dot(l) > 0.0 {
                true => seen.pose.sunlight * sunlit(0.5, roughness, n, v, l),
                false => 0.0,
            };
            let k = earth_light::tests::integrated(n.dot(down), seen.disc.limb_sine, 60);
            for channel in 0..3 {
                let earth = f64::from(seen.disc.light[channel]);
                let got = f64::from(seen.light[at][channel]);
                let expected = sun + 0.5 * k * earth;
                // The Earth's image in the face is at most its reflectance, which is low but at grazing angles.
                let image = 0.12 * earth;
                assert!(
                    got > expected * 0.995 - 1e-3 && got < expected * 1.005 + image + 1e-3,
                    "{at} {channel} {n}: {got}, not {expected} ({sun} of the Sun)"
                );
            }
            match sun > 0.0 {
                true => lit += 1,
                false => dark += 1,
            }
        }
    }
    assert!(lit > 300 && dark > 100, "{lit} {dark}");
}

/// With −z towards the Sun, that side of a cube is fully lit: N·L is one.
#[test]
fn a_model_is_turned_as_its_attitude_says() {
    let white = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, 1]}});
    let eye_m = DVec3::new(1.0, -0.5, -12.0);
    let keys = "attitude = \"sun\"\nmodel_axes = \"body\"";
    let seen = seen(white, keys, 10, eye_m);
    assert!((seen.pose.itrf_from_craft.z_axis + seen.sun).length() < 1e-9);
    let (mut count, n) = (0, DVec3::NEG_Z);
    for (at, hit) in seen.inner(HALF_M) {
        let Some((place, normal)) = hit.filter(|(_, normal)| *normal == n) else {
            continue;
        };
        assert_eq!(normal, n);
        let expected = sunlit(0.5, 1.0, n, (eye_m - place).normalize(), n);
        let got = f64::from(seen.light[at][0]);
        assert!((got - expected).abs() < 0.1, "{at}: {got} {expected}");
        count += 1;
    }
    assert!(count > 200, "{count}");
}

#[test]
fn an_attitude_that_a_file_does_not_have_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = "# frame = GCRF\nepoch_utc,qx,qy,qz,qw\n2018-03-20T10:00:00Z,0,0,0,1\n2018-03-20T10:01:00Z,0,0,1,0\n";
    fs::write(folder.path().join("a.csv"), table).expect("writes");
    let open = |start: &str| {
        let text = format!(
            "[time]\nstart = \"2018-03-20T{start}Z\"\nduration_s = 30\n[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\n\
             attitude_file = \"a.csv\"\n[camera]\nmode = \"chase\"\n"
        );
        let scene = Scene::from_toml(&text, &folder.path().join("a.toml")).expect("a scene");
        Flight::open(scene)
    };
    let flight = open("10:00:20").expect("known");
    let epoch = flight.scene().time.start;
    let pose = flight.at(epoch, 1.5).expect("known").craft.expect("chased");
    // 60° about the pole of GCRF.
    let gcrf = Sky::at(epoch).itrf_from_gcrf.expect("a date");
    let expected = gcrf * DMat3::from_rotation_z(PI / 3.0);
    assert!((pose.itrf_from_craft * DVec3::X - expected * DVec3::X).length() < 1e-9);
    for start in ["10:00:50", "09:59:00"] {
        let error = open(start).err().expect("unknown").to_string();
        assert!(
            error.contains("a.csv: the attitude is not known at"),
            "{error}"
        );
    }
    let late = epoch + terrella::frames::Duration::from_seconds(100.0);
    assert!(flight.at(late, 1.5).is_err());
}

/// Over midnight the Earth hides the Sun, and its own side is dark.
#[test]
fn in_the_shadow_of_the_earth_a_model_is_dark() {
    let white = json!({"pbrMetallicRoughness": {"metallicFactor": 0}});
    let seen = seen(
        white,
        "true_anomaly_deg = 180",
        12,
        DVec3::new(9.0, -5.0, -7.0),
    );
    assert_eq!(seen.pose.sunlight, 0.0);
    for (at, hit) in seen.inner(HALF_M) {
        if hit.is_some() {
            assert!(seen.light[at][0] < 1e-3, "{:?}", seen.light[at]);
        }
    }
}

#[test]
fn the_axes_of_gltf_lie_as_the_key_says() {
    let turn = body_from_model(ModelAxes::Gltf);
    // Forward, up, and the left side, which is +X in glTF.
    assert_eq!(turn * DVec3::Z, DVec3::X);
    assert_eq!(turn * DVec3::Y, DVec3::NEG_Z);
    assert_eq!(turn * DVec3::X, DVec3::NEG_Y);
    assert_eq!(turn.determinant(), 1.0);
}

#[test]
fn a_scene_without_models_has_no_layer() {
    let text = "[camera]\nmode = \"geodetic\"\n[sky]\nstars = false\nmoon = false\n";
    let scene = Scene::from_toml(text, Path::new("a.toml")).expect("a scene");
    let flight = Flight::open(scene).expect("opens");
    assert!(flight.craft_models().models().is_empty());
}

#[test]
fn every_backend_takes_the_shader_and_its_structs_are_ours() {
    let all = TargetColor::all().into_iter();
    for (target, shader) in all.flat_map(|target| ModelShader::all().map(|shader| (target, shader)))
    {
        let text = shader.text(target).expect("its files are there");
        let module = compile_for_every_backend(&text.text);
        let members = |name: &str| {
            let mut structs = module.types.iter().map(|(_, ty)| ty);
            let found = structs.find(|ty| ty.name.as_deref() == Some(name));
            let Some(naga::TypeInner::Struct { members, span }) = found.map(|ty| &ty.inner) else {
                panic!("no struct {name}");
            };
            let members = members.iter();
            let offsets = members.map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
            (offsets.collect::<Vec<_>>(), *span as usize)
        };
        macro_rules! ours {
            ($ours:ty: $($member:ident),*) => {(
                vec![$((stringify!($member).to_owned(), offset_of!($ours, $member))),*],
                size_of::<$ours>(),
            )};
        }
        assert_eq!(
            members("ModelFrame"),
            ours!(ModelFrame: clip_from_model, sun, sunlight, moon, moonlight, eye, exposure, down, limb_sine, earth_light, padding)
        );
        assert_eq!(
            members("ModelMaterial"),
            ours!(ModelMaterial: base_color, emissive, metallic, roughness, alpha_cutoff, normal_scale, padding)
        );
    }
}
