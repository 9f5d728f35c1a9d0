//! A range of heights above the ellipsoid.

/// Lowest and highest of some heights, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightRange {
    /// Lowest height, metres above the ellipsoid.
    pub low_m: f64,
    /// Highest height, metres above the ellipsoid.
    pub high_m: f64,
}
