//! What is found of each surface, and its table.

use super::SurfacePath;
use crate::globe::SurfaceKind;
use crate::measure::Quartiles;
use crate::measure::errors::GroundErrors;
use crate::measure::output::csv_text;

/// A surface with one of its settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The surface's name, as scenes write it.
    pub surface: &'static str,
    /// What is set.
    pub parameter: &'static str,
    /// To what.
    pub value: String,
    /// Whether this is what a scene gets that sets nothing.
    pub is_default: bool,
}

impl Setting {
    /// The parameter and its value.
    pub fn text(&self) -> String {
        format!("{} {}", self.parameter, self.value)
    }
}

/// One setting on one flight over one ground.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceRow {
    /// The ground's name.
    pub data: &'static str,
    /// The flight.
    pub path: SurfacePath,
    /// What draws it.
    pub setting: Setting,
    /// Places of the flight that were measured.
    pub places: u32,
    /// A frame, milliseconds.
    pub frame_ms: Quartiles,
    /// A frame over its floor, each taken in the same moment.
    pub floor_ratio: Quartiles,
    /// `prepare`, milliseconds.
    pub prepare_ms: Quartiles,
    /// The longest `prepare`, milliseconds.
    pub max_prepare_ms: f64,
    /// Vertices drawn, at most.
    pub vertices: u32,
    /// Triangles drawn, at most.
    pub triangles: u32,
    /// Bytes of memory, at most.
    pub resident_bytes: u64,
    /// Bytes on the GPU, at most.
    pub gpu_bytes: u64,
    /// Bytes written to the GPU in a frame, median.
    pub uploaded_bytes: f64,
    /// Errors, each the largest of all places; pixels and holes are summed.
    pub errors: GroundErrors,
    /// Largest jump from a frame to the next, pixels.
    pub popping_px: f64,
}

/// A frame over one of the blocks' default on the same ground and flight, each taken as a multiple of its floor.
pub fn over_blocks(row: &SurfaceRow, rows: &[SurfaceRow]) -> Option<f64> {
    let blocks = rows.iter().find(|other| {
        let setting = &other.setting;
        let same_flight = other.data == row.data && other.path == row.path;
        same_flight && setting.is_default && setting.surface == SurfaceKind::Blocks.name()
    })?;
    Some(row.floor_ratio.median / blocks.floor_ratio.median)
}

/// The columns of the table.
pub const SURFACES_CSV_COLUMNS: [&str; 27] = [
    "data",
    "path",
    "surface",
    "parameter",
    "value",
    "places",
    "frame_ms_median",
    "frame_ms_low",
    "frame_ms_high",
    "floor_ratio",
    "over_blocks",
    "prepare_ms_median",
    "prepare_ms_most",
    "vertices",
    "triangles",
    "resident_bytes",
    "gpu_bytes",
    "uploaded_bytes",
    "error_m_median",
    "error_m_p99",
    "error_m_max",
    "error_px_median",
    "error_px_p99",
    "error_px_max",
    "holes_px",
    "elsewhere_percent",
    "popping_px",
];

/// The table.
pub fn surfaces_csv(rows: &[SurfaceRow]) -> String {
    let head = SURFACES_CSV_COLUMNS.map(str::to_owned);
    let lines = rows.iter().map(|row| row.fields(over_blocks(row, rows)));
    csv_text(std::iter::once(head).chain(lines))
}

impl SurfaceRow {
    /// Its line of the table; `over_blocks` is that of [`over_blocks`].
    fn fields(&self, over_blocks: Option<f64>) -> [String; SURFACES_CSV_COLUMNS.len()] {
        let (setting, errors) = (&self.setting, &self.errors);
        [
            self.data.to_owned(),
            self.path.name().to_owned(),
            setting.surface.to_owned(),
            setting.parameter.to_owned(),
            setting.value.clone(),
            self.places.to_string(),
            format!("{:.3}", self.frame_ms.median),
            format!("{:.3}", self.frame_ms.lower),
            format!("{:.3}", self.frame_ms.upper),
            format!("{:.3}", self.floor_ratio.median),
            format!("{:.3}", over_blocks.unwrap_or(f64::NAN)),
            format!("{:.3}", self.prepare_ms.median),
            format!("{:.3}", self.max_prepare_ms),
            self.vertices.to_string(),
            self.triangles.to_string(),
            self.resident_bytes.to_string(),
            self.gpu_bytes.to_string(),
            format!("{:.0}", self.uploaded_bytes),
            format!("{:.3}", errors.median_m),
            format!("{:.3}", errors.p99_m),
            format!("{:.3}", errors.max_m),
            format!("{:.4}", errors.median_px),
            format!("{:.4}", errors.p99_px),
            format!("{:.4}", errors.max_px),
            errors.holes.to_string(),
            format!("{:.4}", errors.elsewhere_percent()),
            format!("{:.4}", self.popping_px),
        ]
    }
}
