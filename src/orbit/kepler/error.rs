//! What can be wrong with elements.

/// Why there is no orbit, or none any more.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KeplerError {
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
    /// OrbitSize and eccentricity belong to different conics.
    #[error(
        "a semi-major axis of {axis_m:e} m does not go with eccentricity {eccentricity}: it is above 0 for ellipses (e < 1), below 0 for hyperbolas (e > 1), and a parabola has none; give the periapsis radius instead"
    )]
    Contradiction {
        /// The semi-major axis, metres.
        axis_m: f64,
        /// The eccentricity.
        eccentricity: f64,
    },
    /// A true anomaly that a hyperbola or parabola does not reach.
    #[error(
        "true anomaly {anomaly_deg}° is beyond the asymptote of eccentricity {eccentricity}, {most_deg:.6}°"
    )]
    BeyondAsymptote {
        /// The true anomaly, degrees.
        anomaly_deg: f64,
        /// The eccentricity.
        eccentricity: f64,
        /// The asymptote's, degrees.
        most_deg: f64,
    },
    /// A parabola has no mean anomaly.
    #[error("a parabola has no mean anomaly; give the true anomaly or the time of periapsis")]
    NoMeanAnomaly,
    /// Secular drift is defined for ellipses.
    #[error(
        "J2 drift is an average over turns and needs an ellipse; eccentricity {eccentricity} is none"
    )]
    DriftNeedsEllipse {
        /// The eccentricity.
        eccentricity: f64,
    },
    /// The frame turns with the Earth.
    #[error(
        "a conic needs axes that do not turn with the Earth: TEME, GCRF or EME2000, not {frame}"
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
    /// Under the ground at the epoch.
    #[error(
        "at its epoch {satellite} is {depth_m:.0} m below the WGS84 ellipsoid; metres may have been taken for kilometres"
    )]
    ImpactAtEpoch {
        /// The satellite.
        satellite: String,
        /// How deep, metres.
        depth_m: f64,
    },
    /// The orbit meets the ground.
    #[error("{satellite} meets the ground at {impact}; {asked} is on the far side of that")]
    Impact {
        /// The satellite.
        satellite: String,
        /// When, UTC.
        impact: String,
        /// What was asked for, UTC.
        asked: String,
    },
}
