//! A fast floor function, where a library call would take as long as the rest.

/// The largest integer that is not above a number. `f64::floor` is a library call on processors without the instruction.
#[inline]
pub(super) fn floor(x: f64) -> f64 {
    // Larger numbers are integers already and may not fit an i64.
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
