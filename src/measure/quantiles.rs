//! Medians, percentiles and jank of measured times.

/// Quantiles of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantiles {
    /// The value that half of the sample does not reach.
    pub median: f64,
    /// The value that 95 of a hundred do not exceed.
    pub p95: f64,
    /// The value that 99 of a hundred do not exceed.
    pub p99: f64,
}

impl Quantiles {
    /// The quantiles of a sample; all zero for an empty one. Values that are no numbers count as the largest.
    pub fn of(sample: &[f64]) -> Self {
        let sorted = sorted(sample);
        Self {
            median: nearest_rank(&sorted, 0.5),
            p95: nearest_rank(&sorted, 0.95),
            p99: nearest_rank(&sorted, 0.99),
        }
    }
}

/// A median with its quartiles: what is told of a repeated measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// A quarter of the sample lies below.
    pub low: f64,
    /// Half of the sample lies below.
    pub median: f64,
    /// Three quarters of the sample lie below.
    pub high: f64,
}

impl Spread {
    /// The spread of a sample; all zero for an empty one.
    pub fn of(sample: &[f64]) -> Self {
        let sorted = sorted(sample);
        Self {
            low: nearest_rank(&sorted, 0.25),
            median: nearest_rank(&sorted, 0.5),
            high: nearest_rank(&sorted, 0.75),
        }
    }

    /// A value without any spread.
    pub fn exact(value: f64) -> Self {
        Self {
            low: value,
            median: value,
            high: value,
        }
    }
}

/// Jank: the time by which frames are longer than twice the median, summed. In the unit of the sample.
pub fn jank(frames: &[f64]) -> f64 {
    let budget = 2.0 * Quantiles::of(frames).median;
    frames.iter().map(|time| (time - budget).max(0.0)).sum()
}

fn sorted(sample: &[f64]) -> Vec<f64> {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The smallest value that at least `part` of the sample does not exceed.
pub(super) fn nearest_rank(sorted: &[f64], part: f64) -> f64 {
    let rank = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_the_sample() {
        let sample: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let found = Quantiles::of(&sample);
        assert_eq!((found.median, found.p95, found.p99), (50.0, 95.0, 99.0));
        let one = Quantiles::of(&[3.0]);
        assert_eq!((one.median, one.p95, one.p99), (3.0, 3.0, 3.0));
        assert_eq!(Quantiles::of(&[]), Quantiles::default());
        let spread = Spread::of(&[4.0, 1.0, 3.0, 2.0]);
        assert_eq!((spread.low, spread.median, spread.high), (1.0, 2.0, 3.0));
        assert_eq!(Quantiles::of(&[1.0, f64::NAN, 2.0]).median, 2.0);
    }

    #[test]
    fn jank_is_what_exceeds_twice_the_median() {
        assert_eq!(jank(&[10.0, 12.0, 14.0]), 0.0);
        assert_eq!(jank(&[10.0, 10.0, 10.0, 10.0, 20.0, 26.0, 31.0]), 17.0);
        assert_eq!(jank(&[]), 0.0);
    }
}
