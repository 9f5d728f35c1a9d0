//! The charts of a run.

use super::report::{BenchReport, BenchRow, Course};
use crate::{Chart, GroundPath, Point, Series};

/// Names of the files, in the order of [`charts`].
pub(super) const NAMES: [&str; 3] = ["frames_per_s.svg", "floor_ratio.svg", "features.svg"];

/// Frames per second and frame over floor by height, and the features' costs.
pub(super) fn charts(report: &BenchReport) -> [Chart; 3] {
    let [width, height] = report.size;
    let run = format!("{width} × {height}, {} samples", report.samples);
    let by_height = |title: String, y_name: &str, series| Chart {
        title,
        x_name: "height of the eye, km".into(),
        y_name: y_name.into(),
        x_log: true,
        y_log: false,
        series,
    };
    let mut speed = by_path(report, |row| Some(row.frames_per_s));
    let equator = report
        .rows
        .iter()
        .filter(|r| r.path == GroundPath::Equatorial);
    speed.push(Series {
        name: "the paper, another machine (2011)".into(),
        points: points(equator, |row| row.paper_frames_per_s),
        joined: true,
    });
    let of_flight = report.features.iter();
    let of_flight = of_flight.filter(|feature| feature.course == Course::Flight);
    let features = of_flight.map(|feature| Point {
        label: feature.name.clone(),
        ..Point::new(
            feature.texture_bytes as f64 * 1e-6,
            100.0 * (feature.frame_ratio - 1.0),
        )
    });
    [
        by_height(
            format!("Frames per second, {run}"),
            "frames per second",
            speed,
        ),
        by_height(
            format!("A frame over its floor, {run}"),
            "frame time over floor time",
            by_path(report, |row| Some(row.floor_ratio)),
        ),
        Chart {
            title: format!("What each layer and effect costs, {run}"),
            x_name: "textures held for it, MB".into(),
            y_name: "time added to the frame without it, %".into(),
            x_log: false,
            y_log: false,
            series: vec![Series {
                name: "layers and effects".into(),
                points: features.collect(),
                joined: false,
            }],
        },
    ]
}

fn by_path(report: &BenchReport, value: impl Fn(&BenchRow) -> Option<f64> + Copy) -> Vec<Series> {
    let series = GroundPath::ALL.map(|path| Series {
        name: match path {
            GroundPath::Equatorial => "along the equator".into(),
            GroundPath::Inclined => "along a path inclined by 51.6°".into(),
        },
        points: points(report.rows.iter().filter(|row| row.path == path), value),
        joined: true,
    });
    series.into()
}

fn points<'r>(
    rows: impl Iterator<Item = &'r BenchRow>,
    value: impl Fn(&BenchRow) -> Option<f64>,
) -> Vec<Point> {
    rows.filter_map(|row| Some(Point::new(row.height_km, value(row)?)))
        .collect()
}
