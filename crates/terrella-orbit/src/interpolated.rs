//! Interpolated ephemerides: states given at instants, and Lagrange's or Hermite's polynomials between them. The common core of
//! ephemeris files. Our own: of the
//! crates for these files `ccsds-ndm` (0.0) parses only and `lox-odm` is in alpha.

mod basis;
mod doubt;
mod feed;
mod interpolation_error;
mod segment_error;
mod sift;

use super::{Frame, OrbitState};
use basis::{Basis, MAX_NODES};
use glam::DVec3;
use terrella_frames::{Epoch, rfc3339};

pub use doubt::Doubt;
pub(super) use doubt::doubts;
pub use feed::{EphemerisFeed, EphemerisSegment};
pub use interpolation_error::{KeplerOrbit, WorstDifference, interpolation_error};
pub use segment_error::SegmentError;
pub(super) use sift::sift;

/// How a state between samples is found. CCSDS 502.0 and CZML use the same names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The straight line between the two samples around the instant.
    Linear,
    /// The polynomial of that degree through degree + 1 positions; through as many velocities where there are some, else
    /// the velocity is its derivative.
    Lagrange {
        /// 1…[`Interpolation::MAX_DEGREE`].
        degree: usize,
    },
    /// The polynomial that has the samples' positions and velocities: (degree + 1)/2 samples, rounded up, and no fewer than two, so
    /// that it goes from sample to sample.
    Hermite {
        /// 1…[`Interpolation::MAX_DEGREE`].
        degree: usize,
    },
}

impl Interpolation {
    /// The highest degree.
    pub const MAX_DEGREE: usize = MAX_NODES - 1;

    /// Default for files with velocities: four states. [`interpolation_error()`] lists its accuracy: in low orbit 30 nm at one minute from state to
    /// state, 1 cm at five.
    pub const WITH_VELOCITIES: Self = Self::Hermite { degree: 7 };

    /// Default for files with positions only: eight positions; in low orbit 4 µm at one minute, 1.4 m at five.
    pub const WITHOUT_VELOCITIES: Self = Self::Lagrange { degree: 7 };

    /// How many samples one evaluation uses.
    pub fn samples(self) -> usize {
        match self {
            Self::Linear => 2,
            Self::Lagrange { degree } => degree + 1,
            Self::Hermite { degree } => ((degree + 2) / 2).max(2),
        }
    }

    /// Degree of the polynomial.
    pub fn degree(self) -> usize {
        match self {
            Self::Linear => 1,
            Self::Lagrange { degree } | Self::Hermite { degree } => degree,
        }
    }

    /// The interpolation of that name, letter case aside.
    pub fn from_name(name: &str, degree: usize) -> Option<Self> {
        match name.to_ascii_uppercase().as_str() {
            "LINEAR" => Some(Self::Linear),
            "LAGRANGE" => Some(Self::Lagrange { degree }),
            "HERMITE" => Some(Self::Hermite { degree }),
            _ => None,
        }
    }

    /// As CCSDS files and CZML name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "LINEAR",
            Self::Lagrange { .. } => "LAGRANGE",
            Self::Hermite { .. } => "HERMITE",
        }
    }
}

/// A sample of an ephemeris: a position at an instant, with its velocity where that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSample {
    /// When the sample holds.
    pub epoch: Epoch,
    /// Position, metres.
    pub position_m: DVec3,
    /// Velocity as seen in the samples' axes, metres per second.
    pub velocity_m_s: Option<DVec3>,
}

impl StateSample {
    /// Whether it is finite, nearer than 1e13 m and slower than the light.
    fn is_state(&self) -> bool {
        let velocity = self.velocity_m_s.unwrap_or_default();
        self.position_m.length() < 1e13 && velocity.length() < 299_792_458.0
    }
}

/// Why samples cannot be interpolated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum InterpolationError {
    /// No sample at all.
    #[error("no sample")]
    Empty,
    /// Two samples of one instant, or one before its predecessor.
    #[error(
        "{epoch} is not later than {before} before it; samples go forward in time, each instant once"
    )]
    Order {
        /// Which sample, from 0.
        index: usize,
        /// Its instant, UTC.
        epoch: String,
        /// The instant before it, UTC.
        before: String,
    },
    /// A sample later than those that follow it.
    #[error(
        "{epoch} is later than {after} after it; samples go forward in time, each instant once"
    )]
    Ahead {
        /// Which sample, from 0.
        index: usize,
        /// Its instant, UTC.
        epoch: String,
        /// The instant after it, UTC.
        after: String,
    },
    /// A number that is not finite, or is too large for any orbit around the Earth.
    #[error("the sample is not finite, is farther than 1e13 m, or is faster than light")]
    NotAState {
        /// Which sample, from 0.
        index: usize,
    },
    /// More time between the samples than can be counted.
    #[error("{epoch} is more than two centuries after the first sample")]
    TooLong {
        /// Which sample, from 0.
        index: usize,
        /// Its instant, UTC.
        epoch: String,
    },
    /// Hermite's polynomial needs velocities.
    #[error("Hermite interpolation needs a velocity with every position; take LAGRANGE")]
    NoVelocity {
        /// Which sample, from 0.
        index: usize,
    },
    /// A degree that is not offered.
    #[error("interpolation degree {degree} is not from 1 to {most}", most = Interpolation::MAX_DEGREE)]
    Degree { degree: usize },
}

impl InterpolationError {
    /// Which sample is meant, from 0, if one is.
    pub fn index(&self) -> Option<usize> {
        match self {
            Self::Order { index, .. }
            | Self::Ahead { index, .. }
            | Self::NotAState { index }
            | Self::TooLong { index, .. }
            | Self::NoVelocity { index } => Some(*index),
            Self::Empty | Self::Degree { .. } => None,
        }
    }
}

/// An interpolated ephemeris: samples in one frame and the interpolation between them.
///
/// The window of samples is centred on the time. At the ends it is shifted, not shortened. If there are fewer samples than the degree needs, all
/// are used. Times are stored as whole nanoseconds, so a long ephemeris is as precise at its end as at its beginning.
#[derive(Clone, Debug)]
pub struct InterpolatedStates {
    frame: Frame,
    first: Epoch,
    /// Since `first`, strictly rising.
    at_ns: Vec<i64>,
    position_m: Vec<DVec3>,
    /// Empty, or one for each position.
    velocity_m_s: Vec<DVec3>,
    interpolation: Interpolation,
    /// How far the polynomials at the ends go on before the first sample and after the last, nanoseconds.
    beyond_ns: (i64, i64),
}

impl InterpolatedStates {
    /// Samples in the axes of `frame`, in rising order of time. Velocities are used if all samples have one.
    ///
    /// # Errors
    /// Says which sample is out of order or not finite, and why the interpolation does not fit.
    pub fn new(
        frame: Frame,
        samples: &[StateSample],
        interpolation: Interpolation,
    ) -> Result<Self, InterpolationError> {
        let degree = interpolation.degree();
        if !(1..=Interpolation::MAX_DEGREE).contains(&degree) {
            return Err(InterpolationError::Degree { degree });
        }
        let first = samples.first().ok_or(InterpolationError::Empty)?.epoch;
        // Counted in TAI, so that sums with it are elapsed time.
        let first = Epoch::from_tai_duration(first.to_tai_duration());
        let with_velocities = samples.iter().all(|s| s.velocity_m_s.is_some());
        let mut sampled = Self {
            frame,
            first,
            at_ns: Vec::with_capacity(samples.len()),
            position_m: Vec::with_capacity(samples.len()),
            velocity_m_s: Vec::new(),
            interpolation,
            beyond_ns: (0, 0),
        };
        let mut before: Option<(i64, Epoch)> = None;
        for (index, sample) in samples.iter().enumerate() {
            if !sample.is_state() {
                return Err(InterpolationError::NotAState { index });
            }
            if matches!(interpolation, Interpolation::Hermite { .. })
                && sample.velocity_m_s.is_none()
            {
                return Err(InterpolationError::NoVelocity { index });
            }
            let at =
                ns_between(first, sample.epoch).ok_or_else(|| InterpolationError::TooLong {
                    index,
                    epoch: rfc3339(sample.epoch),
                })?;
            if let Some((_, earlier)) = before.filter(|&(ns, _)| ns >= at) {
                return Err(InterpolationError::Order {
                    index,
                    epoch: rfc3339(sample.epoch),
                    before: rfc3339(earlier),
                });
            }
            before = Some((at, sample.epoch));
            sampled.at_ns.push(at);
            sampled.position_m.push(sample.position_m);
            if with_velocities {
                sampled
                    .velocity_m_s
                    .push(sample.velocity_m_s.unwrap_or_default());
            }
        }
        Ok(sampled)
    }

    /// The axes of the samples.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// How it goes from sample to sample.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// How many samples there are; at least one.
    #[allow(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        self.at_ns.len()
    }

    /// Instants of the first and the last sample.
    pub fn span(&self) -> (Epoch, Epoch) {
        let last_ns = self.at_ns.last().copied().unwrap_or_default();
        (self.first, self.first + nanoseconds(last_ns))
    }

    /// First and last time of validity: those of the samples, extended by the extrapolation.
    pub fn reach(&self) -> (Epoch, Epoch) {
        let (first, last) = self.span();
        let (before, after) = self.beyond_ns;
        (first - nanoseconds(before), last + nanoseconds(after))
    }

    /// Extends the polynomials at its ends by this many seconds before the first sample and after the last; at most two centuries.
    pub(super) fn extrapolated(self, before_s: f64, after_s: f64) -> Self {
        let ns = |seconds: f64| (seconds.clamp(0.0, 6.3e9) * 1e9).round() as i64;
        Self {
            beyond_ns: (ns(before_s), ns(after_s)),
            ..self
        }
    }

    /// The samples, in order.
    pub fn samples(&self) -> impl Iterator<Item = StateSample> {
        let positions = self.at_ns.iter().zip(&self.position_m).enumerate();
        positions.map(|(i, (&ns, &position_m))| StateSample {
            epoch: self.first + nanoseconds(ns),
            position_m,
            velocity_m_s: self.velocity_m_s.get(i).copied(),
        })
    }

    /// The state at `epoch`; `None` outside [`Self::reach`]. At a sample it is the sample, bit for bit; if samples have no velocities, the velocity
    /// is interpolated (zero for a single sample). Also `None` if samples are so unevenly spaced that f64 cannot represent their polynomial.
    pub fn state_at(&self, epoch: Epoch) -> Option<OrbitState> {
        let at = ns_between(self.first, epoch)?;
        let behind = self.at_ns.partition_point(|&ns| ns <= at);
        let nearest = behind.saturating_sub(1);
        let is_sample = self.at_ns.get(nearest) == Some(&at);
        let last = self.at_ns.last().copied().unwrap_or_default();
        if at < -self.beyond_ns.0 || at > last.saturating_add(self.beyond_ns.1) {
            return None;
        }
        let state = |position_m, velocity_m_s| OrbitState {
            epoch,
            frame: self.frame,
            position_m,
            velocity_m_s,
        };
        if is_sample {
            let position_m = *self.position_m.get(nearest)?;
            let velocity_m_s = match self.velocity_m_s.get(nearest) {
                Some(velocity) => *velocity,
                None => self.interpolated(at, behind).1,
            };
            return Some(state(position_m, velocity_m_s));
        }
        let (position_m, velocity_m_s) = self.interpolated(at, behind);
        let is_finite = position_m.is_finite() && velocity_m_s.is_finite();
        is_finite.then(|| state(position_m, velocity_m_s))
    }

    /// Position and velocity from the window around `at`, which is before sample `behind`.
    fn interpolated(&self, at: i64, behind: usize) -> (DVec3, DVec3) {
        let count = self.interpolation.samples().min(self.at_ns.len());
        // An even count has as many samples on either side; an odd one has one more on the side of the nearer sample.
        let last_before = behind.checked_sub(1).and_then(|i| self.at_ns.get(i));
        let nearer_behind = match (last_before, self.at_ns.get(behind)) {
            (Some(before), Some(after)) => usize::from(after - at < at - before),
            _ => 0,
        };
        let before = count / 2 + (count % 2) * (1 - nearer_behind);
        let start = behind.saturating_sub(before).min(self.at_ns.len() - count);
        let window = start..start + count;
        let at_ns = &self.at_ns[window.clone()];
        let positions = &self.position_m[window.clone()];
        // In units of half the window, about the instant itself: small numbers, and exact differences.
        let span_ns = at_ns[count - 1] - at_ns[0];
        let unit_s = (span_ns as f64 * 0.5e-9).max(1e-9);
        let mut nodes = [0.0; MAX_NODES];
        for (node, ns) in nodes.iter_mut().zip(at_ns) {
            *node = (ns - at) as f64 * 1e-9 / unit_s;
        }
        let basis = Basis::new(&nodes[..count], 0.0);
        let velocities = self.velocity_m_s.get(window);
        match (self.interpolation, velocities) {
            (Interpolation::Hermite { .. }, Some(velocities)) => {
                let mut slopes = [DVec3::ZERO; MAX_NODES];
                for (slope, velocity) in slopes.iter_mut().zip(velocities) {
                    *slope = *velocity * unit_s;
                }
                let (position, slope) = basis.hermite(positions, &slopes[..count]);
                (position, slope / unit_s)
            }
            (_, Some(velocities)) => (basis.lagrange(positions).0, basis.lagrange(velocities).0),
            (_, None) => {
                let (position, slope) = basis.lagrange(positions);
                (position, slope / unit_s)
            }
        }
    }
}

/// From `first` to `epoch` in nanoseconds of elapsed time; `None` beyond two centuries.
fn ns_between(first: Epoch, epoch: Epoch) -> Option<i64> {
    const MOST: i128 = 200 * 366 * 86_400 * 1_000_000_000;
    let between =
        epoch.to_tai_duration().total_nanoseconds() - first.to_tai_duration().total_nanoseconds();
    (between.abs() <= MOST)
        .then(|| i64::try_from(between).ok())
        .flatten()
}

fn nanoseconds(ns: i64) -> terrella_frames::Duration {
    terrella_frames::Duration::from_total_nanoseconds(i128::from(ns))
}
