//! `cargo xtask web peers`: frame times in a page beside those of CesiumJS.

use super::browser;
use super::npm::{self, CESIUM, PLAYWRIGHT};
use super::serve::Server;
use crate::numbers;
use crate::process::{self, repository_root, say};
use anyhow::Context;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The name of the recorded run, of its file and of its table.
const RECORDING: &str = "web_peers";
const COLUMNS: [&str; 6] = [
    "height_km",
    "renderer",
    "ms",
    "ratio_to_cesiumjs",
    "first_quartile",
    "third_quartile",
];

/// Measures the pages of a folder, records the times and rewrites the page that has them.
///
/// # Errors
/// A missing package, a renderer that draws no Earth.
pub fn run(dist: &Path, tests: &Path, rounds: u32) -> anyhow::Result<()> {
    let tools = npm::installed(&[PLAYWRIGHT, CESIUM]).context("CesiumJS is not measured")?;
    let out = repository_root().join("target/web/peers");
    let pages = Server::start(dist, 0)?;
    let cesium = Server::start(&tools.join("node_modules/cesium/Build/Cesium"), 0)?;
    let mut node = browser::script(&tests.join("peers.mjs"));
    node.args([pages.address(), cesium.address(), rounds.to_string()]);
    process::run(node.arg(&out).current_dir(&tools))?;
    let file = out.join("peers.json");
    let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let measured: Value =
        serde_json::from_str(&text).with_context(|| file.display().to_string())?;
    let table = numbers::store(RECORDING, &head(&measured, rounds)?, &body(&measured)?)?;
    say(format_args!("pictures are in {}", out.display()));
    println!("{table}");
    Ok(())
}

/// How the times were measured, and on which graphics.
fn head(measured: &Value, rounds: u32) -> anyhow::Result<[(&'static str, String); 4]> {
    let text = |key: &str| {
        let text = measured[key].as_str();
        text.with_context(|| format!("peers.json has no text {key:?}"))
    };
    let frames = measured["frames"].as_u64();
    let frames = frames.context("peers.json has no number \"frames\"")?;
    let method = format!(
        "1280 × 720 with 4 samples, straight down on Sicily in daylight with a field of view of 45°; {frames} frames a turn, each ended when \
         the graphics are done; {} and Terrella in tabs of one browser, interleaved; medians of {rounds} rounds, quartiles of the ratio",
        text("version")?
    );
    Ok([
        ("method", method),
        ("command", "cargo xtask web peers".to_owned()),
        ("adapter", text("adapter")?.to_owned()),
        ("driver", text("browser")?.to_owned()),
    ])
}

/// The times as CSV.
fn body(measured: &Value) -> anyhow::Result<String> {
    let rows = measured["rows"].as_array();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for row in rows.context("peers.json has no list \"rows\"")? {
        let number = |key: &str| {
            let number = row[key].as_f64();
            number.with_context(|| format!("a row of peers.json has no number {key:?}"))
        };
        let renderer = row["renderer"].as_str();
        writer.write_record([
            format!("{:.0}", number("height_km")?),
            renderer
                .context("a row of peers.json has no text \"renderer\"")?
                .to_owned(),
            format!("{:.1}", number("ms")?),
            format!("{:.2}", number("ratio")?),
            format!("{:.2}", number("first_quartile")?),
            format!("{:.2}", number("third_quartile")?),
        ])?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_the_browser_measured_becomes_a_recorded_run() {
        let row = json!({
            "height_km": 400, "renderer": "CesiumJS", "ms": 12.34, "ratio": 1, "first_quartile": 0.999, "third_quartile": 1.001
        });
        let mut measured = json!({
            "version": "CesiumJS 1", "adapter": "SwiftShader", "browser": "Chromium 1", "frames": 8, "rows": [row]
        });
        let head = head(&measured, 5).unwrap();
        assert!(
            head[0].1.contains("8 frames")
                && head[0].1.contains("CesiumJS 1")
                && head[0].1.contains("5 rounds")
        );
        assert_eq!(head[3], ("driver", "Chromium 1".to_owned()));
        let expected = "height_km,renderer,ms,ratio_to_cesiumjs,first_quartile,third_quartile\n400,CesiumJS,12.3,1.00,1.00,1.00\n";
        assert_eq!(body(&measured).unwrap(), expected);
        measured["rows"][0]["ms"] = Value::Null;
        let error = body(&measured).unwrap_err().to_string();
        assert!(error.contains("\"ms\""), "{error}");
    }
}
