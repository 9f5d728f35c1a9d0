//! Settings of a scene that affect the work of a frame: two runs are compared only if all of them are equal.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::Path;
use terrella::EarthOptions;
use terrella::frames::rfc3339;
use terrella_imagery::tile::MapLayer;
use terrella_play::scene::{CameraMode, Scene};

/// The scene's part of the settings, each value as the scene writes it. Folders are left out, they differ from machine to
/// machine; the names of files are not.
pub fn of_scene(scene: &Scene) -> BTreeMap<String, String> {
    let (time, camera, earth) = (&scene.time, &scene.camera, &scene.earth);
    let mut settings = vec![
        ("start", rfc3339(time.start)),
        ("duration_s", time.duration_s.to_string()),
        ("mode", word(&camera.mode)),
        ("fov_deg", camera.fov_deg.to_string()),
        ("figure", word(&earth.figure)),
        ("subdivision", earth.subdivision.to_string()),
        ("visibility", word(&earth.visibility)),
        ("shading", word(&earth.shading)),
        ("atmosphere", word(&earth.atmosphere)),
        ("samples", scene.output.samples.to_string()),
    ];
    if camera.mode == CameraMode::Geodetic {
        settings.extend([
            ("lat_deg", camera.lat_deg.to_string()),
            ("lon_deg", camera.lon_deg.to_string()),
            ("height_km", camera.height_km.to_string()),
        ]);
    }
    for orbit in &scene.orbits {
        let file = match &orbit.file {
            Some(file) => file_name(file),
            None if orbit.source.is_file() => "built in".into(),
            None => word(&orbit.source),
        };
        let name = orbit.name.as_deref().unwrap_or_default();
        settings.push(("orbit", format!("{file} {name}").trim_end().to_owned()));
    }
    if let Some(pack) = &earth.pack {
        settings.extend([
            ("pack", file_name(&pack.folder)),
            ("levels", word(&pack.levels)),
            ("texel_px", pack.texel_px.to_string()),
            ("storage", word(&pack.storage)),
            ("texture_mb", pack.texture_mb.to_string()),
            ("upload_mb", pack.upload_mb.to_string()),
        ]);
    }
    let pairs = settings.into_iter();
    pairs.map(|(key, value)| (key.to_owned(), value)).collect()
}

/// The maps that were really loaded, with their sizes.
pub fn of_maps(options: &EarthOptions) -> (String, String) {
    let maps: Vec<_> = MapLayer::ALL
        .into_iter()
        .filter_map(|layer| {
            let map = options.layers.get(layer)?;
            Some(format!("{} {}x{}", layer.name(), map.width, map.height))
        })
        .collect();
    ("maps".into(), maps.join(", "))
}

fn word(value: &impl Debug) -> String {
    format!("{value:?}").to_lowercase()
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
