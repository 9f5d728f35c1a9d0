//! Where airglow is in sight.

use super::Sky;
use super::sky::ROOM_SIN;
use super::view::{ItrfView, ball_bounds};
use crate::plan::{GLOW_BASE_M, GLOW_DAY_SIN, GLOW_TOP, GlowUniforms, SurfaceLight, beneath};
use glam::{DMat3, DVec3, Vec4};
use std::f64::consts::PI;
use terrella_frames::Ellipsoid;
use terrella_ground::air::{Billboard, RADIUS_M};

/// Least distance at which airglow is drawn, metres: for an eye inside it.
const NEAREST_M: f64 = 1e4;

/// Uniforms of the airglow; `None` if it is not drawn or if everything in sight is in daylight or twilight. `ring` is the billboard of the halo.
pub(super) fn glow_in_sight(
    view: &ItrfView,
    ring: &Billboard,
    sky: &Sky,
    ellipsoid: &Ellipsoid,
    light: &SurfaceLight,
) -> Option<GlowUniforms> {
    let gain = light.glow_gain()?;
    let height = ring.eye_distance - 1.0;
    // Beyond the limb, up to the top of the airglow.
    let sight_rad = (1.0 / ring.eye_distance).acos() + (1.0 / (1.0 + GLOW_TOP)).acos();
    let from_sun_rad = view.eye_itrf_m.angle_between(sky.sun_itrf) + sight_rad;
    if from_sun_rad.min(PI).cos() > GLOW_DAY_SIN + ROOM_SIN {
        return None;
    }
    let radius_m = ellipsoid.equatorial_radius_m;
    let top_m = (1.0 + GLOW_TOP) * radius_m;
    let bounds = ball_bounds(&view.clip_from_eye, -view.eye_itrf_m, top_m)?;
    let scaled_from_itrf = radius_m / ellipsoid.itrf_from_scaled();
    let [x, y, z] = ring.axes;
    let billboard_from_scaled = DMat3::from_cols(x, y, z).transpose();
    let ray = |itrf: DVec3| (billboard_from_scaled * (scaled_from_itrf * itrf)).as_vec3();
    let picture = &view.picture;
    Some(GlowUniforms {
        corner: ray(picture.corner),
        depth: depth(view, height * radius_m) as f32,
        across: ray(picture.right),
        gain: gain as f32,
        down: ray(picture.down),
        above: (height * (ring.eye_distance + 1.0)) as f32,
        beneath: beneath(height).as_vec3(),
        padding_b: 0.0,
        bounds: Vec4::from_array(bounds),
    })
}

/// Depth at which airglow is drawn: the depth of its nearest point, so that it covers the ground but not spacecraft. For an eye below it,
/// everything is in front of it.
fn depth(view: &ItrfView, height_m: f64) -> f64 {
    let picture = &view.picture;
    let forward = picture.corner + 0.5 * (picture.right + picture.down);
    let forward = forward.normalize_or(DVec3::NEG_Z);
    let clip = if height_m < GLOW_BASE_M {
        view.clip_from_eye * forward.extend(0.0)
    } else {
        let nearest_m = (height_m - GLOW_TOP * RADIUS_M).max(NEAREST_M);
        view.clip_from_eye * (forward * nearest_m).extend(1.0)
    };
    if clip.w > 0.0 {
        (clip.z / clip.w).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::earth::{EyeView, Viewport};
    use terrella_frames::Geodetic;
    use terrella_ground::air::TOP;

    fn view(height_m: f64) -> ItrfView {
        let place = Geodetic::from_degrees(0.0, 0.0, height_m);
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
        let view = EyeView::itrf(eye, -eye, DVec3::Z, 0.8, 1.6);
        view.in_itrf(Viewport::from((640, 400))).expect("a picture")
    }

    fn glow(height_m: f64, sun: DVec3, airglow: bool) -> Option<GlowUniforms> {
        let light = SurfaceLight {
            airglow,
            ..SurfaceLight::default()
        };
        let (view, ellipsoid) = (view(height_m), Ellipsoid::WGS84);
        let scale = ellipsoid.itrf_from_scaled();
        let eye_scaled = view.eye_itrf_m / scale;
        let ring = Billboard::new(eye_scaled, TOP, 0.0, &view.clip_from_eye, scale);
        glow_in_sight(&view, &ring, &Sky::new(sun), &ellipsoid, &light)
    }

    #[test]
    fn the_day_side_is_drawn_without_glow() {
        assert!(glow(4e5, DVec3::NEG_X, true).is_some());
        assert_eq!(glow(4e5, DVec3::NEG_X, false), None);
        assert_eq!(glow(4e5, DVec3::X, true), None);
        // From far away the terminator is in sight.
        assert!(glow(4e8, DVec3::X, true).is_some());
    }

    #[test]
    fn it_stands_before_the_ground_and_behind_craft() {
        let near = EyeView::NEAR_M;
        for (height_m, nearest_m, farthest_m) in [(4.1e5, 1e3, 3.2e5), (2e5, 1e3, 1.2e5)] {
            let glow = glow(height_m, DVec3::NEG_X, true).expect("night");
            let depth = f64::from(glow.depth);
            assert!(
                (near / farthest_m..near / nearest_m).contains(&depth),
                "{depth}"
            );
        }
        let low = glow(1e4, DVec3::NEG_X, true).expect("night");
        assert_eq!(low.depth, 0.0);
    }
}
