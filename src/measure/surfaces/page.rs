//! What is found, as one page.

use super::plots::SurfacePlot;
use super::rows::over_blocks;
use super::{SurfacePath, SurfaceRow, SurfaceStudy};
use crate::measure::html::{self, PageError, STYLE};
use serde::Serialize;

/// What `surfaces.html` is filled with; numbers are text already.
#[derive(Serialize)]
struct Values<'s> {
    style: &'static str,
    version: &'static str,
    adapter: &'s str,
    size: (u32, u32),
    compared_size: (u32, u32),
    places: u32,
    partial: Option<Partial>,
    choices: Vec<Choice<'s>>,
    flights: Vec<FlightTable<'s>>,
}

/// How much of a run that was stopped is there.
#[derive(Serialize)]
struct Partial {
    done: usize,
    wanted: usize,
}

/// The surface to choose for a flight.
#[derive(Serialize)]
struct Choice<'s> {
    ground: &'s str,
    flight: &'s str,
    surface: &'s str,
    setting: String,
    floor_ratio: String,
    p99_px: String,
}

/// All surfaces on one flight over one ground.
#[derive(Serialize)]
struct FlightTable<'s> {
    ground: &'s str,
    name: &'s str,
    /// Names of files.
    charts: Vec<&'s str>,
    rows: Vec<Row<'s>>,
}

#[derive(Serialize)]
struct Row<'s> {
    surface: &'s str,
    setting: String,
    is_default: bool,
    /// In the order of the table's columns.
    numbers: [String; 18],
}

/// The page as HTML.
///
/// # Errors
/// As [`html::page`].
pub(super) fn page(study: &SurfaceStudy, plots: &[SurfacePlot]) -> Result<String, PageError> {
    let all = || {
        let grounds = study.data().into_iter();
        grounds.flat_map(|ground| SurfacePath::ALL.map(|path| (ground, path)))
    };
    let values = Values {
        style: STYLE,
        version: env!("CARGO_PKG_VERSION"),
        adapter: &study.adapter,
        size: study.size,
        compared_size: study.compared_size,
        places: study.places,
        partial: (study.rows.len() < study.wanted).then_some(Partial {
            done: study.rows.len(),
            wanted: study.wanted,
        }),
        choices: all()
            .filter_map(|(ground, path)| study.choice(ground, path).map(Choice::new))
            .collect(),
        flights: all()
            .filter_map(|(ground, path)| FlightTable::new(study, plots, ground, path))
            .collect(),
    };
    html::page("surfaces.html", include_str!("surfaces.html"), &values)
}

impl<'s> Choice<'s> {
    fn new(row: &'s SurfaceRow) -> Self {
        Self {
            ground: row.data,
            flight: row.path.name(),
            surface: row.setting.surface,
            setting: row.setting.text(),
            floor_ratio: format!("{:.2}", row.floor_ratio.median),
            p99_px: format!("{:.2}", row.errors.p99_px),
        }
    }
}

impl<'s> FlightTable<'s> {
    /// `None` where nothing was measured.
    fn new(
        study: &'s SurfaceStudy,
        plots: &'s [SurfacePlot],
        ground: &'static str,
        path: SurfacePath,
    ) -> Option<Self> {
        let rows = study.of(ground, path);
        let plots = plots.iter().filter(|p| p.data == ground && p.path == path);
        (!rows.is_empty()).then(|| Self {
            ground,
            name: path.name(),
            charts: plots.map(|plot| plot.name.as_str()).collect(),
            rows: rows.into_iter().map(|row| Row::new(row, study)).collect(),
        })
    }
}

impl<'s> Row<'s> {
    fn new(row: &'s SurfaceRow, study: &SurfaceStudy) -> Self {
        let errors = &row.errors;
        let over_blocks = over_blocks(row, &study.rows).unwrap_or(f64::NAN);
        Self {
            surface: row.setting.surface,
            setting: row.setting.text(),
            is_default: row.setting.is_default,
            numbers: [
                format!("{:.1}", row.frame_ms.median),
                format!("{:.2}", row.floor_ratio.median),
                format!("{over_blocks:.2}"),
                format!("{:.2}", row.prepare_ms.median),
                format!("{:.2}", row.max_prepare_ms),
                row.vertices.to_string(),
                row.triangles.to_string(),
                format!("{:.1}", row.resident_bytes as f64 / 1e6),
                format!("{:.1}", row.gpu_bytes as f64 / 1e6),
                format!("{:.0}", row.uploaded_bytes / 1e3),
                format!("{:.1}", errors.median_m),
                format!("{:.1}", errors.p99_m),
                format!("{:.0}", errors.max_m),
                format!("{:.2}", errors.p99_px),
                format!("{:.2}", errors.max_px),
                errors.holes.to_string(),
                format!("{:.2}", errors.elsewhere_percent()),
                format!("{:.2}", row.popping_px),
            ],
        }
    }
}
