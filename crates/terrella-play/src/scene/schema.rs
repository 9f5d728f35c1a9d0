//! `config/terrella.schema.json`, with which editors complete and check scenes, generated from the key declarations.
//!
//! `TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-play reference` writes it and the reference page. Without the variable the same test compares
//! them.

use super::articulations::{ANGLE_DEG, AXIS, MAX_ARTICULATIONS, RATE_DEG_S, TRACKED};
use super::camera_keys::{CUT, NUMBERS, OFFSET, OFFSET_M};
use super::caption_keys::MAX_CAPTIONS;
use super::coverage_keys::MAX_NAMES;
use super::field::names_of;
use super::globe_keys::{GRATICULE_STEP_DEG, MAX_GEOJSON, MAX_STATIONS, PLACE_NAMES};
use super::keys::{
    BURN_M_S2, BURN_S, CLIPMAP_LEVELS, CLIPMAP_SAMPLES, GRID_SAMPLES, LAT_DEG, LON_DEG, MAX_BURNS,
    MAX_CAMERA_KEYS, MAX_DATED_MAPS, MAX_ELEVATION_FILES, MAX_LEAVES, MAX_ORBITS, MAX_ORIGINS,
    QUADTREE_LAMBDA, SAMPLES, TABLES,
};
use super::look_at::PLACE_HEIGHT_KM;
use super::orbit_keys::SPAN_MIN;
use super::table::{Key, Shape, Table};
use serde_json::{Map, Value, json};
use std::ops::RangeInclusive;
use terrella_ground::globe::ContourDrawing;
use terrella_ground::globe::clipmap::Trim;
use terrella_ground::light::{Exposure, Tone};

/// The schema of scenes.
pub(super) fn schema() -> Value {
    let tables = TABLES.iter().map(|table| {
        let schema = match table.is_list() {
            true => {
                let one = json!({ "$ref": format!("#/$defs/{}", table.name) });
                let most = match table.name {
                    "orbit" => MAX_ORBITS,
                    "caption" => MAX_CAPTIONS,
                    "geojson" => MAX_GEOJSON,
                    _ => MAX_STATIONS,
                };
                json!({ "anyOf": [one, { "type": "array", "maxItems": most, "items": one }] })
            }
            false => table_schema(table),
        };
        (table.name.to_owned(), schema)
    });
    let lists = TABLES.iter().filter(|table| table.is_list());
    let lists = lists.map(|table| (table.name.to_owned(), table_schema(table)));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A scene of Terrella",
        "type": "object",
        "properties": tables.collect::<Map<_, _>>(),
        "additionalProperties": false,
        "$defs": lists.collect::<Map<_, _>>(),
    })
}

/// The schema as text, one line per key.
pub(super) fn schema_text() -> String {
    /// Depth of the keys: in the properties of a table, in the properties of a scene.
    const KEYS: usize = 4;
    fn text(value: &Value, depth: usize) -> String {
        let Some(entries) = value.as_object().filter(|_| depth < KEYS) else {
            return value.to_string();
        };
        let indent = "  ".repeat(depth + 1);
        let lines = entries.iter();
        let lines =
            lines.map(|(name, value)| format!("{indent}{name:?}: {}", text(value, depth + 1)));
        let lines = lines.collect::<Vec<_>>().join(",\n");
        format!("{{\n{lines}\n{}}}", "  ".repeat(depth))
    }
    text(&schema(), 0) + "\n"
}

fn table_schema(table: &Table) -> Value {
    let keys = table.keys.iter().map(|key| {
        let mut schema = value_schema(key);
        schema["description"] = key.about.meaning.trim().into();
        if let Some(default) = default_of(key) {
            schema["default"] = default;
        }
        (key.name.to_owned(), schema)
    });
    object(keys.collect(), &[])
}

/// The default of a key, if it is constant.
pub(super) fn default_of(key: &Key) -> Option<Value> {
    let default = key.about.default?();
    Some(default.as_f64().map_or(default, number))
}

pub(super) fn value_schema(key: &Key) -> Value {
    let range = key.about.range;
    let bounded = |kind: &str| match range {
        Some(range) => bounded(kind, range),
        None => json!({ "type": kind }),
    };
    let path = json!({ "type": "string" });
    match (key.about.shape)() {
        Shape::Flag => json!({ "type": "boolean" }),
        Shape::Number => bounded("number"),
        Shape::Whole => match key.name {
            "samples" => json!({ "enum": SAMPLES }),
            _ => bounded("integer"),
        },
        Shape::Word(names) => json!({ "enum": names }),
        Shape::Text | Shape::Path => path,
        Shape::Paths => json!({ "type": "array", "maxItems": MAX_ELEVATION_FILES, "items": path }),
        Shape::Vector if key.name == "sensor_half_angles_deg" => list(bounded("number"), 2),
        Shape::Vector if key.name == "region_deg" => list(bounded("number"), 4),
        Shape::Vector => list(bounded("number"), 3),
        Shape::Pair => list(bounded("integer"), 2),
        Shape::DatedMaps => json!({
            "type": "array",
            "minItems": 1,
            "maxItems": MAX_DATED_MAPS,
            "items": { "anyOf": [path, table_within(key.name)] },
        }),
        Shape::Tone => json!({ "anyOf": [
            { "enum": names_of::<Tone>() },
            table_within(key.name),
        ] }),
        Shape::LookAt => json!({ "anyOf": [path, table_within(key.name)] }),
        Shape::Own => own(key),
    }
}

/// The schema of a value that only this key has.
fn own(key: &Key) -> Value {
    let table = || table_within(key.name);
    match key.name {
        "start" | "epoch" => json!({ "type": "string" }),
        "all" => json!({ "anyOf": [{ "type": "boolean" }, { "type": "string" }] }),
        "trail" | "ground_track" | "swath" | "graticule" => {
            json!({ "anyOf": [{ "type": "boolean" }, table()] })
        }
        "place_names" => json!({ "anyOf": [
            { "type": "boolean" },
            { "type": "integer", "minimum": PLACE_NAMES.start(), "maximum": PLACE_NAMES.end() },
        ] }),
        "burns" => json!({ "type": "array", "maxItems": MAX_BURNS, "items": table() }),
        "articulations" => {
            json!({ "type": "array", "maxItems": MAX_ARTICULATIONS, "items": table() })
        }
        "events" => {
            json!({ "type": "array", "items": { "enum": ["nodes", "apsides", "eclipses"] } })
        }
        "satellites" => json!({
            "type": "array", "minItems": 1, "maxItems": MAX_NAMES, "items": { "type": "string" },
        }),
        "allowed_origins" => {
            json!({ "type": "array", "maxItems": MAX_ORIGINS, "items": { "type": "string" } })
        }
        "keys" => json!({
            "type": "array", "minItems": 1, "maxItems": MAX_CAMERA_KEYS, "items": table(),
        }),
        "subdivision" => json!({ "anyOf": [
            { "const": "auto" },
            bounded("integer", key.about.range.expect("a range")),
        ] }),
        "principal_point_px" => list(json!({ "type": "number" }), 2),
        "distortion" => json!({
            "type": "array", "minItems": 4, "maxItems": 8, "items": { "type": "number" },
        }),
        "bands_nm" => list(list(json!({ "type": "number" }), 2), 3),
        "exposure_ev" => json!({ "anyOf": [
            { "const": "auto" },
            bounded("number", ends(&Exposure::RANGE_EV)),
        ] }),
        _ => table(),
    }
}

/// A key of a table within the value of a key.
pub(super) struct KeyPart {
    pub(super) name: &'static str,
    /// The schema of its value.
    pub(super) value: Value,
    pub(super) meaning: &'static str,
    pub(super) is_needed: bool,
}

/// The keys of the table within the value of a key; empty without a table.
pub(super) fn parts(key: &str) -> Vec<KeyPart> {
    let part = |name, value, meaning| KeyPart {
        name,
        value,
        meaning,
        is_needed: false,
    };
    let needed = |name, value, meaning| KeyPart {
        is_needed: true,
        ..part(name, value, meaning)
    };
    let whole = |range: &RangeInclusive<i64>| {
        bounded("integer", [*range.start() as f64, *range.end() as f64])
    };
    let number = |range: &RangeInclusive<f64>| bounded("number", ends(range));
    let flag = || json!({ "type": "boolean" });
    let text = || json!({ "type": "string" });
    let words = |names: &[&str]| json!({ "enum": names });
    match key {
        "trail" | "ground_track" | "swath" => vec![
            part("before_min", number(&SPAN_MIN), "Minutes before now."),
            part("after_min", number(&SPAN_MIN), "Minutes after now."),
        ],
        "graticule" => vec![part(
            "step_deg",
            number(&GRATICULE_STEP_DEG),
            "Degrees from one line to the next.",
        )],
        "burns" => vec![
            needed("start", text(), "UTC instant at which the burn begins."),
            needed("duration_s", number(&BURN_S), "Length, seconds."),
            needed(
                "acceleration_m_s2",
                list(number(&BURN_M_S2), 3),
                "Acceleration along the three axes, m/s².",
            ),
            part(
                "axes",
                words(&["flight", "radial", "gcrf"]),
                "Axes of the acceleration: of the flight (x along the velocity, z along the angular momentum), the default, radial (x away from the Earth's centre, z likewise), or of the GCRF.",
            ),
        ],
        "articulations" => vec![
            needed("node", text(), "Name of the node in the model's file."),
            needed(
                "axis",
                list(number(&AXIS), 3),
                "Axis through the node's origin, in the axes of the node.",
            ),
            part(
                "angle_deg",
                number(&ANGLE_DEG),
                "Angle at the scene's start, degrees counter-clockwise from how the file places the node; by default 0.",
            ),
            part(
                "rate_deg_s",
                number(&RATE_DEG_S),
                "Degrees a second; by default 0.",
            ),
            part(
                "track",
                words(&TRACKED),
                "In place of angle_deg and rate_deg_s: what normal is turned to, as near as the axis allows.",
            ),
            part(
                "normal",
                list(number(&AXIS), 3),
                "Direction in the axes of the node that track turns; by default [0, 0, 1].",
            ),
        ],
        "day_maps" | "cloud_maps" | "night_light_maps" => vec![
            needed("date", text(), "UTC instant of the map."),
            needed("file", text(), "Path of the map."),
        ],
        "keys" => {
            let numbers = NUMBERS.iter().map(|(name, range, unit)| KeyPart {
                is_needed: *name == "time_s",
                ..part(name, number(range), unit)
            });
            let offset = part(
                OFFSET,
                list(number(&OFFSET_M), 3),
                "metres ahead of the satellite, to its right and down",
            );
            let cut = part(
                CUT,
                json!({ "type": "boolean" }),
                "whether the camera jumps there: what is keyed before counts no more",
            );
            numbers.chain([offset, cut]).collect()
        }
        "tone" => vec![
            needed(
                "file",
                text(),
                "Path of a file of camera responses in the format of the database DoRF.",
            ),
            part(
                "name",
                text(),
                "Name of the response in the file; three curves whose names end in Red, Green and Blue by what is before that.",
            ),
        ],
        "look_at" => vec![
            needed(
                "lat_deg",
                number(&LAT_DEG),
                "Geodetic latitude, degrees, south negative.",
            ),
            needed(
                "lon_deg",
                number(&LON_DEG),
                "Longitude, degrees, west negative.",
            ),
            part(
                "height_km",
                number(&PLACE_HEIGHT_KM),
                "Height above the ellipsoid, kilometres; by default 0.",
            ),
        ],
        "clipmap" => vec![
            part(
                "samples",
                json!({ "enum": CLIPMAP_SAMPLES }),
                "Samples along an edge of a level.",
            ),
            part(
                "levels",
                whole(&CLIPMAP_LEVELS),
                "Levels besides the globe's.",
            ),
            part(
                "trimming",
                words(names_of::<Trim>()),
                "Shape of a level: a hexagon cuts off the sharp corners of a diamond.",
            ),
        ],
        "contours" => vec![part(
            "drawn",
            words(names_of::<ContourDrawing>()),
            "As triangles, or by a ray cast at each pixel.",
        )],
        "projected_grid" => vec![
            part(
                "samples",
                list(whole(&GRID_SAMPLES), 2),
                "Samples across and down.",
            ),
            part("on_gpu", flag(), "Whether the GPU makes the vertices."),
        ],
        "quadtree" => vec![
            part(
                "lambda",
                number(&QUADTREE_LAMBDA),
                "Metres of distance for a metre of error; without it tolerance_px divides the squares.",
            ),
            part(
                "culling",
                flag(),
                "Whether squares out of sight are left out.",
            ),
            part("max_leaves", whole(&MAX_LEAVES), "Most squares."),
        ],
        _ => Vec::new(),
    }
}

fn table_within(key: &str) -> Value {
    let parts = parts(key);
    assert!(!parts.is_empty(), "{key} has no schema");
    let needed = parts.iter().filter(|part| part.is_needed);
    let needed: Vec<_> = needed.map(|part| part.name).collect();
    let properties = parts.into_iter().map(|mut part| {
        part.value["description"] = part.meaning.into();
        (part.name.to_owned(), part.value)
    });
    object(properties.collect(), &needed)
}

fn list(items: Value, count: usize) -> Value {
    json!({ "type": "array", "minItems": count, "maxItems": count, "items": items })
}

fn object(properties: Map<String, Value>, required: &[&str]) -> Value {
    let mut schema = json!({ "type": "object", "properties": properties });
    if !required.is_empty() {
        schema["required"] = required.into();
    }
    schema["additionalProperties"] = false.into();
    schema
}

fn ends(range: &RangeInclusive<f64>) -> [f64; 2] {
    [*range.start(), *range.end()]
}

fn bounded(kind: &str, [least, most]: [f64; 2]) -> Value {
    match least == f64::MIN_POSITIVE {
        true => json!({ "type": kind, "exclusiveMinimum": 0, "maximum": number(most) }),
        false => json!({ "type": kind, "minimum": number(least), "maximum": number(most) }),
    }
}

/// A number in common notation: without a fraction if it is an integer.
fn number(number: f64) -> Value {
    match number.fract() == 0.0 && number.abs() < 1e15 {
        true => json!(number as i64),
        false => json!(number),
    }
}
