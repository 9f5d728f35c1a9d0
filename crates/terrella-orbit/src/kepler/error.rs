//! Errors of orbital elements.

use crate::StartError;

/// Why there is no orbit, or none any longer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum KeplerError {
    /// A number that cannot be, or a start under the ground.
    #[error(transparent)]
    Start(#[from] StartError),
    /// Size and eccentricity belong to different conics.
    #[error(
        "a semi-major axis of {axis_m:e} m is inconsistent with eccentricity {eccentricity}: it is above 0 for ellipses (e < 1), below 0 for hyperbolas (e > 1), and a parabola has none; give the periapsis radius instead"
    )]
    Contradiction {
        /// The semi-major axis, metres.
        axis_m: f64,
        eccentricity: f64,
    },
    /// A true anomaly that a hyperbola or parabola does not reach.
    #[error(
        "true anomaly {anomaly_deg}° is beyond the asymptote of eccentricity {eccentricity}, {most_deg:.6}°"
    )]
    BeyondAsymptote {
        /// The true anomaly, degrees.
        anomaly_deg: f64,
        eccentricity: f64,
        most_deg: f64,
    },
    /// A parabola has no mean anomaly.
    #[error("a parabola has no mean anomaly; give the true anomaly or the time of periapsis")]
    NoMeanAnomaly,
    /// Secular drift is defined for ellipses.
    #[error(
        "J2 drift is an average over revolutions and needs an ellipse; eccentricity {eccentricity} is not one"
    )]
    DriftNeedsEllipse { eccentricity: f64 },
    /// The frame turns with the Earth.
    #[error(
        "a conic needs axes that do not rotate with the Earth: TEME, GCRF or EME2000, not {frame}"
    )]
    TurningFrame {
        /// The frame's name.
        frame: &'static str,
    },
    /// First after last, or the epoch outside.
    #[error("the span from {first} to {last} is empty")]
    EmptySpan {
        /// First epoch, UTC.
        first: String,
        /// Last, UTC.
        last: String,
    },
}
