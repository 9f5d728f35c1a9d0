//! Why no motion can start.

/// The most common cause of an implausible state.
pub(super) const METRES_FOR_KILOMETRES: &str = "metres may have been taken for kilometres";

/// Why no motion can start from a state or from elements, whether on a conic or integrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
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
    #[error("at its epoch {satellite} is {depth_m:.0} m below {surface}; {METRES_FOR_KILOMETRES}")]
    BelowGround {
        satellite: String,
        /// How deep, metres.
        depth_m: f64,
        surface: &'static str,
    },
}
