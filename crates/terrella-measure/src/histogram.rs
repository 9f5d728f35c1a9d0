//! Quantiles of more values than are kept.

/// How many values there are of each size: bins on a logarithmic scale, each a hundredth wider than the one below.
///
/// Counts are the same in any order, so quantiles are the same in every run.
#[derive(Clone, Debug, Default)]
pub struct LogHistogram {
    counts: Vec<u64>,
    len: u64,
    max: f64,
}

/// Smaller values count as this.
const LEAST: f64 = 1e-6;
/// Natural logarithm of a bin's width.
const WIDTH: f64 = 0.01;

impl LogHistogram {
    /// Counts the size of a value; one that is no number counts as infinite.
    pub fn add(&mut self, value: f64) {
        let size = value.abs();
        let size = if size.is_nan() { f64::INFINITY } else { size };
        let bin = ((size.clamp(LEAST, 1e12) / LEAST).ln() / WIDTH) as usize;
        if bin >= self.counts.len() {
            self.counts.resize(bin + 1, 0);
        }
        self.counts[bin] += 1;
        self.len += 1;
        self.max = self.max.max(size);
    }

    /// How many values were counted.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The exact maximum; 0 if empty.
    pub fn max(&self) -> f64 {
        self.max
    }

    /// A value that at least `part` (0…1) of all do not exceed, at most one per cent above the smallest such value; 0 if empty.
    pub fn quantile(&self, part: f64) -> f64 {
        let rank = ((part * self.len as f64).ceil() as u64).max(1);
        let mut below = 0;
        for (bin, count) in self.counts.iter().enumerate() {
            below += count;
            if below >= rank {
                return (LEAST * ((bin + 1) as f64 * WIDTH).exp()).min(self.max);
            }
        }
        self.max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_right_to_a_hundredth() {
        let mut histogram = LogHistogram::default();
        assert_eq!((histogram.quantile(0.5), histogram.is_empty()), (0.0, true));
        for n in (1..=100_000).rev() {
            histogram.add(-1e-3 * f64::from(n));
        }
        for (part, expected) in [(0.5, 50.0), (0.99, 99.0), (0.999, 99.9), (1.0, 100.0)] {
            let found = histogram.quantile(part);
            assert!(
                (expected..=1.0101 * expected).contains(&found),
                "{part}: {found}"
            );
        }
        assert_eq!((histogram.max(), histogram.len()), (100.0, 100_000));
        histogram.add(f64::NAN);
        assert_eq!(histogram.max(), f64::INFINITY);
    }
}
