//! The Earth's shadow.

use glam::DVec3;
use terrella_frames::{Ellipsoid, SUN_RADIUS_M, uncovered};

/// The Earth's shadow: that of a sphere of 6378.137 km, without refraction. Flattening shifts its edge at the poles by 21 km, 3 s of flight in low
/// orbit; refraction extends red light by some 10 s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadow {
    /// No shadow: sunlight everywhere.
    None,
    /// A cylinder: full light or no light.
    Cylinder,
    /// Umbra and penumbra, by how much of the Sun's disc the Earth covers.
    #[default]
    Cone,
}

impl Shadow {
    /// Share of the sunlight at a position, 0…1; position and Sun in metres from the Earth's centre, in the same axes.
    pub fn sunlight(self, position_m: DVec3, sun_m: DVec3) -> f64 {
        let radius = Ellipsoid::WGS84.equatorial_radius_m;
        match self {
            Self::None => 1.0,
            Self::Cylinder => {
                let towards = sun_m.normalize_or_zero();
                let along = position_m.dot(towards);
                let aside = (position_m - towards * along).length();
                if along < 0.0 && aside < radius {
                    0.0
                } else {
                    1.0
                }
            }
            Self::Cone => {
                let (sun, earth, apart) = discs(position_m, sun_m);
                uncovered(sun, earth, apart)
            }
        }
    }
}

/// Elevation angle of the Sun's centre above the Earth's limb, radians; negative behind it.
pub(in crate::numerical) fn sun_above_limb_rad(position_m: DVec3, sun_m: DVec3) -> f64 {
    let (_, earth, apart) = discs(position_m, sun_m);
    apart - earth
}

/// Angular radii of Sun and Earth and the angle between their centres.
fn discs(position_m: DVec3, sun_m: DVec3) -> (f64, f64, f64) {
    let to_sun = sun_m - position_m;
    let sun = (SUN_RADIUS_M / to_sun.length()).min(1.0).asin();
    let earth = (Ellipsoid::WGS84.equatorial_radius_m / position_m.length())
        .min(1.0)
        .asin();
    (sun, earth, to_sun.angle_between(-position_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUN: DVec3 = DVec3::new(1.496e11, 0.0, 0.0);

    #[test]
    fn day_night_and_the_edge_between() {
        for shadow in [Shadow::Cylinder, Shadow::Cone] {
            assert_eq!(shadow.sunlight(DVec3::new(7e6, 0.0, 0.0), SUN), 1.0);
            assert_eq!(shadow.sunlight(DVec3::new(0.0, 7e6, 0.0), SUN), 1.0);
            assert_eq!(shadow.sunlight(DVec3::new(-7e6, 0.0, 0.0), SUN), 0.0);
        }
        assert_eq!(Shadow::None.sunlight(DVec3::new(-7e6, 0.0, 0.0), SUN), 1.0);
        // Beyond the tip of the umbra, 1.38 million km away, the Sun is a ring.
        let ring = Shadow::Cone.sunlight(DVec3::new(-1.6e9, 0.0, 0.0), SUN);
        assert!((0.1..0.5).contains(&ring), "{ring}");
    }

    #[test]
    fn light_goes_through_the_penumbra_without_a_step() {
        // From full shadow to full light along y at x = −42 000 km: the penumbra is 2 · 42 000 km · 0.00465 rad wide.
        let light = |y: f64| Shadow::Cone.sunlight(DVec3::new(-4.2e7, y, 0.0), SUN);
        let (mut first, mut last, mut before) = (0.0, 0.0, 0.0);
        for k in 0..60_000 {
            let y = 6.0e6 + 20.0 * f64::from(k);
            let now = light(y);
            assert!(
                now >= before - 1e-12 && now - before < 2e-4,
                "{y}: {before} {now}"
            );
            if before == 0.0 && now > 0.0 {
                first = y;
            }
            if before < 1.0 && now == 1.0 {
                last = y;
            }
            before = now;
        }
        assert!(
            (last - first - 2.0 * 4.2e7 * 0.004_65).abs() < 2e3,
            "{first} {last}"
        );
        assert!((light(0.5 * (first + last)) - 0.5).abs() < 0.01);
    }
}
