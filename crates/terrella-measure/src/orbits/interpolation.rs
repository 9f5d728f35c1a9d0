//! Interpolated ephemerides by degree and step, as a table.

use crate::output::csv_text;
use terrella_orbit::interpolated::{Interpolation, KeplerOrbit, interpolation_error};

/// Steps from state to state, seconds.
const STEPS_S: [f64; 7] = [10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0];

/// Largest error of positions by degree and step over one revolution, perigee included, of named orbits, as comma-separated
/// values: a line for each polynomial, Lagrange and Hermite of degrees 1 to 15, a column of metres for each step.
pub fn interpolation_csv(orbits: &[(&str, &KeplerOrbit)]) -> String {
    let steps = STEPS_S.map(|step_s| match step_s < 60.0 {
        true => format!("{step_s} s"),
        false => format!("{} min", step_s / 60.0),
    });
    let mut lines = vec![
        ["orbit".to_owned(), String::new()]
            .into_iter()
            .chain(steps)
            .collect(),
    ];
    for (orbit_name, orbit) in orbits {
        for (name, interpolation) in rows() {
            let mut line = vec![(*orbit_name).to_owned(), name];
            line.extend(STEPS_S.map(|step_s| {
                match interpolation_error(interpolation, step_s, orbit) {
                    Ok(worst) => format!("{:.0e}", worst.position_m),
                    Err(_) => "–".to_owned(),
                }
            }));
            lines.push(line);
        }
    }
    csv_text(lines)
}

/// Hermite's polynomials of an even degree use the states of the next odd one, so they are left out.
fn rows() -> Vec<(String, Interpolation)> {
    let lagrange = (1..=15).map(|degree| {
        let interpolation = Interpolation::Lagrange { degree };
        (format!("Lagrange {degree}"), interpolation)
    });
    let hermite = (1..=15).step_by(2).map(|degree| {
        let interpolation = Interpolation::Hermite { degree };
        (format!("Hermite {degree}"), interpolation)
    });
    lagrange.chain(hermite).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_degree_has_a_row_and_more_states_are_better() {
        let text = interpolation_csv(&[("low", &KeplerOrbit::LOW)]);
        assert_eq!(text.lines().count(), 1 + 15 + 8);
        let cell = |row: &str, column: usize| -> f64 {
            let line = text
                .lines()
                .find(|line| line.starts_with(&format!("low,{row},")));
            let cell = line
                .expect("a row")
                .split(',')
                .nth(2 + column)
                .expect("a cell");
            cell.parse().expect("a number")
        };
        // At two minutes: 9e-4 m of eight positions, 7e-6 m of four states.
        assert!((5e-4..2e-3).contains(&cell("Lagrange 7", 3)));
        assert!((3e-6..2e-5).contains(&cell("Hermite 7", 3)));
        for degree in 3..10 {
            let (more, fewer) = (
                format!("Lagrange {degree}"),
                format!("Lagrange {}", degree - 2),
            );
            assert!(cell(&more, 4) < 0.5 * cell(&fewer, 4), "{degree}");
        }
    }

    #[test]
    #[ignore = "prints the rows of docs/recorded/interpolation.csv"]
    fn print_interpolations() {
        let orbits = [
            ("low", &KeplerOrbit::LOW),
            ("Molniya", &KeplerOrbit::MOLNIYA),
        ];
        println!("\n--- begin csv\n{}--- end csv", interpolation_csv(&orbits));
    }
}
