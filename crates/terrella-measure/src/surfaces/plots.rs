//! Results as charts.

use super::{ErrorRow, FlightSummary, SurfacePath, SurfaceStudy, SurfacesError};
use crate::{Chart, ChartError, Point, Series, pareto_front};

/// A chart.
pub(super) struct SurfacePlot {
    /// The file's name without its extension.
    pub name: String,
    /// The ground.
    pub data: String,
    /// The flight.
    pub path: SurfacePath,
    /// The SVG document.
    pub svg: String,
}

/// Smallest error that a logarithmic axis shows, pixels.
const MIN_PX: f64 = 1e-3;

/// Error against cost, a chart for each ground and flight.
pub(super) fn plots(study: &SurfaceStudy) -> Result<Vec<SurfacePlot>, SurfacesError> {
    let mut plots = Vec::new();
    for data in study.data() {
        for path in SurfacePath::ALL {
            let timed = study.of(data, path);
            let timed = timed.filter_map(|row| Some((row, study.summary_of(row)?)));
            let rows: Vec<_> = timed.collect();
            let at = |(row, cost): &(&ErrorRow, FlightSummary)| {
                (cost.over_blocks.median, row.error_px_p99.max(MIN_PX))
            };
            let front = pareto_front(&rows.iter().map(at).collect::<Vec<_>>());
            let mut series: Vec<Series> = Vec::new();
            for (one, on_front) in rows.iter().zip(front) {
                let (row, cost) = one;
                let name = row.surface.name();
                let (x, y) = at(one);
                let point = Point {
                    x_error_bar: Some((cost.over_blocks.lower, cost.over_blocks.upper)),
                    label: row.value.clone(),
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
                x_name: "frame over one of blocks (quartiles as bars)".into(),
                y_name: "screen-space error over the flight, 99th percentile, px".into(),
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
                data: data.to_owned(),
                path,
                svg,
            });
        }
    }
    Ok(plots)
}
