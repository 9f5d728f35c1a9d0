//! Nodes that are turned, tangents and alpha, in files made in the tests.

use super::*;

fn jointed(document: &Value, buffer: &[u8], joints: &[&str]) -> Result<Model, ModelError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.glb");
    fs::write(&path, glb(document, buffer)).expect("writes");
    Model::load_jointed(&path, joints)
}

/// A body, on it a boom, on that a panel; the panel has a child without a name.
fn satellite() -> (Vec<u8>, Value) {
    let (buffer, mut document) = square();
    document["nodes"] = json!([
        {"name": "Body", "mesh": 0, "children": [1]},
        {"name": "Boom", "mesh": 0, "translation": [2.0, 0.0, 0.0], "children": [2]},
        {"name": "Panel", "mesh": 0, "translation": [0.0, 3.0, 0.0], "rotation": [0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()], "children": [3]},
        {"mesh": 0},
    ]);
    (buffer, document)
}

#[test]
fn joints_are_the_nodes_of_their_names_with_all_that_is_attached_to_them() {
    let (buffer, document) = satellite();
    let still = jointed(&document, &buffer, &[]).expect("good");
    assert!(still.joints.is_empty() && still.parts.len() == 1);
    assert_eq!(still.parts[0].joint, None);
    // In the order of the names, not in that of the file.
    let model = jointed(&document, &buffer, &["Panel", "Boom"]).expect("good");
    let [panel, boom] = model.joints.as_slice() else {
        panic!("{:?}", model.joints);
    };
    assert_eq!((panel.name.as_str(), panel.parent), ("Panel", Some(1)));
    assert_eq!((boom.name.as_str(), boom.parent), ("Boom", None));
    let origin = panel.model_from_node.transform_point3(glam::DVec3::ZERO);
    assert_eq!(origin, glam::DVec3::new(2.0, 3.0, 0.0));
    let x = panel.model_from_node.transform_vector3(glam::DVec3::X);
    assert!(x.distance(glam::DVec3::Y) < 1e-12, "{x}");
    // Six indices a square: the panel has two.
    let of = |joint| {
        let parts = model.parts.iter().filter(move |part| part.joint == joint);
        parts.map(|part| part.indices.len()).sum::<usize>()
    };
    assert_eq!((of(None), of(Some(1)), of(Some(0))), (6, 6, 12));
    // All vertices stay where the file places them, and all parts have the one material.
    assert_eq!(model.vertices, still.vertices);
    assert!(model.parts.iter().all(|part| part.material == 0));
    assert_eq!(model.materials.len(), 1);
}

#[test]
fn joints_that_the_file_does_not_have_once_are_errors() {
    let (buffer, mut document) = satellite();
    let said = |document: &Value| {
        let error = jointed(document, &buffer, &["Wing"]).expect_err("none");
        error.to_string()
    };
    let error = said(&document);
    assert!(
        error.contains("a.glb: has no node \"Wing\"")
            && error.contains("\"Body\", \"Boom\", \"Panel\""),
        "{error}"
    );
    document["nodes"][1]["name"] = json!("Wing");
    document["nodes"][2]["name"] = json!("Wing");
    let error = said(&document);
    assert!(
        error.contains("/nodes/2: has two nodes \"Wing\""),
        "{error}"
    );
    for node in 0..3 {
        document["nodes"][node]["name"] = json!(null);
    }
    assert!(said(&document).contains("its nodes are without names"));
}

/// A square with normals and tangents of the file.
fn with_tangents(tangents: [[f32; 4]; 4]) -> (Vec<u8>, Value) {
    let (mut buffer, mut document) = square();
    let normals = [[0.0_f32, 0.0, 1.0]; 4];
    let at = buffer.len();
    let numbers = normals.as_flattened().iter().chain(tangents.as_flattened());
    numbers.for_each(|x| buffer.extend(x.to_le_bytes()));
    for (offset, length) in [(at, 48), (at + 48, 64)] {
        let views = document["bufferViews"].as_array_mut().expect("a list");
        views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": length}));
    }
    for (view, kind) in [(2, "VEC3"), (3, "VEC4")] {
        let accessors = document["accessors"].as_array_mut().expect("a list");
        accessors
            .push(json!({"bufferView": view, "componentType": 5126, "count": 4, "type": kind}));
    }
    document["buffers"][0]["byteLength"] = json!(buffer.len());
    let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = json!(2);
    attributes["TANGENT"] = json!(3);
    (buffer, document)
}

/// The bitangent, normal × tangent · w, goes where the transform takes it, in a mirror too.
#[test]
fn tangents_are_placed_with_their_meshes() {
    let (buffer, mut document) = with_tangents([[1.0, 0.0, 0.0, -1.0]; 4]);
    for (node, tangent, bitangent) in [
        (json!({"mesh": 0}), Vec3::X, Vec3::NEG_Y),
        (
            json!({"mesh": 0, "scale": [-2.0, 1.0, 1.0]}),
            Vec3::NEG_X,
            Vec3::NEG_Y,
        ),
        (
            json!({"mesh": 0, "scale": [1.0, -1.0, 3.0]}),
            Vec3::X,
            Vec3::Y,
        ),
        (
            json!({"mesh": 0, "rotation": [0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]}),
            Vec3::Y,
            Vec3::X,
        ),
    ] {
        document["nodes"][0] = node.clone();
        let model = read(&document, &buffer).expect("good");
        for vertex in &model.vertices {
            let along = vertex.tangent.truncate();
            assert!(along.distance(tangent) < 1e-6, "{node} {vertex:?}");
            let other = vertex.normal.cross(along) * vertex.tangent.w;
            assert!(other.distance(bitangent) < 1e-6, "{node} {vertex:?}");
        }
    }
    // Of no length, and without the file's normals: none.
    let (buffer, document) = with_tangents([[0.0, 0.0, 0.0, 1.0]; 4]);
    let none = |document: &Value, buffer: &[u8]| {
        let model = read(document, buffer).expect("good");
        model
            .vertices
            .iter()
            .all(|vertex| vertex.tangent == Vec4::ZERO)
    };
    assert!(none(&document, &buffer));
    let (buffer, mut document) = with_tangents([[1.0, 0.0, 0.0, 1.0]; 4]);
    document["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "TANGENT": 3});
    assert!(none(&document, &buffer));
    let (buffer, document) = with_tangents([[f32::NAN, 0.0, 0.0, 1.0]; 4]);
    let error = read(&document, &buffer).expect_err("no number").to_string();
    assert!(
        error.contains("/accessors/3: tangent 0 is not finite"),
        "{error}"
    );
}

#[test]
fn alpha_modes_are_those_of_the_file() {
    let (buffer, mut document) = square();
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    for (material, alpha) in [
        (json!({}), AlphaMode::Opaque),
        (
            json!({"alphaMode": "OPAQUE", "alphaCutoff": 0.25}),
            AlphaMode::Opaque,
        ),
        (json!({"alphaMode": "MASK"}), AlphaMode::Mask(0.5)),
        (
            json!({"alphaMode": "MASK", "alphaCutoff": 0.25}),
            AlphaMode::Mask(0.25),
        ),
        (json!({"alphaMode": "BLEND"}), AlphaMode::Blend),
    ] {
        document["materials"] = json!([material]);
        let model = read(&document, &buffer).expect("good");
        assert_eq!(model.materials[0].alpha, alpha, "{material}");
        assert!(model.ignored.is_empty());
    }
    let scale = json!({"normalTexture": {"index": 0, "scale": 1e300}});
    document["materials"] = json!([scale]);
    assert!(read(&document, &buffer).is_err());
}
