//! Declares the keys of `[layers]`, `[[geojson]]` and `[[station]]`, which are drawn on the globe. [`keys`](super::keys) declares those of
//! the other tables.

use super::field::{Bounds, Field, RawPath};
use super::keys::{LAT_DEG, LON_DEG};
use super::record::{Notes, Record};
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::Deserialize;
#[cfg(test)]
use serde_json::json;
use std::ops::{Range, RangeInclusive};
use toml::Spanned;

/// Maximum ground stations, `[[station]]` tables, in one scene: a frame computes a circle for each.
pub(super) const MAX_STATIONS: usize = 200;
/// Maximum GeoJSON files, `[[geojson]]` tables, in one scene.
pub(super) const MAX_GEOJSON: usize = 32;
/// `step_deg` of `graticule`, degrees.
pub(super) const GRATICULE_STEP_DEG: RangeInclusive<f64> = 1.0..=90.0;
/// Range of the maximum number in `place_names`.
pub(super) const PLACE_NAMES: RangeInclusive<i64> = 1..=500;
/// Opacity of lines.
const OPACITY: RangeInclusive<f64> = 0.01..=1.0;

const fn only(why: &'static str) -> Only {
    Only { why, sources: &[] }
}
const GRATICULE: &Only = &only("only for graticule = true");
const COAST_LINES: &Only = &only("only for coast_lines = true");
const BORDERS: &Only = &only("only for borders = true");
const TERMINATOR: &Only = &only("only for terminator = true");
const MOON_SHADOW: &Only = &only("only for moon_shadow = true");

table!(RawLayers = "layers" {
    // True or a table, checked by layers.rs.
    /// The graticule: meridians and parallels, by default 10° apart. By default false.
    graticule: toml::Value, of "true, false or { step_deg = 10 }";
    /// Colour of the graticule. By default "#ffffff".
    graticule_color: String, of "a string, \"#\" and six hexadecimal digits", for GRATICULE;
    /// Opacity of the graticule.
    graticule_opacity: f64, in OPACITY, default 0.3, for GRATICULE;
    /// Whether coast lines are drawn.
    coast_lines: bool, default false;
    /// Colour of coast lines. By default "#fff2c4".
    coast_lines_color: String, of "a string, \"#\" and six hexadecimal digits", for COAST_LINES;
    /// Opacity of coast lines.
    coast_lines_opacity: f64, in OPACITY, default 0.8, for COAST_LINES;
    /// Whether national borders are drawn.
    borders: bool, default false;
    /// Colour of borders. By default "#ffffff".
    borders_color: String, of "a string, \"#\" and six hexadecimal digits", for BORDERS;
    /// Opacity of borders.
    borders_opacity: f64, in OPACITY, default 0.6, for BORDERS;
    /// Whether the terminator is drawn, and where twilight ends: the Sun at 0°, −6°, −12° and −18°.
    terminator: bool, default false;
    /// Colour of the terminator. By default "#ffb066".
    terminator_color: String, of "a string, \"#\" and six hexadecimal digits", for TERMINATOR;
    /// Opacity of the terminator.
    terminator_opacity: f64, in OPACITY, default 0.8, for TERMINATOR;
    /// Whether the outlines of the Moon's umbra and penumbra on the ground are drawn at an eclipse of the Sun.
    moon_shadow: bool, default false;
    /// Colour of these outlines. By default "#d0b8ff".
    moon_shadow_color: String, of "a string, \"#\" and six hexadecimal digits", for MOON_SHADOW;
    /// Opacity of these outlines.
    moon_shadow_opacity: f64, in OPACITY, default 0.9, for MOON_SHADOW;
    // True or a number, checked by layers.rs.
    /// Names of cities and towns, the most important first where there is room: true, which is at most 60 in a picture, or their greatest number, 1 to 500. By default false.
    place_names: toml::Value, of "true, false or a number";
    /// Width of these lines.
    width_px: f64, of "pixels", in 0.5..=16.0, default 1.0;
    /// File of coast lines and borders. By default lines.bin of the starter pack.
    vector_map: RawPath, of "a file of coast lines and borders";
});

table!(RawGeojson = "geojson" {
    /// A file of GeoJSON (RFC 7946). Its lines, the outlines of its polygons and its points are drawn, with the properties stroke, stroke-width, stroke-opacity, fill, fill-opacity, marker-color and title of simplestyle-spec.
    file: RawPath, of "a GeoJSON file";
    /// Colour of features that have none of their own. By default "#ffd166".
    color: String, of "a string, \"#\" and six hexadecimal digits";
    /// Width of lines that have none of their own.
    width_px: f64, of "pixels", in 0.5..=16.0, default 1.5;
    /// Opacity of lines that have none of their own, and of points.
    opacity: f64, in OPACITY, default 0.9;
    /// Opacity of the filling of polygons that have neither fill nor fill-opacity. 0 draws their outlines alone.
    fill_opacity: f64, in 0.0..=1.0, default 0.0;
    /// The property of features with the name that is written beside them. By default "title".
    name_key: String, of "a string, the name of a property";
});

table!(RawStation = "station" {
    /// What the station is called.
    name: String, of "a string, the station's name";
    /// Geodetic latitude, south negative.
    lat_deg: f64, of "degrees", in LAT_DEG;
    /// Longitude, west negative.
    lon_deg: f64, of "degrees", in LON_DEG;
    /// Height above the ellipsoid.
    height_m: f64, of "metres", in -1000.0..=10_000.0, default 0.0;
    /// Minimum elevation of a satellite above the station's horizon.
    min_elevation_deg: f64, of "degrees", in 0.0..=89.0, default 5.0;
    /// Colour of all that is drawn of the station. By default one of a palette, after those of the satellites.
    color: String, of "a string, \"#\" and six hexadecimal digits";
});
