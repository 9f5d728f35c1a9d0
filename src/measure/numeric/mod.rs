//! Formulas held against arbitrary precision, and numerical methods compared by error and cost.
//!
//! | file | what |
//! |---|---|
//! | `oracle.rs` | real numbers of 320 bits |
//! | `method.rs` | anything that has an error and a cost, and the driver that measures both |
//! | `formula.rs` | a formula with its forms, each held against the oracle over a range |

mod formula;
mod method;
pub mod oracle;

pub use formula::{AnyFormula, Form, Formula, Judge, StabilityRow};
pub use method::{Measurement, Method, Quartiles, Sweep, Work, log_spaced, measure};
