//! Rounding down, where a call to a library would take as long as the rest.

/// The largest whole number that is not above a number: `f64::floor` is a call where the processor may lack the instruction.
#[inline]
pub(super) fn floor(x: f64) -> f64 {
    // Larger numbers are whole, and may not fit an i64.
    if x.is_nan() || x.abs() > 4e15 {
        return x;
    }
    let towards_zero = x as i64 as f64;
    if towards_zero > x {
        towards_zero - 1.0
    } else {
        towards_zero
    }
}
