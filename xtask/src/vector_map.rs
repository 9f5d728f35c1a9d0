//! `cargo xtask vector-map`: generates `textures/lines.bin`, coastlines and borders, from Natural Earth in the npm package world-atlas.
//!
//! `textures/SOURCES.md` describes source and format.

use crate::files::write_bytes;
use crate::process::repository_root;
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::path::Path;

/// The package's file: countries at 1:50 million.
const SOURCE: &str = "countries-50m.json";
/// The generated file.
const PRODUCT: &str = "textures/lines.bin";
/// Integer steps of the file per degree.
const PER_DEGREE: f64 = 1000.0;
const HALF_TURN: i64 = 180_000;
const QUARTER_TURN: i64 = 90_000;
/// Distance from the date line or the South Pole below which a point lies on a cut of the source, in steps.
const EDGE: i64 = 2;

/// Longitude and latitude.
type Point = [i64; 2];

/// Generates the file, or compares it with the one in the repository.
///
/// # Errors
/// The package is missing or not as expected, or the file differs or cannot be written.
pub fn run(atlas: &Path, check: bool) -> Result<()> {
    let source = atlas.join(SOURCE);
    let text = std::fs::read_to_string(&source).with_context(|| source.display().to_string())?;
    let topology = serde_json::from_str(&text).with_context(|| source.display().to_string())?;
    let [coasts, borders] = lines(&topology).with_context(|| source.display().to_string())?;
    let bytes = file(&coasts, &borders);
    let path = repository_root().join(PRODUCT);
    if check {
        let there = std::fs::read(&path).with_context(|| path.display().to_string())?;
        if there != bytes {
            bail!(
                "{} differs; `cargo xtask vector-map` makes it again",
                path.display()
            );
        }
        return Ok(());
    }
    write_bytes(&path, &bytes)?;
    println!(
        "{} ({} bytes, {} coast lines, {} borders)",
        path.display(),
        bytes.len(),
        coasts.len(),
        borders.len()
    );
    Ok(())
}

/// Arcs of one country are coastlines; those of two are borders.
fn lines(topology: &Value) -> Result<[Vec<Vec<Point>>; 2]> {
    let transform = &topology["transform"];
    let pair = |value: &Value| -> Result<[f64; 2]> {
        let number = |k: usize| value[k].as_f64().context("a transform without numbers");
        Ok([number(0)?, number(1)?])
    };
    let (scale, translate) = (pair(&transform["scale"])?, pair(&transform["translate"])?);
    let arcs = topology["arcs"].as_array().context("no arcs")?;
    let mut owners = vec![Vec::new(); arcs.len()];
    let countries = &topology["objects"]["countries"]["geometries"];
    for (country, geometry) in countries
        .as_array()
        .context("no countries")?
        .iter()
        .enumerate()
    {
        note_owners(&geometry["arcs"], country, &mut owners)?;
    }
    let mut kinds = [Vec::new(), Vec::new()];
    for (arc, mut owners) in arcs.iter().zip(owners) {
        owners.dedup();
        let kind = match owners.len() {
            1 => 0,
            2 => 1,
            count => bail!("an arc of {count} countries"),
        };
        let mut at = [0.0; 2];
        let mut line: Vec<Point> = Vec::new();
        for change in arc.as_array().context("an arc that is no list")? {
            let change = pair(change)?;
            at = [at[0] + change[0], at[1] + change[1]];
            let place = [0, 1].map(|k| PER_DEGREE * (at[k] * scale[k] + translate[k]));
            let point = place.map(|number| number.round_ties_even() as i64);
            ensure!(
                point[0].abs() <= HALF_TURN && point[1].abs() <= QUARTER_TURN,
                "a point off the globe"
            );
            match line.last() {
                Some(last) if *last == point => continue,
                // A cut is neither coastline nor border.
                Some(last) if is_cut(*last, point) => {
                    kinds[kind].push(std::mem::replace(&mut line, vec![point]));
                }
                _ => line.push(point),
            }
        }
        kinds[kind].push(line);
    }
    Ok(kinds.map(|lines| lines.into_iter().filter(|line| line.len() > 1).collect()))
}

/// Whether a segment lies on the date line or at the South Pole, where a flat map cuts polygons.
fn is_cut(a: Point, b: Point) -> bool {
    let is_at_date_line = |point: Point| point[0].abs() >= HALF_TURN - EDGE;
    let is_at_pole = |point: Point| point[1] <= EDGE - QUARTER_TURN;
    is_at_date_line(a) && is_at_date_line(b) || is_at_pole(a) || is_at_pole(b)
}

/// Records a country for each of its arcs; reversed arcs are −1 − n.
fn note_owners(arcs: &Value, country: usize, owners: &mut [Vec<usize>]) -> Result<()> {
    if let Some(list) = arcs.as_array() {
        return list
            .iter()
            .try_for_each(|part| note_owners(part, country, owners));
    }
    if arcs.is_null() {
        return Ok(());
    }
    let arc = arcs.as_i64().context("an arc that is no number")?;
    let index = usize::try_from(if arc < 0 { !arc } else { arc })?;
    let owners = owners.get_mut(index).context("an arc that is not there")?;
    owners.push(country);
    Ok(())
}

/// `TRLINES1`, the checksum of the rest, three counts, then the lines.
fn file(coasts: &[Vec<Point>], borders: &[Vec<Point>]) -> Vec<u8> {
    let lines = coasts.iter().chain(borders);
    let points: usize = lines.clone().map(Vec::len).sum();
    let mut rest = Vec::new();
    for count in [coasts.len(), borders.len(), points] {
        rest.extend((count as u32).to_le_bytes());
    }
    for line in lines {
        number(line.len() as u64, &mut rest);
        let mut before = [0, 0];
        for point in line {
            let east = point[0] - before[0];
            // Take the shorter way round the Earth.
            let turns = (east as f64 / (2 * HALF_TURN) as f64).round() as i64;
            change(east - 2 * HALF_TURN * turns, &mut rest);
            change(point[1] - before[1], &mut rest);
            before = *point;
        }
    }
    let mut checksum = flate2::Crc::new();
    checksum.update(&rest);
    let mut file = b"TRLINES1".to_vec();
    file.extend(checksum.sum().to_le_bytes());
    file.extend(rest);
    file
}

/// Zigzag coding: 0, −1, 1, −2, 2 … become 0, 1, 2, 3, 4 …
fn change(value: i64, bytes: &mut Vec<u8>) {
    number(((value << 1) ^ (value >> 63)) as u64, bytes);
}

/// Seven bits per byte, lowest first; the highest bit means that more bytes follow.
fn number(mut value: u64, bytes: &mut Vec<u8>) {
    while value > 0x7f {
        bytes.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Two adjacent squares: the arc between them is a border, and the edge at the date line is not.
    #[test]
    fn shared_arcs_are_borders_and_cuts_are_left_out() {
        let topology = json!({
            "transform": { "scale": [1.0, 1.0], "translate": [0.0, 0.0] },
            "arcs": [
                [[170, 0], [0, 10]],
                [[170, 10], [-10, 0], [0, -10], [10, 0]],
                [[170, 0], [10, 0], [0, 10], [-10, 0]],
            ],
            "objects": { "countries": { "geometries": [
                { "arcs": [[0, 1]] }, { "arcs": [[[-1, 2]]] }, {},
            ] } },
        });
        let [coasts, borders] = lines(&topology).expect("good");
        assert_eq!(borders, [[[170_000, 0], [170_000, 10_000]]]);
        assert_eq!(coasts.len(), 3, "{coasts:?}");
        assert_eq!(coasts[1], [[170_000, 0], [180_000, 0]]);
        assert_eq!(coasts[2], [[180_000, 10_000], [170_000, 10_000]]);
        let file = file(&coasts, &borders);
        assert_eq!(file[..8], *b"TRLINES1");
        assert_eq!(file[12..24], [3, 0, 0, 0, 1, 0, 0, 0, 10, 0, 0, 0]);
    }
}
