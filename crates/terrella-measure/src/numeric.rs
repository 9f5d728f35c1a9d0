//! Formulas compared with arbitrary precision, and numerical methods compared by error and cost.
//!
//! | file | what |
//! |---|---|
//! | `oracle.rs` | real numbers of 320 bits |
//! | `method.rs` | anything that has an error and a cost, and the driver that measures both |
//! | `formula.rs` | a formula with its forms, each compared with the oracle over a range |
//! | `limb.rs`, `roots.rs`, `horizon.rs`, `geodetic.rs`, `sidereal.rs`, `depth.rs`, `place.rs` | the formulas |

mod depth;
mod formula;
mod geodetic;
mod horizon;
mod limb;
mod method;
pub mod oracle;
mod place;
mod roots;
mod sidereal;

pub use depth::{reversed_depth, standard_depth};
pub use formula::{AnyFormula, ErrorMeasure, Form, Formula, StabilityRow};
pub use method::{Measurement, Method, Sweep, Work, log_spaced, measure};
pub use place::{PixelRay, Placed, ShaderInput, place};

/// Every formula that the product would lose digits in, were it written as usual.
pub fn formulas() -> Vec<Box<dyn AnyFormula>> {
    [
        limb::formulas(),
        roots::formulas(),
        horizon::formulas(),
        geodetic::formulas(),
        place::formulas(),
        depth::formulas(),
        sidereal::formulas(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Every form of every formula against the oracle, the printed one before the stable one. Takes seconds.
pub fn stability_table() -> Vec<StabilityRow> {
    formulas()
        .iter()
        .flat_map(|formula| formula.rows())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::csv_text;

    #[test]
    #[ignore = "prints the rows of docs/recorded/stability.csv; seconds in a release build"]
    fn print_stability() {
        let head = StabilityRow::CSV_COLUMNS.map(str::to_owned);
        let rows = stability_table();
        let lines = std::iter::once(head).chain(rows.iter().map(StabilityRow::csv_fields));
        println!("\n--- begin csv\n{}--- end csv", csv_text(lines));
    }
}
