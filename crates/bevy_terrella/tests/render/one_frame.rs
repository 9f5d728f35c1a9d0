//! One Bevy frame, compared with the native host's of the same view.

use crate::compare::{assert_alike, difference, lit};
use crate::native::Native;
use crate::scene::{SIZE, View, alone};
use bevy::camera::{CameraProjection, PerspectiveProjection};
use bevy::math::{DVec3, Vec3};
use bevy::prelude::{Msaa, Transform};
use bevy::transform::components::GlobalTransform;
use bevy_terrella::EarthFrame;
use terrella::frames::Geodetic;
use terrella::{Exposure, EyeView};

/// The view with Bevy's matrices in f32.
pub fn as_bevy_has_it(view: &View) -> EyeView {
    let (width, height) = SIZE;
    let mut projection = PerspectiveProjection {
        fov: view.fov_rad,
        near: crate::scene::NEAR,
        ..Default::default()
    };
    projection.update(width as f32, height as f32);
    let transform = GlobalTransform::from(view.transform);
    let (_, rotation, eye) = transform.to_scale_rotation_translation();
    EyeView {
        eye_world: eye.as_dvec3(),
        view_from_world: rotation.inverse().as_dquat().normalize(),
        clip_from_view: projection.get_clip_from_view().as_dmat4(),
        itrf_from_world: view.frame.itrf_from_world,
    }
}

#[track_caller]
fn is_the_native_hosts(native: &Native, view: &View) {
    let picture = alone(view);
    let key = (view.format(), view.msaa.samples());
    let drawn = |eye| native.draw(key, (&eye, &view.sky()), SIZE, view.exposure);
    let lit = lit(&picture, view.format());
    assert!((0.15..=1.0).contains(&lit), "{lit} of the picture is lit");

    let same = difference(&picture, &drawn(as_bevy_has_it(view)), view.format());
    assert_eq!(same.channels, 0, "with the same matrices: {same:?}");

    // Bevy's matrices are f32, the native host's f64.
    let near = difference(&picture, &drawn(view.eye(SIZE)), view.format());
    eprintln!("{key:?}: {near:?}");
    assert_alike(&near, view.hdr);
}

#[test]
fn a_frame_is_the_native_hosts_in_each_format() {
    let Some(native) = Native::open() else { return };
    for (hdr, msaa, exposure) in [
        (false, Msaa::Off, Exposure::default()),
        (false, Msaa::Sample4, Exposure::Ev(-0.7)),
        (true, Msaa::Off, Exposure::default()),
        (true, Msaa::Sample4, Exposure::default()),
    ] {
        let view = View {
            hdr,
            msaa,
            exposure,
            ..View::station()
        };
        is_the_native_hosts(&native, &view);
    }
}

/// A world with its zero ten million kilometres from the Earth. An eye in it is 2 km over the coast of Somalia, 50 m farther each step.
fn far_world(step: u32) -> (EarthFrame, DVec3) {
    let local = EarthFrame::local(Geodetic::from_degrees(-0.4, 42.6, 2_000.0));
    let world = local.shifted(DVec3::new(6e9, -7e9, 4e9));
    let eye = DVec3::new(40.0, 5.0, -30.0) * f64::from(step);
    let eye_itrf_m = local.itrf_from_world.transform_point3(eye);
    (world, world.world_from_itrf(eye_itrf_m))
}

#[test]
fn a_camera_that_moves_sees_what_the_native_host_does_by_a_floating_origin() {
    let Some(native) = Native::open() else { return };
    let ahead = Transform::IDENTITY.looking_to(Vec3::new(0.3, -0.35, -1.0), Vec3::Y);
    let mut expected = None;
    for step in 0..3 {
        let (world, eye_world) = far_world(step);
        let view = View {
            frame: world.shifted(eye_world),
            transform: ahead,
            fov_rad: 0.5,
            ..View::station()
        };
        is_the_native_hosts(&native, &view);
        // The native host in the world itself, all in f64.
        let eye = EyeView {
            eye_world,
            itrf_from_world: world.itrf_from_world,
            ..view.eye(SIZE)
        };
        let key = (view.format(), 1);
        let drawn = native.draw(key, (&eye, &view.sky()), SIZE, view.exposure);
        let found = difference(&alone(&view), &drawn, key.0);
        assert!(found.greatest <= 1.0, "{found:?}");
        assert!(found.channels * 50 < found.of, "{found:?}");
        expected = Some((view, world, eye_world, drawn));
    }
    // With its f32 position in that world, the camera is up to half a kilometre off.
    let (view, frame, eye_world, expected) = expected.expect("three steps");
    let view = View {
        frame,
        transform: ahead.with_translation(eye_world.as_vec3()),
        ..view
    };
    let found = difference(&alone(&view), &expected, view.format());
    assert!(found.channels * 20 > found.of, "f32 was enough: {found:?}");
}
