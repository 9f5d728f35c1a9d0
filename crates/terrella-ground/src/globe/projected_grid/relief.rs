//! Height ranges of the ground about an eye, and how far ground can be visible.

use crate::elevation::{Bounds, Elevation, HeightRange};
use crate::globe::culling::{GroundShell, Horizon};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_frames::Ellipsoid;

/// Rings of ground about the eye, each twice as wide as the one inside it.
pub const RINGS: usize = 24;

/// Ground between two angles from the eye's radius, with its height range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ring {
    /// Outer edge, radians of scaled space; the inner edge is the outer edge of the ring before.
    pub outer_rad: f64,
    /// Lowest height, metres.
    pub low_m: f64,
    /// Highest height, metres.
    pub high_m: f64,
}

/// Height ranges about an eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefRings {
    /// From the inside outwards.
    pub rings: [Ring; RINGS],
    /// Horizon of the ground about the eye.
    pub horizon: Horizon,
    /// Highest minus lowest, metres.
    pub span_m: f64,
}

impl ReliefRings {
    /// The ground about an eye. Queries the source for one range per ring.
    pub fn new(ellipsoid: &Ellipsoid, eye_itrf_m: DVec3, ground: &dyn Elevation) -> Self {
        let eye = eye_itrf_m * ellipsoid.scaled_from_itrf();
        let up = eye.normalize_or(DVec3::Z);
        let around = |angle_rad: f64| -> HeightRange {
            let range = ground.range_m(&disc(ellipsoid, up, angle_rad));
            HeightRange {
                low_m: range.low_m.max(LOWEST_M),
                high_m: range.high_m.max(range.low_m).min(HIGHEST_M),
            }
        };
        let horizon =
            |range| Horizon::new(ellipsoid, eye_itrf_m, GroundShell::new(ellipsoid, range));
        // First the region visible with the heights of the whole Earth, then with those of that region. Its own mountains then limit the
        // region, not ones on the other side of the Earth.
        let range = around(horizon(around(PI)).far_rad());
        let horizon = horizon(range);
        let far_rad = horizon.far_rad();
        let mut rings = [Ring::default(); RINGS];
        for (k, ring) in rings.iter_mut().enumerate() {
            let outer_rad = far_rad * 0.5_f64.powi((RINGS - 1 - k) as i32);
            let range = around(outer_rad);
            *ring = Ring {
                outer_rad,
                low_m: range.low_m,
                high_m: range.high_m,
            };
        }
        Self {
            rings,
            horizon,
            span_m: range.high_m - range.low_m,
        }
    }
}

/// Limits of heights on the Earth; values beyond them from a source cannot make the grid useless.
const LOWEST_M: f64 = -100_000.0;
const HIGHEST_M: f64 = 100_000.0;

/// Latitudes and longitudes within an angle (scaled space) of the unit vector `up`.
fn disc(ellipsoid: &Ellipsoid, up: DVec3, angle_rad: f64) -> Bounds {
    let stretch = ellipsoid.equatorial_radius_m / ellipsoid.polar_radius_m;
    let reduced = up.z.atan2(up.truncate().length());
    // tan φ = (a/b) tan β.
    let geodetic = |reduced: f64| {
        if reduced.abs() >= FRAC_PI_2 {
            return FRAC_PI_2.copysign(reduced);
        }
        (stretch * reduced.sin()).atan2(reduced.cos())
    };
    let (south, north) = (reduced - angle_rad, reduced + angle_rad);
    let around_a_pole = south <= -FRAC_PI_2 || north >= FRAC_PI_2;
    let half_rad = if around_a_pole {
        PI
    } else {
        (angle_rad.sin() / reduced.cos()).clamp(-1.0, 1.0).asin()
    };
    let lon_rad = up.y.atan2(up.x);
    Bounds {
        south_rad: geodetic(south),
        north_rad: geodetic(north),
        west_rad: lon_rad - half_rad,
        width_rad: (2.0 * half_rad).min(TAU),
    }
}
