//! Tables of `docs/orbits.md`.

use super::markdown::table;
use super::record::{Recorded, Row};
use anyhow::{Context, bail};

/// Errors of propagators, metres.
pub fn errors(run: &Recorded) -> anyhow::Result<String> {
    wide(run, |row| Ok(format!("{:.1e}", row.number("error_m")?)))
}

/// Force evaluations and CPU time.
pub fn times(run: &Recorded) -> anyhow::Result<String> {
    wide(run, |row| {
        let time = milliseconds(row.number("ms_median")?);
        Ok(match row.text("evaluations")? {
            "0" => time,
            evaluations => format!("{evaluations} / {time}"),
        })
    })
}

/// Changes of energy and angular momentum.
pub fn drifts(run: &Recorded) -> anyhow::Result<String> {
    wide(run, |row| {
        let (energy, momentum) = (row.number("energy_drift")?, row.number("momentum_drift")?);
        Ok(format!("{energy:.0e} / {momentum:.0e}"))
    })
}

/// Median and largest interquartile range of the rows' times, relative to each median: "3 % (median of the rows), 12 % at most".
pub fn spread(run: &Recorded) -> anyhow::Result<String> {
    let mut parts = Vec::new();
    for row in run.rows()? {
        let apart = row.number("ms_upper")? - row.number("ms_lower")?;
        parts.push(100.0 * apart / row.number("ms_median")?);
    }
    parts.sort_by(f64::total_cmp);
    let last = parts.last().context("no rows")?;
    Ok(format!(
        "{:.0} % (median of the rows), {last:.0} % at most",
        parts[parts.len() / 2]
    ))
}

/// Interpolation errors on one orbit, without its name.
pub fn interpolation(run: &Recorded, orbit: &str) -> anyhow::Result<String> {
    let mut lines = Vec::new();
    for row in run.rows()? {
        if row.text("orbit")? == orbit {
            lines.push(row.fields[1..].to_vec());
        }
    }
    if lines.is_empty() {
        bail!("it has no row of the orbit {orbit:?}");
    }
    Ok(table(&run.columns()?[1..], lines))
}

/// A time with two digits.
fn milliseconds(ms: f64) -> String {
    match ms {
        ms if ms < 1.0 => super::markdown::significant(ms, 2),
        ms if ms < 10.0 => format!("{ms:.1}"),
        ms => format!("{ms:.0}"),
    }
}

/// A line for each orbit, and a column for each method and tolerance, in the file's order.
fn wide(
    run: &Recorded,
    cell: impl Fn(&Row<'_>) -> anyhow::Result<String>,
) -> anyhow::Result<String> {
    let (mut heads, mut lines) = (vec!["orbit".to_owned()], Vec::<Vec<String>>::new());
    let mut last_method = "";
    for row in run.rows()? {
        let (case, method) = (row.text("case")?, row.text("method")?);
        if lines.last().is_none_or(|line| line[0] != case) {
            lines.push(vec![case.to_owned()]);
        }
        if lines.len() == 1 {
            // Name each method only once.
            heads.push(
                match (method == last_method, row.text("relative_tolerance")?) {
                    (_, "") => method.to_owned(),
                    (true, tolerance) => tolerance.to_owned(),
                    (false, tolerance) => format!("{method} {tolerance}"),
                },
            );
            last_method = method;
        }
        let line = lines.last_mut().context("no rows")?;
        line.push(cell(&row)?);
    }
    if let Some(line) = lines.iter().find(|line| line.len() != heads.len()) {
        bail!(
            "{} has {} methods, the first orbit {}",
            line[0],
            line.len() - 1,
            heads.len() - 1
        );
    }
    Ok(table(&heads, lines))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    fn run(rows: &str) -> Recorded {
        let head = KEYS.map(|key| (key, "x".to_owned()));
        let body = format!(
            "case,method,relative_tolerance,error_m,energy_drift,momentum_drift,evaluations,ms_lower,ms_median,ms_upper\n{rows}"
        );
        Recorded::read("a.csv", &written("a.csv", &head, &body).unwrap()).unwrap()
    }

    const ROWS: &str = "a,conic,,1.4e-7,2e-15,1e-15,0,0.0099,0.01,0.0101\n\
        a,DOP853,1e-6,2.4e2,1e-6,5e-7,2177,0.9,1.25,1.3\n\
        a,DOP853,1e-8,3e1,1e-6,5e-7,3827,20,21.4,22\n\
        b,conic,,1e-7,2e-15,1e-15,0,0.01,0.01,0.01\n\
        b,DOP853,1e-6,2e2,1e-6,5e-7,2000,0.12,0.123,0.13\n\
        b,DOP853,1e-8,3e1,1e-6,5e-7,3827,5,5,5\n";

    #[test]
    fn each_orbit_has_a_line() {
        let run = run(ROWS);
        assert_eq!(
            errors(&run).unwrap(),
            "| orbit | conic | DOP853 1e-6 | 1e-8 |\n|---|---|---|---|\n\
             | a | 1.4e-7 | 2.4e2 | 3.0e1 |\n| b | 1.0e-7 | 2.0e2 | 3.0e1 |\n"
        );
        let times = times(&run).unwrap();
        assert!(
            times.contains("| a | 0.010 | 2177 / 1.2 | 3827 / 21 |"),
            "{times}"
        );
        assert!(drifts(&run).unwrap().contains("| 1e-6 / 5e-7 |"));
        assert_eq!(
            spread(&run).unwrap(),
            "8 % (median of the rows), 32 % at most"
        );
    }

    #[test]
    fn a_method_that_is_missing_is_reported() {
        let few = ROWS.lines().take(5).collect::<Vec<_>>().join("\n");
        assert!(
            errors(&run(&few))
                .unwrap_err()
                .to_string()
                .contains("b has 2")
        );
    }
}
