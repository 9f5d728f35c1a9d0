//! The files of the sky.

use super::error::PlayError;
use super::maps::DroppedLayer;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrella::DiffractionPattern;
use terrella::celestial::{CelestialOptions, MILKY_WAY_FILE, MOON_FILE, STARS_FILE, StarCatalogue};
use terrella_imagery::{LayerImage, find_textures, load_color_map};

/// Missing parts of a scene's sky.
///
/// # Errors
/// In a strict scene, the first of them.
pub(super) fn dropped_parts(scene: &Scene) -> Result<Vec<DroppedLayer>, PlayError> {
    match scene.sky.is_on() {
        true => Ok(read(scene, Reading::Names)?.1),
        false => Ok(Vec::new()),
    }
}

/// The files that [`read`] reads, as far as they exist.
pub(super) fn sky_files(scene: &Scene) -> Vec<PathBuf> {
    let sky = &scene.sky;
    let Ok(folder) = folder_of(scene) else {
        return Vec::new();
    };
    let parts = [
        (sky.stars, STARS_FILE),
        (sky.milky_way, MILKY_WAY_FILE),
        (sky.moon, MOON_FILE),
    ];
    let read = parts.into_iter().filter(|(is_on, _)| *is_on);
    let paths = read.map(|(_, name)| folder.join(name));
    paths.filter(|path| path.exists()).collect()
}

fn folder_of(scene: &Scene) -> Result<PathBuf, String> {
    match &scene.sky.folder {
        Some(folder) => Ok(folder.clone()),
        None => find_textures().map_err(|error| error.to_string()),
    }
}

/// The files of the maps that a scene's sky is drawn with.
#[cfg(feature = "window")]
pub(super) fn map_files(scene: &Scene, folder: &Path) -> Vec<std::path::PathBuf> {
    let sky = &scene.sky;
    let maps = [(sky.milky_way, MILKY_WAY_FILE), (sky.moon, MOON_FILE)];
    let wanted = maps.into_iter().filter(|(is_on, _)| *is_on && sky.is_on());
    wanted.map(|(_, name)| folder.join(name)).collect()
}

/// How far files are read.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Reading {
    /// All of them.
    Whole,
    /// Checks that maps exist; stars are read.
    Names,
}

/// Reads the requested parts, and reports missing ones.
///
/// # Errors
/// In a strict scene, a missing part.
pub(super) fn read(
    scene: &Scene,
    depth: Reading,
) -> Result<(CelestialOptions, Vec<DroppedLayer>), PlayError> {
    let sky = &scene.sky;
    let mut dropped = Vec::new();
    let folder = folder_of(scene);
    let mut drop = |layer, missing: String| {
        if scene.earth.strict {
            return Err(PlayError::MissingLayer {
                scene: scene.path.clone(),
                table: "sky",
                layer,
                missing,
            });
        }
        dropped.push(DroppedLayer { layer, missing });
        Ok(())
    };
    let aperture = scene.aperture.filter(|_| depth == Reading::Whole);
    let aperture = aperture.map(|aperture| Arc::new(DiffractionPattern::new(aperture)));
    let mut options = CelestialOptions {
        sun: sky.sun,
        glare: sky.glare,
        aperture,
        ghosts: scene.ghosts,
        star_gain: sky.star_gain,
        stars_fade_by_day: sky.stars_fade_by_day,
        ..CelestialOptions::NOTHING
    };
    let in_folder = |name: &str| folder.clone().map(|folder| folder.join(name));
    if sky.stars {
        let read = in_folder(STARS_FILE).and_then(|path| {
            let named = |error: terrella::celestial::StarError| error.named(&path);
            StarCatalogue::read(&path).map_err(named)
        });
        match read {
            Ok(stars) => options.stars = Some(Arc::new(stars)),
            Err(why) => drop("stars", why)?,
        }
    }
    for (is_on, layer, name) in [
        (sky.milky_way, "milky_way", MILKY_WAY_FILE),
        (sky.moon, "moon", MOON_FILE),
    ] {
        let slot = match layer {
            "moon" => &mut options.moon,
            _ => &mut options.milky_way,
        };
        if !is_on {
            continue;
        }
        match in_folder(name).and_then(|path| map(&path, layer, depth)) {
            Ok(map) => *slot = map,
            Err(why) => drop(layer, why)?,
        }
    }
    Ok((options, dropped))
}

fn map(
    path: &Path,
    layer: &'static str,
    depth: Reading,
) -> Result<Option<Arc<LayerImage>>, String> {
    match depth {
        Reading::Whole => {
            let map = load_color_map(path, layer).map_err(|error| error.to_string())?;
            Ok(Some(Arc::new(map)))
        }
        Reading::Names if path.is_file() => Ok(None),
        Reading::Names => Err(format!("{} is missing", path.display())),
    }
}
