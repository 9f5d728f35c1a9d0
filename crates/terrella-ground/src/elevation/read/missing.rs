//! Stored numbers that mean no data.

/// Most single numbers.
const MOST: usize = 4;

/// Stored numbers that mean no data: single ones, and all outside of a range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Missing {
    /// No numbers where there are fewer.
    values: [f64; MOST],
    lowest: f64,
    highest: f64,
}

impl Missing {
    /// At most one number.
    pub fn of(value: Option<f64>) -> Self {
        let mut missing = Self {
            values: [f64::NAN; MOST],
            lowest: f64::NEG_INFINITY,
            highest: f64::INFINITY,
        };
        missing.values[0] = value.unwrap_or(f64::NAN);
        missing
    }

    /// Some numbers; `None` for more than are possible.
    pub(super) fn of_all(values: &[f64]) -> Option<Self> {
        let mut missing = Self::of(None);
        missing
            .values
            .get_mut(..values.len())?
            .copy_from_slice(values);
        Some(missing)
    }

    /// Also all below and above.
    pub(super) fn outside(self, lowest: f64, highest: f64) -> Self {
        Self {
            lowest,
            highest,
            ..self
        }
    }

    /// The range of the same, but this single number.
    pub(super) fn but(self, value: f64) -> Self {
        Self::of(Some(value)).outside(self.lowest, self.highest)
    }

    #[inline]
    pub(super) fn has(&self, stored: f64) -> bool {
        // A value in the file's own precision may have been written with more digits.
        let is_one = |value: &f64| stored == *value || stored == f64::from(*value as f32);
        self.values.iter().any(is_one) || stored < self.lowest || stored > self.highest
    }
}
