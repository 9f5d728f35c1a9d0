//! What is found, as charts and one page.

use super::rows::over_blocks;
use super::{SurfacePath, SurfaceRow, SurfaceStudy, SurfacesError};
use crate::measure::report::{STYLE, escaped};
use crate::measure::{Chart, ChartError, Point, Series, pareto_front};
use std::fmt::Write;

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
const LEAST_PX: f64 = 1e-3;

impl SurfaceStudy {
    /// The grounds, in order.
    pub fn data(&self) -> Vec<&'static str> {
        let mut names = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.data) {
                names.push(row.data);
            }
        }
        names
    }

    /// Which surface to choose, as text for a terminal: a line for each ground and flight.
    pub fn summary(&self) -> String {
        let mut text = String::new();
        for data in self.data() {
            for path in SurfacePath::ALL {
                let Some(row) = self.choice(data, path) else {
                    continue;
                };
                let _ = writeln!(
                    text,
                    "{data}, {}: {} ({} {}): {:.2} of the floor, {:.2} px",
                    path.name(),
                    row.setting.surface,
                    row.setting.parameter,
                    row.setting.value,
                    row.floor_ratio.median,
                    row.errors.p99_px,
                );
            }
        }
        text
    }

    fn of(&self, data: &str, path: SurfacePath) -> Vec<&SurfaceRow> {
        let rows = self.rows.iter();
        rows.filter(|row| row.data == data && row.path == path)
            .collect()
    }

    /// The cheapest setting without holes whose error 99 of a hundred pixels keep below a pixel, else the most exact
    /// without holes.
    pub fn choice(&self, data: &str, path: SurfacePath) -> Option<&SurfaceRow> {
        let rows = self.of(data, path).into_iter();
        let sound: Vec<_> = rows.filter(|row| row.errors.holes == 0).collect();
        let exact = sound.iter().filter(|row| row.errors.p99_px <= 1.0);
        let cheapest = exact.min_by(|a, b| a.floor_ratio.median.total_cmp(&b.floor_ratio.median));
        let least = || {
            sound
                .iter()
                .min_by(|a, b| a.errors.p99_px.total_cmp(&b.errors.p99_px))
        };
        cheapest.or_else(least).copied()
    }
}

/// Error against frame time, a chart for each ground and flight.
pub(super) fn plots(study: &SurfaceStudy) -> Result<Vec<SurfacePlot>, SurfacesError> {
    let mut plots = Vec::new();
    for data in study.data() {
        for path in SurfacePath::ALL {
            let rows = study.of(data, path);
            let at = |row: &SurfaceRow| (row.frame_ms.median, row.errors.p99_px.max(LEAST_PX));
            let front = pareto_front(&rows.iter().map(|row| at(row)).collect::<Vec<_>>());
            let mut series: Vec<Series> = Vec::new();
            for (row, on_front) in rows.iter().zip(front) {
                let name = row.setting.surface;
                let (x, y) = at(row);
                let point = Point {
                    x_spread: Some((row.frame_ms.low, row.frame_ms.high)),
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

/// The page. Writing to a string does not fail, so its results are not looked at.
pub(super) fn page(study: &SurfaceStudy, plots: &[SurfacePlot]) -> String {
    let mut out = String::new();
    let _ = write!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Surfaces with relief</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>Surfaces with relief</h1>\n<p class=\"with\">{} · frames of {} × {} \
         pixels, {} of each flight · errors in pictures of {} × {} · terrella {}</p>\n",
        escaped(&study.adapter),
        study.size.0,
        study.size.1,
        study.places,
        study.compared_size.0,
        study.compared_size.1,
        env!("CARGO_PKG_VERSION"),
    );
    if study.rows.len() < study.wanted {
        let _ = writeln!(
            out,
            "<p class=\"partial\">Partial: the run was stopped after {} of {} flights.</p>",
            study.rows.len(),
            study.wanted
        );
    }
    choices(&mut out, study);
    for data in study.data() {
        for path in SurfacePath::ALL {
            table(&mut out, study, data, path, plots);
        }
    }
    out.push_str(
        "<h2>What the columns say</h2>\n<p>Errors compare each pixel's drawn ground with the data at their finest over the same \
         place: vertically in metres, and as seen from the eye in pixels; the largest of all frames is told. Holes are \
         pixels of space where ground must be. Elsewhere are pixels whose place is to \
         appear more than a pixel away or, ray by ray, lies behind other ground: peaks that are missing, and what they would \
         hide. Popping is the largest change of the error in pixels from a frame to the \
         next, a sixtieth of a second later. Frame times are of the whole picture, maps and air included, the device waited \
         for; the floor takes as many texture samples on the smooth Earth and computes nothing.</p>\n</body>\n</html>\n",
    );
    out
}

fn choices(out: &mut String, study: &SurfaceStudy) {
    out.push_str(
        "<h2>Which to choose</h2>\n<p>The cheapest without holes whose error 99 of a hundred pixels keep below one; where none \
         does, the most exact.</p>\n<div class=\"scroll\"><table>\n<tr><th>ground</th><th>flight</th><th>surface</th>\
         <th>setting</th><th>over floor</th><th>99 %, px</th></tr>\n",
    );
    for data in study.data() {
        for path in SurfacePath::ALL {
            let Some(row) = study.choice(data, path) else {
                continue;
            };
            let _ = writeln!(
                out,
                "<tr><td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{} \
                 {}</td><td>{:.2}</td><td>{:.2}</td></tr>",
                escaped(data),
                path.name(),
                row.setting.surface,
                row.setting.parameter,
                escaped(&row.setting.value),
                row.floor_ratio.median,
                row.errors.p99_px,
            );
        }
    }
    out.push_str("</table></div>\n");
}

fn table(
    out: &mut String,
    study: &SurfaceStudy,
    data: &str,
    path: SurfacePath,
    plots: &[SurfacePlot],
) {
    let rows = study.of(data, path);
    if rows.is_empty() {
        return;
    }
    let _ = writeln!(out, "<h2>{}, {}</h2>", escaped(data), path.name());
    for plot in plots.iter().filter(|p| p.data == data && p.path == path) {
        let _ = writeln!(
            out,
            "<img src=\"plots/{0}.svg\" alt=\"Error against frame time, {1}, {2}\">",
            plot.name,
            escaped(data),
            path.name()
        );
    }
    out.push_str(
        "<div class=\"scroll\"><table>\n<tr><th>surface</th><th>setting</th><th>frame<br>ms</th><th>over<br>floor</th><th>over<br>blocks</th>\
         <th>prepare<br>ms</th><th>most</th><th>vertices</th><th>triangles</th><th>memory<br>MB</th><th>GPU<br>MB</th>\
         <th>written<br>kB a frame</th><th>median<br>m</th><th>99 %<br>m</th><th>largest<br>m</th><th>99 %<br>px</th>\
         <th>largest<br>px</th><th>holes<br>px</th><th>elsewhere<br>%</th><th>popping<br>px</th></tr>\n",
    );
    for row in rows {
        let (errors, setting) = (&row.errors, &row.setting);
        let class = if setting.is_default {
            " class=\"here\""
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "<tr{class}><td class=\"text\">{}</td><td class=\"text\">{} {}</td><td>{:.1}</td><td>{:.2}</td><td>{:.2}</td><td>{:.2}</td>\
             <td>{:.2}</td><td>{}</td><td>{}</td><td>{:.1}</td><td>{:.1}</td><td>{:.0}</td><td>{:.1}</td><td>{:.1}</td>\
             <td>{:.0}</td><td>{:.2}</td><td>{:.2}</td><td>{}</td><td>{:.2}</td><td>{:.2}</td></tr>",
            setting.surface,
            setting.parameter,
            escaped(&setting.value),
            row.frame_ms.median,
            row.floor_ratio.median,
            over_blocks(row, &study.rows).unwrap_or(f64::NAN),
            row.prepare_ms.median,
            row.prepare_most_ms,
            row.vertices,
            row.triangles,
            row.resident_bytes as f64 / 1e6,
            row.gpu_bytes as f64 / 1e6,
            row.uploaded_bytes / 1e3,
            errors.median_m,
            errors.p99_m,
            errors.max_m,
            errors.p99_px,
            errors.max_px,
            errors.holes,
            errors.elsewhere_percent(),
            row.popping_px,
        );
    }
    out.push_str("</table></div>\n");
}
