//! Figure, time, Earth rotation and Sun against published values and independent formulas.

mod earth_orientation;
mod figure;
mod rotation;
mod sun;
mod time;

use terrella::frames::{Epoch, utc_from_rfc3339};

/// The epoch that a test writes down.
fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap()
}
