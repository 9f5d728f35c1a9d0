//! Tables of the air's light against radiative transfer.

use super::markdown::table;
use super::record::{Recorded, Row};
use anyhow::{Context, bail};

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Errors in one atmosphere, of the renderer and of the reference, by kind of view.
pub fn errors(run: &Recorded, air: &str) -> anyhow::Result<String> {
    let heads = [
        match air {
            "clear" => "without haze",
            _ => "with haze",
        },
        "drawn: median",
        "drawn: worst",
        "reference: median",
        "reference: worst",
        "allowed to drawn",
    ];
    let (drawn, reference) = (of(run, "drawn", air)?, of(run, "reference", air)?);
    let mut lines = Vec::new();
    for row in drawn {
        let view = row.text("view")?;
        let same = |other: &&Row<'_>| other.text("view").is_ok_and(|other| other == view);
        let other = reference.iter().find(same);
        let other = other.with_context(|| format!("the reference has no {view:?}"))?;
        let allowed = match (row.text("allowed_median")?, row.text("allowed_worst")?) {
            ("", _) => "–".to_owned(),
            (median, worst) => format!("{median} / {worst}"),
        };
        lines.push(vec![
            view.to_owned(),
            channels(&row, "median")?,
            channels(&row, "worst")?,
            channels(other, "median")?,
            channels(other, "worst")?,
            allowed,
        ]);
    }
    Ok(table(&heads, lines))
}

/// The largest median error of a channel in the clear atmosphere as rendered, over views with this prefix: "0.3 %".
pub fn largest_median(run: &Recorded, begins: &str) -> anyhow::Result<String> {
    let mut largest = 0.0_f64;
    for row in of(run, "drawn", "clear")? {
        if row.text("view")?.starts_with(begins) {
            for channel in CHANNELS {
                largest = largest.max(row.number(&format!("{channel}_median"))?);
            }
        }
    }
    if largest == 0.0 {
        bail!("it has no views that begin with {begins:?}");
    }
    Ok(format!("{} %", super::markdown::significant(largest, 1)))
}

/// Mean colour differences in a set: "drawn 0.23, reference 0.20".
pub fn colors(run: &Recorded, set: &str) -> anyhow::Result<String> {
    let mut words = Vec::new();
    for by in ["drawn", "reference"] {
        let rows = run.rows()?;
        let is_it = |row: &&Row<'_>| {
            row.text("set").is_ok_and(|of| of == set) && row.text("by").is_ok_and(|of| of == by)
        };
        let row = rows.iter().find(is_it);
        let row = row.with_context(|| format!("it has no set {set} {by}"))?;
        words.push(format!("{by} {:.2}", row.number("mean")?));
    }
    Ok(words.join(", "))
}

/// The rows of one method and one atmosphere.
fn of<'r>(run: &'r Recorded, by: &str, air: &str) -> anyhow::Result<Vec<Row<'r>>> {
    let mut rows = Vec::new();
    for row in run.rows()? {
        if row.text("by")? == by && row.text("air")? == air {
            rows.push(row);
        }
    }
    match rows.is_empty() {
        true => bail!("it has no rows by {by:?} in {air:?} air"),
        false => Ok(rows),
    }
}

/// Red, green and blue of a kind of error.
fn channels(row: &Row<'_>, kind: &str) -> anyhow::Result<String> {
    let mut words = Vec::new();
    for channel in CHANNELS {
        words.push(format!("{:.1}", row.number(&format!("{channel}_{kind}"))?));
    }
    Ok(words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    #[test]
    fn drawn_and_reference_stand_side_by_side() {
        let head = KEYS.map(|key| (key, "x".to_owned()));
        let body = "by,air,view,red_median,red_worst,green_median,green_worst,blue_median,blue_worst,allowed_median,allowed_worst\n\
            drawn,clear,ground,0.12,0.8,0.2,1.3,0.26,1,3,10\ndrawn,clear,sky low,1,2,3,4,5,6,,\n\
            reference,clear,sky low,7,8,9,10,11,12,,\nreference,clear,ground,1,1,1,1,1,1,3,10\n";
        let run = Recorded::read("a.csv", &written("a.csv", &head, body).unwrap()).unwrap();
        let text = errors(&run, "clear").unwrap();
        assert!(
            text.ends_with(
                "| ground | 0.1 0.2 0.3 | 0.8 1.3 1.0 | 1.0 1.0 1.0 | 1.0 1.0 1.0 | 3 / 10 |\n\
                 | sky low | 1.0 3.0 5.0 | 2.0 4.0 6.0 | 7.0 9.0 11.0 | 8.0 10.0 12.0 | – |\n"
            ),
            "{text}"
        );
        assert_eq!(largest_median(&run, "ground").unwrap(), "0.3 %");
        assert!(largest_median(&run, "sea").is_err() && errors(&run, "hazy").is_err());
    }
}
