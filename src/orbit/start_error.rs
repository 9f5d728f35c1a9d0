//! Why no motion can start.

/// Why no motion can start from a state or from elements, whether on a conic or integrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// NaN or an infinite number.
    #[error("{field} is not a finite number")]
    NotFinite {
        /// Which number.
        field: &'static str,
    },
    /// A number outside its range.
    #[error("{field} is {value:e}; expected {expected}")]
    Range {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// Under the ground at the epoch.
    #[error(
        "at its epoch {satellite} is {depth_m:.0} m below {surface}; metres may have been taken for kilometres"
    )]
    BelowGround {
        /// The satellite.
        satellite: String,
        /// How deep, metres.
        depth_m: f64,
        /// What it is below.
        surface: &'static str,
    },
}
