//! Meshes and the Earth hide each other by depth; the Sun lights both alike.

use crate::compare::{channels, difference};
use crate::headless::{self, Picture};
use crate::native::Native;
use crate::scene::{self, SIZE, View, block};
use bevy::prelude::*;
use bevy_terrella::EarthSun;

const MAGENTA: [u8; 3] = [255, 0, 255];

/// A level view from 420 km: the horizon is 20.4° down, below the middle.
fn level() -> View {
    View {
        transform: Transform::IDENTITY.looking_to(Vec3::new(0.0, -0.372, -1.0), Vec3::Y),
        fov_rad: 0.6,
        ..View::station()
    }
}

fn with(view: &View, blocks: &[(Vec3, Vec3)]) -> Picture {
    let mut app = scene::app(view);
    let image = headless::target(&mut app, SIZE, view.format());
    scene::camera(&mut app, view, &image, None);
    for &(size, at) in blocks {
        block(&mut app, size, at, Color::srgb_u8(255, 0, 255));
    }
    headless::draw(&mut app, &image).expect("a picture")
}

fn pixel(picture: &Picture, (x, y): (u32, u32)) -> [u8; 3] {
    let at = 4 * (y * picture.size.0 + x) as usize;
    [0, 1, 2].map(|channel| picture.bytes[at + channel])
}

#[test]
fn a_mesh_before_the_earth_hides_it_and_one_beyond_the_limb_is_hidden() {
    if Native::open().is_none() {
        return;
    }
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let view = View { msaa, ..level() };
        let bare = with(&view, &[]);
        // One block is 40 m ahead and aside. The other is 6000 km away, behind the lower half of the Earth.
        let ahead = *view.transform.forward();
        let right = *view.transform.right();
        let near = ahead * 40.0 - right * 8.0 - *view.transform.up() * 4.0;
        let far = ahead * 6e6 + right * 8e5;
        let picture = with(
            &view,
            &[(Vec3::splat(4.0), near), (Vec3::splat(1.6e6), far)],
        );
        let height = SIZE.1;
        // 8 m and 4 m at 40, 0.8 and 6. 90 pixels correspond to tan 0.3.
        let pixels = 90.0 / 0.3_f64.tan();
        let near_at = (160 - (pixels * 0.2) as u32, 90 + (pixels * 0.1) as u32);
        let x_far = 160 + (pixels * 8.0 / 60.0) as u32;
        let is_far = |y: u32| pixel(&picture, (x_far, y)) == MAGENTA;
        let is_bare = |x: u32, y: u32| pixel(&picture, (x, y)) == pixel(&bare, (x, y));

        // In front of the ground: visible.
        assert_eq!(pixel(&picture, near_at), MAGENTA, "{msaa:?}");
        assert_ne!(pixel(&bare, near_at), MAGENTA);

        // Beyond the limb: visible above it, through the atmosphere just above, and nowhere on the
        // ground.
        let seen: Vec<_> = (0..height).filter(|&y| is_far(y)).collect();
        let ground = (0..height).find(|&y| pixel(&bare, (x_far, y)).iter().all(|&c| c > 20));
        let ground = ground.expect("ground in view");
        assert!(seen.len() > 10, "{msaa:?} {seen:?}");
        assert!(
            seen.iter().all(|&y| y < ground),
            "{msaa:?} {seen:?} {ground}"
        );
        // Without the Earth it would extend down to here: its half is 800 km in 6000.
        let bottom = height / 2 + (pixels * 0.13) as u32;
        assert!(bottom > ground + 20, "{bottom} {ground}");
        let through = (ground + 8..bottom).filter(|&y| !is_bare(x_far, y));
        let through: Vec<_> = through
            .map(|y| (y, pixel(&picture, (x_far, y)), pixel(&bare, (x_far, y))))
            .collect();
        assert!(
            through.is_empty(),
            "{msaa:?}: seen through the ground from {ground}: {through:?}"
        );
        let veiled = (seen.len() as u32..ground).any(|y| !is_far(y) && !is_bare(x_far, y));
        assert!(veiled, "{msaa:?}: no air lies over the mesh");
    }
}

#[test]
fn a_white_sheet_that_faces_the_sun_is_as_bright_as_the_earths_light_says() {
    if Native::open().is_none() {
        return;
    }
    let view = View {
        hdr: true,
        ..View::station()
    };
    let towards = view.frame.world_direction(view.sky().sun_itrf).as_vec3();
    let aside = towards.any_orthonormal_vector();
    let view = View {
        transform: Transform::from_translation(towards * 3.0).looking_at(Vec3::ZERO, aside),
        ..view
    };
    for ev100 in [9.7, 15.0] {
        let mut app = scene::app(&view);
        let image = headless::target(&mut app, SIZE, view.format());
        let camera = scene::camera(&mut app, &view, &image, None);
        app.world_mut()
            .entity_mut(camera)
            .insert(bevy::camera::Exposure { ev100 });
        app.insert_resource(GlobalAmbientLight::NONE);
        app.world_mut().spawn(EarthSun {
            ev100,
            ..EarthSun::default()
        });
        let sheet = block(
            &mut app,
            Vec3::new(40.0, 40.0, 0.1),
            Vec3::ZERO,
            Color::WHITE,
        );
        let mut sheet = app.world_mut().entity_mut(sheet);
        sheet.insert(Transform::IDENTITY.looking_to(-towards, aside));
        let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
        for (_, material) in materials.iter_mut() {
            (material.unlit, material.reflectance) = (false, 0.0);
            material.perceptual_roughness = 1.0;
        }
        let picture = headless::draw(&mut app, &image).expect("a picture");
        let light = channels(&picture, view.format());
        let middle = 3 * (SIZE.1 / 2 * SIZE.0 + SIZE.0 / 2) as usize;
        let middle = &light[middle..middle + 3];
        assert!(middle.iter().all(|c| (c - 1.0).abs() < 0.01), "{middle:?}");
    }
}

#[test]
fn a_scaled_camera_shares_depth_too() {
    if Native::open().is_none() {
        return;
    }
    // A scaled view scales Bevy's near plane and depths as well; the image is the same.
    let view = level();
    let scaled = View {
        transform: view.transform.with_scale(Vec3::splat(4.0)),
        ..view
    };
    let ahead = *view.transform.forward();
    let blocks = [(Vec3::splat(1.6e6), ahead * 6e6)];
    let found = difference(
        &with(&view, &blocks),
        &with(&scaled, &blocks),
        view.format(),
    );
    assert!(found.channels * 200 < found.of, "{found:?}");
}
