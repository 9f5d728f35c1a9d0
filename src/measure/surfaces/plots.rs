//! What is found, as charts.

use super::{SurfacePath, SurfaceRow, SurfaceStudy, SurfacesError};
use crate::measure::{Chart, ChartError, Point, Series, pareto_front};

/// A chart.
pub(super) struct SurfacePlot {
    /// The file's name without its extension.
    pub name: String,
    /// The ground.
    pub data: &'static str,
    /// The flight.
    pub path: SurfacePath,
    /// The SVG document.
    pub svg: String,
}

/// Smallest error that a logarithmic axis shows, pixels.
const MIN_PX: f64 = 1e-3;

/// Error against frame time, a chart for each ground and flight.
pub(super) fn plots(study: &SurfaceStudy) -> Result<Vec<SurfacePlot>, SurfacesError> {
    let mut plots = Vec::new();
    for data in study.data() {
        for path in SurfacePath::ALL {
            let rows = study.of(data, path);
            let at = |row: &SurfaceRow| (row.frame_ms.median, row.errors.p99_px.max(MIN_PX));
            let front = pareto_front(&rows.iter().map(|row| at(row)).collect::<Vec<_>>());
            let mut series: Vec<Series> = Vec::new();
            for (row, on_front) in rows.iter().zip(front) {
                let name = row.setting.surface;
                let (x, y) = at(row);
                let point = Point {
                    x_error_bar: Some((row.frame_ms.lower, row.frame_ms.upper)),
                    label: row.setting.value.clone(),
                    on_front,
                    ..Point::new(x, y)
                };
                match series.iter_mut().find(|series| series.name == name) {
                    Some(series) => series.points.push(point),
                    None => series.push(Series {
                        name: name.to_owned(),
                        points: vec![point],
                        joined: true,
                    }),
                }
            }
            let chart = Chart {
                title: format!("{data}, {}", path.name()),
                x_name: "frame, ms (quartiles as bars)".into(),
                y_name: "screen-space error, 99th percentile, px".into(),
                x_log: true,
                y_log: true,
                series,
            };
            let svg = match chart.to_svg() {
                Err(ChartError::Empty(_)) => continue,
                svg => svg?,
            };
            let name = format!("surfaces_{data}_{}", path.name()).replace([' ', ','], "_");
            plots.push(SurfacePlot {
                name,
                data,
                path,
                svg,
            });
        }
    }
    Ok(plots)
}
