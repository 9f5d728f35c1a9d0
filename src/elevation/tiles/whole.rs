//! Rounding down, where a call to a library would take as long as the rest.

/// The largest whole number that is not above a number, without a call to a library.
#[inline]
pub fn whole_below(value: f64) -> f64 {
    if value.abs() >= (1_u64 << 52) as f64 {
        return value;
    }
    let towards_zero = value as i64 as f64;
    if towards_zero > value {
        towards_zero - 1.0
    } else {
        towards_zero
    }
}
