//! Results as one page.

use super::markdown::{COLUMNS, numbers};
use super::plots::SurfacePlot;
use super::{ErrorRow, SettlingRow, SurfacePath, SurfaceStudy};
use crate::html::{self, PageError, STYLE};
use serde::Serialize;

/// Values of `surfaces.html`; numbers are formatted.
#[derive(Serialize)]
struct Values<'s> {
    style: &'static str,
    version: &'static str,
    adapter: &'s str,
    size: (u32, u32),
    is_partial: bool,
    columns: &'static [&'static str],
    near_ground: Option<&'static str>,
    choices: Vec<Choice<'s>>,
    flights: Vec<FlightTable<'s>>,
    settling: Vec<Settling<'s>>,
}

/// The surface to choose for a flight.
#[derive(Serialize)]
struct Choice<'s> {
    ground: &'s str,
    flight: &'s str,
    surface: &'s str,
    setting: String,
    over_blocks: String,
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
    /// In the order of the columns.
    numbers: Vec<String>,
}

#[derive(Serialize)]
struct Settling<'s> {
    ground: &'s str,
    surface: &'s str,
    setting: String,
    frames: u32,
    frames_to_double: u32,
    first_px: String,
    settled_px: String,
    prepare_ms: String,
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
        is_partial: study.is_partial,
        columns: &COLUMNS,
        near_ground: study.default_surface().map(|surface| surface.name()),
        choices: all()
            .filter_map(|(ground, path)| Some(Choice::new(study.choice(ground, path)?, study)))
            .collect(),
        flights: all()
            .map(|(ground, path)| FlightTable::new(study, plots, ground, path))
            .filter(|flight| !flight.rows.is_empty())
            .collect(),
        settling: study.settling.iter().map(Settling::new).collect(),
    };
    html::page("surfaces.html", include_str!("surfaces.html"), &values)
}

impl<'s> Choice<'s> {
    fn new(row: &'s ErrorRow, study: &SurfaceStudy) -> Self {
        let cost = study.summary_of(row);
        Self {
            ground: &row.data,
            flight: row.path.name(),
            surface: row.surface.name(),
            setting: setting(&row.parameter, &row.value),
            over_blocks: cost
                .map_or_else(|| "–".into(), |c| format!("{:.2}", c.over_blocks.median)),
            p99_px: format!("{:.2}", row.error_px_p99),
        }
    }
}

impl<'s> FlightTable<'s> {
    fn new(
        study: &'s SurfaceStudy,
        plots: &'s [SurfacePlot],
        ground: &'s str,
        path: SurfacePath,
    ) -> Self {
        let plots = plots.iter().filter(|p| p.data == ground && p.path == path);
        let row = |row: &'s ErrorRow| Row {
            surface: row.surface.name(),
            setting: setting(&row.parameter, &row.value),
            is_default: row.is_default,
            numbers: numbers(row, study.summary_of(row).as_ref()).into(),
        };
        Self {
            ground,
            name: path.name(),
            charts: plots.map(|plot| plot.name.as_str()).collect(),
            rows: study.of(ground, path).map(row).collect(),
        }
    }
}

impl<'s> Settling<'s> {
    fn new(row: &'s SettlingRow) -> Self {
        Self {
            ground: &row.data,
            surface: row.surface.name(),
            setting: setting(&row.parameter, &row.value),
            frames: row.frames,
            frames_to_double: row.frames_to_double,
            first_px: format!("{:.1}", row.first_px),
            settled_px: format!("{:.2}", row.settled_px),
            prepare_ms: format!("{:.1}", row.prepare_ms_most),
        }
    }
}

fn setting(parameter: &str, value: &str) -> String {
    format!("{parameter} {value}")
}
