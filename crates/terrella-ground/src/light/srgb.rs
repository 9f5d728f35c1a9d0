//! The sRGB transfer function (IEC 61966-2-1).

/// Display value, 0…1, of linear light.
pub(super) fn encoded(linear: f64) -> f64 {
    match linear <= 0.003_130_8 {
        true => 12.92 * linear,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    }
}

/// Its inverse.
pub(super) fn linear_from_encoded(encoded: f64) -> f64 {
    match encoded <= 0.040_45 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}
