//! Why an integration cannot be, or cannot go on.

/// Why there is no trajectory, or none any more.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NumericalError {
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
    /// The epoch is not in the span, or the span is empty.
    #[error("the span from {first} to {last} does not hold the state's epoch {epoch}")]
    Span {
        /// First epoch, UTC.
        first: String,
        /// Last, UTC.
        last: String,
        /// The state's, UTC.
        epoch: String,
    },
    /// Under the ground at the epoch.
    #[error(
        "at its epoch {satellite} is {depth_m:.0} m below the ground; metres may have been taken for kilometres"
    )]
    ImpactAtEpoch {
        /// The satellite.
        satellite: String,
        /// How deep, metres.
        depth_m: f64,
    },
    /// It has met the ground.
    #[error("{satellite} meets the ground at {impact}; {asked} is on the far side of that")]
    Impact {
        /// The satellite.
        satellite: String,
        /// When, UTC.
        impact: String,
        /// What was asked for, UTC.
        asked: String,
    },
    /// The steps have become too short to advance the time.
    #[error(
        "the integration of {satellite} cannot pass {epoch}: its steps shrink to nothing, {height_km:.1} km above the ground; a force jumps or grows without bound there"
    )]
    Underflow {
        /// The satellite.
        satellite: String,
        /// How far it came, UTC.
        epoch: String,
        /// Height there, kilometres.
        height_km: f64,
    },
    /// A force is not a finite number.
    #[error("the force on {satellite} is not a finite number at {epoch}")]
    Force {
        /// The satellite.
        satellite: String,
        /// When, UTC.
        epoch: String,
    },
    /// More steps than allowed.
    #[error(
        "the integration of {satellite} has taken its {limit} steps by {epoch}; shorten the span, raise the limit (0.4 kB a step) or the tolerance"
    )]
    StepLimit {
        /// The satellite.
        satellite: String,
        /// How far it came, UTC.
        epoch: String,
        /// The limit.
        limit: usize,
    },
}
