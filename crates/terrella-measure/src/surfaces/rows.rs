//! Results of each surface, and their tables.

use super::SurfacePath;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use terrella_ground::globe::SurfaceKind;
use terrella_play::scene::DEFAULT_TOLERANCE_PX;

/// A surface with one of its settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    pub surface: SurfaceKind,
    /// The changed parameter.
    pub parameter: &'static str,
    pub value: String,
    /// Whether it is the default.
    pub is_default: bool,
}

/// The parameter of contours that are cast.
pub const CAST: &str = "cast at tolerance px";

impl Setting {
    /// Whether it is a default, or contours cast with the tolerance of scenes: the rows in tables of all surfaces.
    pub fn is_shown(&self) -> bool {
        self.is_default || is_cast_at_default(self.parameter, &self.value)
    }
}

fn is_cast_at_default(parameter: &str, value: &str) -> bool {
    parameter == CAST && value.parse() == Ok(DEFAULT_TOLERANCE_PX)
}

impl ErrorRow {
    /// As [`Setting::is_shown`].
    pub fn is_shown(&self) -> bool {
        self.is_default || is_cast_at_default(&self.parameter, &self.value)
    }
}

impl SettlingRow {
    /// As [`Setting::is_shown`].
    pub fn is_shown(&self) -> bool {
        self.is_default || is_cast_at_default(&self.parameter, &self.value)
    }
}

/// A row that a later one of the same flight and setting takes the place of.
pub trait Keyed {
    /// Terrain, flight (`None`: of all), surface, parameter and value.
    fn key(&self) -> (&str, Option<SurfacePath>, SurfaceKind, &str, &str);
}

impl Keyed for ErrorRow {
    fn key(&self) -> (&str, Option<SurfacePath>, SurfaceKind, &str, &str) {
        let path = Some(self.path);
        (&self.data, path, self.surface, &self.parameter, &self.value)
    }
}

impl Keyed for TimeRow {
    fn key(&self) -> (&str, Option<SurfacePath>, SurfaceKind, &str, &str) {
        let path = Some(self.path);
        (&self.data, path, self.surface, &self.parameter, &self.value)
    }
}

impl Keyed for SettlingRow {
    fn key(&self) -> (&str, Option<SurfacePath>, SurfaceKind, &str, &str) {
        (&self.data, None, self.surface, &self.parameter, &self.value)
    }
}

/// Puts rows of one key in the place of those that have it, or at the end.
pub fn replace<Row: Keyed>(rows: &mut Vec<Row>, with: Vec<Row>) {
    let Some(first) = with.first() else {
        return;
    };
    let place = rows.iter().position(|row| row.key() == first.key());
    let place = place.unwrap_or(rows.len());
    rows.retain(|row| row.key() != first.key());
    rows.splice(place..place, with);
}

/// Errors of one setting on one flight over one test terrain, and its frame times. Over all frames of the flight, with a fixed fraction of the
/// pixels of each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorRow {
    /// The ground's name.
    pub data: String,
    /// The flight.
    pub path: SurfacePath,
    /// The surface.
    pub surface: SurfaceKind,
    /// The changed parameter.
    pub parameter: String,
    pub value: String,
    /// Whether it is the default.
    pub is_default: bool,
    /// Frames flown.
    pub frames: u32,
    /// Time that the thread works in `prepare`, milliseconds: what half of the frames do not exceed.
    pub prepare_ms_median: f64,
    /// 99th percentile.
    pub prepare_ms_p99: f64,
    /// The longest.
    pub prepare_ms_most: f64,
    /// Triangles drawn: what half of the frames do not exceed.
    pub triangles_median: u64,
    /// Triangles drawn, at most.
    pub triangles_most: u64,
    /// Vertices drawn, at most.
    pub vertices_most: u64,
    /// Bytes of memory, at most.
    pub resident_bytes: u64,
    /// Bytes on the GPU, at most.
    pub gpu_bytes: u64,
    /// Bytes written to the GPU in a frame, median.
    pub written_bytes_median: u64,
    /// Vertical distance of drawn ground from the data, metres: what half of the pixels do not exceed.
    pub error_m_median: f64,
    /// 99th percentile over pixels.
    pub error_m_p99: f64,
    /// Largest.
    pub error_m_most: f64,
    /// How far drawn ground appears from where its place should, pixels of the picture: what half do not exceed.
    pub error_px_median: f64,
    /// 99th percentile over pixels.
    pub error_px_p99: f64,
    /// Largest.
    pub error_px_most: f64,
    /// 99th percentile over the pixels of the worst frame.
    pub worst_frame_px: f64,
    /// The largest error that the surface itself reports, pixels; `None` where it has no bound.
    pub reported_px_most: Option<f64>,
    /// Holes among the pixels that were looked at.
    pub holes: u64,
    /// Part of the pixels that show what is not to be seen there, %.
    pub elsewhere_percent: f64,
    /// How much the error of a place changes from a frame to the next, pixels: what 999 of a thousand do not exceed.
    pub popping_px_p999: f64,
    /// Largest.
    pub popping_px_most: f64,
}

/// One frame that was timed beside its floor and a frame of blocks, in the same moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeRow {
    /// The ground's name.
    pub data: String,
    /// The flight.
    pub path: SurfacePath,
    /// The surface.
    pub surface: SurfaceKind,
    /// The changed parameter.
    pub parameter: String,
    pub value: String,
    /// Seconds of the flight.
    pub time_s: f64,
    /// The frame, milliseconds.
    pub frame_ms: f64,
    /// Time that all threads of this process worked meanwhile, milliseconds: with a software adapter, what the frame costs.
    pub processor_ms: f64,
    /// The floor, milliseconds.
    pub floor_ms: f64,
    /// The frame of blocks, milliseconds.
    pub blocks_ms: f64,
    /// Time that all threads worked on that, milliseconds.
    pub blocks_processor_ms: f64,
}

/// How one setting becomes fine after a jump.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SettlingRow {
    /// The ground's name.
    pub data: String,
    /// The surface.
    pub surface: SurfaceKind,
    /// The changed parameter.
    pub parameter: String,
    pub value: String,
    /// Whether it is the default.
    pub is_default: bool,
    /// The frame from which on its error is as it stays, the first after the jump being 0.
    pub frames: u32,
    /// The frame from which on it is at most twice what stays.
    pub frames_to_double: u32,
    /// Error in the first frame, pixels: what 99 of a hundred do not exceed.
    pub first_px: f64,
    /// As it stays.
    pub settled_px: f64,
    /// The longest `prepare` on the way, milliseconds of the thread.
    pub prepare_ms_most: f64,
}

/// A value for tables: rounded to this many decimals, and clamped to [`MOST`], which represents an unbounded value.
pub(super) fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    let value = if value.is_nan() {
        MOST
    } else {
        value.clamp(-MOST, MOST)
    };
    (value * scale).round() / scale
}

/// The largest value of a table.
const MOST: f64 = 1e9;

/// A table as text.
pub fn csv_of<Row: Serialize>(rows: &[Row]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        // Writing plain values to memory cannot fail.
        let _ = writer.serialize(row);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A table from its text.
///
/// # Errors
/// A line that is no row of it, with its number.
pub fn rows_of<Row: DeserializeOwned>(text: &str) -> Result<Vec<Row>, csv::Error> {
    csv::Reader::from_reader(text.as_bytes())
        .deserialize()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_as_they_were_written() {
        let row = SettlingRow {
            data: "worst case".into(),
            surface: SurfaceKind::ProjectedGrid,
            parameter: "samples".into(),
            value: "129, \"made\" on the CPU".into(),
            is_default: false,
            frames: 7,
            frames_to_double: 3,
            first_px: rounded(f64::INFINITY, 4),
            settled_px: rounded(0.123_456, 4),
            prepare_ms_most: 1.5,
        };
        let text = csv_of(&[row.clone(), row.clone()]);
        assert_eq!(
            rows_of::<SettlingRow>(&text).expect("sound"),
            [row.clone(), row.clone()]
        );
        let mut rows = vec![row.clone()];
        let other = SettlingRow {
            data: "globe".into(),
            ..row.clone()
        };
        replace(&mut rows, vec![other.clone()]);
        replace(
            &mut rows,
            vec![SettlingRow {
                frames: 9,
                ..row.clone()
            }],
        );
        assert_eq!((rows.len(), rows[0].frames, &rows[1]), (2, 9, &other));
        let wrong = text.replace("projected-grid", "sphere");
        let error = rows_of::<SettlingRow>(&wrong).expect_err("no such surface");
        assert!(error.to_string().contains("line: 2"), "{error}");
        assert_eq!((rounded(f64::NAN, 3), rounded(-1.23456, 3)), (MOST, -1.235));
    }
}
