//! Numbers as text.

use crate::Quartiles;
use serde::Serialize;

/// Six significant digits without an exponent where that is short.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor();
    if !(-6.0..9.0).contains(&magnitude) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

pub(super) fn digits(value: f64, significant: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if magnitude < -4 {
        return format!("{value:.0$e}", (significant - 1) as usize);
    }
    format!("{value:.0$}", (significant - 1 - magnitude).max(0) as usize)
}

/// Quartiles to two decimals.
#[derive(Debug, Serialize)]
pub(super) struct QuartilesText {
    lower: String,
    median: String,
    upper: String,
}

impl From<&Quartiles> for QuartilesText {
    fn from(quartiles: &Quartiles) -> Self {
        let text = |value: f64| format!("{value:.2}");
        Self {
            lower: text(quartiles.lower),
            median: text(quartiles.median),
            upper: text(quartiles.upper),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits() {
        let values = [0.0, 1234567.0, 0.123456789, 1e-9, 1e12, 3.0, f64::INFINITY];
        let texts = values.map(number);
        assert_eq!(
            texts,
            [
                "0",
                "1234567",
                "0.123457",
                "1.00000e-9",
                "1.00000e12",
                "3",
                "inf"
            ]
        );
    }
}
