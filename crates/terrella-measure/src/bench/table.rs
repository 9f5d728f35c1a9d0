//! A run as text: for a person, and as comma-separated rows.

use super::baseline::Comparison;
use super::report::{BenchReport, BenchRow, COURSE_HEIGHT_KM, Course};
use crate::output::csv_text;
use crate::{GroundPath, median};
use std::fmt::Write;

/// Adds a line; writing to a string does not fail.
macro_rules! line {
    ($out:expr, $($words:tt)*) => {{
        let _ = writeln!($out, $($words)*);
    }};
}

/// Headline, rows, features, comparison with a baseline and notices.
pub(super) fn text(
    report: &BenchReport,
    comparison: Option<&Comparison>,
    notices: &[String],
) -> String {
    let mut out = String::new();
    let [width, height] = report.size;
    line!(
        out,
        "{}, {}, {width} × {height}, {} sample{} a pixel, {} frames a row in {} run{}{}",
        report.adapter,
        report.backend,
        report.samples,
        if report.samples == 1 { "" } else { "s" },
        report.frames,
        report.repeats,
        if report.repeats == 1 { "" } else { "s" },
        if report.partial { ", INTERRUPTED" } else { "" }
    );
    line!(
        out,
        "{}; {}; {}; commit {}; {}",
        report.driver,
        report.cpu,
        report.os,
        report.commit,
        report.date
    );
    headline(&mut out, report);
    if !report.rows.is_empty() {
        rows(&mut out, report);
    }
    if !report.features.is_empty() {
        features(&mut out, report);
    }
    for unmeasured in &report.unmeasured {
        line!(
            out,
            "{:<14} not measured: {}",
            unmeasured.name,
            unmeasured.why
        );
    }
    if let Some(comparison) = comparison {
        compared(&mut out, comparison);
    }
    for notice in notices {
        line!(out, "\nnote: {notice}");
    }
    out
}

fn headline(out: &mut String, report: &BenchReport) {
    let ratios: Vec<_> = report.rows.iter().map(|row| row.floor_ratio).collect();
    let by_ratio = |a: &&BenchRow, b: &&BenchRow| a.floor_ratio.total_cmp(&b.floor_ratio);
    let (Some(worst), Some(best)) = (
        report.rows.iter().max_by(by_ratio),
        report.rows.iter().min_by(by_ratio),
    ) else {
        return;
    };
    line!(
        out,
        "frame over floor {:.2} (median of rows), worst {:.2} at {}, best {:.2} at {}",
        median(&ratios),
        worst.floor_ratio,
        worst.name(),
        best.floor_ratio,
        best.name()
    );
    line!(
        out,
        "floor {:.2} ms: the same texture samples at the same places and no light computed; bare clear {:.2} ms",
        report.floor_ms,
        report.clear_ms
    );
}

/// A number with so many decimals, or a dash where it is not known.
fn some(value: Option<f64>, decimals: usize) -> String {
    value.map_or("–".to_owned(), |value| format!("{value:.decimals$}"))
}

/// The passes, as they are drawn.
const PASSES: [&str; 3] = ["surface", "air", "development"];

fn rows(out: &mut String, report: &BenchReport) {
    line!(
        out,
        "\n{:>7} {:<10} {:>6} {:>7} {:^23} {:>7} {:^23} {:>8} {:>7} {:>6}",
        "height",
        "",
        "frame/",
        "spread,",
        "whole frame, ms",
        "jank,",
        "GPU, ms",
        "prepare,",
        "frames",
        "2011*"
    );
    line!(
        out,
        "{:>7} {:<10} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>6} {:>7} {:>8} {:>7} {:>6}",
        "km",
        "path",
        "floor",
        "%",
        "median",
        "p95",
        "p99",
        "ms",
        "surface",
        "air",
        "develop",
        "ms",
        "/s",
        "/s"
    );
    for row in &report.rows {
        let [surface, air, development] = PASSES.map(|pass| match row.gpu_ms.get(pass) {
            Some(time) => format!("{time:.2}"),
            None => "–".into(),
        });
        let paper = row.paper_frames_per_s;
        line!(
            out,
            "{:>7} {:<10} {:>6.2} {:>7} {:>7.2} {:>7} {:>7} {:>7.1} {:>8} {:>6} {:>7} {:>8.3} {:>7.1} {:>6}",
            row.height_km,
            row.path.name(),
            row.floor_ratio,
            some(row.floor_ratio_spread.map(|spread| 100.0 * spread), 0),
            row.frame_ms.median,
            some(row.frame_ms.p95, 2),
            some(row.frame_ms.p99, 2),
            row.jank_ms,
            surface,
            air,
            development,
            row.prepare_ms.median,
            row.frames_per_s,
            paper.map_or("–".into(), |paper| format!("{paper:.0}")),
        );
    }
    line!(
        out,
        "spread: largest less smallest of the runs' medians of frame over floor\n\
         GPU: surface and air as two passes, in frames of their own; two cost a little more than the one of a whole frame\n\
         * the paper's own figures, of another machine (GeForce 6800): to look at, not to compare"
    );
    line!(
        out,
        "\n{:>7} {:<10} {:^29} {:>9} {:>6} {:>9}",
        "height",
        "",
        "blocks, most of all frames",
        "triangles",
        "draw",
        "uploaded,"
    );
    line!(
        out,
        "{:>7} {:<10} {:>7} {:>6} {:>7} {:>6} {:>9} {:>6} {:>9}",
        "km",
        "path",
        "visible",
        "exact",
        "paper's",
        "drawn",
        "",
        "calls",
        "kB"
    );
    for row in &report.rows {
        line!(
            out,
            "{:>7} {:<10} {:>7} {:>6} {:>7} {:>6} {:>9} {:>6} {:>9.1}",
            row.height_km,
            row.path.name(),
            row.blocks_visible,
            row.blocks_exact,
            row.blocks_paper_rule,
            row.blocks_drawn,
            row.triangles,
            row.draw_calls,
            row.uploaded_bytes as f64 * 1e-3,
        );
    }
    let lost = |of: fn(&BenchRow) -> u32| report.rows.iter().map(of).max().unwrap_or(0);
    line!(
        out,
        "visible: above the horizon by the scene's rule; exact: in truth; paper's: by its rule; drawn: in the frustum\n\
         blocks in sight that a rule lost in one frame: {}, the paper's {}",
        lost(|row| row.blocks_lost),
        lost(|row| row.blocks_lost_paper_rule)
    );
    levels(out, report);
}

fn levels(out: &mut String, report: &BenchReport) {
    if report.rows.iter().all(|row| row.levels.is_empty()) {
        return;
    }
    line!(
        out,
        "\nblocks in daylight by level of the day map, the finest first, the largest of all frames"
    );
    for row in &report.rows {
        line!(
            out,
            "{:>7} {:<10} {:?}",
            row.height_km,
            row.path.name(),
            row.levels
        );
    }
}

fn features(out: &mut String, report: &BenchReport) {
    line!(
        out,
        "\n{:<14} {:<12} {:>10} {:>10} {:>8} {:>8} {:>10} {:>9}",
        "what it costs",
        "along",
        "with, ms",
        "without",
        "time",
        "spread",
        "textures",
        "shader"
    );
    for feature in &report.features {
        let spread = feature.frame_ratio_spread.map(|spread| 100.0 * spread);
        line!(
            out,
            "{:<14} {:<12} {:>10.2} {:>10.2} {:>+7.0}% {:>7}% {:>7.2} MB {:>7} B",
            feature.name,
            along(feature.course),
            feature.frame_ms_with,
            feature.frame_ms_without,
            100.0 * (feature.frame_ratio - 1.0),
            some(spread, 0),
            feature.texture_bytes as f64 * 1e-6,
            feature.shader_bytes
        );
    }
    line!(
        out,
        "along: the scene's own flight, and both paths {COURSE_HEIGHT_KM} km up"
    );
}

fn along(course: Course) -> &'static str {
    course.path().map_or("flight", GroundPath::name)
}

fn compared(out: &mut String, comparison: &Comparison) {
    let effect = comparison.smallest_effect;
    line!(
        out,
        "\nframe over floor against the baseline, view by view; marked where all that noise leaves open is beyond {:.0} %",
        100.0 * effect
    );
    for change in &comparison.changes {
        let mark = match change.times {
            times if times.is_slower(effect) => "  SLOWER",
            times if times.is_faster(effect) => "  faster",
            _ => "",
        };
        line!(
            out,
            "{:>22} {:>6.2} {:>6.2}   {}{mark}",
            change.row,
            change.before,
            change.now,
            change.times
        );
    }
}

/// Columns of the table of rows; times in milliseconds, levels separated by blanks.
const CSV_COLUMNS: [&str; 29] = [
    "height_km",
    "path",
    "inclination_deg",
    "blocks_visible",
    "blocks_drawn",
    "blocks_paper_rule",
    "blocks_exact",
    "blocks_lost",
    "blocks_lost_paper_rule",
    "levels",
    "triangles",
    "draw_calls",
    "uploaded_bytes",
    "prepare_median_ms",
    "prepare_p95_ms",
    "prepare_p99_ms",
    "gpu_surface_ms",
    "gpu_air_ms",
    "gpu_development_ms",
    "frame_median_ms",
    "frame_p95_ms",
    "frame_p99_ms",
    "jank_ms",
    "floor_ms",
    "clear_ms",
    "floor_ratio",
    "floor_ratio_spread",
    "frames_per_s",
    "paper_frames_per_s",
];

/// One line for each row.
pub(super) fn csv(report: &BenchReport) -> String {
    let head = CSV_COLUMNS.map(str::to_owned);
    csv_text(std::iter::once(head).chain(report.rows.iter().map(csv_fields)))
}

/// A number, or nothing where it is not known.
fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

fn csv_fields(row: &BenchRow) -> [String; CSV_COLUMNS.len()] {
    let levels: Vec<_> = row.levels.iter().map(u32::to_string).collect();
    let gpu = |pass| row.gpu_ms.get(pass).map_or(String::new(), f64::to_string);
    let path = match row.path {
        GroundPath::Equatorial => "equatorial",
        GroundPath::Inclined => "inclined",
    };
    [
        row.height_km.to_string(),
        path.into(),
        row.path.inclination_deg().to_string(),
        row.blocks_visible.to_string(),
        row.blocks_drawn.to_string(),
        row.blocks_paper_rule.to_string(),
        row.blocks_exact.to_string(),
        row.blocks_lost.to_string(),
        row.blocks_lost_paper_rule.to_string(),
        levels.join(" "),
        row.triangles.to_string(),
        row.draw_calls.to_string(),
        row.uploaded_bytes.to_string(),
        row.prepare_ms.median.to_string(),
        optional(row.prepare_ms.p95),
        optional(row.prepare_ms.p99),
        gpu("surface"),
        gpu("air"),
        gpu("development"),
        row.frame_ms.median.to_string(),
        optional(row.frame_ms.p95),
        optional(row.frame_ms.p99),
        row.jank_ms.to_string(),
        row.floor_ms.to_string(),
        row.clear_ms.to_string(),
        row.floor_ratio.to_string(),
        optional(row.floor_ratio_spread),
        row.frames_per_s.to_string(),
        optional(row.paper_frames_per_s),
    ]
}
