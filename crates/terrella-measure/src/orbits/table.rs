//! The comparison as a table.

use super::{OrbitCase, VARIANTS, methods};
use crate::Quartiles;
use crate::output::csv_text;
use cpu_time::ThreadTime;
use std::hint::black_box;
use terrella_orbit::numerical::Solver;

/// One method with one tolerance in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitRow {
    /// The orbit, the forces and the span.
    pub case: String,
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
    /// Processor time of one run with 24 places read, milliseconds.
    pub milliseconds: Quartiles,
}

/// Least processor time that is timed in one piece, seconds: shorter runs are repeated until they take as much.
const LEAST_S: f64 = 4e-3;

/// All cases, each run timed `repeats` times after one that is thrown away. Takes minutes.
pub fn rows(repeats: u32) -> Vec<OrbitRow> {
    let cases = methods();
    cases
        .iter()
        .flat_map(|case| case_rows(case, repeats))
        .collect()
}

/// One method with one tolerance, and the times of its runs.
struct Entry {
    method: &'static str,
    solver: Option<Solver>,
    tolerance: f64,
    /// Runs that are timed in one piece.
    calls: u32,
    milliseconds: Vec<f64>,
}

impl Entry {
    /// Processor time of a run, milliseconds: what other programs take is not in it.
    fn time(&self, case: &OrbitCase) -> f64 {
        let start = ThreadTime::now();
        for _ in 0..self.calls {
            black_box(case.propagate(self.solver, self.tolerance));
        }
        start.elapsed().as_secs_f64() * 1e3 / f64::from(self.calls)
    }
}

fn case_rows(case: &OrbitCase, repeats: u32) -> Vec<OrbitRow> {
    let mut entries = Vec::new();
    for (method, solver) in VARIANTS {
        let tolerances: &[f64] = match solver {
            Some(_) => &[1e-6, 1e-8, 1e-10, 1e-12],
            None => &[1e-10],
        };
        entries.extend(tolerances.iter().map(|&tolerance| Entry {
            method,
            solver,
            tolerance,
            calls: 1,
            milliseconds: Vec::new(),
        }));
    }
    for entry in &mut entries {
        let once_s = entry.time(case) * 1e-3;
        entry.calls = (LEAST_S / once_s.max(1e-7)).ceil().max(1.0) as u32;
    }
    // Interleaved, so that a slower phase of the machine affects all methods.
    for _ in 0..repeats {
        for entry in &mut entries {
            entry.milliseconds.push(entry.time(case));
        }
    }
    let rows = entries.into_iter().map(|entry| {
        let run = case.propagate(entry.solver, entry.tolerance);
        let (energy_drift, momentum_drift) = run
            .as_ref()
            .map_or((f64::INFINITY, f64::INFINITY), |run| case.drifts(run));
        OrbitRow {
            case: case.name.clone(),
            method: entry.method,
            relative_tolerance: entry.solver.map(|_| entry.tolerance),
            error_m: case.error_m(run.as_ref()),
            energy_drift,
            momentum_drift,
            evaluations: run.map_or(0, |run| run.evaluations),
            milliseconds: Quartiles::of(entry.milliseconds),
        }
    });
    rows.collect()
}

/// The columns of [`csv()`].
const COLUMNS: [&str; 10] = [
    "case",
    "method",
    "relative_tolerance",
    "error_m",
    "energy_drift",
    "momentum_drift",
    "evaluations",
    "ms_lower",
    "ms_median",
    "ms_upper",
];

/// The rows as comma-separated values; times are processor time, milliseconds, with their quartiles.
pub fn csv(rows: &[OrbitRow]) -> String {
    let head = COLUMNS.map(str::to_owned);
    let lines = rows.iter().map(|row| {
        let tolerance = row.relative_tolerance;
        [
            row.case.clone(),
            row.method.to_owned(),
            tolerance.map_or(String::new(), |tolerance| format!("{tolerance:.0e}")),
            format!("{:.3e}", row.error_m),
            format!("{:.2e}", row.energy_drift),
            format!("{:.2e}", row.momentum_drift),
            row.evaluations.to_string(),
            format!("{:.5}", row.milliseconds.lower),
            format!("{:.5}", row.milliseconds.median),
            format!("{:.5}", row.milliseconds.upper),
        ]
    });
    csv_text(std::iter::once(head).chain(lines))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_all_of_it() {
        let case = OrbitCase::new(0.1, false, 1.0).unwrap();
        let rows = case_rows(&case, 1);
        assert_eq!(rows.len(), 9);
        let text = csv(&rows);
        assert_eq!(text.lines().count(), 10);
        let line = text
            .lines()
            .find(|line| line.starts_with("\"e = 0.1, two bodies, 1 day\",DOP853,1e-8,"))
            .expect(&text);
        // Times rise from quartile to quartile.
        let times: Vec<f64> = line
            .rsplit(',')
            .take(3)
            .map(|field| field.parse().expect("a number"))
            .collect();
        assert!(
            0.0 < times[2] && times[2] <= times[1] && times[1] <= times[0],
            "{line}"
        );
        assert!(
            rows.iter()
                .all(|row| row.error_m.is_finite() && row.energy_drift < 1e-3)
        );
    }

    #[test]
    #[ignore = "prints the rows of docs/recorded/orbits.csv; some minutes in a release build"]
    fn print_orbits() {
        println!("\n--- begin csv\n{}--- end csv", csv(&rows(9)));
    }
}
