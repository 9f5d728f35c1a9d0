//! `[[geojson]]`: files with lines, outlines and points on the globe.

use super::Scene;
use super::error::{SceneError, printable};
use super::field::PathKind;
use super::globe_keys::{MAX_GEOJSON, RawGeojson};
use super::record::quoted;
use super::text::SceneText;
use std::path::PathBuf;

/// Why keys of a file have no value.
pub(super) const NO_GEOJSON: &str = "the scene has no [[geojson]]";
/// Default colour.
const COLOR: &str = "#ffd166";
/// Default property with names: that of simplestyle-spec.
const NAME_KEY: &str = "title";

/// A GeoJSON file, and the default style of its features.
#[derive(Clone, Debug, PartialEq)]
pub struct GeojsonTable {
    /// The file.
    pub file: PathBuf,
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Pixels.
    pub width_px: f64,
    /// Above 0 to 1.
    pub opacity: f64,
    /// Of the filling of polygons, 0 to 1.
    pub fill_opacity: f64,
    /// The property with names; `None` is the title.
    pub name_key: Option<String>,
}

impl SceneText<'_> {
    /// Checks all `[[geojson]]` tables.
    pub(super) fn geojson(&self, raw: &[RawGeojson]) -> Result<Vec<GeojsonTable>, SceneError> {
        if let Some(table) = raw.get(MAX_GEOJSON) {
            let advice = format!(
                "a scene has at most {MAX_GEOJSON} files of GeoJSON and this one {}; leave some out, or put them together",
                raw.len()
            );
            return Err(self.reject(&table.file(), advice));
        }
        raw.iter().map(|table| self.geojson_table(table)).collect()
    }

    fn geojson_table(&self, raw: &RawGeojson) -> Result<GeojsonTable, SceneError> {
        let (field, color, key) = (raw.file(), raw.color(), raw.name_key());
        let Some(given) = field.given else {
            let remedy = "a layer of GeoJSON needs its file; add file = \"…\"";
            return Err(self.missing(&field, raw.given(), remedy));
        };
        let file = self.existing(&field, given.get_ref(), PathKind::File)?;
        field.note(quoted(&file.display().to_string()));
        let name_key = match key.given.map(|key| key.get_ref().as_str()) {
            Some("") => {
                let advice = "must not be empty: it is the name of a property of features";
                return Err(self.reject(&key, advice));
            }
            name_key => name_key,
        };
        key.note(quoted(name_key.unwrap_or(NAME_KEY)));
        let written = color.given.map_or(COLOR, |given| given.get_ref());
        Ok(GeojsonTable {
            file,
            color: self.color_of(&color, written)?,
            width_px: self.quantity(&raw.width_px())?,
            opacity: self.quantity(&raw.opacity())?,
            fill_opacity: self.quantity(&raw.fill_opacity())?,
            name_key: name_key.map(str::to_owned),
        })
    }
}

impl Scene {
    /// Descriptions of the drawn GeoJSON files.
    pub(super) fn geojson_uses(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.geojson.iter().map(|table| {
            let file = printable(&table.file.display().to_string());
            ("geojson", format!("lines, polygons and points of {file}"))
        })
    }
}
