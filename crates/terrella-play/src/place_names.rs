//! Names of cities on the globe: `place_names` of `[layers]`.

use super::error::PlayError;
use super::maps::DroppedLayer;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use terrella::tracks::{NamedPlace, read_place_names};
use terrella_imagery::find_textures;

/// Their file in the starter pack.
const PLACE_NAMES: &str = "place_names.bin";
/// Name of the key in lists of dropped layers.
const LAYER: &str = "place_names";

/// The file that [`place_names`] reads, if it is there.
pub(super) fn place_name_files(scene: &Scene) -> Vec<PathBuf> {
    let is_wanted = scene.layers.place_names.is_some();
    let folder = starter_folder(scene).ok().filter(|_| is_wanted);
    let file = folder.map(|folder| folder.join(PLACE_NAMES));
    file.filter(|path| path.exists()).into_iter().collect()
}

/// The folder of the starter pack's lines and names.
pub(super) fn starter_folder(scene: &Scene) -> Result<PathBuf, String> {
    match &scene.layers.folder {
        Some(folder) => Ok(folder.clone()),
        None => find_textures().map_err(|error| error.to_string()),
    }
}

/// The names in a folder of the starter pack.
fn names_in(folder: &Path) -> Result<Vec<NamedPlace>, String> {
    read_place_names(&folder.join(PLACE_NAMES)).map_err(|error| error.to_string())
}

/// All cities of the starter pack, the most important first; none if the file is missing or corrupt.
#[cfg(feature = "window")]
pub(super) fn shipped_names() -> Vec<NamedPlace> {
    let folder = find_textures().map_err(|error| error.to_string());
    folder
        .and_then(|folder| names_in(&folder))
        .unwrap_or_else(|error| {
            tracing::warn!("places cannot be chosen by name: {error}");
            Vec::new()
        })
}

/// The places that a scene may label, the most important first, and a report if they are missing.
///
/// # Errors
/// A file that is missing or corrupt, in a strict scene.
pub(super) fn place_names(
    scene: &Scene,
) -> Result<(Vec<NamedPlace>, Option<DroppedLayer>), PlayError> {
    if scene.layers.place_names.is_none() {
        return Ok((Vec::new(), None));
    }
    match starter_folder(scene).and_then(|folder| names_in(&folder)) {
        Ok(places) => Ok((places, None)),
        Err(missing) if scene.earth.strict => Err(PlayError::MissingLayer {
            scene: scene.path.clone(),
            table: "layers",
            layer: LAYER,
            missing,
        }),
        Err(missing) => Ok((
            Vec::new(),
            Some(DroppedLayer {
                layer: LAYER,
                missing,
            }),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Coordinates of capitals according to national surveys, and the first names of an atlas.
    #[test]
    fn the_shipped_names_are_where_atlases_have_them() {
        let scene = Scene::from_toml("[layers]\nplace_names = true\n", Path::new("a.toml"));
        let (places, dropped) = place_names(&scene.expect("a good scene")).expect("shipped");
        assert!(dropped.is_none() && places.len() > 1000, "{dropped:?}");
        for (name, lat_deg, lon_deg, is_capital) in [
            ("Vienna", 48.21, 16.37, true),
            ("Canberra", -35.28, 149.13, true),
            ("Sydney", -33.87, 151.21, false),
            ("New York City", 40.71, -74.01, false),
            ("Nuuk", 64.18, -51.72, true),
            ("Suva", -18.14, 178.44, true),
            ("Honolulu", 21.31, -157.86, false),
        ] {
            let found = places.iter().find(|place| place.name == name);
            let Some(found) = found else {
                panic!("{name} is missing")
            };
            let off = |angle: f64, deg: f64| (angle.to_degrees() - deg).abs();
            assert!(off(found.place.lat_rad, lat_deg) < 0.05, "{found:?}");
            assert!(off(found.place.lon_rad, lon_deg) < 0.05, "{found:?}");
            assert_eq!(found.is_capital, is_capital, "{name}");
        }
        let rank = |name: &str| places.iter().position(|place| place.name == name);
        assert!(rank("Tokyo") < rank("Nuuk") && rank("Cairo") < rank("Vienna"));
    }
}
