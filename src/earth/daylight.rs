//! Measures the daylight, the moonlight and the city lights in an image. Stars and night lights fade by them: a camera that is exposed for sunlit
//! ground shows neither, and one that is exposed for moonlit ground or cities shows no airglow.

use super::sky::{MOON_DISTANCE_M, moonlight};
use super::view::ItrfView;
use crate::gpu::{LAMPS_FULL_SIN, LAMPS_OUT_SIN};
use glam::DVec3;
use std::f64::consts::PI;
use terrella_frames::Ellipsoid;
use terrella_ground::light::{Lamps, VIEW_RAYS, view_rays};
use terrella_ground::step::smooth_step;

/// Fraction of the image that must be in daylight for full effect.
const ENOUGH: f64 = 0.04;
/// Sines of the Sun's elevation, −9° and 3°, between which a place changes from night to day.
const TWILIGHT: [f64; 2] = [-0.156, 0.052];
/// Scale height of the air near the ground, metres.
const AIR_SCALE_M: f64 = 8e3;
/// As [`ENOUGH`], for the disc of a distant Earth, which few rays meet.
const ENOUGH_OF_DISC: f64 = 5e-4;
/// Distances of the eye from the centre, in equatorial radii, between which the Earth becomes such a disc.
const FAR: [f64; 2] = [3.0, 6.0];
/// Largest factor of the gains without moonlight: airglow on the limb is then visible.
const WITHOUT_MOON: f64 = 10.0;
/// Sines of the Moon's elevation, −12° and 24°, below the eye, between which the ground in sight becomes moonlit.
const MOONRISE: [f64; 2] = [-0.2, 0.4];
/// Altitudes of the eye, metres, between which cities become a small part of the ground in sight. Below, they light the image.
const ABOVE_CITIES_M: [f64; 2] = [4e4, 2.5e5];
/// Margin for the ellipsoid's flattening, in angles, radians.
const ROOM_RAD: f64 = 0.02;

/// Reduces the gain of a night light for an image with so much daylight, 0…1: it falls to 1, the true brightness, by equal factors for equal steps
/// of daylight. A gain below 1 is not changed.
pub(crate) fn gain_beside(gain: f64, daylight: f64) -> f64 {
    match gain > 1.0 {
        true => gain.powf(1.0 - daylight),
        false => gain,
    }
}

/// Raises the gain of a night light where the ground in sight has less than a full Moon's light. `moon` is the Moon's direction, unit, and its light as
/// a fraction of the Sun's, `lamps` the city lights in the image. It does not apply to a distant Earth, nor low over the ground, where cities fill
/// the image.
pub(crate) fn gain_by_night(
    gain: f64,
    eye_itrf_m: DVec3,
    moon: (DVec3, f64),
    lamps: f64,
    ellipsoid: &Ellipsoid,
) -> f64 {
    let distance = eye_itrf_m.length() / ellipsoid.equatorial_radius_m;
    let is_up = smooth_step(MOONRISE, eye_itrf_m.normalize_or_zero().dot(moon.0));
    let part = (is_up * moon.1 / moonlight(0.0, MOON_DISTANCE_M)).min(1.0);
    let height_m = (distance - 1.0) * ellipsoid.equatorial_radius_m;
    let is_low = 1.0 - smooth_step(ABOVE_CITIES_M, height_m);
    let part = part.max(smooth_step(FAR, distance)).max(is_low).max(lamps);
    // That light and the rest of the light of the night together.
    let rest = (WITHOUT_MOON - 1.0).recip();
    match gain > 1.0 {
        true => gain * (1.0 + rest) / (part + rest),
        false => gain,
    }
}

/// Daylight in the image: 0 for none, 1 if the Sun in direction `sun_itrf`, a unit vector, lights 4 % of the image, ground or air, or 0.05 % as the
/// disc of a distant Earth. Allocates nothing.
pub(crate) fn daylight_in_sight(view: &ItrfView, sun_itrf: DVec3, ellipsoid: &Ellipsoid) -> f64 {
    let of_disc = disc_in_sight(view, sun_itrf, ellipsoid);
    if of_disc >= 1.0 || is_night_all_round(view.eye_itrf_m, sun_itrf, ellipsoid) {
        return of_disc;
    }
    let enough = ENOUGH * VIEW_RAYS as f64;
    let mut lit = 0.0;
    for ray in view_rays(&view.clip_from_eye) {
        lit += light_along(view.eye_itrf_m, ray, sun_itrf, ellipsoid);
        // By day most rays need not be cast.
        if lit >= enough {
            return 1.0;
        }
    }
    of_disc.max(lit / enough)
}

/// Daylight from the sunlit part of a distant Earth's disc: 0 to 1, where it covers enough of the image.
fn disc_in_sight(view: &ItrfView, sun_itrf: DVec3, ellipsoid: &Ellipsoid) -> f64 {
    let eye = view.eye_itrf_m;
    let distance = eye.length() / ellipsoid.equatorial_radius_m;
    let is_far = smooth_step(FAR, distance);
    let center = view.clip_from_eye * (-eye).extend(1.0);
    if is_far == 0.0 || center.w <= 0.0 {
        return 0.0;
    }
    let tangent = ((distance - 1.0) * (distance + 1.0)).sqrt().recip();
    let sides = [
        (view.picture.right, center.x),
        (view.picture.down, center.y),
    ];
    // Per axis: the disc's radius in half sides of the image, and the fraction of the disc inside the image.
    let [across, down] = sides.map(|(side, at)| {
        let radius = tangent / (0.5 * side.length());
        let from_edge = 1.0 + radius - (at / center.w).abs();
        (radius, (from_edge / (2.0 * radius)).clamp(0.0, 1.0))
    });
    let part_of_picture = 0.25 * PI * across.0 * down.0 * across.1 * down.1;
    let lit = 0.5 * (1.0 + eye.normalize_or_zero().dot(sun_itrf));
    is_far * (lit * part_of_picture / ENOUGH_OF_DISC).min(1.0)
}

/// Whether no ray from this eye meets sunlit ground or passes sunlit air: the point of a ray nearest to the ground never lies beyond the limb.
fn is_night_all_round(eye_itrf_m: DVec3, sun_itrf: DVec3, ellipsoid: &Ellipsoid) -> bool {
    let distance = (eye_itrf_m * ellipsoid.scaled_from_itrf()).length();
    let to_limb_rad = distance.max(1.0).recip().acos();
    let from_sun_rad = eye_itrf_m.angle_between(sun_itrf) - to_limb_rad - ROOM_RAD;
    from_sun_rad.clamp(0.0, PI).cos() <= TWILIGHT[0]
}

/// City lights in the image, 0…1: the mean over it of the neighbourhoods' lamps, where they are on. Allocates nothing.
pub(crate) fn lamps_in_sight(
    view: &ItrfView,
    sun_itrf: DVec3,
    ellipsoid: &Ellipsoid,
    lamps: &Lamps,
) -> f64 {
    if lamps.is_empty() {
        return 0.0;
    }
    let seen = view_rays(&view.clip_from_eye).map(|ray| {
        let (place, height_m) = lowest_along(view.eye_itrf_m, ray, ellipsoid);
        if height_m > 0.0 {
            return 0.0;
        }
        let up = place.normalize_or_zero();
        let off = smooth_step([LAMPS_FULL_SIN, LAMPS_OUT_SIN], up.dot(sun_itrf));
        lamps.at(up) * (1.0 - off)
    });
    seen.sum::<f64>() / VIEW_RAYS as f64
}

/// Daylight along a ray, 0…1: of the ground that it meets, or of the air where the ray is nearest to the ground.
fn light_along(eye_itrf_m: DVec3, ray: DVec3, sun_itrf: DVec3, ellipsoid: &Ellipsoid) -> f64 {
    let (place, height_m) = lowest_along(eye_itrf_m, ray, ellipsoid);
    let density = (-height_m / AIR_SCALE_M).exp();
    density * smooth_step(TWILIGHT, place.normalize_or_zero().dot(sun_itrf))
}

/// Where a ray meets the ground, or its lowest point, in scaled space; and the height of that above the ground, metres.
fn lowest_along(eye_itrf_m: DVec3, ray: DVec3, ellipsoid: &Ellipsoid) -> (DVec3, f64) {
    let scale = ellipsoid.scaled_from_itrf();
    let (eye, direction) = (eye_itrf_m * scale, (ray * scale).normalize_or_zero());
    let along = (-eye.dot(direction)).max(0.0);
    let nearest = eye + along * direction;
    let height_m = (nearest.length() - 1.0) * ellipsoid.equatorial_radius_m;
    if height_m >= 0.0 {
        return (nearest, height_m);
    }
    let below = (1.0 - nearest.length_squared()).max(0.0).sqrt();
    (nearest - below * direction, 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::{EyeView, Viewport};
    use super::*;

    const E: Ellipsoid = Ellipsoid::WGS84;

    fn share(height_m: f64, look: DVec3, sun: DVec3) -> f64 {
        let eye = DVec3::X * (E.equatorial_radius_m + height_m);
        let view = EyeView::itrf(eye, look, DVec3::Z, 0.8, 16.0 / 9.0);
        let view = view.in_itrf(Viewport::from((640, 360))).expect("a view");
        daylight_in_sight(&view, sun, &E)
    }

    #[test]
    fn sunlit_ground_and_a_sunlit_sky_are_daylight() {
        assert_eq!(share(4e5, -DVec3::X, DVec3::X), 1.0);
        assert_eq!(share(0.0, DVec3::new(1.0, 0.5, 0.0), DVec3::X), 1.0);
        // Looking away from the Earth, and at its night side.
        assert!(share(4e5, DVec3::X, DVec3::X) < 1e-9);
        assert!(share(4e5, -DVec3::X, -DVec3::X) < 1e-9);
    }

    /// A camera that is exposed for a small Earth shows no stars beside it. The daylight does not jump while the Earth recedes, turns or leaves the
    /// image.
    #[test]
    fn a_far_earth_is_daylight_too() {
        // 0.15 % of the picture.
        assert_eq!(share(2e8, -DVec3::X, DVec3::X), 1.0);
        // A thin crescent, and the night side alone.
        let sun = DVec3::new(-2.7_f64.cos().abs(), 2.7_f64.sin(), 0.0);
        assert_eq!(share(4e7, -DVec3::X, sun), 1.0);
        assert!(share(3e7, -DVec3::X, DVec3::NEG_X) < 1e-9);
        assert!(share(2e8, DVec3::X, DVec3::X) < 1e-9);
        let smooth = |name: &str, share_at: &dyn Fn(f64) -> f64| {
            let shares = Vec::from_iter((0..=400).map(|step| share_at(f64::from(step) / 400.0)));
            let steps = shares.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            let largest = steps.fold(0.0, f64::max);
            assert!(largest < 0.2, "{name}: {largest}");
            assert!(shares.iter().any(|share| *share > 0.9), "{name}");
            assert!(shares.iter().any(|share| *share < 0.1), "{name}");
        };
        smooth("recedes", &|t| {
            share(1e8 * 1e3_f64.powf(t), -DVec3::X, DVec3::X)
        });
        smooth("turns to night", &|t| {
            let angle = PI * t;
            let sun = DVec3::new(angle.cos(), angle.sin(), 0.0);
            share(2e8, -DVec3::X, sun)
        });
        smooth("leaves the picture", &|t| {
            share(2e8, DVec3::new(-1.0, t, 0.0), DVec3::X)
        });
    }

    /// Rays that are skipped, because all is night or enough daylight was found, do not change the result.
    #[test]
    fn what_is_left_out_changes_nothing() {
        for height_m in [0.0, 1e4, 4e5, 2e7, 4e7] {
            for step in 0..=60 {
                let angle = f64::from(step) * PI / 60.0;
                let sun = DVec3::new(angle.cos(), 0.6 * angle.sin(), 0.8 * angle.sin());
                let eye = DVec3::X * (E.equatorial_radius_m + height_m);
                for look in [-DVec3::X, DVec3::new(-0.5, 1.0, 0.0), DVec3::Z, DVec3::X] {
                    let up = DVec3::new(0.1, 0.2, 1.1);
                    let view = EyeView::itrf(eye, look, up, 0.8, 16.0 / 9.0);
                    let view = view.in_itrf(Viewport::from((640, 360))).expect("a view");
                    let rays = view_rays(&view.clip_from_eye);
                    let all: f64 = rays.map(|ray| light_along(eye, ray, sun, &E)).sum();
                    let all = (all / (ENOUGH * VIEW_RAYS as f64)).min(1.0);
                    let all = all.max(disc_in_sight(&view, sun, &E));
                    let found = daylight_in_sight(&view, sun, &E);
                    assert!(
                        (found - all).abs() < 1e-12,
                        "{height_m} {step}: {found} {all}"
                    );
                }
            }
        }
    }

    #[test]
    fn gains_fall_by_equal_factors_to_the_truth() {
        assert_eq!(gain_beside(4e4, 0.0), 4e4);
        assert_eq!(gain_beside(4e4, 1.0), 1.0);
        assert!((gain_beside(4e4, 0.5) - 200.0).abs() < 1e-9);
        // A gain that darkens on request also does so by day.
        assert_eq!(gain_beside(0.25, 1.0), 0.25);
        assert_eq!(gain_beside(0.0, 1.0), 0.0);
    }

    #[test]
    fn gains_rise_as_the_moon_sets_and_wanes() {
        let eye = DVec3::X * (E.equatorial_radius_m + 4e5);
        let gain = |sine: f64, phase_rad: f64, eye: DVec3| {
            let moon = DVec3::new(sine, (1.0 - sine * sine).sqrt(), 0.0);
            gain_by_night(
                4e4,
                eye,
                (moon, moonlight(phase_rad, MOON_DISTANCE_M)),
                0.0,
                &E,
            )
        };
        assert!((gain(0.9, 0.0, eye) - 4e4).abs() < 1.0);
        assert!((gain(-0.9, 0.0, eye) - 4e5).abs() < 1.0);
        assert!(gain(0.9, PI, eye) > 3.9e5);
        // Beside a distant Earth and low over the ground the Moon does not matter.
        assert!((gain(-0.9, 0.0, DVec3::X * 1e8) - 4e4).abs() < 1.0);
        assert!((gain(-0.9, 0.0, DVec3::X * 6.4e6) - 4e4).abs() < 1.0);
        // A given gain of 1 or less is no exposure.
        assert_eq!(gain_by_night(1.0, eye, (DVec3::X, 0.0), 0.0, &E), 1.0);
        // By a quarter at most from a degree to the next.
        let mut before = gain(-1.0, 0.0, eye);
        for step in -90..=90 {
            let now = gain(f64::from(step).to_radians().sin(), 0.0, eye);
            assert!((0.75..=1.0 + 1e-9).contains(&(now / before)), "{step}");
            before = now;
        }
    }

    /// City lights of 0.4 everywhere.
    #[test]
    fn lamps_lower_the_gain_where_they_are_on_and_in_the_image() {
        let lamps = Lamps::new(vec![0.4; 66 * 32]);
        let eye = DVec3::X * (E.equatorial_radius_m + 4e5);
        let seen = |look: DVec3, sun: DVec3, lamps: &Lamps| {
            let view = EyeView::itrf(eye, look, DVec3::Z, 0.8, 16.0 / 9.0);
            let view = view.in_itrf(Viewport::from((640, 360))).expect("a view");
            lamps_in_sight(&view, sun, &E, lamps)
        };
        let all = seen(-DVec3::X, -DVec3::X, &lamps);
        assert!((all - 0.4).abs() < 1e-6, "{all}");
        let half = seen(DVec3::new(-0.36, 1.0, 0.0), -DVec3::X, &lamps);
        assert!((0.1..0.3).contains(&half), "{half}");
        assert_eq!(seen(-DVec3::X, DVec3::X, &lamps), 0.0);
        assert_eq!(seen(DVec3::X, -DVec3::X, &lamps), 0.0);
        assert_eq!(seen(-DVec3::X, -DVec3::X, &Lamps::default()), 0.0);
        let gain = |moonlight, lamps| gain_by_night(4e4, eye, (DVec3::X, moonlight), lamps, &E);
        assert!((8e4..1e5).contains(&gain(0.0, 0.4)), "{}", gain(0.0, 0.4));
        // A full Moon is more light than that.
        let full = moonlight(0.0, MOON_DISTANCE_M);
        assert_eq!(gain(full, 0.4), gain(full, 0.0));
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
