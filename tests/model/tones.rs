//! The plot of the tone curves on docs/light.md: of the curves themselves.

use glam::DVec3;
use std::fmt::Write;
use std::path::Path;
use terrella::Tone;

const SIZE: [f64; 2] = [640.0, 380.0];
/// Left, top, right and bottom margin.
const MARGIN: [f64; 4] = [46.0, 12.0, 84.0, 40.0];
/// Exposed light, EV from white.
const EV: [i32; 2] = [-8, 4];
const COLORS: [&str; 5] = ["#d95f02", "#1b9e77", "#7570b3", "#e7298a", "#66a61e"];

fn place(ev: f64, code: f64) -> [f64; 2] {
    let [left, top, right, bottom] = MARGIN;
    let across = (ev - f64::from(EV[0])) / f64::from(EV[1] - EV[0]);
    [
        left + across * (SIZE[0] - left - right),
        SIZE[1] - bottom - code / 255.0 * (SIZE[1] - top - bottom),
    ]
}

/// The code of grey light by a curve.
fn code(tone: Tone, ev: f64) -> f64 {
    let shown = tone.shown(DVec3::splat(ev.exp2())).y.clamp(0.0, 1.0);
    match shown <= 0.003_130_8 {
        true => 255.0 * 12.92 * shown,
        false => 255.0 * (1.055 * shown.powf(1.0 / 2.4) - 0.055),
    }
}

fn plot() -> Result<String, std::fmt::Error> {
    let mut svg = String::new();
    let [width, height] = SIZE;
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">"
    )?;
    writeln!(
        svg,
        "<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>"
    )?;
    for ev in (EV[0]..=EV[1]).step_by(2) {
        let ([x, top], [_, bottom]) = (place(f64::from(ev), 255.0), place(f64::from(ev), 0.0));
        writeln!(
            svg,
            "<path d=\"M{x:.1} {top:.1}V{bottom:.1}\" stroke=\"#ccc\"/>"
        )?;
        let below = bottom + 16.0;
        writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{below:.1}\" text-anchor=\"middle\">{ev:+}</text>"
        )?;
    }
    for code in [0, 64, 128, 192, 255] {
        let [[left, y], [right, _]] = EV.map(|ev| place(f64::from(ev), f64::from(code)));
        writeln!(
            svg,
            "<path d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"#ccc\"/>"
        )?;
        let (before, lower) = (left - 6.0, y + 4.0);
        writeln!(
            svg,
            "<text x=\"{before:.1}\" y=\"{lower:.1}\" text-anchor=\"end\">{code}</text>"
        )?;
    }
    let [middle, _] = place(f64::from(EV[0] + EV[1]) / 2.0, 0.0);
    let low = SIZE[1] - 8.0;
    writeln!(
        svg,
        "<text x=\"{middle:.1}\" y=\"{low:.1}\" text-anchor=\"middle\">exposed light, EV from 1</text>"
    )?;
    for (n, (tone, color)) in Tone::ALL.into_iter().zip(COLORS).enumerate() {
        let points = (EV[0] * 8..=EV[1] * 8).map(|step| {
            let ev = f64::from(step) / 8.0;
            let [x, y] = place(ev, code(tone, ev));
            format!("{x:.1},{y:.1}")
        });
        let points = points.collect::<Vec<_>>().join(" ");
        writeln!(
            svg,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>"
        )?;
        let (x, y) = (SIZE[0] - MARGIN[2] + 10.0, 40.0 + 18.0 * n as f64);
        let name = format!("{tone:?}").to_lowercase();
        writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"{color}\">{name}</text>"
        )?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

#[test]
fn the_plot_is_that_of_the_curves() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tones.svg");
    let plot = plot().expect("a text");
    if std::env::var_os("TERRELLA_UPDATE_REFERENCE").is_some() {
        std::fs::write(&path, &plot).expect("written");
    }
    let there = std::fs::read_to_string(&path).expect("docs/tones.svg");
    assert!(
        there == plot,
        "docs/tones.svg is not that of the curves; TERRELLA_UPDATE_REFERENCE=1 writes it"
    );
}
