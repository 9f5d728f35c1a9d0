//! Keplerian orbit propagation: motion on a conic, of two bodies, and where wanted the Earth's flattening as an average.
//!
//! | file | what |
//! |---|---|
//! | `stumpff.rs` | functions that are the same for every conic |
//! | `conic.rs` | position from time and time from position, by a universal variable |
//! | `elements.rs` | Keplerian elements, there and back |
//! | `drift.rs` | the drift of node and periapsis by J2 |

mod conic;
mod drift;
mod elements;
mod error;
mod stumpff;
#[cfg(test)]
mod tests;

pub use conic::Conic;
pub(crate) use drift::SecularRates;
pub use elements::{Anomaly, KeplerElements, OrbitSize};
pub use error::KeplerError;

use super::constants::EARTH_GM_M3_S2;
use super::validity::{Impacts, Validity};
use super::{Feed, Frame, OrbitError, OrbitState, StartError};
use elements::{angles, plane};
use glam::DVec3;
use terrella_frames::{Duration, Ellipsoid, Epoch, rfc3339};

/// How the Earth's flattening is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drift {
    /// Not at all: the conic is fixed.
    #[default]
    None,
    /// Node, periapsis and mean anomaly drift as J2 makes them on average. Ellipses only.
    ///
    /// The elements are then mean elements. A state gives osculating ones: its period is corrected for that, its shape is
    /// not, so that the place swings by terms of short period, some 10 km in low orbit, hundreds along a long ellipse.
    J2,
}

/// A satellite on a conic around the Earth's centre.
///
/// Neglected: everything except the Earth's mass and, with [`Drift::J2`], the secular effect of its flattening. No short-period terms, drag, Sun or
/// Moon. The two-body position is accurate to a few roundings of the axis and of time: 1 mm after thirty years in low orbit. The equator is the
/// frame's: in GCRF that of J2000, from which the true one drifts by 0.006° a year.
#[derive(Clone, Debug)]
pub struct KeplerFeed {
    name: String,
    frame: Frame,
    epoch: Epoch,
    conic: Conic,
    /// Inclination, node and argument at the epoch, radians.
    drift: Option<([f64; 3], SecularRates)>,
    validity: Validity,
}

/// How a [`KeplerFeed`] moves and how long it is good for.
#[derive(Clone, Copy, Debug)]
pub struct KeplerOptions {
    /// How the Earth's flattening is modelled.
    pub drift: Drift,
    /// First epoch of validity.
    pub first: Epoch,
    /// Last epoch of validity.
    pub last: Epoch,
}

impl KeplerFeed {
    /// From classical elements at `epoch`, in the axes of `frame` (TEME, GCRF or EME2000).
    ///
    /// # Errors
    /// Errors of [`KeplerElements::conic`], a rotating frame, a drift for a conic that is not an ellipse, an empty span, or an epoch below the
    /// ground.
    pub fn from_elements(
        name: impl Into<String>,
        frame: Frame,
        epoch: Epoch,
        elements: &KeplerElements,
        options: KeplerOptions,
    ) -> Result<Self, KeplerError> {
        let conic = elements.conic(EARTH_GM_M3_S2, epoch)?;
        Self::new(name.into(), frame, epoch, conic, options)
    }

    /// The conic that touches a state: any, also a fall along a straight line.
    ///
    /// # Errors
    /// As [`Self::from_elements`].
    pub fn from_state(
        name: impl Into<String>,
        state: &OrbitState,
        options: KeplerOptions,
    ) -> Result<Self, KeplerError> {
        let conic = Conic::from_state(EARTH_GM_M3_S2, state.position_m, state.velocity_m_s)?;
        let mut feed = Self::new(name.into(), state.frame, state.epoch, conic, options)?;
        feed.drift = feed
            .drift
            .map(|(angles, rates)| (angles, rates.with_mean_axis(&conic, state.position_m)));
        Ok(feed)
    }

    fn new(
        name: String,
        frame: Frame,
        epoch: Epoch,
        conic: Conic,
        options: KeplerOptions,
    ) -> Result<Self, KeplerError> {
        if frame.is_earth_fixed() {
            return Err(KeplerError::TurningFrame {
                frame: frame.name(),
            });
        }
        if options.first > options.last {
            return Err(KeplerError::EmptySpan {
                first: rfc3339(options.first),
                last: rfc3339(options.last),
            });
        }
        let drift = match options.drift {
            Drift::None => None,
            Drift::J2 => {
                let eccentricity = conic.eccentricity;
                let rates = SecularRates::of(&conic)
                    .ok_or(KeplerError::DriftNeedsEllipse { eccentricity })?;
                Some((angles(&conic), rates))
            }
        };
        let mut feed = Self {
            name,
            frame,
            epoch,
            conic,
            drift,
            validity: Validity::between(options.first, options.last),
        };
        let height_m = feed.height_m(conic.chi_at(0.0, 0.0));
        if height_m < 0.0 {
            return Err(KeplerError::Start(StartError::BelowGround {
                satellite: feed.name,
                depth_m: -height_m,
                surface: "the WGS84 ellipsoid",
            }));
        }
        feed.find_impacts();
        Ok(feed)
    }

    /// The conic at the epoch.
    pub fn conic(&self) -> &Conic {
        &self.conic
    }

    /// The epoch that the elements are of.
    pub fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// Time of impact on the ground (WGS84), if it is after the epoch and within the span.
    pub fn impact(&self) -> Option<Epoch> {
        self.validity.impacts.after
    }

    /// Height over WGS84, metres, at χ; without drift, whose part in one turn is 0.1° at most.
    fn height_m(&self, chi: f64) -> f64 {
        let ((x, y), _) = self.conic.in_plane(chi);
        let position = self.conic.to_periapsis * x + self.conic.across * y;
        Ellipsoid::WGS84.geodetic_from_itrf(position).height_m
    }

    /// If the conic dips below the ground, the satellite leaves the ground on one side and hits it on the other.
    ///
    /// This is only possible if the periapsis radius is below the equatorial radius: then the height is searched from the epoch outwards.
    fn find_impacts(&mut self) {
        let radius = Ellipsoid::WGS84.equatorial_radius_m;
        let (q, e, alpha) = (
            self.conic.periapsis_m,
            self.conic.eccentricity,
            self.conic.reciprocal_axis_1_m,
        );
        if q > radius {
            return;
        }
        let turn = if alpha > 0.0 {
            std::f64::consts::TAU / alpha.sqrt()
        } else {
            f64::INFINITY
        };
        // r = q + e U2 and U1² = U2 (2 − αU2), at the farthest place that is this low.
        let u2 = ((radius - q) / e).min(if alpha > 0.0 { 2.0 / alpha } else { f64::MAX });
        let edge = self
            .conic
            .chi_from((u2 * (2.0 - alpha * u2)).max(0.0).sqrt(), u2);
        let now = self.conic.chi_at(0.0, 0.0);
        let crossing = |direction: f64| {
            [0.0, turn]
                .into_iter()
                .filter(|from| from.is_finite())
                .find_map(|from| {
                    // In units of `direction`: 0 is the periapsis of this revolution.
                    let first = (direction * now - from).max(-edge);
                    self.dip(first, edge, |x| direction * (x + from))
                })
        };
        let (before, after) = (crossing(-1.0), crossing(1.0));
        self.validity.impacts = Impacts {
            before: before.filter(|at| *at >= self.validity.first),
            after: after.filter(|at| *at <= self.validity.last),
        };
    }

    /// The epoch at which the height first falls below 0 from `first` to `last`, through a change of variable.
    fn dip(&self, first: f64, last: f64, chi: impl Fn(f64) -> f64) -> Option<Epoch> {
        const LOOKS: u32 = 1024;
        let step = (last - first) / f64::from(LOOKS);
        let low = (0..=LOOKS)
            .map(|k| first + step * f64::from(k))
            .take_while(|x| *x <= last)
            .find(|x| self.height_m(chi(*x)) < 0.0)?;
        let (mut above, mut below) = (low - step, low);
        for _ in 0..100 {
            let middle = 0.5 * (above + below);
            match self.height_m(chi(middle)) < 0.0 {
                true => below = middle,
                false => above = middle,
            }
        }
        let (_, seconds) = self.conic.radius_and_time(chi(above));
        Some(self.epoch + Duration::from_seconds(seconds))
    }

    /// Propagates from the epoch: position, metres, and velocity, metres per second.
    fn state_after(&self, elapsed: Duration) -> (DVec3, DVec3) {
        let ns = elapsed.total_nanoseconds();
        let (whole, rest) = (
            ns.div_euclid(1_000_000_000) as f64,
            ns.rem_euclid(1_000_000_000) as f64 * 1e-9,
        );
        let Some(([inclination, node, argument], rates)) = &self.drift else {
            return self.conic.at(whole, rest);
        };
        let seconds = whole + rest;
        let factor = rates.mean_motion_relative;
        let normal = self.conic.to_periapsis.cross(self.conic.across);
        let [to_periapsis, across] = plane(
            *inclination,
            node + rates.raan_rad_s * seconds,
            argument + rates.argument_of_periapsis_rad_s * seconds,
        );
        let turned = Conic {
            to_periapsis,
            across,
            ..self.conic
        };
        let (position, velocity) = turned.at(whole, rest + factor * seconds);
        let node_turn = DVec3::Z * rates.raan_rad_s;
        let own_turn =
            to_periapsis.cross(across).normalize_or(normal) * rates.argument_of_periapsis_rad_s;
        (
            position,
            velocity * (1.0 + factor) + (node_turn + own_turn).cross(position),
        )
    }
}

impl KeplerFeed {
    /// The state at an epoch that is known to be answered for.
    fn inside(&self, epoch: Epoch) -> OrbitState {
        let (position_m, velocity_m_s) = self.state_after(epoch - self.epoch);
        OrbitState {
            epoch,
            frame: self.frame,
            position_m,
            velocity_m_s,
        }
    }
}

impl Feed for KeplerFeed {
    fn name(&self) -> &str {
        &self.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.validity.interval()
    }

    fn impact(&self) -> Option<Epoch> {
        self.validity.impacts.after
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        self.validity
            .state_at(&self.name, epoch, |epoch| self.inside(epoch))
    }
}
