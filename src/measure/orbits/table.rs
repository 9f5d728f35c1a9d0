//! The comparison as a table.

use super::{OrbitCase, VARIANTS, methods};
use crate::measure::Quartiles;
use std::fmt::Write as _;
use std::time::Instant;

/// One method with one tolerance in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitRow {
    /// The orbit, the forces and the span.
    pub case: String,
    /// The method.
    pub method: &'static str,
    /// Relative tolerance; `None` for a formula.
    pub relative_tolerance: Option<f64>,
    /// Largest error of the position over the span, metres.
    pub error_m: f64,
    /// Largest change of the energy, relative.
    pub energy_drift: f64,
    /// Largest change of the angular momentum about the pole, relative.
    pub momentum_drift: f64,
    /// Evaluations of the force.
    pub evaluations: u64,
    /// Time of one run with 24 places read, milliseconds.
    pub milliseconds: Quartiles,
}

/// All cases, each run timed `repeats` times after one that is thrown away. Takes a minute.
pub fn rows(repeats: u32) -> Vec<OrbitRow> {
    methods()
        .iter()
        .flat_map(|case| case_rows(case, repeats))
        .collect()
}

fn case_rows(case: &OrbitCase, repeats: u32) -> Vec<OrbitRow> {
    let mut rows = Vec::new();
    for (method, solver) in VARIANTS {
        let tolerances: &[f64] = match solver {
            Some(_) => &[1e-6, 1e-8, 1e-10, 1e-12],
            None => &[1e-10],
        };
        for &tolerance in tolerances {
            let mut times = Vec::new();
            let mut run = None;
            for round in 0..=repeats {
                let start = Instant::now();
                run = case.propagate(solver, tolerance);
                if round > 0 {
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                }
            }
            let (energy_drift, momentum_drift) = run
                .as_ref()
                .map_or((f64::INFINITY, f64::INFINITY), |f| case.drifts(f));
            rows.push(OrbitRow {
                case: case.name.clone(),
                method,
                relative_tolerance: solver.map(|_| tolerance),
                error_m: case.error_m(run.as_ref()),
                energy_drift,
                momentum_drift,
                evaluations: run.map_or(0, |f| f.evaluations),
                milliseconds: Quartiles::of(times),
            });
        }
    }
    rows
}

/// The table as Markdown.
pub fn markdown(rows: &[OrbitRow]) -> String {
    let mut text = String::from(
        "| orbit | method | tolerance | error, m | energy | momentum | evaluations | ms (quartiles) |\n|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let tolerance = row
            .relative_tolerance
            .map_or("–".to_owned(), |t| format!("{t:.0e}"));
        let q = row.milliseconds;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {tolerance} | {:.1e} | {:.0e} | {:.0e} | {} | {:.2} ({:.2}–{:.2}) |",
            row.case,
            row.method,
            row.error_m,
            row.energy_drift,
            row.momentum_drift,
            row.evaluations,
            q.median,
            q.lower,
            q.upper,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_all_of_it() {
        let case = OrbitCase::new(0.1, false, 1.0).unwrap();
        let rows = case_rows(&case, 1);
        assert_eq!(rows.len(), 9);
        let text = markdown(&rows);
        assert_eq!(text.lines().count(), 11);
        assert!(
            text.contains("| e = 0.1, two bodies, 1 day | DOP853 | 1e-8 |"),
            "{text}"
        );
        assert!(
            rows.iter()
                .all(|row| row.error_m.is_finite() && row.energy_drift < 1e-3)
        );
    }

    #[test]
    #[ignore = "prints the table of docs/orbits.md; a minute in a release build"]
    fn print_the_table() {
        println!("{}", markdown(&rows(5)));
    }
}
