//! Between which heights the ground lies around an eye, and how far of it can show.

use crate::elevation::{Bounds, Elevation, HeightRange};
use crate::frames::Ellipsoid;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Rings of ground about the eye, each twice as wide as the one inside it.
pub const RINGS: usize = 24;

/// Ground between two angles from the eye's radius, and how high it reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ring {
    /// Outer edge, radians of scaled space; the inner edge is the ring's before.
    pub outer_rad: f64,
    /// Lowest height, metres.
    pub low_m: f64,
    /// Highest height, metres.
    pub high_m: f64,
}

/// The heights about an eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// From the inside outwards.
    pub rings: [Ring; RINGS],
    /// Radius in scaled space of a sphere that lies under all ground about the eye.
    pub floor: f64,
    /// θ of the floor's limb: ground beyond it shows only where it is high.
    pub floor_limb_rad: f64,
    /// θ of the farthest ground that can show.
    pub far_rad: f64,
    /// Highest less lowest, metres.
    pub span_m: f64,
}

/// Radius in scaled space that no point at this height comes below.
///
/// With p a unit vector of scaled space and n the ellipsoid's normal there, |p + h D⁻¹n| lies between 1 + h/a and 1 + h/b:
/// p·D⁻¹n = |D⁻¹p| is 1/a…1/b, and so is |D⁻¹n|. (The exact upper end for h < 0 is larger by less than 1e-10.)
pub fn lowest_radius(ellipsoid: &Ellipsoid, height_m: f64) -> f64 {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    1.0 + height_m / if height_m < 0.0 { b.min(a) } else { a.max(b) } - 1e-10
}

/// Radius in scaled space that no point at this height goes beyond.
pub fn highest_radius(ellipsoid: &Ellipsoid, height_m: f64) -> f64 {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    1.0 + height_m / if height_m < 0.0 { a.max(b) } else { b.min(a) } + 1e-10
}

/// Visible region, eq. 3 of the paper with relief: whether ground at a unit vector P̂ of scaled space can be seen from
/// an eye towards û. P̂·û ≥ R/L is P̂·û ≥ cos θ with θ the limb's angle; over a floor R₁ ground up to R₂ shows as far as
/// θ = acos(R₁/L) + acos(R₁/R₂), where a tangent to the floor leaves the highest ground behind it.
pub fn can_show(place: DVec3, up: DVec3, far_rad: f64) -> bool {
    // cos θ as the length of the chord: |P̂ − û| = 2 sin(θ/2), which is exact near the eye too.
    place.distance(up) <= 2.0 * (0.5 * far_rad.min(PI)).sin()
}

/// θ at which ground that reaches up to `high` ends to show over a floor, for an eye at distance `length` (scaled space).
pub fn far_angle(length: f64, floor: f64, high: f64) -> f64 {
    limb(length, floor) + limb(high, floor)
}

/// acos(radius/length) without cancellation; 0 from below.
pub fn limb(length: f64, radius: f64) -> f64 {
    let above = (length - radius).max(0.0) * (length + radius);
    above.sqrt().atan2(radius)
}

impl Relief {
    /// The ground about an eye, `eye` in scaled space. Asks the source for a range once a ring.
    pub fn new(ellipsoid: &Ellipsoid, eye: DVec3, ground: &dyn Elevation) -> Self {
        let length = eye.length();
        let up = eye.normalize_or(DVec3::Z);
        let around = |angle_rad: f64| -> HeightRange {
            let range = ground.range_m(&disc(ellipsoid, up, angle_rad));
            HeightRange {
                low_m: range.low_m.max(LOWEST_M),
                high_m: range.high_m.max(range.low_m).min(HIGHEST_M),
            }
        };
        let far = |range: HeightRange| {
            let floor = lowest_radius(ellipsoid, range.low_m);
            let high = highest_radius(ellipsoid, range.high_m);
            (floor, far_angle(length, floor, high))
        };
        // What may show by the heights of the whole Earth, then by those of that region: its mountains end the region,
        // not ones on the other side of the Earth.
        let (_, widest_rad) = far(around(PI));
        let range = around(widest_rad);
        let (floor, far_rad) = far(range);
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
            floor,
            floor_limb_rad: limb(length, floor),
            far_rad,
            span_m: range.high_m - range.low_m,
        }
    }

    /// Lowest height that can show at an angle from the eye's radius: what is lower lies behind the floor.
    pub fn lowest_seen_m(&self, ellipsoid: &Ellipsoid, theta: f64) -> f64 {
        let beyond = theta - self.floor_limb_rad;
        if beyond <= 0.0 {
            return f64::NEG_INFINITY;
        }
        if beyond >= FRAC_PI_2 {
            return f64::INFINITY;
        }
        let over = self.floor / beyond.cos() - 1.0;
        let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
        over * if over > 0.0 { b.min(a) } else { a.max(b) } - 1e-3
    }
}

/// Heights beyond these are no ground of the Earth's; a source that answers them cannot make the grid useless.
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
