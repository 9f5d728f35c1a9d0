//! Why no motion can start.

/// Why no motion can start from a state or from elements, whether on a conic or integrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// NaN or an infinite number.
    #[error("{field} is not a finite number")]
    NotFinite {
        /// Name of the number that is not finite.
        field: &'static str,
    },
    /// A number outside its range.
    #[error("{field} is {value:e}; expected {expected}")]
    Range {
        /// Name of the number that is out of range.
        field: &'static str,
        /// The value that was given.
        value: f64,
        /// The range that is accepted.
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
        /// The surface that it is below.
        surface: &'static str,
    },
}
