//! Files made in the tests: reading of valid ones, and errors with a position for hostile ones.

use super::*;
use glam::Vec4;
use serde_json::{Value, json};
use std::fs;

/// Corners of a unit square at z = 0 and its two triangles, and a place for more.
fn square() -> (Vec<u8>, Value) {
    let mut buffer = Vec::new();
    for corner in [
        [0.0_f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ] {
        corner.iter().for_each(|x| buffer.extend(x.to_le_bytes()));
    }
    for index in [0_u16, 1, 2, 0, 2, 3] {
        buffer.extend(index.to_le_bytes());
    }
    let document = json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "buffers": [{"byteLength": buffer.len()}],
    });
    (buffer, document)
}

fn glb(document: &Value, buffer: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = Vec::new();
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend((12 + 8 + text.len() as u32 + 8 + buffer.len() as u32).to_le_bytes());
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(&text);
    file.extend((buffer.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(buffer);
    file
}

fn read(document: &Value, buffer: &[u8]) -> Result<Model, ModelError> {
    Model::of_bytes(glb(document, buffer), Path::new("a.glb"))
}

/// The error for a square that is changed at this pointer.
fn rejected(pointer: &str, value: Value) -> String {
    let (buffer, mut document) = square();
    set(&mut document, pointer, value);
    read(&document, &buffer).expect_err(pointer).to_string()
}

fn set(document: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    let parent = document.pointer_mut(parent).expect("it is there");
    match parent {
        Value::Array(all) => all[key.parse::<usize>().expect("a number")] = value,
        parent => parent[key] = value,
    }
}

#[test]
fn a_square_has_two_triangles_with_flat_normals() {
    let (buffer, document) = square();
    let model = read(&document, &buffer).expect("good");
    assert_eq!(model.vertices.len(), 6);
    assert_eq!(model.indices, [0, 1, 2, 3, 4, 5]);
    assert!(model.vertices.iter().all(|v| v.normal == Vec3::Z));
    assert_eq!(model.bounds_m, [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)]);
    assert_eq!(model.length_m(), 1.0);
    assert_eq!(model.materials, [Material::default()]);
}

#[test]
fn nodes_place_their_meshes() {
    let (buffer, mut document) = square();
    // A turn of 90° about y takes z to x; what is scaled first is turned then and moved last.
    document["nodes"] = json!([
        {"children": [1], "translation": [10.0, 0.0, 0.0]},
        {"mesh": 0, "rotation": [0.0, 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()], "scale": [2.0, 1.0, 1.0]},
    ]);
    let model = read(&document, &buffer).expect("good");
    for (vertex, expected) in
        model
            .vertices
            .iter()
            .zip([[10.0, 0.0, 0.0], [10.0, 0.0, -2.0], [10.0, 1.0, -2.0]])
    {
        assert!(
            vertex.position_m.distance(expected.into()) < 1e-6,
            "{vertex:?}"
        );
        assert!(vertex.normal.distance(Vec3::X) < 1e-6, "{vertex:?}");
    }
    // Mirrored, the same side is outside, and counter-clockwise.
    document["nodes"][1] = json!({"mesh": 0, "scale": [-1.0, 1.0, 1.0]});
    let model = read(&document, &buffer).expect("good");
    let [a, b, c] = [0, 1, 2].map(|at| model.vertices[at].position_m);
    assert!((b - a).cross(c - a).z > 0.0);
    assert_eq!(model.vertices[0].normal, Vec3::Z);
}

#[test]
fn strips_and_fans_are_the_same_square() {
    let (mut buffer, mut document) = square();
    let area = |document: &Value, buffer: &[u8]| {
        let model = read(document, buffer).expect("good");
        let corner = |at: u32| model.vertices[at as usize].position_m;
        let triangles = model.indices.chunks_exact(3);
        let areas = triangles.map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(corner);
            (b - a).cross(c - a).z / 2.0
        });
        areas.sum::<f32>()
    };
    document["accessors"][1]["count"] = json!(4);
    document["meshes"][0]["primitives"][0]["mode"] = json!(6);
    buffer.truncate(48);
    [0_u16, 1, 2, 3, 0, 0]
        .iter()
        .for_each(|i| buffer.extend(i.to_le_bytes()));
    assert_eq!(area(&document, &buffer), 1.0);
    document["meshes"][0]["primitives"][0]["mode"] = json!(5);
    buffer.truncate(48);
    [0_u16, 1, 3, 2, 0, 0]
        .iter()
        .for_each(|i| buffer.extend(i.to_le_bytes()));
    assert_eq!(area(&document, &buffer), 1.0);
}

#[test]
fn materials_have_what_the_file_says() {
    let (mut buffer, mut document) = square();
    let mut picture = Vec::new();
    let mut encoder = png::Encoder::new(&mut picture, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&[7, 8, 9]).expect("a texel");
    writer.finish().expect("an end");
    let at = buffer.len();
    buffer.extend(&picture);
    document["bufferViews"]
        .as_array_mut()
        .expect("a list")
        .push(json!({"buffer": 0, "byteOffset": at, "byteLength": picture.len()}));
    document["buffers"][0]["byteLength"] = json!(buffer.len());
    document["images"] = json!([{"bufferView": 2, "mimeType": "image/png"}]);
    document["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    document["textures"] = json!([{"source": 0, "sampler": 0}]);
    document["materials"] = json!([{
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 1.0, 1.0], "metallicFactor": 0.25, "roughnessFactor": 0.75,
            "baseColorTexture": {"index": 0},
        },
        "emissiveFactor": [0.0, 0.5, 1.0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}, "KHR_materials_clearcoat": {}},
        "normalTexture": {"index": 0, "scale": 0.25},
        "occlusionTexture": {"index": 0},
        "alphaMode": "MASK", "doubleSided": true,
    }]);
    document["extensionsUsed"] =
        json!(["KHR_materials_clearcoat", "KHR_materials_emissive_strength"]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    let model = read(&document, &buffer).expect("good");
    let texture = TextureUse {
        image: 0,
        wrap: [Wrap::Clamp, Wrap::Mirror],
    };
    assert_eq!(
        model.materials,
        [Material {
            base_color: Vec4::new(0.5, 0.25, 1.0, 1.0),
            base_color_texture: Some(texture),
            metallic: 0.25,
            roughness: 0.75,
            emissive: Vec3::new(0.0, 2.0, 4.0),
            double_sided: true,
            alpha: AlphaMode::Mask(0.5),
            normal_texture: Some(texture),
            normal_scale: 0.25,
            ..Material::default()
        }]
    );
    assert_eq!(model.images[0].rgba, [7, 8, 9, 255]);
    let ignored: Vec<_> = model.ignored.iter().map(String::as_str).collect();
    assert_eq!(
        ignored,
        ["COLOR_0", "KHR_materials_clearcoat", "occlusionTexture"]
    );
    // Sizes are looked at before texels are allocated.
    buffer[at + 16..at + 20].copy_from_slice(&1_000_000_u32.to_be_bytes());
    let error = read(&document, &buffer).expect_err("too wide").to_string();
    assert!(
        error.starts_with("a.glb at /images/0: the picture: it has 1000000 × 1 texels"),
        "{error}"
    );
}

#[test]
fn sparse_and_normalized_numbers_are_read() {
    let (mut buffer, mut document) = square();
    // Corner 2 at (0, 0, 5), by an index of one byte, and its value behind it.
    let at = buffer.len();
    buffer.extend([2_u8, 0, 0, 0]);
    [0.0_f32, 0.0, 5.0]
        .iter()
        .for_each(|x| buffer.extend(x.to_le_bytes()));
    let views = document["bufferViews"].as_array_mut().expect("a list");
    views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": 4}));
    views.push(json!({"buffer": 0, "byteOffset": at + 4, "byteLength": 12}));
    document["buffers"][0]["byteLength"] = json!(buffer.len());
    document["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3},
    });
    let model = read(&document, &buffer).expect("good");
    assert_eq!(model.bounds_m[1], Vec3::new(1.0, 1.0, 5.0));
    document["accessors"][0]["sparse"]["count"] = json!(4_000_000_000_u32);
    let error = read(&document, &buffer).expect_err("many").to_string();
    assert!(
        error.contains("/accessors/0/sparse: 4000000000 elements"),
        "{error}"
    );

    let (_, mut document) = square();
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    document["accessors"][0] = json!({"bufferView": 0, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3"});
    document["bufferViews"][0] = json!({"buffer": 0, "byteLength": 16, "byteStride": 4});
    let mut small = Vec::new();
    for corner in [
        [0_i8, 0, 0, 0],
        [127, 0, 0, 0],
        [127, -128, 0, 0],
        [0, -127, 0, 0],
    ] {
        small.extend(corner.map(|x| x as u8));
    }
    small.resize(48, 0);
    [0_u16, 1, 2, 0, 2, 3]
        .iter()
        .for_each(|i| small.extend(i.to_le_bytes()));
    let model = read(&document, &small).expect("good");
    assert_eq!(model.bounds_m, [Vec3::new(0.0, -1.0, 0.0), Vec3::X]);
}

#[test]
fn hostile_documents_are_errors_that_say_where() {
    for (pointer, value, said) in [
        (
            "/asset/version",
            json!("1.0"),
            "/asset/version: glTF version",
        ),
        (
            "/nodes",
            json!([{"children": [0]}]),
            "node 0 is reached twice",
        ),
        (
            "/nodes",
            json!([{"children": [1]}, {"children": [0]}]),
            "node 0 is reached twice",
        ),
        (
            "/nodes",
            json!([{"children": [7]}]),
            "/nodes/0: refers to node 7, and the file has 1",
        ),
        (
            "/nodes",
            json!([{"mesh": 9}]),
            "/nodes/0/mesh: refers to mesh 9",
        ),
        (
            "/nodes",
            json!([{"scale": [1e200, 1, 1], "children": [1]}, {"mesh": 0, "scale": [1e200, 1, 1]}]),
            "/nodes/1: the transform of node 1 is not finite",
        ),
        (
            "/nodes",
            json!([{"mesh": 0, "translation": [1e200, 0, 0], "scale": [1e100, 1, 1]}]),
            "has no triangles",
        ),
        (
            "/nodes",
            json!([{"mesh": 0, "scale": [1e60, 1, 1]}]),
            "the placed position 1 is not finite",
        ),
        (
            "/scenes",
            json!([{"nodes": [4]}]),
            "/scenes: refers to node 4",
        ),
        (
            "/accessors/0/count",
            json!(4_000_000_000_u32),
            "4000000000 vertices; a model has at most",
        ),
        (
            "/accessors/0/count",
            json!(5),
            "/accessors/0: needs 60 bytes of a buffer view, which has 48",
        ),
        (
            "/accessors/1/count",
            json!(u64::MAX),
            "indices; a model has at most",
        ),
        (
            "/accessors/0/byteOffset",
            json!(u64::MAX),
            "bytes of a buffer",
        ),
        (
            "/accessors/0/type",
            json!("VEC4"),
            "type is VEC4; expected VEC3",
        ),
        ("/accessors/0/componentType", json!(1), "componentType is 1"),
        (
            "/accessors/1/componentType",
            json!(5126),
            "componentType is 5126",
        ),
        (
            "/bufferViews/0/byteOffset",
            json!(u64::MAX),
            "/bufferViews/0: needs",
        ),
        (
            "/bufferViews/0/byteLength",
            json!(4_000_000_000_u32),
            "/bufferViews/0: needs",
        ),
        ("/bufferViews/0/byteStride", json!(0), "byteStride is 0"),
        ("/bufferViews/0/buffer", json!(3), "refers to buffer 3"),
        (
            "/buffers/0/byteLength",
            json!(4_000_000_000_u32),
            "/buffers/0: needs 4000000000 bytes",
        ),
        (
            "/buffers/0/uri",
            json!("../../x.bin"),
            "/buffers/0: \"../../x.bin\" leads out of the model's folder",
        ),
        ("/buffers/0/uri", json!("%2e%2e/x.bin"), "leads out of"),
        ("/buffers/0/uri", json!("/etc/passwd"), "leads out of"),
        (
            "/buffers/0/uri",
            json!("file:///etc/passwd"),
            "leads out of",
        ),
        (
            "/buffers/0/uri",
            json!("http://example.org/x"),
            "leads out of",
        ),
        (
            "/buffers/0/uri",
            json!("data:application/octet-stream;base64,!!!"),
            "a data URI",
        ),
        (
            "/buffers/0/uri",
            json!("not there.bin"),
            "/buffers/0: not there.bin:",
        ),
        ("/meshes/0/primitives", json!([]), "has no triangles"),
        ("/meshes/0/primitives/0/mode", json!(1), "has no triangles"),
        ("/meshes/0/primitives/0/mode", json!(9), "mode is 9"),
        (
            "/meshes/0/primitives/0/material",
            json!(2),
            "refers to material 2",
        ),
        (
            "/meshes/0/primitives/0/attributes",
            json!({}),
            "no attribute POSITION",
        ),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "/extensionsRequired/0: the file requires the extension KHR_draco_mesh_compression, which is not read; export the model without compression",
        ),
        (
            "/extensionsRequired",
            json!(["EXT_x\u{1b}[2J"]),
            "EXT_x\\u{1b}[2J",
        ),
    ] {
        let error = rejected(pointer, value);
        assert!(
            error.starts_with("a.glb") && error.contains(said),
            "{pointer}: {error}"
        );
    }
}

#[test]
fn lights_that_a_file_requires_are_left_out() {
    let (buffer, mut document) = square();
    document["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    document["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let model = read(&document, &buffer).expect("good");
    assert!(model.ignored.contains("KHR_lights_punctual"));
}

#[test]
fn bad_numbers_in_buffers_are_errors() {
    let (mut buffer, document) = square();
    buffer[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = read(&document, &buffer).expect_err("NaN").to_string();
    assert!(
        error.contains("/accessors/0: position 0 is not finite"),
        "{error}"
    );
    let (mut buffer, document) = square();
    buffer[50..52].copy_from_slice(&4_u16.to_le_bytes());
    let error = read(&document, &buffer).expect_err("4").to_string();
    assert!(
        error.contains("/accessors/1: index 4 at position 1, and there are 4 vertices"),
        "{error}"
    );
}

/// Deep, and many times the same mesh.
#[test]
fn a_hierarchy_has_limits() {
    let (buffer, mut document) = square();
    let deep = (0..1000).map(|n| json!({"children": [n + 1]}));
    document["nodes"] = deep.chain([json!({"mesh": 0})]).collect();
    let error = read(&document, &buffer).expect_err("deep").to_string();
    assert!(
        error.contains("nodes in a row below one another"),
        "{error}"
    );
    let all: Vec<_> = (1..=200_000).collect();
    let many = std::iter::once(json!({"children": all}));
    let same = std::iter::repeat_n(json!({"mesh": 0}), 200_000);
    document["nodes"] = many.chain(same).collect();
    let error = read(&document, &buffer).expect_err("many").to_string();
    assert!(
        error.contains("100001 primitives; a model has at most"),
        "{error}"
    );
}

#[test]
fn every_cut_and_many_corruptions_are_errors_or_models() {
    let (buffer, document) = square();
    let whole = glb(&document, &buffer);
    for end in 0..whole.len() {
        let cut = Model::of_bytes(whole[..end].to_vec(), Path::new("a.glb"));
        assert!(cut.is_err(), "{end}");
    }
    // A fixed sequence: each byte replaced by several others.
    for at in 0..whole.len() {
        for value in [0, 0x22, 0x39, 0x7B, 0x80, 0xFF] {
            let mut bad = whole.clone();
            bad[at] = value;
            let _ = Model::of_bytes(bad, Path::new("a.glb"));
        }
    }
}

#[test]
fn files_beside_the_model_are_read_and_those_behind_links_are_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let (buffer, mut document) = square();
    fs::create_dir(at("m")).expect("made");
    fs::write(at("m/the data.bin"), &buffer).expect("writes");
    fs::write(at("outside.bin"), &buffer).expect("writes");
    document["buffers"][0]["uri"] = json!("the%20data.bin");
    let path = at("m/a.gltf");
    fs::write(&path, document.to_string()).expect("writes");
    assert_eq!(Model::load(&path).expect("good").vertices.len(), 6);
    assert_eq!(model_files(&path), [path.clone(), at("m/the data.bin")]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(at("outside.bin"), at("m/link.bin")).expect("links");
        document["buffers"][0]["uri"] = json!("link.bin");
        fs::write(&path, document.to_string()).expect("writes");
        let error = Model::load(&path).expect_err("outside").to_string();
        assert!(error.contains("leads out of the model's folder"), "{error}");
    }
    // "AA…" is sixty zeros: every triangle is a point.
    document["buffers"][0]["uri"] = json!(format!("data:;base64,{}", "A".repeat(80)));
    fs::write(&path, document.to_string()).expect("writes");
    let error = Model::load(&path).expect_err("points").to_string();
    assert!(
        error.ends_with(
            "has no triangles to draw; export meshes, not only points, lines or cameras"
        ),
        "{error}"
    );
    let error = Model::load(&at("none.glb")).expect_err("none").to_string();
    assert!(error.contains("none.glb"), "{error}");
}

#[path = "tests_joints.rs"]
mod joints;
