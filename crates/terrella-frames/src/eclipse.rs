//! Whether a position in space is sunlit.

use super::{Ellipsoid, Epoch, Orientation, sun_direction_itrf_oriented, sun_position_gcrf_m};
use glam::DVec3;
use std::f64::consts::PI;

/// Radius of the Sun's disc, metres (IAU 2015 resolution B3).
pub const SUN_RADIUS_M: f64 = 6.957e8;

/// How much of the Sun is seen from a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illumination {
    /// All of it.
    Sunlit,
    /// A part of it.
    Penumbra,
    /// Nothing.
    Umbra,
}

impl Illumination {
    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sunlit => "sunlit",
            Self::Penumbra => "penumbra",
            Self::Umbra => "umbra",
        }
    }
}

/// The Sun's centre as it is seen from the Earth's, ITRF metres: with aberration, which moves shadows too.
pub fn sun_position_itrf_m(epoch: Epoch, orientation: &Orientation) -> DVec3 {
    sun_direction_itrf_oriented(epoch, orientation) * sun_position_gcrf_m(epoch).length()
}

/// How much of the Sun is visible at a position: its class, and the visible fraction of the disc, 0…1. Position and Sun in ITRF metres.
///
/// The Earth is the ellipsoid, with its limb in the plane of the position, the Earth's centre and the Sun's. The air is neglected, which refracts
/// red light further in, by some ten seconds of flight in low orbit.
pub fn illumination(
    position_itrf_m: DVec3,
    sun_itrf_m: DVec3,
    ellipsoid: &Ellipsoid,
) -> (Illumination, f64) {
    let discs = match Discs::seen_from(position_itrf_m, sun_itrf_m, ellipsoid) {
        Ok(discs) => discs,
        // Below the ground, or in the Sun.
        Err(Illumination::Umbra) => return (Illumination::Umbra, 0.0),
        Err(state) => return (state, 1.0),
    };
    let [penumbra, umbra] = discs.margins();
    let state = if penumbra >= 0.0 {
        Illumination::Sunlit
    } else if umbra <= 0.0 {
        Illumination::Umbra
    } else {
        Illumination::Penumbra
    };
    (state, uncovered(discs.sun, discs.earth, discs.apart))
}

/// How far a position is from the penumbra and from the umbra: the angles by which the Sun would have to be nearer to the Earth's centre, as it is
/// seen, to begin to be covered, and to be covered, radians. They are continuous, and negative inside the shadow. Arguments as for [`illumination`].
pub fn shadow_margins_rad(
    position_itrf_m: DVec3,
    sun_itrf_m: DVec3,
    ellipsoid: &Ellipsoid,
) -> [f64; 2] {
    match Discs::seen_from(position_itrf_m, sun_itrf_m, ellipsoid) {
        Ok(discs) => discs.margins(),
        Err(Illumination::Umbra) => [-PI; 2],
        Err(_) => [PI; 2],
    }
}

/// The discs of the Sun and the Earth, radians.
struct Discs {
    /// Radius of the Sun's.
    sun: f64,
    /// Radius of the Earth's towards the Sun.
    earth: f64,
    /// From centre to centre.
    apart: f64,
}

impl Discs {
    /// Where there are no discs, the state is the error.
    fn seen_from(
        position_itrf_m: DVec3,
        sun_itrf_m: DVec3,
        ellipsoid: &Ellipsoid,
    ) -> Result<Self, Illumination> {
        let to_sun = sun_itrf_m - position_itrf_m;
        let sun = (SUN_RADIUS_M / to_sun.length()).asin();
        // The transformation to the unit sphere preserves planes and tangents.
        let scale = ellipsoid.itrf_from_scaled();
        let (eye, towards) = (position_itrf_m / scale, to_sun / scale);
        if eye.length_squared() < 1.0 {
            return Err(Illumination::Umbra);
        }
        if to_sun.length() <= SUN_RADIUS_M {
            return Err(Illumination::Sunlit);
        }
        let down = -eye.normalize();
        let aside = towards - down * towards.dot(down);
        let aside = aside.normalize_or(down.any_orthonormal_vector());
        let sine = eye.length().recip();
        let limb = (down * (1.0 - sine * sine).sqrt() + aside * sine) * scale;
        let earth = limb.angle_between(-position_itrf_m);
        let apart = to_sun.angle_between(-position_itrf_m);
        Ok(Self { sun, earth, apart })
    }

    /// Towards the penumbra and the umbra.
    fn margins(&self) -> [f64; 2] {
        [
            self.apart - (self.sun + self.earth),
            self.apart - (self.earth - self.sun),
        ]
    }
}

/// Share of a disc of angular radius `a` that one of radius `b` leaves free, centres `c` apart (Montenbruck & Gill 2000,
/// 3.4.2).
pub fn uncovered(a: f64, b: f64, c: f64) -> f64 {
    if c >= a + b {
        return 1.0;
    }
    if c <= b - a {
        return 0.0;
    }
    if c <= a - b {
        return 1.0 - (b / a).powi(2);
    }
    let x = (c * c + a * a - b * b) / (2.0 * c);
    let y = (a * a - x * x).max(0.0).sqrt();
    let area = a * a * (x / a).clamp(-1.0, 1.0).acos()
        + b * b * ((c - x) / b).clamp(-1.0, 1.0).acos()
        - c * y;
    (1.0 - area / (PI * a * a)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUN: DVec3 = DVec3::new(1.496e11, 0.0, 0.0);

    fn at(position: DVec3) -> (Illumination, f64) {
        illumination(position, SUN, &Ellipsoid::WGS84)
    }

    #[test]
    fn day_night_and_the_edge_between() {
        assert_eq!(at(DVec3::X * 7e6), (Illumination::Sunlit, 1.0));
        assert_eq!(at(DVec3::Y * 7e6), (Illumination::Sunlit, 1.0));
        assert_eq!(at(DVec3::X * -7e6), (Illumination::Umbra, 0.0));
        // Beyond the tip of the umbra, 1.38 million km away, the Sun is a ring.
        let (state, share) = at(DVec3::X * -1.6e9);
        assert_eq!(state, Illumination::Penumbra);
        assert!((0.1..0.5).contains(&share), "{share}");
        // On the limb half of it.
        let (state, share) = at(DVec3::new(-1e7, 6_378_137.0, 0.0));
        assert_eq!(state, Illumination::Penumbra);
        assert!((0.48..0.52).contains(&share), "{share}");
    }

    /// Margins have the signs of the states, and are continuous across them.
    #[test]
    fn margins_are_negative_inside_the_shadow() {
        let mut before: Option<[f64; 2]> = None;
        for metre in 0..40_000 {
            let place = DVec3::new(-1e7, 6.33e6 + 2.5 * f64::from(metre), 0.0);
            let margins = shadow_margins_rad(place, SUN, &Ellipsoid::WGS84);
            let state = match margins.map(|margin| margin < 0.0) {
                [false, _] => Illumination::Sunlit,
                [true, false] => Illumination::Penumbra,
                [true, true] => Illumination::Umbra,
            };
            assert_eq!(state, at(place).0, "{place} {margins:?}");
            if let Some([penumbra, umbra]) = before {
                let steps = [margins[0] - penumbra, margins[1] - umbra];
                assert!(steps.iter().all(|step| step.abs() < 1e-6), "{steps:?}");
            }
            before = Some(margins);
        }
        let margins = shadow_margins_rad(DVec3::X, SUN, &Ellipsoid::WGS84);
        assert!(margins.iter().all(|margin| *margin < 0.0));
    }

    #[test]
    fn the_shadow_is_flat_as_the_earth_is() {
        let edge = |axis: DVec3| {
            let (mut dark, mut lit) = (6.2e6, 6.5e6);
            for _ in 0..60 {
                let middle = 0.5 * (dark + lit);
                match at(DVec3::X * -7e6 + axis * middle).1 < 0.5 {
                    true => dark = middle,
                    false => lit = middle,
                }
            }
            dark
        };
        let flattening = edge(DVec3::Y) - edge(DVec3::Z);
        assert!((flattening - 21_385.0).abs() < 30.0, "{flattening}");
    }

    #[test]
    fn no_place_is_undefined() {
        for position in [DVec3::ZERO, DVec3::X, DVec3::Z * 1e-3, SUN, DVec3::X * 1e15] {
            let (_, share) = at(position);
            assert!((0.0..=1.0).contains(&share), "{position}: {share}");
        }
    }
}
