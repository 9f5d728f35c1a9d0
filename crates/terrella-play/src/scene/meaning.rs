//! Terms known from other programs, with the tables and keys of the same meaning here.

/// Table, key, and synonyms. A synonym may occur in several rows of different tables.
const KEYS: &[(&str, &str, &[&str])] = &[
    (
        "time",
        "start",
        &["begin", "date", "datetime", "epoch", "utc"],
    ),
    ("time", "duration_s", &["length", "seconds", "stop", "end"]),
    (
        "time",
        "speed",
        &["time_scale", "time_warp", "timelapse", "warp"],
    ),
    (
        "time",
        "frame_rate_hz",
        &["fps", "framerate", "frames_per_second"],
    ),
    (
        "time",
        "orientation",
        &["eop", "finals", "polar_motion", "ut1"],
    ),
    (
        "orbit",
        "file",
        &[
            "tle",
            "omm",
            "oem",
            "czml",
            "csv",
            "sp3",
            "stk",
            "elements",
            "ephemeris",
            "path",
        ],
    ),
    (
        "orbit",
        "source",
        &["format", "kind", "propagator", "sgp4", "type"],
    ),
    (
        "orbit",
        "name",
        &["catalog_number", "id", "norad", "norad_id", "satellite"],
    ),
    ("orbit", "semi_major_axis_km", &["a", "a_km", "sma"]),
    ("orbit", "periapsis_km", &["perigee", "perigee_km"]),
    ("orbit", "eccentricity", &["e", "ecc"]),
    ("orbit", "inclination_deg", &["i", "i_deg", "inc"]),
    ("orbit", "raan_deg", &["ascending_node", "node"]),
    (
        "orbit",
        "argument_of_periapsis_deg",
        &["aop", "argp", "argument_of_perigee"],
    ),
    ("orbit", "true_anomaly_deg", &["nu", "ta"]),
    ("orbit", "mean_anomaly_deg", &["ma"]),
    ("orbit", "position_km", &["r_km", "state"]),
    ("orbit", "velocity_km_s", &["v_km_s"]),
    ("orbit", "cd", &["drag_coefficient"]),
    (
        "orbit",
        "cr",
        &["radiation_coefficient", "reflectivity", "srp_coefficient"],
    ),
    (
        "orbit",
        "radiation",
        &["solar_radiation_pressure", "solar_pressure", "srp"],
    ),
    ("orbit", "method", &["integrator"]),
    (
        "orbit",
        "air_model",
        &["atmosphere_model", "density_model", "drag_model"],
    ),
    ("orbit", "burns", &["maneuvers", "manoeuvres", "thrust"]),
    ("orbit", "listen", &["address", "port", "tcp", "udp"]),
    (
        "coverage",
        "show",
        &["display", "kind", "metric", "quantity", "value"],
    ),
    (
        "coverage",
        "region_deg",
        &["area", "bbox", "bounds", "region"],
    ),
    ("coverage", "step_deg", &["cell_deg", "resolution_deg"]),
    (
        "coverage",
        "duration_h",
        &["duration_s", "hours", "days", "span"],
    ),
    ("camera", "mode", &["attitude", "pointing", "type", "view"]),
    ("camera", "follow", &["satellite"]),
    ("camera", "look_at", &["lookat", "target", "track"]),
    ("camera", "roll_deg", &["roll", "bank"]),
    ("camera", "fov_deg", &["field_of_view", "zoom"]),
    (
        "camera",
        "height_km",
        &["alt", "alt_km", "altitude", "altitude_km"],
    ),
    ("camera", "heading_deg", &["azimuth", "azimuth_deg", "yaw"]),
    ("camera", "pitch_deg", &["tilt", "tilt_deg"]),
    ("camera", "keys", &["animation", "keyframes", "path"]),
    (
        "earth",
        "elevation",
        &[
            "dem",
            "dtm",
            "height_map",
            "heightmap",
            "heights",
            "relief",
            "terrain",
        ],
    ),
    (
        "earth",
        "night_lights",
        &["city_lights", "lights", "night", "nightlights"],
    ),
    ("earth", "atmosphere", &["air", "scattering"]),
    (
        "earth",
        "aerosol_optical_depth",
        &["aerosol", "aod", "haze"],
    ),
    (
        "earth",
        "relief_exaggeration",
        &["exaggeration", "vertical_exaggeration"],
    ),
    ("earth", "water", &["ocean", "sea", "specular"]),
    ("earth", "sea_floor", &["bathymetry"]),
    ("earth", "figure", &["datum", "ellipsoid"]),
    ("earth", "pack", &["imagery", "tiles"]),
    ("earth", "textures", &["images", "maps"]),
    ("earth", "levels", &["lod", "level_of_detail"]),
    ("caption", "text", &["label", "title"]),
    ("station", "name", &["label", "site", "title"]),
    ("sky", "milky_way", &["galaxy"]),
    ("sky", "glare", &["bloom", "flare", "lens_flare"]),
    (
        "lens",
        "blades",
        &["aperture_blades", "spikes", "starburst"],
    ),
    ("lens", "ghosts", &["flares", "lens_flares", "reflections"]),
    (
        "output",
        "size",
        &["dimensions", "height", "resolution", "width"],
    ),
    (
        "output",
        "samples",
        &["aa", "anti_aliasing", "antialiasing", "msaa"],
    ),
    ("output", "exposure_ev", &["brightness", "ev", "exposure"]),
    (
        "output",
        "tone",
        &["tone_curve", "tone_mapping", "tonemap", "tonemapping"],
    ),
    ("quality", "target_ms", &["budget_ms", "target_fps"]),
    ("quality", "scale", &["render_scale", "resolution_scale"]),
];

/// Table, and synonyms.
const TABLES: &[(&str, &[&str])] = &[
    ("orbit", &["craft", "satellite", "satellites", "spacecraft"]),
    ("tracks", &["track", "trail"]),
    (
        "station",
        &["ground_station", "ground_stations", "stations", "observer"],
    ),
    (
        "caption",
        &[
            "captions", "label", "labels", "logo", "text", "texts", "title", "titles",
        ],
    ),
    (
        "geojson",
        &["area", "areas", "geo_json", "json", "polygons", "vector"],
    ),
    ("coverage", &["coverage_map", "revisit"]),
    ("layers", &["layer", "lines", "overlay", "overlays"]),
    ("camera", &["eye", "view"]),
    ("earth", &["globe", "imagery", "planet", "terrain"]),
    ("sky", &["background", "stars"]),
    ("lens", &["aperture", "optics"]),
    ("output", &["image", "picture", "render", "video", "window"]),
    ("quality", &["performance"]),
];

/// The key for a synonym, with its table. Keys of `table` take precedence over those of other tables.
pub(super) fn key_meant(table: &str, word: &str) -> Option<(&'static str, &'static str)> {
    let word = folded(word);
    let mut rows = KEYS
        .iter()
        .filter(|(_, _, words)| words.contains(&word.as_str()));
    let first = rows.clone().next();
    let row = rows.find(|(of, ..)| *of == table).or(first);
    row.map(|(of, key, _)| (*of, *key))
}

/// The table for a synonym.
pub(super) fn table_meant(word: &str) -> Option<&'static str> {
    let word = folded(word);
    let mut rows = TABLES.iter();
    let row = rows.find(|(_, words)| words.contains(&word.as_str()));
    row.map(|(table, _)| *table)
}

fn folded(word: &str) -> String {
    word.to_lowercase().replace('-', "_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::keys;

    #[test]
    fn meanings_are_keys_and_words_are_none_of_their_table() {
        for (table, key, words) in KEYS {
            let known = keys::TABLES.iter().find(|one| one.name == *table);
            let known = known.unwrap_or_else(|| panic!("[{table}] is no table"));
            let is_key = |word: &str| known.keys.iter().any(|one| one.name == word);
            assert!(is_key(key), "[{table}] has no {key}");
            for word in *words {
                assert!(!is_key(word), "[{table}] {word} is a key itself");
                assert_eq!(folded(word), *word);
                assert_eq!(key_meant(table, word), Some((*table, *key)), "{word}");
            }
        }
        for (table, words) in TABLES {
            assert!(keys::TABLES.iter().any(|one| one.name == *table), "{table}");
            for word in *words {
                assert!(
                    keys::TABLES.iter().all(|one| one.name != *word),
                    "[{word}] is a table itself"
                );
                assert_eq!(table_meant(word), Some(*table));
            }
        }
    }

    #[test]
    fn the_own_table_comes_first() {
        assert_eq!(key_meant("orbit", "path"), Some(("orbit", "file")));
        assert_eq!(key_meant("camera", "path"), Some(("camera", "keys")));
        assert_eq!(key_meant("earth", "FPS"), Some(("time", "frame_rate_hz")));
        assert_eq!(key_meant("earth", "unheard_of"), None);
    }
}
