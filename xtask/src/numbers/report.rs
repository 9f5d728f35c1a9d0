//! Figures of `terrella report`.

use super::record::{Recorded, Row};
use anyhow::Context;

/// From 100 km up: smallest and largest mean FLIP, the largest error of the limb, and that of places.
pub fn range(run: &Recorded) -> anyhow::Result<String> {
    let rows = run.rows()?;
    let mut of_space = Vec::new();
    for row in &rows {
        if number(row, "height, km")? >= 100.0 {
            of_space.push(*row);
        }
    }
    let all = |column: &str| -> anyhow::Result<Vec<f64>> {
        of_space.iter().map(|row| number(row, column)).collect()
    };
    let largest = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
    let flip = all("FLIP, mean")?;
    let least = flip.iter().copied().fold(f64::INFINITY, f64::min);
    Ok(format!(
        "{least:.4}–{:.4}; ≤ {:.2} px; ≤ {} px",
        largest(flip),
        largest(all("limb, px (≤ 0.5)")?),
        super::markdown::significant(largest(all("place, px (≤ 1)")?), 1)
    ))
}

/// The number at the start of a field; spaces in it separate thousands.
fn number(row: &Row<'_>, column: &str) -> anyhow::Result<f64> {
    let text = row.text(column)?;
    let digits: String = text
        .chars()
        .filter(|c| *c != ' ')
        .take_while(|c| c.is_ascii_digit() || *c == '.')
        .collect();
    digits
        .parse()
        .with_context(|| format!("its column {column:?} has {text:?}, which is no number"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    #[test]
    fn heights_in_the_air_are_left_out() {
        let head = KEYS.map(|key| (key, "x".to_owned()));
        let body = "\"height, km\",\"FLIP, mean\",\"limb, px (≤ 0.5)\",\"place, px (≤ 1)\"\n1,9,9,9\n100,0.02,0.05,0.0026\n\
            35 786 (geostationary),0.0017,0.14,0.000078\n";
        let run = Recorded::read("a.csv", &written("a.csv", &head, body).unwrap()).unwrap();
        assert_eq!(range(&run).unwrap(), "0.0017–0.0200; ≤ 0.14 px; ≤ 0.003 px");
    }
}
