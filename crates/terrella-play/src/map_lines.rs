//! Earth-fixed lines of a scene: the graticule, coast lines and borders.

use super::error::PlayError;
use super::maps::DroppedLayer;
use super::place_names::{place_names, starter_folder};
use crate::scene::{LineLook, Scene};
use std::path::PathBuf;
use terrella::frames::Ellipsoid;
use terrella::tracks::{LineStyle, Polylines, VectorMap};

/// Its file in the starter pack.
const VECTOR_MAP: &str = "lines.bin";

/// Parts of a scene's `[layers]` that are missing.
///
/// # Errors
/// In a strict scene, the first of them.
pub(super) fn dropped_lines(scene: &Scene) -> Result<Vec<DroppedLayer>, PlayError> {
    let (_, mut dropped) = vector_map(scene)?;
    dropped.extend(place_names(scene)?.1);
    Ok(dropped)
}

/// The file that [`lines`] reads, if it is there.
pub(super) fn line_files(scene: &Scene) -> Vec<PathBuf> {
    let file = scene.layers.needs_vector_map().then(|| file_of(scene));
    let file = file.and_then(Result::ok).filter(|path| path.exists());
    file.into_iter().collect()
}

fn file_of(scene: &Scene) -> Result<PathBuf, String> {
    match &scene.layers.vector_map {
        Some(file) => Ok(file.clone()),
        None => Ok(starter_folder(scene)?.join(VECTOR_MAP)),
    }
}

/// Reads the requested coast lines and borders, and reports missing ones.
///
/// # Errors
/// A file that is missing or corrupt, in a strict scene.
fn vector_map(scene: &Scene) -> Result<(VectorMap, Vec<DroppedLayer>), PlayError> {
    let layers = &scene.layers;
    if !layers.needs_vector_map() {
        return Ok((VectorMap::default(), Vec::new()));
    }
    let read = file_of(scene).and_then(|path| {
        let map = VectorMap::read(&path);
        map.map_err(|error| error.named(&path))
    });
    let missing = match read {
        Ok(map) => return Ok((map, Vec::new())),
        Err(why) => why,
    };
    let wanted = [
        ("coast_lines", layers.coast_lines.is_some()),
        ("borders", layers.borders.is_some()),
    ];
    let dropped = wanted.into_iter().filter(|(_, is_on)| *is_on);
    let dropped: Vec<_> = dropped
        .map(|(layer, _)| DroppedLayer {
            layer,
            missing: missing.clone(),
        })
        .collect();
    match dropped.first() {
        Some(DroppedLayer { layer, .. }) if scene.earth.strict => Err(PlayError::MissingLayer {
            scene: scene.path.clone(),
            table: "layers",
            layer,
            missing,
        }),
        _ => Ok((VectorMap::default(), dropped)),
    }
}

/// How a scene's terminator is drawn.
pub(super) fn twilight(scene: &Scene) -> Option<LineStyle> {
    scene.layers.terminator.map(|look| style(scene, look))
}

/// How the outlines of the Moon's shadow are drawn.
pub(super) fn shadow_lines(scene: &Scene) -> Option<LineStyle> {
    scene.layers.moon_shadow.map(|look| style(scene, look))
}

fn style(scene: &Scene, look: LineLook) -> LineStyle {
    LineStyle {
        width_px: scene.layers.width_px as f32,
        ..LineStyle::thin(look.color, look.opacity)
    }
}

/// The lines that a scene requests, on this figure of the Earth. [`dropped_lines`] reports missing ones.
///
/// # Errors
/// A file that is missing or corrupt, in a strict scene.
pub(super) fn lines(scene: &Scene, ellipsoid: &Ellipsoid) -> Result<Vec<Polylines>, PlayError> {
    let layers = &scene.layers;
    let style = |look| style(scene, look);
    let mut all = Vec::new();
    if let Some((step_deg, look)) = layers.graticule {
        all.push(Polylines::graticule(style(look), ellipsoid, step_deg)?);
    }
    let (map, _) = vector_map(scene)?;
    for (look, lines) in [
        (layers.borders, map.borders),
        (layers.coast_lines, map.coast_lines),
    ] {
        if let Some(look) = look.filter(|_| !lines.is_empty()) {
            all.push(Polylines::on_ground(style(look), ellipsoid, lines)?);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use terrella::frames::Geodetic;

    fn shipped() -> (PathBuf, VectorMap) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures/lines.bin");
        let map = VectorMap::read(&path).unwrap_or_else(|error| panic!("{error}"));
        (path, map)
    }

    /// Distance of the nearest vertex, degrees of a great circle.
    fn nearest_deg(lines: &[Vec<Geodetic>], lat_deg: f64, lon_deg: f64) -> f64 {
        let unit = |lat: f64, lon: f64| {
            let (sin, cos) = lat.sin_cos();
            [cos * lon.cos(), cos * lon.sin(), sin]
        };
        let from = unit(lat_deg.to_radians(), lon_deg.to_radians());
        let chords = lines.iter().flatten().map(|place| {
            let to = unit(place.lat_rad, place.lon_rad);
            from.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum()
        });
        chords.fold(f64::INFINITY, f64::min).sqrt().to_degrees()
    }

    /// Capes at their published coordinates, tripoints of countries, and places far from any line.
    #[test]
    fn coasts_and_borders_are_where_atlases_have_them() {
        let (_, map) = shipped();
        for (name, lat, lon) in [
            ("Cape Agulhas", -34.833, 20.0),
            ("Cape Horn", -55.983, -67.267),
            ("North Cape", 71.169, 25.784),
            ("Cape Finisterre", 42.883, -9.272),
            ("Cape York", -10.688, 142.531),
            ("Cape Dezhnev", 66.079, -169.651),
        ] {
            let off = nearest_deg(&map.coast_lines, lat, lon);
            assert!(off < 0.2, "{name}: {off}°");
        }
        for (name, lat, lon) in [
            ("Basel, of France, Germany and Switzerland", 47.59, 7.589),
            (
                "Iguazu, of Argentina, Brazil and Paraguay",
                -25.594,
                -54.593,
            ),
            ("Lake of the Woods, on 49° north", 49.0, -95.153),
        ] {
            let off = nearest_deg(&map.borders, lat, lon);
            assert!(off < 0.15, "{name}: {off}°");
        }
        for (lat, lon) in [(0.0, -140.0), (-90.0, 0.0), (25.0, -45.0)] {
            let off = nearest_deg(&map.coast_lines, lat, lon);
            assert!(off > 4.0, "{off}° at {lat}° {lon}°");
        }
    }

    #[test]
    fn lines_and_names_come_from_the_folder_of_the_host() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = "[layers]\nborders = true\nplace_names = true\n";
        let mut scene = Scene::from_toml(text, Path::new("a.toml")).expect("a good scene");
        crate::take_starter_files(&mut scene, folder.path());
        let dropped = dropped_lines(&scene).expect("reported");
        let names: Vec<_> = dropped.iter().map(|layer| layer.layer).collect();
        assert_eq!(names, ["borders", "place_names"]);
        for (dropped, file) in dropped.iter().zip([VECTOR_MAP, "place_names.bin"]) {
            let path = folder.path().join(file).display().to_string();
            assert!(dropped.missing.contains(&path), "{}", dropped.missing);
        }
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures");
        crate::take_starter_files(&mut scene, &shipped);
        assert_eq!(dropped_lines(&scene).expect("read"), []);
        assert_eq!(line_files(&scene), [shipped.join(VECTOR_MAP)]);
    }

    #[test]
    fn a_corrupt_file_is_named_and_rejects_a_strict_scene() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, _) = shipped();
        let bytes = std::fs::read(path).expect("read");
        let file = folder.path().join("half.bin");
        std::fs::write(&file, &bytes[..bytes.len() / 2]).expect("written");
        let scene = |text: &str| {
            let text = format!(
                "{text}[layers]\ngraticule = true\ncoast_lines = true\nborders = true\nvector_map = \"half.bin\"\n"
            );
            let path = folder.path().join("a.toml");
            Scene::from_toml(&text, &path).unwrap_or_else(|error| panic!("{error}"))
        };
        let lenient = scene("");
        let dropped = dropped_lines(&lenient).expect("reported");
        let names: Vec<_> = dropped.iter().map(|layer| layer.layer).collect();
        assert_eq!(names, ["coast_lines", "borders"]);
        let said = &dropped[0].missing;
        assert!(
            said.contains("half.bin: it is corrupt or truncated"),
            "{said}"
        );
        // The graticule is drawn.
        assert_eq!(lines(&lenient, &Ellipsoid::WGS84).expect("lines").len(), 1);
        let strict = scene("[earth]\nstrict = true\n");
        for error in [
            dropped_lines(&strict).map(|_| ()),
            lines(&strict, &Ellipsoid::WGS84).map(|_| ()),
        ] {
            let text = error.expect_err("strict").to_string();
            assert!(
                text.contains("[layers] coast_lines: ") && text.contains("half.bin"),
                "{text}"
            );
        }
    }
}
