//! Axes of charts: positions of values, and their tick labels.

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use std::ops::Range;

/// A linear or logarithmic axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    range: Range<f64>,
    is_log: bool,
}

impl Axis {
    /// An axis over a range; above 0 if it is logarithmic.
    pub fn new(range: Range<f64>, is_log: bool) -> Self {
        Self { range, is_log }
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let along = |value: f64| if self.is_log { value.log10() } else { value };
        let (low, high) = (along(self.range.start), along(self.range.end));
        let part = (along(*value) - low) / (high - low);
        // A cast clamps; a non-finite value is placed at the start of the axis.
        let along = (part * f64::from(limit.1 - limit.0)).round() as i32;
        limit.0.saturating_add(along)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let (low, high) = (self.range.start, self.range.end);
        let most = hint.bold_points();
        let named = match self.is_log {
            true => log_ticks(low, high, most),
            false => linear_ticks(low, high, most),
        };
        if !hint.weight().allow_light_points() {
            return named;
        }
        let between = match self.is_log {
            true => of_digits(low, high, &DIGITS),
            false => linear_ticks(low, high, 5 * most),
        };
        if between.len() <= hint.max_num_points() {
            between
        } else {
            named
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

const DIGITS: [i32; 9] = [1, 2, 3, 4, 5, 6, 7, 8, 9];

/// At most `most` round numbers of a logarithmic axis: a span of less than a factor of three is as good as linear, then
/// every digit of each decade, then 1, 2 and 5, then 1 and 3, then decades, then some of them.
fn log_ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    if high < 3.0 * low {
        return linear_ticks(low, high, most);
    }
    for digits in [&DIGITS[..], &[1, 2, 5], &[1, 3], &[1]] {
        let ticks = of_digits(low, high, digits);
        if (2..=most).contains(&ticks.len()) {
            return ticks;
        }
    }
    let decades = of_digits(low, high, &[1]);
    let step = decades.len().div_ceil(most.max(1)).max(1);
    decades.into_iter().step_by(step).collect()
}

/// Every digit × 10ⁿ from `low` to `high`.
fn of_digits(low: f64, high: f64, digits: &[i32]) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    decades
        .flat_map(|n| digits.iter().map(move |d| f64::from(*d) * 10f64.powi(n)))
        .filter(|tick| (low..=high).contains(tick))
        .collect()
}

/// At most `most` multiples of 1, 2 or 5 × 10ⁿ.
fn linear_ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) || most == 0 {
        return Vec::new();
    }
    let least = span / most as f64;
    let decade = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|digit| digit * decade)
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or(10.0 * decade);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|n| n as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let near = |ticks: Vec<f64>, expected: &[f64]| {
            let apart = ticks.iter().zip(expected).map(|(a, b)| (a / b - 1.0).abs());
            assert!(
                ticks.len() == expected.len() && apart.fold(0.0, f64::max) < 1e-9,
                "{ticks:?} instead of {expected:?}"
            );
        };
        near(
            log_ticks(0.015, 0.07, 8),
            &[0.02, 0.03, 0.04, 0.05, 0.06, 0.07],
        );
        near(log_ticks(0.004, 0.05, 8), &[0.005, 0.01, 0.02, 0.05]);
        near(
            log_ticks(0.9, 700.0, 8),
            &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0],
        );
        near(log_ticks(1.5, 4e5, 8), &[10.0, 100.0, 1e3, 1e4, 1e5]);
        near(
            log_ticks(11.0, 19.0, 8),
            &[11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0][..],
        );
        near(linear_ticks(-1.0, 9.0, 5), &[0.0, 2.0, 4.0, 6.0, 8.0]);
        let far = log_ticks(1e-30, 1e30, 8);
        assert!((2..=8).contains(&far.len()), "{far:?}");
        assert!(linear_ticks(1.0, 1.0, 5).is_empty());
    }

    #[test]
    fn values_stand_where_they_belong() {
        let log = Axis::new(1.0..100.0, true);
        assert_eq!(
            [1.0, 10.0, 100.0].map(|v| log.map(&v, (0, 200))),
            [0, 100, 200]
        );
        let linear = Axis::new(0.0..10.0, false);
        assert_eq!([0.0, 5.0].map(|v| linear.map(&v, (100, 0))), [100, 50]);
        // Never a panic.
        for value in [0.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE] {
            log.map(&value, (10, 200));
            linear.map(&value, (200, 10));
        }
    }
}
