//! What is found, as one page that needs nothing from elsewhere but the pictures beside it.

use super::change::PARAMETERS;
use super::plots::Plot;
use super::rows::{GEOLOCATION_MOST_PX, Row, SILHOUETTE_MOST_PX, number};
use super::run::picture_name;
use super::words::{escaped, subdivision_advice, verdict};
use super::{Study, numbers};
use crate::measure::Spread;
use std::fmt::Write;

pub(in crate::measure) const STYLE: &str = include_str!("page.css");
/// Heights whose pictures are shown at once; the others are folded away.
const SHOWN_PICTURES: usize = 3;

/// The page. Writing to a string does not fail, so its results are not looked at.
pub(super) fn page(study: &Study, plots: &[Plot]) -> String {
    let mut out = String::new();
    let title = escaped(&format!("Error against run time: {}", study.scene));
    let _ = write!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
    );
    let _ = writeln!(out, "<h1>{title}</h1>");
    let _ = writeln!(
        out,
        "<p class=\"with\">{} · {} × {} pixels · every frame timed {} times, medians with quartiles · true pictures with \
         {n} × {n} rays a pixel · terrella {}</p>",
        escaped(&study.adapter),
        study.size.0,
        study.size.1,
        study.repeats,
        env!("CARGO_PKG_VERSION"),
        n = study.samples,
    );
    if !study.is_complete() {
        let (done, wanted) = (study.rows.len(), study.wanted);
        let _ = writeln!(
            out,
            "<p class=\"partial\">Partial: the run was stopped after {done} of {wanted} measurements. What is here is \
             complete in itself.</p>"
        );
    }
    for note in &study.notes {
        let _ = writeln!(out, "<p>{}</p>", escaped(note));
    }
    verdict_table(&mut out, study);
    pictures(&mut out, study);
    charts(&mut out, study, plots);
    subdivision_table(&mut out, study);
    sweeps(&mut out, study, plots);
    numbers::section(&mut out, study, plots, chart);
    definitions(&mut out);
    out.push_str("</body>\n</html>\n");
    out
}

fn verdict_table(out: &mut String, study: &Study) {
    if study.scene_rows().next().is_none() {
        return;
    }
    let _ = writeln!(out, "<p class=\"verdict\">{}</p>", escaped(&verdict(study)));
    let _ = writeln!(
        out,
        "<div class=\"scroll\"><table>\n<tr><th>height<br>km</th><th>frame<br>ms</th><th>over<br>floor</th>\
         <th>FLIP<br>mean</th><th>FLIP<br>99 %</th><th>RMSE<br>linear</th>\
         <th>limb, px<br>≤ {SILHOUETTE_MOST_PX}</th><th>place, px<br>≤ {GEOLOCATION_MOST_PX}</th>\
         <th>place, m<br>median</th><th>place, m<br>largest</th><th>texels<br>per px</th></tr>"
    );
    for row in study.scene_rows() {
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td><td>{}</td></tr>",
            number(row.height_km),
            spread(&row.frame_ms, 2),
            spread(&row.floor_ratio, 2),
            digits(row.flip_mean, 3),
            digits(row.flip_p99, 3),
            digits(row.rmse_linear, 3),
            marked_limb(row.silhouette.max_px),
            marked(row.geolocation.max_px, GEOLOCATION_MOST_PX, 2),
            digits(row.geolocation.median_m, 2),
            digits(row.geolocation.max_m, 2),
            digits(row.texels_per_px, 3),
        );
    }
    out.push_str("</table></div>\n");
}

/// A number with as many significant digits.
fn digits(value: f64, significant: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if magnitude < -4 {
        return format!("{value:.0$e}", (significant - 1) as usize);
    }
    format!("{value:.0$}", (significant - 1 - magnitude).max(0) as usize)
}

fn spread(spread: &Spread, decimals: usize) -> String {
    format!(
        "{:.decimals$} <span class=\"spread\">{:.decimals$}…{:.decimals$}</span>",
        spread.median, spread.low, spread.high
    )
}

/// A number with a mark that says whether it is at most `most`.
fn marked(value: f64, most: f64, significant: i32) -> String {
    let (class, mark) = match value <= most {
        true => ("good", "✓"),
        false => ("bad", "✗"),
    };
    format!(
        "<span class=\"{class}\">{} {mark}</span>",
        digits(value, significant)
    )
}

/// A limb's error, which is told to 1/64 pixel.
fn marked_limb(value: f64) -> String {
    if value < 1.0 / 64.0 {
        return "<span class=\"good\">&lt; 1/64 ✓</span>".into();
    }
    marked(value, SILHOUETTE_MOST_PX, 2)
}

fn pictures(out: &mut String, study: &Study) {
    if study.pictured_km.is_empty() {
        return;
    }
    out.push_str("<h2>Drawn, true, and the difference</h2>\n");
    let shown = study.some_heights(SHOWN_PICTURES);
    for height_km in &shown {
        shots(out, study, *height_km);
    }
    let rest = study.pictured_km.iter().filter(|km| !shown.contains(km));
    let rest: Vec<f64> = rest.copied().collect();
    if !rest.is_empty() {
        out.push_str("<details><summary>The other heights</summary>\n");
        for height_km in rest {
            shots(out, study, height_km);
        }
        out.push_str("</details>\n");
    }
}

fn shots(out: &mut String, study: &Study, height_km: f64) {
    let row = study.scene_rows().find(|row| row.height_km == height_km);
    let flip = row.map_or(f64::NAN, |row| row.flip_mean);
    let _ = writeln!(out, "<h3>{height_km} km</h3>\n<div class=\"shots\">");
    for (what, words) in [
        ("drawn", "drawn".to_owned()),
        ("true", "true: exact rays".to_owned()),
        (
            "flip",
            format!(
                "FLIP, mean {}: black for none, yellow for most",
                digits(flip, 3)
            ),
        ),
    ] {
        let _ = writeln!(
            out,
            "<figure><img src=\"{}\" width=\"{}\" height=\"{}\" loading=\"lazy\" alt=\"{} from {height_km} km\">\
             <figcaption>{}</figcaption></figure>",
            picture_name(height_km, what),
            study.size.0,
            study.size.1,
            escaped(&words),
            escaped(&words),
        );
    }
    out.push_str("</div>\n");
}

fn charts(out: &mut String, study: &Study, plots: &[Plot]) {
    if study.rows.is_empty() {
        return;
    }
    out.push_str(
        "<h2>What each setting costs and buys</h2>\n<p>To the left is faster, further down is nearer to the truth. Bars \
         are quartiles of the frame time. A ring marks the Pareto front: nothing else on the chart, or in its line, is \
         both faster and better. Sweeps are drawn for some of the heights; the tables have all.</p>\n<div class=\"charts\">\n",
    );
    for plot in plots.iter().filter(|p| p.is_main && p.about != "methods") {
        chart(out, plot);
    }
    out.push_str("</div>\n");
}

fn chart(out: &mut String, plot: &Plot) {
    let svg = plot.svg.replacen(
        "<svg ",
        &format!("<svg role=\"img\" aria-label=\"{}\" ", escaped(&plot.words)),
        1,
    );
    let _ = writeln!(out, "<figure id=\"{}\">{svg}</figure>", escaped(&plot.name));
}

/// What a finer mesh does to the limb and to the time: what a default is chosen by.
fn subdivision_table(out: &mut String, study: &Study) {
    let values = study.values_of("subdivision");
    if values.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "<h2>How fine the mesh should be</h2>\n<p>Largest error of the limb in pixels, and the frame time over that of the \
         scene's own mesh, both by their floors, from each height.</p>\n<div class=\"scroll\"><table>\n<tr><th>cells per<br>block \
         edge</th>{}</tr>",
        study
            .heights_km
            .iter()
            .map(|km| format!("<th>{km} km</th>"))
            .collect::<String>()
    );
    for value in values {
        let _ = write!(out, "<tr><td>{value}</td>");
        for height_km in &study.heights_km {
            let row = study.row("subdivision", &value, *height_km);
            let scene = study.scene_mesh(*height_km);
            let cell = row.zip(scene).map(|(row, scene)| {
                format!(
                    "{} <span class=\"spread\">× {:.2}</span>",
                    marked_limb(row.silhouette.max_px),
                    row.floor_ratio.median / scene.floor_ratio.median
                )
            });
            let _ = write!(out, "<td>{}</td>", cell.unwrap_or_default());
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></div>\n");
    if let Some(advice) = subdivision_advice(study) {
        let _ = writeln!(out, "<p>{}</p>", escaped(&advice));
    }
}

/// Each sweep with all its numbers and the charts that are not above.
fn sweeps(out: &mut String, study: &Study, plots: &[Plot]) {
    out.push_str("<h2>Every sweep</h2>\n");
    for parameter in PARAMETERS {
        let name = parameter.replace('_', " ");
        if let Some(missing) = study.unavailable.iter().find(|m| m.parameter == parameter) {
            let _ = writeln!(out, "<p><b>{name}</b>: {}.</p>", escaped(&missing.why));
            continue;
        }
        let is_of_it = |row: &&Row| row.change.parameter() == parameter;
        let rows: Vec<&Row> = study.rows.iter().filter(is_of_it).collect();
        if rows.is_empty() {
            continue;
        }
        let _ = writeln!(
            out,
            "<details><summary>{name}</summary>\n<div class=\"scroll\"><table>\n<tr><th>{name}</th><th>height, km</th>\
             <th>frame, ms</th><th>over floor</th><th>FLIP mean</th><th>FLIP 99 %</th><th>RMSE</th><th>limb, px</th>\
             <th>place, m</th><th>place, px</th><th>texels per px</th></tr>"
        );
        for row in rows {
            let _ = writeln!(
                out,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
                 <td>{}</td><td>{}</td></tr>",
                escaped(&row.change.value()),
                number(row.height_km),
                spread(&row.frame_ms, 2),
                spread(&row.floor_ratio, 2),
                digits(row.flip_mean, 3),
                digits(row.flip_p99, 3),
                digits(row.rmse_linear, 3),
                digits(row.silhouette.max_px, 3),
                digits(row.geolocation.max_m, 3),
                digits(row.geolocation.max_px, 3),
                digits(row.texels_per_px, 3),
            );
        }
        out.push_str("</table></div>\n<div class=\"charts\">\n");
        let details = plots.iter().filter(|p| p.about == parameter && !p.is_main);
        for plot in details {
            chart(out, plot);
        }
        out.push_str("</div></details>\n");
    }
}

fn definitions(out: &mut String) {
    out.push_str("<h2>What the numbers mean</h2>\n<dl>\n");
    for (name, words) in [
        (
            "frame, ms",
            "Wall time of one frame: choosing blocks, writing, drawing, waiting for the device.",
        ),
        (
            "over floor",
            "Frame time over that of a pass with the same pixels and texture samples that computes nothing, taken in the same moment.",
        ),
        (
            "FLIP",
            "Difference that an eye sees between the drawn and the true picture at 67 pixels a degree (Andersson and others 2020): 0 for none, 1 at most. The true picture has the same maps, figure, shading and air, by exact rays in 64-bit numbers.",
        ),
        (
            "RMSE",
            "Root mean square error over pixels and channels in linear light; the display's white is 1.",
        ),
        (
            "limb",
            "Silhouette error: how far the drawn edge of the ground is from the analytic limb, across it, at up to 64 places of the limb in the picture, each looked at 64 times as finely; the largest. Where the picture shows no limb, of the whole horizon.",
        ),
        (
            "place",
            "Geolocation error: how far the place whose texels a pixel shows is from the place that the exact ray through the pixel's middle meets; in metres on the ground, and in pixels as seen from the eye. At the limb the ground is seen edge on, and a hundredth of a thousandth of a pixel is many metres.",
        ),
        (
            "texels per px",
            "Texels of the day map per pixel, seen face on, where there are fewest. Below 1 the map is what limits sharpness.",
        ),
    ] {
        let _ = writeln!(out, "<dt>{name}</dt><dd>{words}</dd>");
    }
    out.push_str("</dl>\n<p>All numbers: <a href=\"measurements.csv\">measurements.csv</a>, <a href=\"spread.csv\">spread.csv</a>. Charts as files: <code>plots/</code>.</p>\n");
}
