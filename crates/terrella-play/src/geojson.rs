//! GeoJSON (RFC 7946): lines, rings and points of a file, with the styles of simplestyle-spec 1.1.
//!
//! ```text
//! bytes ─► features, each kept as text ─► one geometry after the other ─► lines by style, points, remarks
//! ```
//!
//! An invalid feature is left out and reported by its index; the others are read.

mod geometry;
mod style;

use geometry::{Shape, shapes};
use serde::Deserialize;
use serde::de::{IgnoredAny, SeqAccess, Visitor};
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use style::{FeatureStyle, Properties};
pub use style::{GeoStyle, UsualStyle};
use terrella::frames::Geodetic;
use terrella::tracks::FillStyle;
use terrella_files as files;

/// Largest file, bytes.
pub const MAX_BYTES: u64 = 64 << 20;
/// Most features that are read of a file, and most positions.
const MAX_FEATURES: usize = 200_000;
const MAX_POSITIONS: usize = 1_000_000;
/// Most styles of a file: each is drawn by itself.
const MAX_STYLES: usize = 64;
/// Most remarks that are kept.
const MAX_REMARKS: usize = 20;
/// Longest name, characters.
const MAX_NAME_CHARS: usize = 100;

/// Elements of a file.
#[derive(Clone, Debug, Default)]
pub struct GeoJson {
    /// Lines and rings by their style.
    pub lines: Vec<(GeoStyle, Vec<Vec<Geodetic>>)>,
    /// Polygons that are filled, by their style: each is its rings, the outer one first.
    pub fills: Vec<(FillStyle, Vec<GeoPolygon>)>,
    pub points: Vec<GeoPoint>,
    /// Errors of features, in order.
    pub remarks: Vec<Remark>,
    /// Further remarks that are not kept.
    pub more_remarks: usize,
    /// Features whose rings are wound the other way.
    pub wrong_windings: usize,
    /// Properties of simplestyle-spec that are there and not drawn.
    pub ignored: Vec<&'static str>,
}

/// The rings of a polygon, the outer one first.
pub type GeoPolygon = Vec<Vec<Geodetic>>;

/// A point of a file, or where the name of a line or a polygon is written.
#[derive(Clone, Debug, PartialEq)]
pub struct GeoPoint {
    pub place: Geodetic,
    pub name: Option<String>,
    pub color: [u8; 3],
    /// Whether it is a point.
    pub is_marked: bool,
}

/// An error in a feature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Its index, from 0; `None` is about the file.
    pub feature: Option<usize>,
    pub what: String,
    /// Whether it is drawn anyway.
    pub is_drawn: bool,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.feature {
            Some(index) => write!(f, "feature {index}: {}", self.what),
            None => write!(f, "{}", self.what),
        }
    }
}

/// Why nothing of a file is drawn.
#[derive(Debug, thiserror::Error)]
pub enum GeoJsonError {
    #[error("it cannot be read: {0}")]
    Read(#[from] std::io::Error),
    #[error("it has more than {} MiB; simplify it, or divide it into several files", MAX_BYTES >> 20)]
    TooLarge,
    #[error("it is not UTF-8, as GeoJSON is")]
    NotUtf8,
    #[error("it is no JSON: {0}")]
    NotJson(serde_json::Error),
    #[error("it is no GeoJSON: its type is {0}, not FeatureCollection, Feature or a geometry")]
    NotGeoJson(String),
}

impl GeoJson {
    /// Reads a file. Features without a style get `usual`; `name_key` is the property with names, by default `title`.
    ///
    /// # Errors
    /// A file that cannot be read, exceeds [`MAX_BYTES`], or is not GeoJSON.
    pub fn read(
        path: &Path,
        usual: UsualStyle,
        name_key: Option<&str>,
    ) -> Result<Self, GeoJsonError> {
        let bytes = files::read(path, MAX_BYTES)?.ok_or(GeoJsonError::TooLarge)?;
        let text = String::from_utf8(bytes).map_err(|_| GeoJsonError::NotUtf8)?;
        // RFC 8259, 8.1: parsers may ignore a byte order mark.
        Self::parse(text.trim_start_matches('\u{feff}'), usual, name_key)
    }

    /// The same of a text.
    pub fn parse(
        text: &str,
        usual: UsualStyle,
        name_key: Option<&str>,
    ) -> Result<Self, GeoJsonError> {
        let text = without_nan(text);
        let top: Top<'_> = serde_json::from_str(&text).map_err(GeoJsonError::NotJson)?;
        let mut reader = Reader {
            usual,
            name_key,
            found: Self::default(),
            groups: BTreeMap::new(),
            positions_left: MAX_POSITIONS,
        };
        match (top.kind.as_deref(), &top.features) {
            (Some("FeatureCollection"), Some(features)) => {
                for (index, feature) in features.kept.iter().enumerate() {
                    reader.feature(index, feature);
                }
                if features.skipped > 0 {
                    let what = format!(
                        "it has more than {MAX_FEATURES} features; {} are left out",
                        features.skipped
                    );
                    reader.remark(None, what, false);
                }
            }
            (Some("Feature"), _) => reader.feature(0, &text),
            (Some(kind), _) if geometry::is_geometry(kind) => {
                let style = FeatureStyle::usual(usual);
                reader.geometry(0, &text, &style, None);
            }
            (kind, _) => {
                let kind = kind.map_or("missing".to_owned(), |kind| format!("{kind:?}"));
                let short: String = kind.chars().take(60).collect();
                return Err(GeoJsonError::NotGeoJson(short));
            }
        }
        reader.found.lines = reader.groups.into_values().collect();
        Ok(reader.found)
    }
}

#[derive(Deserialize)]
struct Top<'a> {
    #[serde(rename = "type", borrow, default)]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow, default)]
    features: Option<Features<'a>>,
}

#[derive(Deserialize)]
struct RawFeature<'a> {
    #[serde(rename = "type", borrow, default)]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow, default)]
    geometry: Option<&'a RawValue>,
    #[serde(borrow, default)]
    properties: Option<&'a RawValue>,
}

/// Features as text: at most [`MAX_FEATURES`].
struct Features<'a> {
    kept: Vec<&'a str>,
    skipped: usize,
}

impl<'de: 'a, 'a> Deserialize<'de> for Features<'a> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct List;
        impl<'de> Visitor<'de> for List {
            type Value = Features<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of features")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
                let mut kept = Vec::new();
                while kept.len() < MAX_FEATURES
                    && let Some(feature) = list.next_element::<&RawValue>()?
                {
                    kept.push(feature.get());
                }
                let mut skipped = 0;
                while list.next_element::<IgnoredAny>()?.is_some() {
                    skipped += 1;
                }
                Ok(Features { kept, skipped })
            }
        }
        deserializer.deserialize_seq(List)
    }
}

struct Reader<'r> {
    usual: UsualStyle,
    name_key: Option<&'r str>,
    found: GeoJson,
    groups: BTreeMap<style::StyleKey, (GeoStyle, Vec<Vec<Geodetic>>)>,
    positions_left: usize,
}

impl Reader<'_> {
    fn remark(&mut self, feature: Option<usize>, what: String, is_drawn: bool) {
        if self.found.remarks.len() < MAX_REMARKS {
            self.found.remarks.push(Remark {
                feature,
                what,
                is_drawn,
            });
        } else {
            self.found.more_remarks += 1;
        }
    }

    fn feature(&mut self, index: usize, text: &str) {
        let feature: RawFeature<'_> = match serde_json::from_str(text) {
            Ok(feature) => feature,
            Err(error) => return self.remark(Some(index), json_fault(&error), false),
        };
        if feature.kind.as_deref() != Some("Feature") {
            let what = "its type is not Feature".to_owned();
            return self.remark(Some(index), what, false);
        }
        // A feature without a geometry is not drawn (RFC 7946, 3.2).
        let Some(geometry) = feature.geometry else {
            return;
        };
        let properties = match feature.properties.map(|raw| Properties::parse(raw.get())) {
            None => Properties::default(),
            Some(Ok(properties)) => properties,
            Some(Err(error)) => return self.remark(Some(index), json_fault(&error), false),
        };
        let (style, faults) = properties.style(self.usual);
        for fault in faults {
            self.remark(Some(index), fault, true);
        }
        for name in properties.ignored() {
            if !self.found.ignored.contains(&name) {
                self.found.ignored.push(name);
            }
        }
        let name = properties.name(self.name_key);
        let name = name.map(|name| name.chars().take(MAX_NAME_CHARS).collect());
        self.geometry(index, geometry.get(), &style, name);
    }

    fn geometry(&mut self, index: usize, text: &str, style: &FeatureStyle, name: Option<String>) {
        let read = match shapes(text, self.positions_left) {
            Ok(read) => read,
            Err(what) => return self.remark(Some(index), what, false),
        };
        self.positions_left -= read.positions;
        self.found.wrong_windings += usize::from(read.is_wound_clockwise);
        for what in read.faults {
            self.remark(Some(index), what, true);
        }
        // The name of a line or a polygon is drawn once, at its longest part.
        let is_point = |shape: &&Shape| matches!(shape, Shape::Point(_));
        let longest = read.shapes.iter().filter(|shape| !is_point(shape));
        let anchor = longest.max_by_key(|shape| shape.len()).map(Shape::anchor);
        let point = |place, color, is_marked| GeoPoint {
            place,
            name: name.clone(),
            color,
            is_marked,
        };
        let is_drawn = style.line.is_drawn() || style.fill.is_some();
        if let Some(place) = anchor.filter(|_| name.is_some() && is_drawn) {
            let named = point(place, style.line.color, false);
            self.found.points.push(named);
        }
        if let Some(fill) = style.fill.filter(|_| !read.polygons.is_empty()) {
            self.fill(index, fill, read.polygons);
        }
        for shape in read.shapes {
            if let Shape::Point(place) = shape {
                let marked = point(place, style.marker_color, true);
                self.found.points.push(marked);
            } else if style.line.is_drawn() {
                for line in shape.into_lines() {
                    self.line(index, line, style.line);
                }
            }
        }
    }

    /// Polygons of one style are drawn together, in the order of the first of them.
    fn fill(&mut self, index: usize, style: FillStyle, polygons: Vec<GeoPolygon>) {
        let fills = &mut self.found.fills;
        match fills.iter().position(|(other, _)| *other == style) {
            Some(at) => fills[at].1.extend(polygons),
            None if fills.len() < MAX_STYLES => fills.push((style, polygons)),
            None => {
                let what = format!(
                    "it is not filled: the file has more than {MAX_STYLES} styles of filling"
                );
                self.remark(Some(index), what, true);
            }
        }
    }

    fn line(&mut self, index: usize, line: Vec<Geodetic>, style: GeoStyle) {
        let is_new = !self.groups.contains_key(&style.key());
        let style = match is_new && self.groups.len() >= MAX_STYLES {
            true => {
                let what = format!(
                    "it is drawn in the usual style: the file has more than {MAX_STYLES} styles"
                );
                self.remark(Some(index), what, true);
                self.usual.line
            }
            false => style,
        };
        let group = self.groups.entry(style.key());
        group.or_insert_with(|| (style, Vec::new())).1.push(line);
    }
}

/// The JSON parser's message about a feature, without line and column, which are relative to the feature.
fn json_fault(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text.split(" at line ").next().unwrap_or(&text);
    match text {
        "recursion limit exceeded" => "it is nested too deeply".to_owned(),
        text => text.to_owned(),
    }
}

/// The text with `null` in place of `NaN` and `Infinity`, which are not valid JSON but occur in files: only the feature that contains them is then
/// invalid.
fn without_nan(text: &str) -> Cow<'_, str> {
    if !(text.contains("NaN") || text.contains("Infinity")) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(['"', 'N', 'I']) {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        let word = ["NaN", "Infinity"]
            .into_iter()
            .find(|word| rest.starts_with(word));
        let len = match word {
            Some(word) => {
                if out.ends_with('-') {
                    out.pop();
                }
                out.push_str("null");
                word.len()
            }
            None if rest.starts_with('"') => {
                let end = string_end(rest);
                out.push_str(&rest[..end]);
                end
            }
            None => {
                out.push_str(&rest[..1]);
                1
            }
        };
        rest = &rest[len..];
    }
    out.push_str(rest);
    Cow::Owned(out)
}

/// Where a string ends that the text begins with, its quotes included.
fn string_end(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests;
