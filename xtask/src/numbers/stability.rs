//! The table of formulas compared with 320-bit arithmetic.

use super::markdown::table;
use super::record::{Recorded, Row};
use anyhow::Context;

/// A line for each formula: the form in use, and the alternatives.
pub fn forms(run: &Recorded) -> anyhow::Result<String> {
    let rows = run.rows()?;
    let mut names: Vec<&str> = Vec::new();
    for row in &rows {
        let name = row.text("formula")?;
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut lines = Vec::new();
    for name in names {
        let mut of_name = Vec::new();
        for row in &rows {
            if row.text("formula")? == name {
                of_name.push(row);
            }
        }
        let (mut used, mut others) = (None, Vec::new());
        for row in of_name {
            match row.text("stable")? {
                "true" => used = Some(row),
                _ => others.push(other(row)?),
            }
        }
        let used = used.with_context(|| format!("{name} has no form in use"))?;
        lines.push(vec![
            format!("{name}, {}", used.text("range")?),
            error(used)?,
            others.join("; "),
        ]);
    }
    Ok(table(
        &[
            "formula, range",
            "in use: worst",
            "as printed, or as usual: worst",
        ],
        lines,
    ))
}

/// The largest error of a form with its unit.
fn error(row: &Row<'_>) -> anyhow::Result<String> {
    let worst = row.number("worst")?;
    let unit = match row.text("unit")? {
        "relative" => "",
        _ if worst.is_infinite() => "",
        unit => unit,
    };
    let text = match worst {
        worst if worst.is_infinite() => "no number".to_owned(),
        worst if (0.01..1e4).contains(&worst) => super::markdown::significant(worst, 2),
        worst => format!("{worst:.0e}"),
    };
    Ok(format!("{text} {unit}").trim_end().to_owned())
}

/// An alternative form: its description, its largest error, and the range where it still keeps the bound.
fn other(row: &Row<'_>) -> anyhow::Result<String> {
    let form = row.text("form")?;
    let form = form.split_once(": ").map_or(form, |(_, form)| form);
    let text = format!("{form}: {}", error(row)?);
    if row.text("holds_from")?.is_empty() {
        return Ok(text);
    }
    Ok(format!(
        "{text}, holds for {} from {:.0e} to {:.0e}",
        row.text("parameter")?,
        row.number("holds_from")?,
        row.number("holds_to")?
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    #[test]
    fn each_formula_has_a_line() {
        let head = KEYS.map(|key| (key, "x".to_owned()));
        let body = "formula,form,range,parameter,holds_from,holds_to,bound,stable,worst,at,unit\n\
            dip,as printed: acos,1 m to 1e12 m,height_m,3e5,1e12,1e-15,false,1.2e-7,1,relative\n\
            dip,stable: asin,1 m to 1e12 m,height_m,1,1e12,1e-15,true,3.1e-16,1,relative\n\
            place,usual: f32,near,lat,,,1,false,inf,0,m\nplace,stable: x,near,lat,1,2,1,true,9.512,0,m\n";
        let run = Recorded::read("a.csv", &written("a.csv", &head, body).unwrap()).unwrap();
        let text = forms(&run).unwrap();
        assert!(
            text.ends_with(
                "| dip, 1 m to 1e12 m | 3e-16 | acos: 1e-7, holds for height_m from 3e5 to 1e12 |\n\
                 | place, near | 9.5 m | f32: no number |\n"
            ),
            "{text}"
        );
    }
}
