//! Faults appear in the camera's status, and disappear when corrected.

use crate::headless::{self, wait};
use crate::native::{Native, maps};
use crate::scene::{self, SIZE, View};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy_terrella::{Earth, EarthCamera, EarthEpoch, EarthFault, EarthMaps};
use terrella::frames::Epoch;
use terrella::{EarthError, Exposure, LayerSelection};

/// Waits until the only camera has this fault.
#[track_caller]
fn fails(app: &mut App, what: &str, is_it: impl Fn(&EarthFault) -> bool) {
    let found = wait(app, |status| status.fault().is_some_and(&is_it));
    found.unwrap_or_else(|error| panic!("{what}: {error}"));
}

#[track_caller]
fn is_drawn(app: &mut App) {
    wait(app, |status| status.is_drawn()).expect("put right");
}

#[test]
fn faults_are_reported_and_pass() {
    if Native::open().is_none() {
        return;
    }
    let view = View::station();
    let mut app = scene::app(&view);
    let image = headless::target(&mut app, SIZE, view.format());
    let camera = scene::camera(&mut app, &view, &image, None);
    let mut earths = app.world_mut().query_filtered::<Entity, With<Earth>>();
    let earth = earths.single(app.world()).expect("one Earth");
    is_drawn(&mut app);

    let whole = app.world().get::<Projection>(camera).cloned();
    let whole = whole.expect("a projection");
    let flat = Projection::Orthographic(OrthographicProjection::default_3d());
    app.world_mut().entity_mut(camera).insert(flat);
    fails(&mut app, "flat", |f| matches!(f, EarthFault::Projection));
    app.world_mut().entity_mut(camera).insert(whole);
    is_drawn(&mut app);

    let mirror = view.transform.with_scale(Vec3::new(-1.0, 1.0, 1.0));
    app.world_mut().entity_mut(camera).insert(mirror);
    fails(&mut app, "mirror", |f| matches!(f, EarthFault::Transform));
    app.world_mut().entity_mut(camera).insert(view.transform);
    is_drawn(&mut app);

    let glaring = EarthCamera {
        exposure: Exposure::Ev(99.0),
    };
    app.world_mut().entity_mut(camera).insert(glaring);
    fails(
        &mut app,
        "glare",
        |f| matches!(f, EarthFault::Earth(EarthError::Exposure(ev)) if *ev == 99.0),
    );
    let camera_as_it_was = EarthCamera::default();
    app.world_mut().entity_mut(camera).insert(camera_as_it_was);
    is_drawn(&mut app);

    let second = app.world_mut().spawn(Earth::new(EarthMaps::Memory(maps())));
    let second = second.id();
    fails(&mut app, "two", |f| matches!(f, EarthFault::Several(2)));
    app.world_mut().despawn(second);
    is_drawn(&mut app);

    let nowhen = EarthEpoch(Epoch::from_gregorian_utc_at_midnight(12_018, 1, 1));
    app.world_mut().entity_mut(earth).insert(nowhen);
    fails(&mut app, "epoch", |f| matches!(f, EarthFault::Epoch(_)));
    let date = EarthEpoch(view.epoch);
    app.world_mut().entity_mut(earth).insert(date);
    is_drawn(&mut app);

    let nowhere = EarthMaps::Folder("no/such/folder".into(), LayerSelection::default());
    let mut component = app.world_mut().get_mut::<Earth>(earth).expect("an Earth");
    component.maps = nowhere;
    fails(&mut app, "maps", |f| matches!(f, EarthFault::Maps(_)));
    let mut component = app.world_mut().get_mut::<Earth>(earth).expect("an Earth");
    component.maps = EarthMaps::default();
    component.light.cloud_height_m = f64::NAN;
    fails(&mut app, "options", |f| {
        matches!(f, EarthFault::Earth(EarthError::SurfaceLight { .. }))
    });
    let mut component = app.world_mut().get_mut::<Earth>(earth).expect("an Earth");
    component.light = Default::default();
    is_drawn(&mut app);

    let linear = headless::target(&mut app, SIZE, TextureFormat::Rgba8Unorm);
    let linear = bevy::camera::RenderTarget::Image(linear.into());
    app.world_mut().entity_mut(camera).insert(linear);
    // Bevy checks a camera's target only when something of the camera changes.
    app.world_mut()
        .get_mut::<Projection>(camera)
        .expect("one")
        .set_changed();
    fails(&mut app, "linear", |f| matches!(f, EarthFault::Format(_)));

    // Without an Earth a camera waits.
    app.world_mut().despawn(earth);
    wait(&mut app, |status| {
        matches!(status, bevy_terrella::EarthCameraStatus::Waiting)
    })
    .expect("no Earth, no fault");
}
