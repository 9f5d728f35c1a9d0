//! Tables of `terrella bench`: complete frames, their floor, and the cost of each feature.

use super::markdown::{significant, table, thousands};
use super::record::Recorded;
use anyhow::{Context, bail};
use serde_json::Value;

/// The rows along the inclined path, compared with the paper's Table 2.
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

/// Ratio to the floor and frame time at four altitudes along the inclined path: "1.16 / 1.82 × (75, 92 ms)".
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

/// The range of the ratio of frame to floor within the atmosphere, at 1 and 30 km, along the inclined path.
pub fn in_the_air(run: &Recorded) -> anyhow::Result<String> {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for height_km in [1.0, 30.0] {
        let ratio = number(at(run, "inclined", height_km)?, "floor_ratio")?;
        (least, most) = (least.min(ratio), most.max(ratio));
    }
    Ok(format!("{least:.2}–{most:.2}"))
}

/// The row of a path and an altitude.
fn at<'r>(run: &'r Recorded, path: &str, height_km: f64) -> anyhow::Result<&'r Value> {
    let rows = rows(run, path)?;
    let row = rows
        .iter()
        .find(|row| row["height_km"].as_f64() == Some(height_km));
    row.copied()
        .with_context(|| format!("it has no row of {height_km} km, {path}"))
}

/// Costs that do not depend on the content of a frame, along the inclined path: the bare clear, and the costs of frame and floor beyond it.
pub fn fixed(run: &Recorded) -> anyhow::Result<String> {
    let heads = [
        "height, km",
        "frame, ms",
        "bare clear, ms",
        "of the frame",
        "floor beyond it, ms",
        "air's pass, ms",
        "frame over floor",
        "the same without the clear",
    ];
    let mut lines = Vec::new();
    for row in rows(run, "inclined")? {
        let frame = number(&row["frame_ms"], "median")?;
        let (floor, clear) = (number(row, "floor_ms")?, number(row, "clear_ms")?);
        let air = row["gpu_ms"]["air"].as_f64();
        let beyond = floor - clear;
        lines.push(vec![
            height(row)?,
            significant(frame, 2),
            significant(clear, 2),
            format!("{:.0} %", 100.0 * clear / frame),
            significant(beyond.max(0.0), 2),
            air.map_or("–".to_owned(), |air| significant(air, 2)),
            format!("{:.2}", number(row, "floor_ratio")?),
            match beyond > 0.05 * clear {
                true => format!("{:.1}", (frame - clear) / beyond),
                false => "–".to_owned(),
            },
        ]);
    }
    Ok(table(&heads, lines))
}

/// The smallest ratio of frame to floor of all rows: "1.05 (600 km, inclined)".
pub fn least(run: &Recorded) -> anyhow::Result<String> {
    let mut least: Option<(f64, &Value)> = None;
    for row in list(run, "rows")? {
        let ratio = number(row, "floor_ratio")?;
        if least.is_none_or(|(least, _)| ratio < least) {
            least = Some((ratio, row));
        }
    }
    let (ratio, row) = least.context("it has no rows")?;
    let path = row["path"].as_str().context("a row has no path")?;
    Ok(format!(
        "{ratio:.2} ({} km, {path} path)",
        thousands(number(row, "height_km")?)
    ))
}

/// The cost of each layer and effect, along the flight and both paths.
pub fn features(run: &Recorded) -> anyhow::Result<String> {
    let heads = [
        "off in turn",
        "time with ÷ without: the scene's flight",
        "equatorial path",
        "inclined path",
        "textures, MB",
        "shader, bytes",
    ];
    let mut lines: Vec<Vec<String>> = Vec::new();
    for feature in list(run, "features")? {
        let name = feature["name"].as_str().context("a feature has no name")?;
        let ratio = format!("{:.2}", number(feature, "frame_ratio")?);
        match lines.last_mut().filter(|line| line[0] == name) {
            Some(line) => {
                let end = line.len() - 2;
                line.insert(end, ratio);
            }
            None => lines.push(vec![
                name.to_owned(),
                ratio,
                format!("{:.1}", number(feature, "texture_bytes")? * 1e-6),
                format!("{:.0}", number(feature, "shader_bytes")?),
            ]),
        }
    }
    for unmeasured in list(run, "unmeasured")? {
        let text = |key: &str| unmeasured[key].as_str().unwrap_or_default();
        let mut line = vec![
            text("name").to_owned(),
            format!("not measured: {}", text("why")),
        ];
        line.resize(heads.len(), String::new());
        lines.push(line);
    }
    if let Some(line) = lines.iter().find(|line| line.len() != heads.len()) {
        bail!(
            "the feature {} is not measured along three courses",
            line[0]
        );
    }
    Ok(table(&heads, lines))
}

/// The rows along a path, lowest first.
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

/// A row's altitude with its name, kilometres.
fn height(row: &Value) -> anyhow::Result<String> {
    let height_km = number(row, "height_km")?;
    Ok(match height_km as u32 {
        35_786 => format!("{} (geostationary)", thousands(height_km)),
        378_022 => format!("{} (the Moon)", thousands(height_km)),
        _ => thousands(height_km),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    fn run() -> Recorded {
        let row = |path: &str, height_km: f64, ratio: f64| {
            format!(
                r#"{{"height_km":{height_km},"path":"{path}","blocks_visible":4,"blocks_exact":3,"blocks_paper_rule":2,"floor_ratio":{ratio},
                "gpu_ms":{{"air":10.6}},"prepare_ms":{{"median":0.3478}},"frame_ms":{{"median":12.0}},"floor_ms":6.0,"clear_ms":3.0,
                "frames_per_s":83.3,"paper_frames_per_s":null}}"#
            )
        };
        let feature = |course: &str, ratio: f64| {
            format!(
                r#"{{"name":"clouds","course":"{course}","frame_ratio":{ratio},"texture_bytes":2800000,"shader_bytes":338}}"#
            )
        };
        let heights = [1.0, 30.0, 100.0, 2_000.0, 20_000.0, 35_786.0];
        let mut rows: Vec<_> = heights
            .map(|height| row("inclined", height, 1.0 + 1e-4 * height))
            .into();
        rows.push(row("equatorial", 100.0, 0.987));
        let features = [("flight", 1.2), ("equatorial", 1.3), ("inclined", 1.4)];
        let features = features.map(|(course, ratio)| feature(course, ratio));
        let body = format!(
            r#"{{"rows":[{}],"features":[{}],"unmeasured":[{{"name":"anisotropy","why":"it is software"}}]}}"#,
            rows.join(","),
            features.join(",")
        );
        let head = KEYS.map(|key| (key, "x".to_owned()));
        Recorded::read("a.json", &written("a.json", &head, &body).unwrap()).unwrap()
    }

    #[test]
    fn tables_are_made_of_the_rows() {
        let run = run();
        let table = table_2(&run).unwrap();
        assert!(
            table.contains("| 35 786 (geostationary) | 4, 3, 2 | 4.58 | – + 11 | 0.348 | 83 | – |"),
            "{table}"
        );
        assert_eq!(table.lines().count(), 8);
        assert_eq!(
            heights(&run).unwrap(),
            "1.01 / 1.20 / 3.00 / 4.58 × (12, 12, 12, 12 ms)"
        );
        assert_eq!(in_the_air(&run).unwrap(), "1.00–1.00");
        assert_eq!(least(&run).unwrap(), "0.99 (100 km, equatorial path)");
        let fixed = fixed(&run).unwrap();
        assert!(
            fixed.contains("| 2 000 | 12 | 3.0 | 25 % | 3.0 | 11 | 1.20 | 3.0 |"),
            "{fixed}"
        );
    }

    #[test]
    fn features_stand_beside_what_was_not_measured() {
        let text = features(&run()).unwrap();
        assert!(
            text.contains("| clouds | 1.20 | 1.30 | 1.40 | 2.8 | 338 |"),
            "{text}"
        );
        assert!(
            text.contains("| anisotropy | not measured: it is software |"),
            "{text}"
        );
    }
}
