//! When rows are exposed.

use std::ops::Range;

/// A shutter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shutter {
    /// All rows at the same time.
    #[default]
    Global,
    /// Row by row.
    Rolling {
        /// Time from one row to the next, seconds.
        line_time_s: f64,
        /// Whether the bottom row is read first.
        from_below: bool,
    },
}

impl Shutter {
    /// Centre of a row's exposure after that of the first row read, seconds.
    pub fn row_time_s(&self, row: f64, height: u32) -> f64 {
        match *self {
            Self::Global => 0.0,
            Self::Rolling {
                line_time_s,
                from_below,
            } => match from_below {
                true => (f64::from(height) - 1.0 - row) * line_time_s,
                false => row * line_time_s,
            },
        }
    }

    /// From the first row to the last, seconds.
    pub fn readout_s(&self, height: u32) -> f64 {
        match *self {
            Self::Global => 0.0,
            Self::Rolling { line_time_s, .. } => line_time_s * f64::from(height.saturating_sub(1)),
        }
    }
}

/// The rows of a picture in this many bands, which differ by one row at most.
pub fn bands(height: u32, count: u32) -> impl Iterator<Item = Range<u32>> {
    let count = count.clamp(1, height.max(1));
    let edge = move |k: u32| (u64::from(height) * u64::from(k) / u64::from(count)) as u32;
    (0..count).map(move |k| edge(k)..edge(k + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_all_rows_once() {
        for (height, count) in [(10, 3), (1, 5), (768, 100), (7, 7)] {
            let rows: Vec<u32> = bands(height, count).flatten().collect();
            assert_eq!(rows, (0..height).collect::<Vec<_>>());
        }
    }

    #[test]
    fn rows_follow_each_other_from_either_side() {
        let mut shutter = Shutter::Rolling {
            line_time_s: 2e-5,
            from_below: false,
        };
        assert!((shutter.row_time_s(100.0, 480) - 2e-3).abs() < 1e-15);
        assert!((shutter.readout_s(480) - 9.58e-3).abs() < 1e-15);
        shutter = Shutter::Rolling {
            line_time_s: 2e-5,
            from_below: true,
        };
        assert_eq!(shutter.row_time_s(479.0, 480), 0.0);
    }
}
