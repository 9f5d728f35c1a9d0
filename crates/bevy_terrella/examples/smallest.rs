//! The Earth from the space station's height, in a window.

use bevy::prelude::*;
use bevy_terrella::prelude::*;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, TerrellaPlugin))
        .insert_resource(ClearColor(Color::BLACK))
        .add_systems(Startup, spawn)
        .run();
}

fn spawn(mut commands: Commands) {
    // The world: metres from a point 420 km over Egypt, x east, y up, z south.
    let place = Geodetic::from_degrees(28.0, 30.0, 420_000.0);
    let time = Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0);
    commands.spawn((
        Earth::default(),
        EarthFrame::local(place),
        EarthEpoch(time),
        EarthClock { rate: 60.0 },
    ));
    commands.spawn((
        // With a `Camera3d`, and what that needs.
        EarthCamera::default(),
        Transform::default().looking_to(Vec3::new(0.0, -0.4, -1.0), Vec3::Y),
    ));
}
