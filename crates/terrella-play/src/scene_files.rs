//! Every file that the pictures of a scene come from: those that it names, and those that its defaults and the environment lead to.
//!
//! Each list stands beside what reads the files. A key that names files and is missing here fails a test, and so does a file that a film opens.

use super::caption_image::caption_files;
use super::craft_models::{attitude_files, model_files};
use super::error::PlayError;
use super::geo_layers::geo_files;
use super::map_lines::line_files;
use super::maps::map_files;
use super::place_names::place_name_files;
use super::relief::relief_files;
use super::sky_parts::sky_files;
use crate::scene::Scene;
use std::path::PathBuf;

/// A file that pictures come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// The key that leads to it, given or not: `earth.textures`.
    pub key: &'static str,
    /// The file.
    pub path: PathBuf,
}

/// The files that the pictures of a scene come from, in the order of its keys. Of a pack that is the manifest, which has the checksums of all
/// that is in it.
///
/// # Errors
/// Maps that are not found; with `strict = true` a map that is missing.
pub fn scene_files(scene: &Scene) -> Result<Vec<SceneFile>, PlayError> {
    let (earth, sky) = (&scene.earth, &scene.sky);
    // A table's file counts once, however many satellites of it are flown.
    let is_first = |index: usize| {
        let table = scene.orbit_table(index);
        index == 0 || scene.orbit_table(index - 1) != table
    };
    let orbits = scene.orbits.iter().enumerate();
    let orbits = orbits.filter(|(index, _)| is_first(*index));
    let mut all = Vec::new();
    let mut add = |key, paths: Vec<PathBuf>| {
        all.extend(paths.into_iter().map(|path| SceneFile { key, path }));
    };
    add(
        "time.orientation",
        scene.time.orientation.iter().cloned().collect(),
    );
    add(
        "orbit.file",
        orbits.filter_map(|(_, orbit)| orbit.file.clone()).collect(),
    );
    add("orbit.model", model_files(scene));
    add("orbit.attitude_file", attitude_files(scene));
    let maps_key = match earth.pack {
        Some(_) => "earth.pack",
        None => "earth.textures",
    };
    add(maps_key, map_files(scene)?);
    for maps in &earth.dated_maps {
        add(maps.layer.path_key(), maps.files.clone());
    }
    let sensor = scene.sensor.as_ref();
    add(
        "sensor.psf_kernel",
        sensor
            .and_then(|sensor| sensor.kernel.clone())
            .into_iter()
            .collect(),
    );
    if let Some(relief) = &earth.relief {
        add("earth.elevation", relief_files(relief)?);
    }
    add("geojson.file", geo_files(scene));
    add("layers.vector_map", line_files(scene));
    add("layers.place_names", place_name_files(scene));
    if sky.is_on() {
        add("sky.folder", sky_files(scene));
    }
    add("caption.image", caption_files(scene));
    add(
        "output.tone",
        scene
            .output
            .tone
            .file()
            .map(PathBuf::from)
            .into_iter()
            .collect(),
    );
    add(
        "quality.ladder",
        scene.quality.ladder.iter().cloned().collect(),
    );
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmKey, PictureSettings};
    use crate::scene::path_keys;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// For each key that names files: a scene with that key, and what it reads. Files of no use to it lie beside them.
    const CASES: &[(&str, &str, &[&str])] = &[
        (
            "time.orientation",
            "[time]\norientation = \"finals\"",
            &["finals"],
        ),
        (
            "orbit.file",
            "[[orbit]]\nfile = \"a.tle\"\n[[orbit]]\nsource = \"oem\"\nfile = \"b.oem\"",
            &["a.tle", "b.oem"],
        ),
        (
            "orbit.model",
            "[[orbit]]\nmodel = \"a.gltf\"\n[[orbit]]\nmodel = \"b.glb\"\n[[orbit]]\nmodel = \"a.gltf\"",
            &["a.gltf", "b.glb"],
        ),
        (
            "orbit.attitude_file",
            "[[orbit]]\nattitude_file = \"a.aem\"\n[[orbit]]\nattitude_file = \"b.csv\"\n[[orbit]]\nattitude_file = \"a.aem\"",
            &["a.aem", "b.csv"],
        ),
        (
            "earth.textures",
            "[earth]\ntextures = \"maps\"",
            &[
                "maps/day.png",
                "maps/clouds.png",
                "maps/elevation.png",
                "maps/night_lights.png",
                "maps/water.png",
            ],
        ),
        (
            "earth.pack",
            "[earth]\npack = \"pack\"",
            &["pack/pack.toml"],
        ),
        (
            "earth.day_maps",
            "[earth]\nday_maps = [{ date = \"2018-01-01T00:00:00Z\", file = \"a.png\" }, { date = \"2018-02-01T00:00:00Z\", file = \"b.png\" }]",
            &["a.png", "b.png"],
        ),
        (
            "earth.cloud_maps",
            "[earth]\ncloud_maps = [\"a.png\", \"b.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\", \"a.png\"]",
            &["a.png", "b.png"],
        ),
        (
            "earth.night_light_maps",
            "[earth]\nnight_light_maps = [{ date = \"2018-01-01T00:00:00Z\", file = \"a.png\" }]",
            &["a.png"],
        ),
        (
            "earth.elevation",
            "[earth]\nelevation = [\"heights.tif\", \"alps.png\"]",
            &["heights.tif", "alps.png", "alps.toml"],
        ),
        (
            "sensor.psf_kernel",
            "[sensor]\nsize = [64, 36]\nfocal_length_mm = 10\npixel_pitch_um = 5\nf_number = 2\nexposure_s = 0.001\nfull_well_e = 10000\npsf = \"measured\"\npsf_kernel = \"kernel.txt\"",
            &["kernel.txt"],
        ),
        (
            "geojson.file",
            "[[geojson]]\nfile = \"areas.geojson\"\n[[geojson]]\nfile = \"sites.json\"",
            &["areas.geojson", "sites.json"],
        ),
        (
            "layers.vector_map",
            "[layers]\nborders = true\nvector_map = \"lines.bin\"",
            &["lines.bin"],
        ),
        (
            "sky.folder",
            "[sky]\nmilky_way = true\nfolder = \"sky\"",
            &["sky/stars.bin", "sky/milky_way.jpg", "sky/moon.jpg"],
        ),
        (
            "output.tone",
            "[output]\ntone = { file = \"film.txt\" }",
            &["film.txt"],
        ),
        (
            "caption.image",
            "[[caption]]\nimage = \"logo.png\"\n[[caption]]\nimage = \"patch.png\"",
            &["logo.png", "patch.png"],
        ),
        (
            "quality.ladder",
            "[quality]\ntarget_ms = 20\nladder = \"ladder.csv\"",
            &["ladder.csv"],
        ),
    ];

    fn place() -> tempfile::TempDir {
        let root = tempfile::tempdir().expect("a folder");
        for folder in ["maps", "sky", "pack"] {
            std::fs::create_dir(root.path().join(folder)).expect("made");
        }
        let read = CASES.iter().flat_map(|(_, _, files)| files.iter());
        for file in read.chain(&["maps/SOURCES.md", "sky/more.txt", "pack/tile"]) {
            std::fs::write(root.path().join(file), file).expect("writes");
        }
        root
    }

    fn scene(root: &Path, text: &str) -> Scene {
        Scene::from_toml(text, &root.join("a.toml")).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn each_key_that_names_files_is_followed() {
        let root = place();
        let declared: BTreeSet<_> = path_keys()
            .map(|(table, key)| format!("{table}.{key}"))
            .collect();
        let tested: BTreeSet<_> = CASES.iter().map(|(key, ..)| (*key).to_owned()).collect();
        assert_eq!(declared, tested, "add a case for each key that names files");
        for (key, text, expected) in CASES {
            let files = scene_files(&scene(root.path(), text)).expect("found");
            let found = files.iter().filter(|file| file.key == *key);
            let found: BTreeSet<_> = found
                .map(|file| {
                    file.path
                        .strip_prefix(root.path())
                        .expect("beside the scene")
                })
                .collect();
            let expected: BTreeSet<_> = expected.iter().map(Path::new).collect();
            assert_eq!(found, expected, "{key}");
        }
    }

    /// Changed, missing, or there again: a film with such a file is another.
    #[test]
    fn each_file_makes_another_film() {
        for (key, text, files) in CASES {
            let root = place();
            let film = || {
                let scene = scene(root.path(), text);
                FilmKey::new(&scene, (64, 36), PictureSettings::default()).expect("a film")
            };
            let before = film();
            for file in *files {
                let path = root.path().join(file);
                std::fs::write(&path, b"changed").expect("writes");
                let words = film().differences(&before).expect("another film");
                let name = path.file_name().expect("a name").display();
                let said = format!("{name} ({key})");
                assert!(
                    words.starts_with("changed files: ") && words.contains(&said),
                    "{words}"
                );
                std::fs::write(&path, file).expect("writes");
                assert_eq!(film().differences(&before), None);
            }
        }
    }

    /// A sidecar, a map of a folder: it need not be there.
    #[test]
    fn a_file_that_comes_later_makes_another_film() {
        let root = place();
        for (text, file) in [
            ("[earth]\nelevation = [\"heights.tif\"]", "heights.toml"),
            ("[earth]\ntextures = \"maps\"", "maps/day.jpg"),
        ] {
            let scene = scene(root.path(), text);
            let film = || FilmKey::new(&scene, (64, 36), PictureSettings::default());
            let before = film().expect("a film");
            std::fs::write(root.path().join(file), b"new").expect("writes");
            let now = film().expect("a film");
            let words = now.differences(&before).expect("another film");
            let name = file.rsplit('/').next().expect("a name");
            assert!(words.contains(&format!("new files: {name}")), "{words}");
            assert!(
                before
                    .differences(&now)
                    .is_some_and(|words| words.contains("missing files"))
            );
        }
    }

    /// What the looks leave out is not read.
    #[test]
    fn files_that_are_not_read_are_left_out() {
        let root = place();
        let text = "[earth]\ntextures = \"maps\"\nclouds = false\nnormals = false\nnight_lights = false\nwater = false\n[sky]\nstars = false\nmoon = false\nfolder = \"sky\"";
        let files = scene_files(&scene(root.path(), text)).expect("found");
        assert_eq!(files.len(), 1, "{files:?}");
        assert!(files[0].path.ends_with("maps/day.png"));
    }
}
