//! How much daylight a picture shows, by which stars fade: a camera that is exposed for sunlit ground shows none.

use crate::earth::ItrfView;
use glam::DVec3;
use terrella_frames::Ellipsoid;
use terrella_ground::light::{VIEW_RAYS, view_rays};

/// Part of the picture that must be in daylight for it to count in full.
const ENOUGH: f64 = 0.04;
/// Sines of the Sun's elevation, −9° and 3°, between which the light of a place goes from night to day.
const TWILIGHT: [f64; 2] = [-0.156, 0.052];
/// Height in which the air beside the ground grows e times thinner, metres.
const AIR_SCALE_M: f64 = 8e3;

/// 0, none, to 1, where the Sun at `sun_itrf`, a unit vector, lights a twenty-fifth of the picture, be it ground or air. Allocates
/// nothing.
pub(super) fn in_sight(view: &ItrfView, sun_itrf: DVec3, ellipsoid: &Ellipsoid) -> f64 {
    let rays = view_rays(&view.clip_from_eye);
    let lit: f64 = rays
        .map(|ray| light_along(view.eye_itrf_m, ray, sun_itrf, ellipsoid))
        .sum();
    (lit / (ENOUGH * VIEW_RAYS as f64)).min(1.0)
}

/// 0…1, of what a ray meets: ground, or the air nearest to it.
fn light_along(eye_itrf_m: DVec3, ray: DVec3, sun_itrf: DVec3, ellipsoid: &Ellipsoid) -> f64 {
    let scale = ellipsoid.scaled_from_itrf();
    let (eye, direction) = (eye_itrf_m * scale, (ray * scale).normalize_or_zero());
    let along = (-eye.dot(direction)).max(0.0);
    let nearest = eye + along * direction;
    let height_m = (nearest.length() - 1.0) * ellipsoid.equatorial_radius_m;
    let (place, density) = match height_m < 0.0 {
        true => {
            let below = (1.0 - nearest.length_squared()).max(0.0).sqrt();
            (nearest - below * direction, 1.0)
        }
        false => (nearest, (-height_m / AIR_SCALE_M).exp()),
    };
    let [night, day] = TWILIGHT;
    let t = ((place.normalize_or_zero().dot(sun_itrf) - night) / (day - night)).clamp(0.0, 1.0);
    density * t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::earth::{EyeView, Viewport};

    const E: Ellipsoid = Ellipsoid::WGS84;

    fn share(height_m: f64, look: DVec3, sun: DVec3) -> f64 {
        let eye = DVec3::X * (E.equatorial_radius_m + height_m);
        let view = EyeView::itrf(eye, look, DVec3::Z, 0.8, 16.0 / 9.0);
        let view = view.in_itrf(Viewport::from((640, 360))).expect("a view");
        in_sight(&view, sun, &E)
    }

    #[test]
    fn sunlit_ground_and_a_sunlit_sky_are_daylight() {
        assert_eq!(share(4e5, -DVec3::X, DVec3::X), 1.0);
        assert_eq!(share(0.0, DVec3::new(1.0, 0.5, 0.0), DVec3::X), 1.0);
        // Past the Earth, and the night below.
        assert!(share(4e5, DVec3::X, DVec3::X) < 1e-9);
        assert!(share(4e5, -DVec3::X, -DVec3::X) < 1e-9);
        // The whole disc, some 2 000 pixels of 230 000.
        let far = share(2e8, -DVec3::X, DVec3::X);
        assert!(far > 0.0 && far < 1.0, "{far}");
    }

    #[test]
    fn dusk_comes_without_jumps() {
        let mut before = 1.0;
        for step in 0..=200 {
            let angle = 1.4 + f64::from(step) * 0.002;
            let now = share(4e5, -DVec3::X, DVec3::new(angle.cos(), angle.sin(), 0.0));
            assert!(
                (0.0..0.25).contains(&(before - now)),
                "{step}: {before} {now}"
            );
            before = now;
        }
    }
}
