//! Parts that turn, transparency and normal maps: pixels against a projection, a composition and formulas.

use super::*;

const EYE_M: DVec3 = DVec3::new(9.0, -5.0, -7.0);

/// A cube that turns by 30° about its own z, which is z of the craft, covers the pixels of a turned cube.
#[test]
fn a_node_that_is_turned_is_seen_turned() {
    let turned = |turn: &str| {
        let keys = format!(
            "model_axes = \"body\"\narticulations = [{{ node = \"Cube\", axis = [0, 0, 3], {turn} }}]"
        );
        seen(lamp(), &keys, 12, EYE_M)
    };
    for (turn, degrees) in [("angle_deg = 30", 30.0_f64), ("angle_deg = 0", 0.0)] {
        let seen = turned(turn);
        let model_from_craft = DMat3::from_rotation_z(-degrees.to_radians());
        let hits = |x_px: f64, y_px: f64| {
            let (eye, ray) = seen.ray(x_px, y_px);
            let (eye, ray) = (model_from_craft * eye, model_from_craft * ray);
            let mut range = [f64::NEG_INFINITY, f64::INFINITY];
            for axis in 0..3 {
                let ends = [-HALF_M, HALF_M].map(|side| (side - eye[axis]) / ray[axis]);
                range[0] = range[0].max(ends[0].min(ends[1]));
                range[1] = range[1].min(ends[0].max(ends[1]));
            }
            range[0] < range[1]
        };
        let mut covered = 0;
        for (y, x) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (y, x))) {
            let (x_px, y_px) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let expected = hits(x_px, y_px);
            let around = [(0.05, 0.0), (-0.05, 0.0), (0.0, 0.05), (0.0, -0.05)];
            if around
                .iter()
                .any(|(dx, dy)| hits(x_px + dx, y_px + dy) != expected)
            {
                continue;
            }
            let light = seen.light[(y * SIZE.0 + x) as usize];
            assert_eq!(light[0] > 50.0, expected, "{turn}: {x} {y} {light:?}");
            covered += u32::from(expected);
        }
        assert!(covered > 300, "{covered}");
    }
}

/// With its normal to the Sun a face of the cube is as bright as a sheet that faces it, and the craft flies level.
#[test]
fn a_node_that_tracks_the_sun_is_lit_squarely() {
    let white = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, 1]}});
    // In March the Sun stands over the equator, and so does the orbit: an axis along z of GCRF, y of the craft, lets the face see it whole.
    let keys = "true_anomaly_deg = 40\nmodel_axes = \"body\"\narticulations = [{ node = \"Cube\", axis = [0, 1, 0], track = \"sun\", normal = [0, 0, -1] }]";
    let seen = seen(white, keys, 10, DVec3::new(1.0, -0.5, -12.0));
    let sun = seen.pose.itrf_from_craft.transpose() * seen.sun;
    // Off the plane of the turn by the Sun's declination.
    let squarely = sun.reject_from_normalized(DVec3::Y).length();
    assert!(squarely > 0.999 && sun.z > -0.9, "{sun}");
    let normal = sun.reject_from_normalized(DVec3::Y).normalize();
    let (eye, _) = seen.ray(0.0, 0.0);
    let mut count = 0;
    for (y, x) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (y, x))) {
        let (_, ray) = seen.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let along = (HALF_M - normal.dot(eye)) / normal.dot(ray);
        let place = eye + along * ray;
        let beside = normal.cross(DVec3::Y);
        let is_inner = place.dot(beside).abs() < 0.9 && place.y.abs() < 0.9;
        if normal.dot(ray) < 0.0 && is_inner {
            let expected = sunlit(0.5, 1.0, normal, -ray.normalize(), sun);
            let got = f64::from(seen.light[(y * SIZE.0 + x) as usize][0]);
            assert!((got - expected).abs() < 0.1, "{x} {y}: {got} {expected}");
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn a_node_that_the_model_does_not_have_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("cube.glb"), cube(lamp())).expect("writes");
    let text = "[orbit]\nmodel = \"cube.glb\"\narticulations = [{ node = \"Wing\", axis = [0, 1, 0], angle_deg = 1 }]\n";
    let scene = Scene::from_toml(text, &folder.path().join("a.toml")).expect("a scene");
    let error = Flight::open(scene).err().expect("no such node").to_string();
    assert!(
        error.contains("cube.glb")
            && error.contains("no node \"Wing\"")
            && error.contains("\"Cube\""),
        "{error}"
    );
}

/// A cube that covers a quarter of what is behind it: a quarter of the light of the opaque one, three quarters of that without it. One whose
/// alpha lies below its cutoff is not there, one above it is opaque.
#[test]
fn a_surface_covers_what_is_behind_it_by_its_alpha() {
    let material = |alpha: f64, mode: &str| json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, alpha], "metallicFactor": 0}, "alphaMode": mode});
    // The Earth lies behind some of the cube, and space behind the rest.
    let eye_m = DVec3::new(-10.0, 3.0, -4.5);
    let light = |material: Value, keys: &str| seen(material, keys, 10, eye_m);
    let opaque = light(material(1.0, "OPAQUE"), "");
    let without = light(material(1.0, "OPAQUE"), "model_scale = 1e-6");
    let quarter = light(material(0.25, "BLEND"), "");
    let masked = light(material(0.25, "MASK"), "");
    let kept = light(material(0.75, "MASK"), "");
    let (mut inside, mut before_earth) = (0, 0);
    for (at, hit) in opaque.inner(HALF_M) {
        for channel in 0..3 {
            let of = |seen: &Seen| f64::from(seen.light[at][channel]);
            let expected = match hit {
                Some(_) => 0.25 * of(&opaque) + 0.75 * of(&without),
                None => of(&without),
            };
            let near = |got: f64, expected: f64| (got - expected).abs() < 2e-3 * expected + 1e-4;
            assert!(
                near(of(&quarter), expected),
                "{at}: {} {expected}",
                of(&quarter)
            );
            assert!(near(of(&masked), of(&without)), "{at} {}", of(&masked));
            assert!(near(of(&kept), of(&opaque)), "{at} {}", of(&kept));
        }
        inside += u32::from(hit.is_some());
        before_earth += u32::from(hit.is_some() && without.light[at][2] > 0.01);
    }
    assert!(
        inside > 300 && before_earth > 30 && before_earth < inside,
        "{inside} {before_earth}"
    );
}

/// A plate of 2 × 2 m at z = 0 of the model that faces −z of the craft, with texture coordinates and a normal map of one texel.
fn plate(texel: [u8; 3], tangent: Option<[f32; 4]>, mirrored: bool) -> Vec<u8> {
    let mut buffer = Vec::new();
    let mut put = |numbers: &[f32]| numbers.iter().for_each(|x| buffer.extend(x.to_le_bytes()));
    // Counter-clockwise as seen from −z; u grows along +x, or against it, and v along +y.
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0_f32]];
    corners.iter().for_each(|[x, y]| put(&[*x, *y, 0.0]));
    corners.iter().for_each(|_| put(&[0.0, 0.0, -1.0]));
    let side = if mirrored { -0.5 } else { 0.5 };
    corners
        .iter()
        .for_each(|[x, y]| put(&[0.5 + side * x, 0.5 + 0.5 * y]));
    corners
        .iter()
        .for_each(|_| put(&tangent.unwrap_or([0.0; 4])));
    for index in [0_u16, 1, 2, 0, 2, 3] {
        buffer.extend(index.to_le_bytes());
    }
    let mut picture = Vec::new();
    let mut encoder = png::Encoder::new(&mut picture, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texel).expect("a texel");
    writer.finish().expect("an end");
    let picture_at = buffer.len();
    buffer.extend(&picture);
    let mut attributes = json!({"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2});
    if tangent.is_some() {
        attributes["TANGENT"] = json!(3);
    }
    let document = json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 4, "material": 0}]}],
        "materials": [{
            "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, 1]},
            "normalTexture": {"index": 0, "scale": 0.8}, "doubleSided": true,
        }],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 5, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4"},
            {"bufferView": 4, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 48},
            {"buffer": 0, "byteOffset": 96, "byteLength": 32},
            {"buffer": 0, "byteOffset": 128, "byteLength": 64},
            {"buffer": 0, "byteOffset": 192, "byteLength": 12},
            {"buffer": 0, "byteOffset": picture_at, "byteLength": picture.len()},
        ],
        "buffers": [{"byteLength": buffer.len()}],
    });
    glb(&document, &buffer)
}

/// The plate is lit as one with the texel's normal: by the file's tangents and without, in a mirror image too.
#[test]
fn normals_of_a_texture_are_those_of_its_axes() {
    let texel = [190, 160, 220];
    let across = texel.map(|code| 2.0 * f64::from(code) / 255.0 - 1.0);
    for (tangent, mirrored) in [
        (None, false),
        (None, true),
        (Some([1.0, 0.0, 0.0, 1.0]), false),
        (Some([-1.0, 0.0, 0.0, -1.0]), true),
    ] {
        let keys = "model_axes = \"body\"\nattitude = \"sun\"";
        let file = plate(texel, tangent, mirrored);
        let seen = seen_model(&file, keys, 10, DVec3::new(3.0, -2.0, -9.0));
        let craft_from_itrf = seen.pose.itrf_from_craft.transpose();
        let l = craft_from_itrf * seen.sun;
        // x of the texel goes with u, y against v, which grows along +y.
        let u = if mirrored { DVec3::NEG_X } else { DVec3::X };
        let n = 0.8 * across[0] * u + 0.8 * across[1] * DVec3::NEG_Y + across[2] * DVec3::NEG_Z;
        let n = n.normalize();
        let flat = sunlit(0.5, 1.0, DVec3::NEG_Z, DVec3::NEG_Z, l);
        let (eye, _) = seen.ray(0.0, 0.0);
        let mut count = 0;
        for (y, x) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (y, x))) {
            let (_, ray) = seen.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let place = eye - ray * (eye.z / ray.z);
            if place.x.abs() < 0.9 && place.y.abs() < 0.9 {
                let expected = sunlit(0.5, 1.0, n, (eye - place).normalize(), l);
                assert!((expected - flat).abs() > 0.05, "{expected} {flat}");
                let got = f64::from(seen.light[(y * SIZE.0 + x) as usize][0]);
                // Besides the Sun there is a little light of the Earth.
                assert!(
                    (got - expected).abs() < 0.035,
                    "{tangent:?} {mirrored} {x} {y}: {got} {expected}"
                );
                count += 1;
            }
        }
        assert!(count > 200, "{count}");
    }
}
