//! The Moon's shadow on the Earth.

use super::eclipse::uncovered;
use super::{Ellipsoid, MOON_RADIUS_M, SUN_RADIUS_M};
use glam::DVec3;

/// The Moon between the Sun and places on the Earth or above it. ITRF axes, metres.
///
/// Light travels, and the Earth moves: give both places as they are seen from the Earth's centre, with light time and aberration. So
/// seen, no light is bent on the way from there to a place of the Earth, and the shadow falls where it fell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoonShadow {
    sun_itrf_m: DVec3,
    moon_itrf_m: DVec3,
}

impl MoonShadow {
    /// That of a Sun and a Moon with these centres.
    pub const fn new(sun_itrf_m: DVec3, moon_itrf_m: DVec3) -> Self {
        Self {
            sun_itrf_m,
            moon_itrf_m,
        }
    }

    /// Part of the Sun's disc that the Moon leaves at a place, 0…1: of its area, so of a Sun as bright at its limb as in its middle.
    pub fn sun_left(&self, place_itrf_m: DVec3) -> f64 {
        let (sun, moon) = (
            self.sun_itrf_m - place_itrf_m,
            self.moon_itrf_m - place_itrf_m,
        );
        let radius = |radius_m: f64, to: DVec3| (radius_m / to.length()).min(1.0).asin();
        // An arc cosine loses precision for such a small angle.
        let apart = sun.cross(moon).length().atan2(sun.dot(moon));
        uncovered(
            radius(SUN_RADIUS_M, sun),
            radius(MOON_RADIUS_M, moon),
            apart,
        )
    }

    /// Where its axis comes to the ground, ITRF metres; `None` where it passes the Earth.
    pub fn center_on(&self, ellipsoid: &Ellipsoid) -> Option<DVec3> {
        let scale = ellipsoid.itrf_from_scaled();
        let (from, along) = (
            self.moon_itrf_m / scale,
            (self.axis() / scale).try_normalize()?,
        );
        let nearest = from - along * from.dot(along);
        let half_chord = (1.0 - nearest.length_squared()).sqrt();
        let is_behind = from.dot(along) < 0.0;
        (is_behind && half_chord.is_finite()).then(|| (nearest - along * half_chord) * scale)
    }

    /// From the Sun through the Moon, of length 1.
    pub fn axis(&self) -> DVec3 {
        (self.moon_itrf_m - self.sun_itrf_m).normalize_or_zero()
    }

    /// The Moon's centre.
    pub fn moon_itrf_m(&self) -> DVec3 {
        self.moon_itrf_m
    }

    /// Distance of Sun and Moon in radii of the Sun: what a step off the axis moves the Moon on the Sun's disc by, in its radii, is this
    /// times the angle that the step has at the Moon.
    pub fn spread(&self) -> f64 {
        self.moon_itrf_m.distance(self.sun_itrf_m) / SUN_RADIUS_M
    }

    /// Whether the penumbra reaches any point of a sphere.
    pub fn reaches(&self, center_itrf_m: DVec3, radius_m: f64) -> bool {
        let from_moon = center_itrf_m - self.moon_itrf_m;
        let behind = from_moon.dot(self.axis());
        let off = (from_moon - self.axis() * behind).length();
        // Its edge spreads by the Sun's and the Moon's radius over their distance, and is as steep at the ball.
        let slope = (SUN_RADIUS_M + MOON_RADIUS_M) / self.sun_itrf_m.distance(self.moon_itrf_m);
        let penumbra = MOON_RADIUS_M + slope * (behind + radius_m);
        behind > -radius_m && off <= penumbra + radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUN: DVec3 = DVec3::new(1.496e11, 0.0, 0.0);

    fn moon_at(distance_m: f64, off_m: f64) -> MoonShadow {
        MoonShadow::new(SUN, DVec3::new(distance_m, off_m, 0.0))
    }

    #[test]
    fn a_near_moon_hides_the_sun_and_a_far_one_leaves_a_ring() {
        let place = DVec3::X * 6_378_137.0;
        assert_eq!(moon_at(3.7e8, 0.0).sun_left(place), 0.0);
        let ring = moon_at(4.0e8, 0.0).sun_left(place);
        // 1 − (asin(1.7374/393.622)/asin(0.6957/149.5936))²
        assert!((ring - 0.099_23).abs() < 1e-4, "{ring}");
        assert_eq!(moon_at(4.0e8, 1e7).sun_left(place), 1.0);
        let half = moon_at(3.7e8, 1.74e6).sun_left(place);
        assert!((0.35..0.65).contains(&half), "{half}");
    }

    #[test]
    fn its_middle_is_where_sun_and_moon_stand_in_line() {
        let shadow = moon_at(3.7e8, 4e6);
        let center = shadow.center_on(&Ellipsoid::WGS84).expect("on the ground");
        let (sun, moon) = (SUN - center, shadow.moon_itrf_m() - center);
        assert!(sun.normalize().cross(moon.normalize()).length() < 1e-12);
        assert!(center.x > 0.0);
        assert_eq!(moon_at(3.7e8, 7e6).center_on(&Ellipsoid::WGS84), None);
        assert_eq!(moon_at(-3.7e8, 0.0).center_on(&Ellipsoid::WGS84), None);
    }

    #[test]
    fn it_reaches_a_ball_where_any_place_of_it_lies_in_the_penumbra() {
        let radius_m = 6.4e6;
        for off in 0..300 {
            let shadow = moon_at(3.8e8, f64::from(off) * 5e4);
            let places = (0..=180).map(|degrees| {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                DVec3::new(cos.abs(), sin, 0.0) * radius_m
            });
            let is_hidden = places.into_iter().any(|place| shadow.sun_left(place) < 1.0);
            let reaches = shadow.reaches(DVec3::ZERO, radius_m);
            assert!(reaches || !is_hidden, "{off}");
            // And not much farther.
            assert!(off < 210 || !reaches, "{off}");
        }
        assert!(!moon_at(-3.8e8, 0.0).reaches(DVec3::ZERO, radius_m));
    }

    #[test]
    fn no_place_is_undefined() {
        for moon in [DVec3::ZERO, DVec3::X, SUN, DVec3::X * 1e15] {
            let shadow = MoonShadow::new(SUN, moon);
            for place in [DVec3::ZERO, DVec3::X * 6.4e6, moon, SUN] {
                let left = shadow.sun_left(place);
                assert!((0.0..=1.0).contains(&left), "{moon} {place}: {left}");
            }
            assert!(
                shadow
                    .center_on(&Ellipsoid::WGS84)
                    .is_none_or(DVec3::is_finite)
            );
        }
    }
}
