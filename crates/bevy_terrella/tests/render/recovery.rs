//! A lost device.

use crate::compare::difference;
use crate::headless;
use crate::native::Native;
use crate::scene::{self, SIZE, View};
use bevy::app::App;
use bevy::ecs::change_detection::{DetectChanges, Tick};
use bevy::render::error_handler::{RenderErrorHandler, RenderErrorPolicy};
use bevy::render::render_resource::PollType;
use bevy::render::renderer::RenderDevice;

/// Change tick of the current device.
fn device_since(app: &App) -> Tick {
    app.world().resource_ref::<RenderDevice>().last_changed()
}

#[test]
fn on_a_new_device_the_earth_is_what_it_was() {
    if Native::open().is_none() {
        return;
    }
    let view = View::station();
    let mut app = scene::app(&view);
    app.insert_resource(RenderErrorHandler(|_, _, _| {
        RenderErrorPolicy::Recover(Default::default())
    }));
    let image = headless::target(&mut app, SIZE, view.format());
    scene::camera(&mut app, &view, &image, None);
    // Read back in another app, because Bevy would use buffers of the lost device.
    let before = scene::alone(&view);
    headless::wait(&mut app, |status| status.is_drawn()).expect("the Earth");

    let since = device_since(&app);
    let lost = app.world().resource::<RenderDevice>().clone();
    // Bevy fails if a buffer is destroyed while it waits to read it.
    let answered = lost.poll(PollType::wait_indefinitely());
    answered.expect("the frames so far");
    lost.wgpu_device().destroy();
    // Notifies Bevy before it draws another frame, as after a driver failure during a frame.
    lost.poll(PollType::Poll)
        .expect("the last word of the device");
    let mut frames = 0;
    while device_since(&app) == since {
        app.update();
        frames += 1;
        assert!(frames < 100, "Bevy has made no new device");
    }
    let after = headless::draw(&mut app, &image).expect("a picture");
    let found = difference(&before, &after, view.format());
    assert_eq!(found.channels, 0, "{found:?}");
}
