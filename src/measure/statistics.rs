//! Medians, quartiles, percentiles and jank of repeated measurements.

/// A sample in rising order. Values that are no numbers count as the largest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SortedSample(Vec<f64>);

impl SortedSample {
    /// Sorts a sample.
    pub fn new(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// How many values there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The smallest value that at least `part` (0…1) of the sample does not exceed, by the nearest rank; 0 of an empty
    /// sample.
    pub fn quantile(&self, part: f64) -> f64 {
        let rank = (part * self.0.len() as f64).ceil() as usize;
        self.0.get(rank.max(1) - 1).copied().unwrap_or(0.0)
    }

    /// The mean; 0 of an empty sample.
    pub fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len().max(1) as f64
    }

    /// The value that half of the sample does not exceed.
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// The largest value.
    pub fn max(&self) -> f64 {
        self.quantile(1.0)
    }
}

/// Quantiles of a sample, as reports keep them.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantiles {
    /// The value that half of the sample does not exceed.
    pub median: f64,
    /// The value that 95 of a hundred do not exceed.
    pub p95: f64,
    /// The value that 99 of a hundred do not exceed.
    pub p99: f64,
}

impl Quantiles {
    /// The quantiles of a sample; all zero for an empty one, because JSON has nothing for what is not a number.
    pub fn of(sample: &[f64]) -> Self {
        let sorted = SortedSample::new(sample.to_vec());
        Self {
            median: sorted.median(),
            p95: sorted.quantile(0.95),
            p99: sorted.quantile(0.99),
        }
    }
}

/// Median and quartiles of a repeated measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quartiles {
    /// The value that a quarter of the sample does not exceed.
    pub lower: f64,
    /// The value that half of the sample does not exceed.
    pub median: f64,
    /// The value that three quarters of the sample do not exceed.
    pub upper: f64,
}

impl Quartiles {
    /// Not measured: no number.
    pub const NONE: Self = Self::exact(f64::NAN);

    /// The quartiles of a sample; [`Self::NONE`] of an empty one.
    pub fn of(sample: impl IntoIterator<Item = f64>) -> Self {
        let sorted = SortedSample::new(sample.into_iter().collect());
        if sorted.is_empty() {
            return Self::NONE;
        }
        Self {
            lower: sorted.quantile(0.25),
            median: sorted.median(),
            upper: sorted.quantile(0.75),
        }
    }

    /// A value without any spread.
    pub const fn exact(value: f64) -> Self {
        Self {
            lower: value,
            median: value,
            upper: value,
        }
    }
}

/// The value that half of a sample does not exceed; 0 of an empty one.
pub fn median(sample: &[f64]) -> f64 {
    SortedSample::new(sample.to_vec()).median()
}

/// Jank: the time by which frames are longer than twice the median, summed. In the unit of the sample.
pub fn jank(frames: &[f64]) -> f64 {
    let budget = 2.0 * median(frames);
    frames.iter().map(|time| (time - budget).max(0.0)).sum()
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
        assert_eq!(Quantiles::of(&[1.0, f64::NAN, 2.0]).median, 2.0);
    }

    #[test]
    fn quartiles_are_values_of_the_sample() {
        let found = Quartiles::of([4.0, 1.0, 3.0, 2.0]);
        assert_eq!((found.lower, found.median, found.upper), (1.0, 2.0, 3.0));
        let found = Quartiles::of([5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!((found.lower, found.median, found.upper), (2.0, 3.0, 4.0));
        assert!(Quartiles::of([]).median.is_nan());
    }

    #[test]
    fn jank_is_what_exceeds_twice_the_median() {
        assert_eq!(jank(&[10.0, 12.0, 14.0]), 0.0);
        assert_eq!(jank(&[10.0, 10.0, 10.0, 10.0, 20.0, 26.0, 31.0]), 17.0);
        assert_eq!(jank(&[]), 0.0);
    }
}
