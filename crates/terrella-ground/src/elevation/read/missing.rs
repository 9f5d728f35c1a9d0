//! Stored numbers that mean no data.

/// Maximum number of single values.
const MOST: usize = 4;

/// Stored numbers that mean no data: single values, and all outside a range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Missing {
    /// Unused entries are NaN.
    values: [f64; MOST],
    lowest: f64,
    highest: f64,
    /// Whether the file or its sidecar declares no data.
    is_declared: bool,
}

impl Missing {
    /// At most one value.
    pub fn of(value: Option<f64>) -> Self {
        let mut missing = Self {
            values: [f64::NAN; MOST],
            lowest: f64::NEG_INFINITY,
            highest: f64::INFINITY,
            is_declared: value.is_some(),
        };
        missing.values[0] = value.unwrap_or(f64::NAN);
        missing
    }

    /// Several values; `None` for more than `MOST`.
    pub(super) fn of_all(values: &[f64]) -> Option<Self> {
        let mut missing = Self::of(None);
        missing
            .values
            .get_mut(..values.len())?
            .copy_from_slice(values);
        missing.is_declared = !values.is_empty();
        Some(missing)
    }

    /// Adds all values below and above a range.
    pub(super) fn outside(self, lowest: f64, highest: f64) -> Self {
        Self {
            lowest,
            highest,
            ..self
        }
    }

    /// Keeps the range, with this single value instead.
    pub(super) fn but(self, value: f64) -> Self {
        Self::of(Some(value)).outside(self.lowest, self.highest)
    }

    /// Adds this value; `None` for more than `MOST`.
    pub(super) fn and(mut self, value: f64) -> Option<Self> {
        let free = self.values.iter_mut().find(|value| value.is_nan());
        *free? = value;
        self.is_declared = true;
        Some(self)
    }

    /// Marks the values as a library's defaults, not declared.
    pub(super) fn by_default(self) -> Self {
        Self {
            is_declared: false,
            ..self
        }
    }

    /// Whether the file or its sidecar declares no data.
    pub(super) fn is_declared(&self) -> bool {
        self.is_declared
    }

    #[inline]
    pub(super) fn has(&self, stored: f64) -> bool {
        // The file may store a value in its own precision that was written with more digits.
        let is_one = |value: &f64| stored == *value || stored == f64::from(*value as f32);
        self.values.iter().any(is_one) || stored < self.lowest || stored > self.highest
    }
}
