//! Why an integration cannot be, or cannot go on.

use crate::StartError;

/// Why there is no trajectory, or none any longer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum NumericalError {
    /// A number that cannot be, or a start under the ground.
    #[error(transparent)]
    Start(#[from] StartError),
    /// The epoch is not in the span, or the span is empty.
    #[error("the span from {first} to {last} does not contain the state's epoch {epoch}")]
    Span {
        /// First epoch, UTC.
        first: String,
        /// Last, UTC.
        last: String,
        /// The state's, UTC.
        epoch: String,
    },
    /// The steps have become too short to advance the time.
    #[error(
        "the integration of {satellite} cannot pass {epoch}: its step size falls to zero, {height_km:.1} km above the ground; a force jumps or grows without bound there"
    )]
    Underflow {
        satellite: String,
        /// How far it came, UTC.
        epoch: String,
        /// Height there, kilometres.
        height_km: f64,
    },
    /// A force is not a finite number.
    #[error("the force on {satellite} is not a finite number at {epoch}")]
    Force {
        satellite: String,
        /// When, UTC.
        epoch: String,
    },
    /// More steps than allowed.
    #[error(
        "the integration of {satellite} has taken its {limit} steps by {epoch}; shorten the span, raise the limit (0.4 kB a step) or the tolerance"
    )]
    StepLimit {
        satellite: String,
        /// How far it came, UTC.
        epoch: String,
        /// Most steps that an integration may take.
        limit: usize,
    },
}
