//! The space station's orbit over Europe by night, in front of the stars. It needs the features `celestial` and
//! `tracks`.
//!
//! ```sh
//! cargo run --example orbit --features celestial,tracks                        # a window
//! cargo run --example orbit --features celestial,tracks -- --frame orbit.png   # one picture, without a window
//! ```

#[path = "../tests/render/headless.rs"]
pub mod headless;

use bevy::prelude::*;
use bevy_terrella::prelude::*;
use bevy_terrella::terrella::frames::Ellipsoid;
use bevy_terrella::terrella::orbit::Catalogue;
use bevy_terrella::terrella::tracks::{LineStyle, Polylines, Station};
use std::error::Error;
use std::path::Path;

/// Orbital elements of the space station, January 2018.
const ELEMENTS: &str = include_str!("../../terrella-orbit/data/iss.tle");

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    match &arguments[..] {
        [] => {
            App::new().add_plugins((DefaultPlugins, fly)).run();
            Ok(())
        }
        [flag, path] if flag == "--frame" => still((960, 540))?.save(path),
        _ => Err("orbit takes nothing, or --frame PATH".into()),
    }
}

/// The app: the Earth, the sky, a satellite and a ground station.
pub fn fly(app: &mut App) {
    app.add_plugins(TerrellaPlugin)
        .insert_resource(ClearColor(Color::BLACK))
        .add_systems(Startup, spawn);
}

fn spawn(mut commands: Commands) -> Result {
    commands.spawn((
        Earth::default(),
        EarthCelestial::default(),
        EarthFrame::local(Geodetic::from_degrees(48.0, 12.0, 7_000_000.0)),
        EarthEpoch(Epoch::from_gregorian_utc(2018, 1, 20, 23, 20, 0, 0)),
        EarthClock { rate: 60.0 },
    ));
    let catalogue = Catalogue::from_text(ELEMENTS, Path::new("iss.tle"), false)?;
    for (index, feed) in catalogue.feeds.into_iter().enumerate() {
        commands.spawn(EarthTrack::new(feed, index));
    }
    commands.spawn(EarthStation(Station {
        place: Geodetic::from_degrees(48.1, 11.3, 600.0),
        min_elevation_rad: 0.0,
        color: [255, 255, 255],
        width_px: 1.5,
    }));
    let style = LineStyle::thin([140, 170, 200], 0.35);
    let lines = Polylines::graticule(style, &Ellipsoid::WGS84, 15.0)?;
    commands.spawn(EarthLines::new(lines));
    commands.spawn((
        EarthCamera::default(),
        Transform::default().looking_to(Vec3::new(0.1, -1.0, 0.05), Vec3::NEG_Z),
    ));
    Ok(())
}

/// One image of the app at its first instant.
pub fn still(size: (u32, u32)) -> Result<headless::Picture, Box<dyn Error>> {
    // Satellite curves grow over several frames.
    headless::still(fly, size, 12)
}
