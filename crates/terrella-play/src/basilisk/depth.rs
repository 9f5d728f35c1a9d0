//! Depth maps as Basilisk reads them: how far the ground is along a camera's boresight, in three bytes a pixel.

use crate::flight::Moment;
use glam::{DVec3, DVec4};
use image::{Rgb, RgbImage};
use terrella::frames::Ellipsoid;

/// Default near and far clipping distances of a camera, metres.
pub const USUAL_CLIP_M: [f64; 2] = [0.1, 100.0];

/// The depth map of a moment: the ellipsoid's, without relief and without craft. Beyond the far end, and where there is no ground,
/// it is white; nearer than the near end there is nothing to be seen, as in any picture with a near plane.
pub fn depth_map(
    moment: &Moment,
    ellipsoid: &Ellipsoid,
    [near_m, far_m]: [f64; 2],
    (width, height): (u32, u32),
) -> RgbImage {
    let (eye_m, clip_from_eye) = moment.view.to_itrf();
    let eye_from_clip = clip_from_eye.inverse();
    // A direction whose part along the boresight is 1: its length is depth.
    let ray = |x: f64, y: f64| {
        let on_screen = |x: f64, y: f64| {
            let at = eye_from_clip * DVec4::new(x, y, 1.0, 1.0);
            at.truncate() / at.w
        };
        let middle = on_screen(0.0, 0.0).normalize();
        let direction = on_screen(x, y);
        direction / direction.dot(middle)
    };
    RgbImage::from_fn(width, height, |column, row| {
        let x = 2.0 * (f64::from(column) + 0.5) / f64::from(width) - 1.0;
        let y = 1.0 - 2.0 * (f64::from(row) + 0.5) / f64::from(height);
        let depth_m = depth(ellipsoid, eye_m, ray(x, y));
        encode(depth_m.filter(|depth_m| *depth_m >= near_m), far_m)
    })
}

/// Distance to the ellipsoid along `direction`, in lengths of `direction`; `None` if the ray misses it.
///
/// In scaled space, where the ellipsoid is the unit sphere: (e + t d)² = 1, in the form without cancellation, t = c/(b + √(d² − |e × d|²)) with b =
/// −e·d and c = (|e| − 1)(|e| + 1).
fn depth(ellipsoid: &Ellipsoid, eye_m: DVec3, direction: DVec3) -> Option<f64> {
    let scale = ellipsoid.scaled_from_itrf();
    let (e, d) = (eye_m * scale, direction * scale);
    let c = (e.length() - 1.0) * (e.length() + 1.0);
    let square = d.length_squared() - e.cross(d).length_squared();
    let b = -e.dot(d);
    (square >= 0.0 && b > 0.0 && c > 0.0).then(|| c / (b + square.sqrt()))
}

/// depth = far · (R/255 + G/255² + B/255³).
fn encode(depth_m: Option<f64>, far_m: f64) -> Rgb<u8> {
    let Some(part) = depth_m.map(|depth_m| depth_m / far_m) else {
        return Rgb([255; 3]);
    };
    if part >= 1.0 {
        return Rgb([255; 3]);
    }
    let steps = (part * 255.0_f64.powi(3)).round();
    let digits = [65_025.0, 255.0, 1.0].map(|unit| (steps / unit).floor());
    let [red, green, blue] = digits;
    // Each less the ones before it; all below 255, as the whole is below 1.
    Rgb([
        red as u8,
        (green - red * 255.0) as u8,
        (blue - green * 255.0) as u8,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Pose;
    use terrella::Sky;

    fn decoded(pixel: &Rgb<u8>, far_m: f64) -> f64 {
        let [red, green, blue] = pixel.0.map(f64::from);
        far_m * (red / 255.0 + green / 255.0_f64.powi(2) + blue / 255.0_f64.powi(3))
    }

    #[test]
    fn depth_is_along_the_boresight_and_white_is_sky() {
        let sphere = Ellipsoid::PAPER_SPHERE;
        let radius_m = sphere.equatorial_radius_m;
        let pose = Pose {
            eye_itrf_m: DVec3::X * (radius_m + 20e6),
            forward: DVec3::NEG_X,
            up: DVec3::Z,
        };
        let moment = Moment {
            epoch: Default::default(),
            frame: 0,
            view: pose.view(35_f64.to_radians(), 1.5),
            sky: Sky::new(DVec3::X),
            satellite: None,
            craft: None,
            eye_velocity_m_s: None,
            turn: None,
            is_starless: false,
            exposure_ev: None,
            shot: 0,
        };
        let size = (241, 161);
        let map = depth_map(&moment, &sphere, [1e3, 1e8], size);
        let step_m = 1e8 / 255.0_f64.powi(3);
        // Straight below, 20 000 km.
        let middle_m = decoded(map.get_pixel(120, 80), 1e8);
        assert!((middle_m - 20e6).abs() < step_m, "{middle_m}");
        assert_eq!(map.get_pixel(0, 0).0, [255; 3]);
        // At the limb the depth is that of the circle of tangent points: d − R²/d.
        let distance_m = radius_m + 20e6;
        let limb_m = distance_m - radius_m * radius_m / distance_m;
        let row: Vec<_> = (0..241).map(|x| *map.get_pixel(x, 80)).collect();
        let seen: Vec<_> = row.iter().filter(|pixel| pixel.0 != [255; 3]).collect();
        let deepest_m = seen.iter().map(|p| decoded(p, 1e8)).fold(0.0, f64::max);
        assert!(
            deepest_m < limb_m && deepest_m > limb_m - 1.5e6,
            "{deepest_m} {limb_m}"
        );
        // Its radius in pixels: tan of the limb's angle over the half height's.
        let angle = (radius_m / distance_m).asin();
        let pixels = angle.tan() / 17.5_f64.to_radians().tan() * 161.0;
        assert!(
            (seen.len() as f64 - pixels).abs() < 1.5,
            "{} {pixels}",
            seen.len()
        );
        // Nearer than the near end, and beyond the far one, is nothing.
        for clip in [[2.1e7, 2.2e7], [1.0, 1e3]] {
            let map = depth_map(&moment, &sphere, clip, size);
            assert_eq!(map.get_pixel(120, 80).0, [255; 3]);
        }
    }

    #[test]
    fn three_bytes_hold_every_depth() {
        for part in [0.0, 1e-7, 0.25, 0.5, 0.999_999, 0.999_999_999] {
            let back = decoded(&encode(Some(part), 1.0), 1.0);
            assert!(
                (back - part).abs() <= 0.51 / 255.0_f64.powi(3),
                "{part} {back}"
            );
        }
    }
}
