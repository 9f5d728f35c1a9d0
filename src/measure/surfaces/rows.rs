//! What is found of each surface, and its table.

use super::SurfacePath;
use crate::globe::SurfaceKind;
use crate::measure::Spread;
use crate::measure::errors::GroundErrors;
use std::fmt::Write;

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
    pub frame_ms: Spread,
    /// A frame over its floor, each taken in the same moment.
    pub floor_ratio: Spread,
    /// `prepare`, milliseconds.
    pub prepare_ms: Spread,
    /// The longest `prepare`, milliseconds.
    pub prepare_most_ms: f64,
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

/// First line of the table.
pub const SURFACES_CSV_HEADER: &str = "data,path,surface,parameter,value,places,frame_ms_median,frame_ms_low,frame_ms_high,floor_ratio,over_blocks,\
prepare_ms_median,prepare_ms_most,vertices,triangles,resident_bytes,gpu_bytes,uploaded_bytes,error_m_median,error_m_p99,\
error_m_max,error_px_median,error_px_p99,error_px_max,holes_px,elsewhere_percent,popping_px";

/// The table.
pub fn surfaces_csv(rows: &[SurfaceRow]) -> String {
    let mut text = format!("{SURFACES_CSV_HEADER}\n");
    for row in rows {
        let (setting, errors) = (&row.setting, &row.errors);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{:.3},{:.3},{:.3},{:.3},{:.3},{:.3},{:.3},{},{},{},{},{:.0},{:.3},{:.3},{:.3},{:.4},{:.4},{:.4},{},{:.4},{:.4}",
            row.data,
            row.path.name(),
            setting.surface,
            setting.parameter,
            setting.value,
            row.places,
            row.frame_ms.median,
            row.frame_ms.low,
            row.frame_ms.high,
            row.floor_ratio.median,
            over_blocks(row, rows).unwrap_or(f64::NAN),
            row.prepare_ms.median,
            row.prepare_most_ms,
            row.vertices,
            row.triangles,
            row.resident_bytes,
            row.gpu_bytes,
            row.uploaded_bytes,
            errors.median_m,
            errors.p99_m,
            errors.max_m,
            errors.median_px,
            errors.p99_px,
            errors.max_px,
            errors.holes,
            errors.elsewhere_percent(),
            row.popping_px,
        );
    }
    text
}
