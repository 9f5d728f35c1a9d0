//! States that can be interpolated and cannot be meant: most often a unit has been mistaken.

use super::StateSample;
use crate::Frame;
use crate::start_error::METRES_FOR_KILOMETRES;
use glam::DVec3;
use terrella_frames::{EARTH_ROTATION_RATE_RAD_S, Ellipsoid};

/// Nothing that leaves the Earth moves away from it so fast, m/s.
const FASTEST_M_S: f64 = 100_000.0;
/// Allowed depth, metres: launch sites are below the ellipsoid, and frames differ by the precession of their poles.
const DEEPEST_M: f64 = 1_000.0;

/// Why states are doubted: the first of them, and how many there are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Doubt {
    /// Faster than anything about the Earth.
    #[error(
        "{distance_km:.0} km from the Earth's centre at {speed_km_s:.0} km/s, {count} such states; {METRES_FOR_KILOMETRES}"
    )]
    TooFast {
        /// Which state, from 0.
        index: usize,
        /// From the Earth's centre, kilometres.
        distance_km: f64,
        /// Seen from the stars, kilometres per second.
        speed_km_s: f64,
        /// How many such states there are.
        count: usize,
    },
    /// Below the WGS84 ellipsoid.
    #[error(
        "{depth_km:.0} km below the WGS84 ellipsoid, {count} such states; kilometres may have been taken for metres, or positions are not from the Earth's centre"
    )]
    BelowGround {
        /// Which state, from 0.
        index: usize,
        /// How deep, kilometres.
        depth_km: f64,
        /// How many such states there are.
        count: usize,
    },
}

impl Doubt {
    /// Which sample is meant, from 0.
    pub fn index(&self) -> usize {
        match self {
            Self::TooFast { index, .. } | Self::BelowGround { index, .. } => *index,
        }
    }
}

/// Doubts about samples in order of time: at most one of each kind.
pub(crate) fn doubts(frame: Frame, samples: &[StateSample]) -> Vec<Doubt> {
    let (mut fast, mut deep) = (None, None);
    for (at, sample) in samples.iter().enumerate() {
        let before = at.checked_sub(1).and_then(|at| samples.get(at));
        let speed_m_s = speed_m_s(frame, before, sample);
        if speed_m_s > FASTEST_M_S {
            let first = fast.get_or_insert(Doubt::TooFast {
                index: at,
                distance_km: sample.position_m.length() / 1e3,
                speed_km_s: speed_m_s / 1e3,
                count: 0,
            });
            first.add();
        }
        let depth_m = depth_m(sample.position_m);
        if depth_m > DEEPEST_M {
            let first = deep.get_or_insert(Doubt::BelowGround {
                index: at,
                depth_km: depth_m / 1e3,
                count: 0,
            });
            first.add();
        }
    }
    fast.into_iter().chain(deep).collect()
}

impl Doubt {
    fn add(&mut self) {
        match self {
            Self::TooFast { count, .. } | Self::BelowGround { count, .. } => *count += 1,
        }
    }
}

/// The speed seen from the stars: the sample's own, or that with which it has come from the one before, whichever is more.
fn speed_m_s(frame: Frame, before: Option<&StateSample>, sample: &StateSample) -> f64 {
    let turning = |position_m: DVec3| match frame.is_earth_fixed() {
        true => DVec3::new(0.0, 0.0, EARTH_ROTATION_RATE_RAD_S).cross(position_m),
        false => DVec3::ZERO,
    };
    let own = sample.velocity_m_s.map_or(0.0, |velocity_m_s| {
        (velocity_m_s + turning(sample.position_m)).length()
    });
    let come = before.map_or(0.0, |before| {
        let way_m = sample.position_m - before.position_m;
        let middle_m = before.position_m + way_m / 2.0;
        // Instants written to a millisecond are no measure of shorter times.
        let time_s = (sample.epoch - before.epoch).to_seconds().max(0.1);
        (way_m / time_s + turning(middle_m)).length()
    });
    own.max(come)
}

/// Depth below the ellipsoid; the poles of all frames are taken as its axis, which is accurate to the 50 m of precession.
fn depth_m(position_m: DVec3) -> f64 {
    match position_m.length() > Ellipsoid::WGS84.equatorial_radius_m {
        true => 0.0,
        false => -Ellipsoid::WGS84.geodetic_from_itrf(position_m).height_m,
    }
}
