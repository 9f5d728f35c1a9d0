//! Results as text for a terminal and as sentences for the page.

use super::format::number;
use super::{MAX_GEOLOCATION_PX, MAX_SILHOUETTE_PX, Study};
use crate::Quartiles;
use std::fmt::Write;
use terrella::Subdivision;

/// Last height of the paper's Table 2, kilometres.
const TABLE_2_ENDS_KM: f64 = 20_000.0;

/// One sentence: at how many heights limb and geolocation have the required accuracy.
pub(super) fn verdict(study: &Study) -> String {
    let rows: Vec<_> = study.scene_rows().collect();
    let exact = rows.iter().filter(|row| row.is_exact()).count();
    let mut text = format!(
        "From {exact} of {} heights the scene's settings draw the limb to {MAX_SILHOUETTE_PX} px and places to \
         {MAX_GEOLOCATION_PX} px.",
        rows.len()
    );
    let mut missed = rows
        .iter()
        .filter(|row| !row.is_exact() && row.height_km <= TABLE_2_ENDS_KM)
        .peekable();
    if missed.peek().is_some() {
        let heights: Vec<_> = missed.map(|row| number(row.height_km)).collect();
        // Writing to a string does not fail.
        let _ = write!(text, " They miss that from {} km.", heights.join(", "));
    }
    text
}

/// The coarsest mesh with an accurate limb from every height, and its cost.
pub(super) fn subdivision_advice(study: &Study) -> Option<String> {
    let heights: Vec<f64> = study.scene_rows().map(|row| row.height_km).collect();
    let of = |value: &str| -> Option<Vec<(f64, f64)>> {
        let at = heights.iter().map(|height_km| {
            let row = study.row("subdivision", value, *height_km)?;
            let scene = study.scene_mesh(*height_km)?;
            let times = row.floor_ratio.median / scene.floor_ratio.median;
            Some((row.silhouette.max_px, times))
        });
        at.collect()
    };
    let values = study.values_of("subdivision");
    // The automatic mesh is no number of cells.
    let fixed = values
        .iter()
        .filter(|value| **value != Subdivision::Auto.to_string());
    let found = fixed.clone().find_map(|value| {
        let found = of(value)?;
        let keeps = found
            .iter()
            .all(|(limb_px, _)| *limb_px <= MAX_SILHOUETTE_PX);
        (keeps && !found.is_empty()).then_some((value, found))
    });
    let text = match found {
        Some((value, found)) => {
            let times = Quartiles::of(found.iter().map(|(_, times)| *times));
            let most = found.iter().map(|(_, times)| *times).fold(0.0, f64::max);
            format!(
                "{value} cells is the coarsest mesh of the sweep that draws the limb to {MAX_SILHOUETTE_PX} px from every \
                 height; a frame then takes {:.2} times as long as the scene's (median of the heights; {most:.2} at most).",
                times.median
            )
        }
        None if values.is_empty() => return None,
        None => format!(
            "No mesh of the sweep draws the limb to {MAX_SILHOUETTE_PX} px from every height."
        ),
    };
    Some(text)
}

/// Lines for a terminal.
pub(super) fn summary(study: &Study) -> String {
    let mut text = String::new();
    if !study.is_complete() {
        let (done, wanted) = (study.rows.len(), study.wanted);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "PARTIAL: stopped after {done} of {wanted} measurements"
        );
    }
    let _ = writeln!(
        text,
        "{:>10} {:>10} {:>8} {:>10} {:>10} {:>10} {:>12} {:>14}",
        "height km", "frame ms", "/ floor", "FLIP mean", "FLIP p99", "RMSE", "limb px", "places px"
    );
    for row in study.scene_rows() {
        let limb = row.silhouette.max_px;
        let mark = |good: bool| if good { "ok" } else { "MISS" };
        let _ = writeln!(
            text,
            "{:>10} {:>10.2} {:>8.2} {:>10.4} {:>10.4} {:>10.4} {:>7.3} {:<4} {:>9.6} {}",
            number(row.height_km),
            row.frame_ms.median,
            row.floor_ratio.median,
            row.flip_mean,
            row.flip_p99,
            row.rmse_linear,
            limb,
            mark(limb <= MAX_SILHOUETTE_PX),
            row.geolocation.max_px,
            mark(row.geolocation.max_px <= MAX_GEOLOCATION_PX),
        );
    }
    let _ = writeln!(text, "{}", verdict(study));
    if let Some(advice) = subdivision_advice(study) {
        let _ = writeln!(text, "{advice}");
    }
    for missing in &study.unavailable {
        let _ = writeln!(text, "{}: {}", missing.parameter, missing.why);
    }
    text
}
