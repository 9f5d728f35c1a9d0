//! Tables of `terrella bench`: whole frames, their floor, what each feature costs.

use super::markdown::{significant, table, thousands};
use super::record::Recorded;
use anyhow::Context;
use serde_json::Value;

/// The rows along the inclined path beside the paper's Table 2.
pub fn table_2(run: &Recorded) -> anyhow::Result<String> {
    let heads = [
        "height, km",
        "blocks: visible, in truth, by the paper's rule",
        "frame over floor",
        "GPU surface + air, ms",
        "`prepare`, ms",
        "frames/s",
        "paper",
    ];
    let mut lines = Vec::new();
    for row in rows(run, "inclined")? {
        let pass = |name: &str| {
            let time = row["gpu_ms"][name].as_f64();
            time.map_or("–".to_owned(), |time| format!("{time:.0}"))
        };
        let paper = row["paper_frames_per_s"].as_f64();
        lines.push(vec![
            height(row)?,
            format!(
                "{}, {}, {}",
                number(row, "blocks_visible")?,
                number(row, "blocks_exact")?,
                number(row, "blocks_paper_rule")?
            ),
            format!("{:.2}", number(row, "floor_ratio")?),
            format!("{} + {}", pass("surface"), pass("air")),
            format!("{:.3}", number(&row["prepare_ms"], "median")?),
            significant(number(row, "frames_per_s")?, 2),
            paper.map_or("–".to_owned(), |paper| format!("{paper:.0}")),
        ]);
    }
    Ok(table(&heads, lines))
}

/// Frame over floor and frame from four heights along the inclined path: "1.16 / 1.82 × (75, 92 ms)".
pub fn heights(run: &Recorded) -> anyhow::Result<String> {
    let (mut ratios, mut times) = (Vec::new(), Vec::new());
    for height_km in [100.0, 2_000.0, 20_000.0, 35_786.0] {
        let row = at(run, "inclined", height_km)?;
        ratios.push(format!("{:.2}", number(row, "floor_ratio")?));
        times.push(format!("{:.0}", number(&row["frame_ms"], "median")?));
    }
    Ok(format!(
        "{} × ({} ms)",
        ratios.join(" / "),
        times.join(", ")
    ))
}

/// The range of frame over floor from the heights in the air, 1 and 30 km, along the inclined path.
pub fn in_the_air(run: &Recorded) -> anyhow::Result<String> {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for height_km in [1.0, 30.0] {
        let ratio = number(at(run, "inclined", height_km)?, "floor_ratio")?;
        (least, most) = (least.min(ratio), most.max(ratio));
    }
    Ok(format!("{least:.2}–{most:.2}"))
}

/// The row of a path and a height.
fn at<'r>(run: &'r Recorded, path: &str, height_km: f64) -> anyhow::Result<&'r Value> {
    let rows = rows(run, path)?;
    let row = rows
        .iter()
        .find(|row| row["height_km"].as_f64() == Some(height_km));
    row.copied()
        .with_context(|| format!("it has no row of {height_km} km, {path}"))
}

/// The rows along a path, the lowest first.
fn rows<'r>(run: &'r Recorded, path: &str) -> anyhow::Result<Vec<&'r Value>> {
    let rows = list(run, "rows")?.iter();
    Ok(rows.filter(|row| row["path"] == path).collect())
}

fn list<'r>(run: &'r Recorded, key: &str) -> anyhow::Result<&'r Vec<Value>> {
    let list = run.run()?[key].as_array();
    list.with_context(|| format!("it has no list {key:?}"))
}

fn number(of: &Value, key: &str) -> anyhow::Result<f64> {
    let number = of[key].as_f64();
    number.with_context(|| format!("it has no number {key:?} where one belongs"))
}

/// A row's height with its name, kilometres.
fn height(row: &Value) -> anyhow::Result<String> {
    let height_km = number(row, "height_km")?;
    Ok(match height_km as u32 {
        35_786 => format!("{} (geostationary)", thousands(height_km)),
        378_022 => format!("{} (the Moon)", thousands(height_km)),
        _ => thousands(height_km),
    })
}
