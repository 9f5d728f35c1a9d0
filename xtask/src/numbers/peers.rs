//! The table of frame times beside other renderers.

use super::markdown::table;
use super::record::{Recorded, Row};
use anyhow::bail;

/// A line for each height, a column for each renderer: milliseconds, and the base's time over its own with quartiles. The ratio is in the column
/// `ratio`.
pub fn heights(run: &Recorded, base: &str, ratio: &str) -> anyhow::Result<String> {
    let rows = run.rows()?;
    let (mut heights, mut renderers) = (Vec::new(), Vec::new());
    for row in &rows {
        push_new(&mut heights, row.text("height_km")?);
        push_new(&mut renderers, row.text("renderer")?);
    }
    let mut lines = Vec::new();
    for height in heights {
        let mut line = vec![height.to_owned()];
        for name in &renderers {
            for row in &rows {
                if row.text("height_km")? == height && row.text("renderer")? == *name {
                    line.push(cell(row, base, ratio)?);
                }
            }
        }
        lines.push(line);
    }
    let mut heads = vec!["height, km"];
    heads.extend(renderers);
    Ok(table(&heads, lines))
}

/// The range of VTK's time over this renderer's: with one map, and as shipped.
pub fn ratios(run: &Recorded) -> anyhow::Result<String> {
    let [one_map, standard] = ["Terrella with one map", "Terrella as shipped"]
        .map(|name| range(run, name, "ratio_to_vtk"));
    Ok(format!(
        "With one map it is {} times as fast as VTK, as shipped {} times",
        one_map?, standard?
    ))
}

/// The range of CesiumJS's time over this renderer's in a page, on both backends: as shipped, and with one map.
pub fn web_ratios(run: &Recorded) -> anyhow::Result<String> {
    let [webgpu, webgl, one_webgpu, one_webgl] = [
        "Terrella on WebGPU",
        "Terrella on WebGL2",
        "Terrella with one map on WebGPU",
        "Terrella with one map on WebGL2",
    ]
    .map(|name| range(run, name, "ratio_to_cesiumjs"));
    Ok(format!(
        "As shipped it is {} times as fast as CesiumJS on WebGPU and {} times on WebGL2; with one map, {} and {} times",
        webgpu?, webgl?, one_webgpu?, one_webgl?
    ))
}

fn range(run: &Recorded, name: &str, column: &str) -> anyhow::Result<String> {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for row in run.rows()? {
        if row.text("renderer")? == name {
            let ratio = row.number(column)?;
            (least, most) = (least.min(ratio), most.max(ratio));
        }
    }
    if most < least {
        bail!("it has no renderer {name:?}");
    }
    Ok(format!("{least:.1} to {most:.1}"))
}

fn cell(row: &Row<'_>, base: &str, ratio: &str) -> anyhow::Result<String> {
    let ms = row.text("ms")?;
    if row.text("renderer")? == base {
        return Ok(format!("{ms} ms"));
    }
    let [ratio, first, third] =
        [ratio, "first_quartile", "third_quartile"].map(|column| row.number(column));
    Ok(format!(
        "{ms} ms, {:.2} × ({:.2} to {:.2})",
        ratio?, first?, third?
    ))
}

fn push_new<'a>(list: &mut Vec<&'a str>, text: &'a str) {
    if !list.contains(&text) {
        list.push(text);
    }
}
