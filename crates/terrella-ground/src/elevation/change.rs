//! Where heights changed since they were read.

use super::{Bounds, HeightRange};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, PI, TAU};

/// Largest spacing of tile samples, radians. Slopes may change up to this distance from a change of
/// heights.
pub const COARSEST_STEP_RAD: f64 = FRAC_PI_8 / 16.0;

/// Tolerance at which bounds meet, radians: a micrometre of ground.
const NEAR: f64 = 1e-13;

/// Part of the Earth where a source's heights became finer or coarser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightChange {
    /// Heights outside and on the edge are unchanged.
    pub bounds: Bounds,
    /// Heights at this spacing and above are unchanged, radians.
    pub below_rad: f64,
    /// Height limits inside the bounds, metres. No height is outside both this range and the earlier
    /// [`Elevation::range_up_to_m`](super::Elevation::range_up_to_m).
    pub range: HeightRange,
}

impl HeightChange {
    /// Whether heights at a spacing may have changed inside some bounds or up to an angle beyond them.
    pub fn touches(&self, bounds: &Bounds, beyond_rad: f64, spacing_rad: f64) -> bool {
        spacing_rad < self.below_rad
            && self.is_near_latitudes(bounds.south_rad, bounds.north_rad, beyond_rad)
            && bounds.grown(beyond_rad).meets(&self.bounds)
    }

    /// Whether latitudes, or some up to an angle beyond them, overlap the change. This test rejects most of the Earth with two
    /// comparisons.
    fn is_near_latitudes(&self, south_rad: f64, north_rad: f64, beyond_rad: f64) -> bool {
        south_rad - beyond_rad.max(0.0) <= self.bounds.north_rad + NEAR
            && self.bounds.south_rad <= north_rad + beyond_rad.max(0.0) + NEAR
    }

    /// Whether the height at a place, or up to an angle away, may have changed.
    pub fn touches_place(&self, lat_rad: f64, lon_rad: f64, beyond_rad: f64) -> bool {
        let place = Bounds {
            south_rad: lat_rad,
            north_rad: lat_rad,
            west_rad: lon_rad,
            width_rad: 0.0,
        };
        place.grown(beyond_rad).meets(&self.bounds)
    }
}

impl Bounds {
    /// The smallest bounds of all places within an angle at the Earth's centre of these bounds.
    pub fn grown(&self, angle_rad: f64) -> Self {
        let angle_rad = angle_rad.max(0.0);
        let is_short_of_poles = self.south_rad > -FRAC_PI_2 && self.north_rad < FRAC_PI_2;
        if angle_rad == 0.0 && is_short_of_poles && self.width_rad < TAU {
            return *self;
        }
        let (south_rad, north_rad) = (self.south_rad - angle_rad, self.north_rad + angle_rad);
        let has_pole = north_rad >= FRAC_PI_2 || south_rad <= -FRAC_PI_2;
        let poleward_rad = self.south_rad.abs().max(self.north_rad.abs());
        // A circle around a place touches meridians at sin Δλ = sin r / cos φ.
        let aside_rad = match has_pole || angle_rad >= FRAC_PI_2 {
            true => PI,
            false => (angle_rad.sin() / poleward_rad.cos()).min(1.0).asin(),
        };
        let width_rad = self.width_rad + 2.0 * aside_rad;
        let (west_rad, width_rad) = match width_rad >= TAU {
            true => (-PI, TAU),
            false => (self.west_rad - aside_rad, width_rad),
        };
        Self {
            south_rad: south_rad.max(-FRAC_PI_2),
            north_rad: north_rad.min(FRAC_PI_2),
            west_rad,
            width_rad,
        }
    }

    /// Whether two bounds share a place, within the rounding of their angles.
    pub fn meets(&self, other: &Self) -> bool {
        let from = (other.west_rad - self.west_rad).rem_euclid(TAU);
        let back = (self.west_rad - other.west_rad).rem_euclid(TAU);
        let along = |from: f64, width: f64| from <= width + NEAR || from >= TAU - NEAR;
        let is_beside = along(from, self.width_rad) || along(back, other.width_rad);
        // All meridians meet at a pole.
        let pole = |bounds: &Self| {
            let near = FRAC_PI_2 - 1e-9;
            (bounds.north_rad >= near, bounds.south_rad <= -near)
        };
        let (own, others) = (pole(self), pole(other));
        let at_pole = own.0 && others.0 || own.1 && others.1;
        self.south_rad <= other.north_rad + NEAR
            && other.south_rad <= self.north_rad + NEAR
            && (is_beside || at_pole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds_deg(south: f64, north: f64, west: f64, width: f64) -> Bounds {
        Bounds {
            south_rad: south.to_radians(),
            north_rad: north.to_radians(),
            west_rad: west.to_radians(),
            width_rad: width.to_radians(),
        }
    }

    #[test]
    fn bounds_meet_on_edges_over_the_date_line_and_at_poles() {
        let a = bounds_deg(10.0, 20.0, 170.0, 20.0);
        for (b, meets) in [
            (bounds_deg(20.0, 30.0, -170.0, 5.0), true),
            (bounds_deg(20.1, 30.0, -170.0, 5.0), false),
            (bounds_deg(12.0, 13.0, 190.0, 1.0), true),
            (bounds_deg(12.0, 13.0, 191.0, 1.0), false),
            (bounds_deg(12.0, 13.0, 160.0, 10.0), true),
            (bounds_deg(12.0, 13.0, 160.0, 9.9), false),
            (Bounds::GLOBE, true),
        ] {
            assert_eq!((a.meets(&b), b.meets(&a)), (meets, meets), "{b:?}");
        }
        let (north, other) = (
            bounds_deg(80.0, 90.0, 0.0, 10.0),
            bounds_deg(85.0, 90.0, 100.0, 10.0),
        );
        assert!(north.meets(&other));
        assert!(!north.meets(&bounds_deg(-90.0, -85.0, 0.0, 10.0)));
    }

    #[test]
    fn what_is_grown_holds_all_that_is_near() {
        for k in 0..2000_u32 {
            let t = f64::from(k);
            let south = -89.0 + (t * 7.31) % 170.0;
            let b = bounds_deg(
                south,
                south + (t * 0.37) % 9.0,
                t * 13.7 % 360.0,
                t * 3.1 % 300.0,
            );
            let angle = 1e-6 + (t * 0.113) % 0.6;
            let grown = b.grown(angle);
            // From a corner by the angle, in any direction.
            let (lat, lon) = (b.north_rad, b.west_rad + b.width_rad);
            let way = t * 2.399;
            let (sin, cos) = (angle * 0.9999).sin_cos();
            let to_lat = (lat.sin() * cos + lat.cos() * sin * way.cos()).asin();
            let to_lon = lon + (way.sin() * sin * lat.cos()).atan2(cos - lat.sin() * to_lat.sin());
            assert!(grown.contains(to_lat, to_lon), "{b:?} by {angle}");
        }
    }
}
