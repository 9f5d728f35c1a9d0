//! Several cameras that appear and disappear.

use crate::compare::{difference, part};
use crate::headless;
use crate::native::Native;
use crate::scene::{self, SIZE, View, alone};
use bevy::prelude::*;
use terrella::Exposure;

/// The station's view and a view back over its shoulder, both as linear light, which has no per-pixel dithering. The third is a
/// telescope's view as displayed, with its own exposure and more samples.
fn three() -> [View; 3] {
    let station = View {
        hdr: true,
        ..View::station()
    };
    let turned = |axis: Vec3, angle| {
        let turn = Quat::from_axis_angle(axis, angle);
        station
            .transform
            .with_rotation(turn * station.transform.rotation)
    };
    [
        station,
        View {
            transform: turned(Vec3::Y, 2.5),
            ..station
        },
        View {
            transform: turned(Vec3::Y, 1.0),
            fov_rad: 0.3,
            hdr: false,
            exposure: Exposure::Ev(-1.0),
            msaa: Msaa::Sample4,
            ..station
        },
    ]
}

#[test]
fn each_camera_sees_its_own_picture_while_others_come_and_go() {
    if Native::open().is_none() {
        return;
    }
    let views = three();
    let expected = views.map(|view| alone(&view));
    let apart = difference(&expected[0], &expected[1], views[0].format());
    assert!(apart.channels > 10_000, "{apart:?}");

    // A split screen of two, and a separate texture for the third.
    let mut app = scene::app(&views[0]);
    let screen = headless::target(&mut app, (2 * SIZE.0, SIZE.1), views[0].format());
    let texture = headless::target(&mut app, SIZE, views[2].format());
    let size = UVec2::from(SIZE);
    let halves = [UVec2::ZERO, UVec2::new(SIZE.0, 0)].map(|corner| Some((corner, size)));
    let first = scene::camera(&mut app, &views[0], &screen, halves[0]);
    let second = scene::camera(&mut app, &views[1], &screen, halves[1]);
    let third = scene::camera(&mut app, &views[2], &texture, None);

    let is = |picture: &headless::Picture, at: u32, index: usize| {
        let found = part(picture, (at * SIZE.0, 0), SIZE);
        let found = difference(&found, &expected[index], views[index].format());
        // Rays round differently in a part that does not start at the corner.
        let step = if views[index].hdr { 5e-3 } else { 0.0 };
        assert!(found.greatest <= step, "{index}: {found:?}");
        assert!(found.channels * 50 < found.of, "{index}: {found:?}");
    };
    let both = headless::draw(&mut app, &screen).expect("a picture");
    is(&both, 0, 0);
    is(&both, 1, 1);
    is(
        &headless::draw(&mut app, &texture).expect("a picture"),
        0,
        2,
    );

    // The camera with the Earth's own view disappears, and another takes it over.
    app.world_mut().despawn(first);
    let mut right = app.world_mut().entity_mut(second);
    let mut right = right.get_mut::<Camera>().expect("a camera");
    (right.order, right.clear_color) = (0, ClearColorConfig::Default);
    is(&headless::draw(&mut app, &screen).expect("a picture"), 1, 1);
    // Another camera with the third's format and sample count has its own exposure, also when it is alone.
    let bright = View {
        exposure: Exposure::Ev(1.5),
        ..views[2]
    };
    let other = headless::target(&mut app, SIZE, bright.format());
    scene::camera(&mut app, &bright, &other, None);
    let expected_bright = alone(&bright);
    let format = bright.format();
    assert!(difference(&expected_bright, &expected[2], format).channels > 10_000);
    for third_is_there in [true, false] {
        if third_is_there {
            is(
                &headless::draw(&mut app, &texture).expect("a picture"),
                0,
                2,
            );
        } else {
            app.world_mut().despawn(third);
        }
        let found = headless::draw(&mut app, &other).expect("a picture");
        let found = difference(&found, &expected_bright, format);
        assert_eq!(found.channels, 0, "{found:?}");
    }
    // A camera that changes its sample count switches to another Earth, and comes back.
    for msaa in [Msaa::Sample4, Msaa::Off] {
        app.world_mut().entity_mut(second).insert(msaa);
        headless::draw(&mut app, &screen).expect("a picture");
    }
    is(&headless::draw(&mut app, &screen).expect("a picture"), 1, 1);
}
