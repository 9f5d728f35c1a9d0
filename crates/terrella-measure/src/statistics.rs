//! Medians, quartiles, percentiles and jank of repeated measurements.

/// A sample in rising order. Values that are no numbers count as the largest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SortedSample(Vec<f64>);

impl SortedSample {
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

    /// The middle value, or the mean of the two in the middle; 0 of an empty sample.
    pub fn median(&self) -> f64 {
        let (half, is_odd) = (self.0.len() / 2, self.0.len() % 2 == 1);
        match (is_odd, half.checked_sub(1)) {
            (true, _) => self.0[half],
            (false, Some(below)) => 0.5 * (self.0[below] + self.0[half]),
            (false, None) => 0.0,
        }
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
    pub median: f64,
    /// 95th percentile; `None` for fewer than 20 values, for which it would be the maximum.
    pub p95: Option<f64>,
    /// 99th percentile; `None` for fewer than 100 values.
    pub p99: Option<f64>,
}

impl Quantiles {
    /// The quantiles of a sample; the median of an empty one is zero, because JSON cannot represent NaN.
    pub fn of(sample: &[f64]) -> Self {
        let sorted = SortedSample::new(sample.to_vec());
        let beyond =
            |part: f64, least: usize| (sorted.len() >= least).then(|| sorted.quantile(part));
        Self {
            median: sorted.median(),
            p95: beyond(0.95, 20),
            p99: beyond(0.99, 100),
        }
    }
}

/// Median and quartiles of a repeated measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quartiles {
    /// The value that a quarter of the sample does not exceed.
    pub lower: f64,
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

/// The middle value of a sample, or the mean of the two in the middle; 0 of an empty one.
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
    fn percentiles_are_values_of_the_sample_and_need_enough_of_them() {
        let sample: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let found = Quantiles::of(&sample);
        assert_eq!(
            (found.median, found.p95, found.p99),
            (50.5, Some(95.0), Some(99.0))
        );
        assert_eq!(Quantiles::of(&sample[..99]).p99, None);
        let twenty = Quantiles::of(&sample[..20]);
        assert_eq!((twenty.p95, twenty.p99), (Some(99.0), None));
        assert_eq!(Quantiles::of(&sample[..19]).p95, None);
        assert_eq!(Quantiles::of(&[]), Quantiles::default());
        assert_eq!(Quantiles::of(&[1.0, f64::NAN, 2.0]).median, 2.0);
    }

    #[test]
    fn the_median_of_an_even_sample_is_in_the_middle() {
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&[4.0, 1.0, 3.0]), 3.0);
        assert_eq!((median(&[7.0]), median(&[])), (7.0, 0.0));
    }

    #[test]
    fn quartiles_are_values_of_the_sample() {
        let found = Quartiles::of([4.0, 1.0, 3.0, 2.0]);
        assert_eq!((found.lower, found.median, found.upper), (1.0, 2.5, 3.0));
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
