//! Results as charts.

use super::change::{PARAMETERS, SettingChange};
use super::{ReportError, Study, SweepRow};
use crate::html::ChartFigure;
use crate::{Chart, ChartError, Point, Quartiles, Series, pareto_front};

/// A chart of the report.
#[derive(Clone, Debug)]
pub struct Plot {
    /// The file's name without its extension.
    pub name: String,
    /// Its subject: `overview`, `height`, `methods`, `orbits`, or a parameter's name.
    pub about: &'static str,
    /// Alternative text.
    pub alt_text: String,
    /// Whether it is on the page itself and not among the details.
    pub is_main: bool,
    /// The SVG document.
    pub svg: String,
}

impl Plot {
    /// For the page.
    pub(super) fn figure(&self) -> ChartFigure<'_> {
        ChartFigure::new(&self.name, &self.alt_text, &self.svg)
    }
}

/// An error that is drawn against time.
struct Metric {
    name: &'static str,
    axis: &'static str,
    of: fn(&SweepRow) -> f64,
}

/// The cost that an error is plotted against.
struct Cost {
    suffix: &'static str,
    name: &'static str,
    axis: &'static str,
    of: fn(&SweepRow) -> Quartiles,
}

const FRAME_TIME: Cost = Cost {
    suffix: "",
    name: "frame time",
    axis: "frame, ms (quartiles as bars)",
    of: |row| row.frame_ms,
};
const FLOOR_RATIO: Cost = Cost {
    suffix: "_floor",
    name: "frame over floor",
    axis: "frame over floor (quartiles as bars)",
    of: |row| row.floor_ratio,
};

/// Resolution of the strip across the limb; smaller errors are plotted as this.
const LIMB_RESOLUTION_PX: f64 = 1.0 / 128.0;

const METRICS: [Metric; 7] = [
    Metric {
        name: "flip_mean",
        axis: "FLIP, mean",
        of: |row| row.flip_mean,
    },
    Metric {
        name: "flip_p99",
        axis: "FLIP, 99th percentile",
        of: |row| row.flip_p99,
    },
    Metric {
        name: "rmse_linear",
        axis: "RMSE, linear light",
        of: |row| row.rmse_linear,
    },
    Metric {
        name: "silhouette_px",
        axis: "silhouette error, px (1/128 and less as 1/128)",
        of: |row| row.silhouette.max_px.max(LIMB_RESOLUTION_PX),
    },
    Metric {
        name: "geolocation_m",
        axis: "geolocation error, largest, m",
        of: |row| row.geolocation.max_m,
    },
    Metric {
        name: "geolocation_px",
        axis: "geolocation error, largest, px",
        of: |row| row.geolocation.max_px,
    },
    Metric {
        name: "texels_per_px",
        axis: "texels per pixel",
        of: |row| row.texels_per_px,
    },
];

/// Number of heights with a chart of all settings.
const OVERVIEWS: usize = 3;
/// Limit of heights in one chart of a sweep, for readability. The tables have all.
const LINES: usize = 4;

/// Charts of errors that hardly change over a sweep are not drawn: the largest by less than this factor over the
/// smallest, at every height.
const MIN_CHANGE: f64 = 1.05;

/// All charts of a study.
///
/// # Errors
/// The drawing library's.
pub fn plots(study: &Study) -> Result<Vec<Plot>, ReportError> {
    let mut plots = Vec::new();
    for height_km in study.some_heights(OVERVIEWS) {
        let name = format!("all_{height_km}km");
        let title = format!("All settings from {height_km} km: mean FLIP against frame time");
        let chart = overview(study, height_km, title);
        let alt_text = "Each point is one value of one setting. Ringed: no other setting is both faster and nearer to the truth.";
        push(&mut plots, name, "overview", alt_text.into(), true, &chart)?;
    }
    for (name, chart) in by_height(study) {
        let alt_text = chart.title.clone();
        push(&mut plots, name.into(), "height", alt_text, true, &chart)?;
    }
    for parameter in PARAMETERS {
        for (metric, cost) in METRICS
            .iter()
            .flat_map(|m| [(m, FRAME_TIME), (m, FLOOR_RATIO)])
        {
            let Some(chart) = sweep(study, parameter, metric, &cost) else {
                continue;
            };
            let is_limb = parameter == "subdivision" && metric.name == "silhouette_px";
            let is_main = cost.suffix.is_empty() && (metric.name == "flip_mean" || is_limb);
            let alt_text = format!("{}. Ringed: the Pareto front of each height.", chart.title);
            let name = format!("{parameter}_{}{}", metric.name, cost.suffix);
            push(&mut plots, name, parameter, alt_text, is_main, &chart)?;
        }
    }
    Ok(plots)
}

pub(super) fn push(
    plots: &mut Vec<Plot>,
    name: String,
    about: &'static str,
    alt_text: String,
    is_main: bool,
    chart: &Chart,
) -> Result<(), ReportError> {
    match chart.to_svg() {
        Ok(svg) => plots.push(Plot {
            name,
            about,
            alt_text,
            is_main,
            svg,
        }),
        Err(ChartError::Empty(_)) => {}
        Err(error) => return Err(error.into()),
    }
    Ok(())
}

/// Settings whose pictures show the same, by mean FLIP and frame time.
fn overview(study: &Study, height_km: f64, title: String) -> Chart {
    let here = |row: &&SweepRow| row.height_km == height_km && row.change.shows_the_same();
    let rows: Vec<&SweepRow> = study.rows.iter().filter(here).collect();
    let times: Vec<_> = rows
        .iter()
        .map(|r| (r.frame_ms.median, r.flip_mean))
        .collect();
    let front = pareto_front(&times);
    let mut names: Vec<&'static str> = rows.iter().map(|row| row.change.parameter()).collect();
    names.dedup();
    let series = names.into_iter().map(|name| {
        let of_it = rows.iter().zip(&front);
        let of_it = of_it.filter(|(row, _)| row.change.parameter() == name);
        Series {
            name: name.replace('_', " "),
            joined: false,
            points: of_it
                .map(|(row, on_front)| point(row.frame_ms, row.flip_mean, *on_front, label_of(row)))
                .collect(),
        }
    });
    let mut series: Vec<Series> = series.collect();
    declutter(&mut series);
    Chart {
        title,
        x_name: FRAME_TIME.axis.into(),
        y_name: "FLIP, mean".into(),
        x_log: true,
        y_log: true,
        series,
    }
}

fn label_of(row: &SweepRow) -> String {
    match row.change {
        SettingChange::Scene => "scene".into(),
        _ => row.change.value(),
    }
}

fn point(cost: Quartiles, error: f64, on_front: bool, label: String) -> Point {
    Point {
        x_error_bar: Some((cost.lower, cost.upper)),
        on_front,
        label,
        ..Point::new(cost.median, error)
    }
}

/// Room that a label takes of a logarithmic chart's width and height.
const LABEL_ROOM: (f64, f64) = (0.05, 0.04);

/// Removes overlapping labels: those on a front have priority.
fn declutter(series: &mut [Series]) {
    let all = || series.iter().flat_map(|series| &series.points);
    let span = |of: fn(&Point) -> f64| {
        let values = all().map(of).filter(|value| *value > 0.0);
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        (high / low).ln().max(0.5)
    };
    let (wide, tall) = (span(|p| p.x), span(|p| p.y));
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for fronts in [true, false] {
        for point in series.iter_mut().flat_map(|series| &mut series.points) {
            if point.on_front != fronts {
                continue;
            }
            let at = (point.x.ln() / wide, point.y.ln() / tall);
            let is_free = kept.iter().all(|other| {
                (at.0 - other.0).abs() > LABEL_ROOM.0 || (at.1 - other.1).abs() > LABEL_ROOM.1
            });
            if is_free {
                kept.push(at);
            } else {
                point.label.clear();
            }
        }
    }
}

/// The scene as it is, from every height.
fn by_height(study: &Study) -> Vec<(&'static str, Chart)> {
    let rows: Vec<&SweepRow> = study.scene_rows().collect();
    if rows.len() < 2 {
        return Vec::new();
    }
    let series = |metric: &str, name: &str| {
        let of = METRICS.iter().find(|m| m.name == metric).map(|m| m.of);
        Series {
            name: name.into(),
            joined: true,
            points: rows
                .iter()
                .map(|row| Point::new(row.height_km, of.map_or(f64::NAN, |of| of(row))))
                .collect(),
        }
    };
    let chart = |title: &str, y_name: &str, series: Vec<Series>| Chart {
        title: title.into(),
        x_name: "height, km".into(),
        y_name: y_name.into(),
        x_log: true,
        y_log: true,
        series,
    };
    let colours = vec![
        series("flip_mean", "FLIP, mean"),
        series("flip_p99", "FLIP, 99th percentile"),
        series("rmse_linear", "RMSE, linear light"),
    ];
    let geometry = vec![
        series("silhouette_px", "silhouette"),
        series("geolocation_px", "geolocation, largest"),
    ];
    vec![
        (
            "colours_by_height",
            chart("The scene as it is: errors of colour", "error", colours),
        ),
        (
            "geometry_by_height",
            chart(
                "The scene as it is: errors of limb and place",
                "error, px",
                geometry,
            ),
        ),
    ]
}

/// One error over one sweep, a line for each height; `None` if there is nothing to show.
fn sweep(study: &Study, parameter: &str, metric: &Metric, cost: &Cost) -> Option<Chart> {
    let mut series = Vec::new();
    let mut changes = metric.name == "flip_mean";
    for height_km in &study.some_heights(LINES) {
        let mut rows: Vec<&SweepRow> = study
            .rows
            .iter()
            .filter(|row| row.change.parameter() == parameter && row.height_km == *height_km)
            .collect();
        if rows.len() < 2 {
            continue;
        }
        // The position of the automatic mesh among the others follows from its result.
        if parameter == "subdivision" {
            rows.sort_by(|a, b| (metric.of)(b).total_cmp(&(metric.of)(a)));
        }
        let errors: Vec<f64> = rows.iter().map(|row| (metric.of)(row)).collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let most = errors.iter().copied().fold(0.0, f64::max);
        changes |= most > MIN_CHANGE * least;
        let times: Vec<_> = rows
            .iter()
            .zip(&errors)
            .map(|(row, error)| ((cost.of)(row).median, *error))
            .collect();
        let front = pareto_front(&times);
        let points = rows.iter().zip(&errors).zip(front);
        series.push(Series {
            name: format!("{height_km} km"),
            joined: true,
            points: points
                .map(|((row, error), on_front)| {
                    point((cost.of)(row), *error, on_front, row.change.value())
                })
                .collect(),
        });
    }
    declutter(&mut series);
    (changes && !series.is_empty()).then(|| Chart {
        title: format!(
            "{}: {} against {}",
            parameter.replace('_', " "),
            metric.axis.split(" (").next().unwrap_or_default(),
            cost.name
        ),
        x_name: cost.axis.into(),
        y_name: metric.axis.into(),
        x_log: true,
        y_log: true,
        series,
    })
}
