//! Interpolated ephemerides by degree and step, as a table.

use crate::orbit::interpolated::{Interpolation, KeplerOrbit, interpolation_error};
use std::fmt::Write as _;

/// Steps from state to state, seconds.
const STEPS_S: [f64; 7] = [10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0];

/// Largest error of positions, metres, by degree and step, as Markdown: Lagrange and Hermite of degrees 1 to 15, over one
/// revolution, perigee included.
pub fn interpolation_markdown(orbit: &KeplerOrbit) -> String {
    let mut text = String::from("| |");
    // Writing to a String cannot fail.
    for step_s in STEPS_S {
        let _ = match step_s < 60.0 {
            true => write!(text, " {step_s} s |"),
            false => write!(text, " {} min |", step_s / 60.0),
        };
    }
    text += "\n|---|";
    text += &"---|".repeat(STEPS_S.len());
    text.push('\n');
    for (name, interpolation) in rows() {
        let _ = write!(text, "| {name} |");
        for step_s in STEPS_S {
            let _ = match interpolation_error(interpolation, step_s, orbit) {
                Ok(worst) => write!(text, " {:.0e} |", worst.position_m),
                Err(_) => write!(text, " – |"),
            };
        }
        text.push('\n');
    }
    text
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
        let text = interpolation_markdown(&KeplerOrbit::LOW);
        assert_eq!(text.lines().count(), 2 + 15 + 8);
        let cell = |row: &str, column: usize| -> f64 {
            let line = text
                .lines()
                .find(|line| line.starts_with(&format!("| {row} |")));
            let cell = line
                .expect("a row")
                .split('|')
                .nth(2 + column)
                .expect("a cell");
            cell.trim().parse().expect("a number")
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
    #[ignore = "prints tables of docs/orbits.md"]
    fn print_the_table_of_interpolations() {
        println!("{}", interpolation_markdown(&KeplerOrbit::LOW));
        println!("{}", interpolation_markdown(&KeplerOrbit::MOLNIYA));
    }
}
