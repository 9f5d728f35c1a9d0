//! The smooth step.

/// 0 up to `from`, 1 from `to` on, and between them a cubic with zero slope at both ends. With `from` above `to` it falls.
#[inline]
pub fn smooth_step([from, to]: [f64; 2], value: f64) -> f64 {
    let part = ((value - from) / (to - from)).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}
