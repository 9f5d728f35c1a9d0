//! The sky beyond the Earth and the tracks over it, compared with the native host.

use crate::compare::{assert_alike, channels, difference, part};
use crate::headless::{self, Picture};
use crate::native::{Beside, Native};
use crate::one_frame::as_bevy_has_it;
use crate::scene::{self, SIZE, View, block};
use bevy::prelude::*;
use bevy_terrella::{Earth, EarthLines, EarthStation, EarthTrack};
use bevy_terrella::{EarthCameraStatus, EarthCelestial, EarthFault, EarthFrame};
use std::path::Path;
use terrella::celestial::{CelestialOptions, CelestialSelection};
use terrella::find_textures;
use terrella::frames::{Ellipsoid, Epoch, Geodetic};
use terrella::orbit::Catalogue;
use terrella::tracks::{LineStyle, Polylines, Station};

/// Frames in which satellite curves grow to their full length.
const GROWTH: usize = 12;

/// The space station over the night side, with the limb in the middle and stars above it.
fn by_night(hdr: bool, msaa: Msaa) -> View {
    View {
        epoch: Epoch::from_gregorian_utc(2018, 1, 20, 22, 0, 0, 0),
        transform: Transform::IDENTITY.looking_to(Vec3::new(0.2, -0.37, -1.0), Vec3::Y),
        hdr,
        msaa,
        ..View::station()
    }
}

/// The whole disc from 14 000 km.
fn from_afar(hdr: bool, msaa: Msaa) -> View {
    View {
        frame: EarthFrame::local(Geodetic::from_degrees(28.0, 30.0, 14e6)),
        transform: Transform::IDENTITY.looking_to(Vec3::NEG_Y, Vec3::NEG_Z),
        ..by_night(hdr, msaa)
    }
}

fn station() -> Station {
    Station {
        place: Geodetic::from_degrees(31.2, 30.0, 20.0),
        min_elevation_rad: 0.1,
        color: [255, 255, 255],
        width_px: 1.5,
    }
}

fn track() -> EarthTrack {
    let text = include_str!("../../../terrella-orbit/data/iss.tle");
    let catalogue = Catalogue::from_text(text, Path::new("iss.tle"), true).expect("elements");
    let feed = catalogue.feeds.into_iter().next().expect("the station");
    EarthTrack::new(feed, 0)
}

fn graticule() -> Polylines {
    let style = LineStyle::thin([120, 160, 200], 0.6);
    Polylines::graticule(style, &Ellipsoid::WGS84, 15.0).expect("a graticule")
}

/// The native host's image, with Bevy's matrices.
fn native(native: &Native, view: &View, beside: &Beside) -> Picture {
    let key = (view.format(), view.msaa.samples());
    let seen = (&as_bevy_has_it(view), &view.sky());
    native.draw_with(key, seen, SIZE, view.exposure, beside)
}

fn earth(app: &mut App) -> Entity {
    let mut earths = app.world_mut().query_filtered::<Entity, With<Earth>>();
    earths.single(app.world()).expect("one Earth")
}

/// An image after all curves have grown.
fn grown(app: &mut App, image: &Handle<Image>) -> Picture {
    headless::wait(app, EarthCameraStatus::is_drawn).expect("drawn");
    for _ in 0..GROWTH {
        app.update();
    }
    headless::read(app, image).expect("a picture")
}

/// Extent of a change: channels that differ by more than dithering noise.
fn changed(a: &Picture, b: &Picture, view: &View) -> usize {
    let (a, b) = (channels(a, view.format()), channels(b, view.format()));
    let least = if view.hdr { 0.02 } else { 8.0 };
    let apart = a.iter().zip(&b).filter(|(a, b)| (**a - **b).abs() > least);
    apart.count()
}

#[test]
fn the_sky_is_the_native_hosts() {
    let Some(host) = Native::open() else { return };
    let folder = find_textures().expect("the starter maps");
    let all = CelestialSelection::default();
    let options = CelestialOptions::load(&*folder, all).expect("the starter sky");
    for (hdr, msaa) in [
        (false, Msaa::Off),
        (false, Msaa::Sample4),
        (true, Msaa::Off),
    ] {
        let view = by_night(hdr, msaa);
        let mut app = scene::app(&view);
        let image = headless::target(&mut app, SIZE, view.format());
        scene::camera(&mut app, &view, &image, None);
        let bare = headless::draw(&mut app, &image).expect("a picture");
        let at = earth(&mut app);
        app.world_mut()
            .entity_mut(at)
            .insert(EarthCelestial::default());
        // The old image is drawn until the new Earth is ready.
        app.update();
        app.update();
        let begin = std::time::Instant::now();
        let expected = Beside {
            celestial: Some(options.clone()),
            ..Beside::default()
        };
        let expected = native(&host, &view, &expected);
        let stars = difference(&expected, &bare, view.format()).channels;
        assert!(stars > 30, "the native host draws {stars} channels of sky");
        let found = loop {
            let picture = headless::read(&mut app, &image).expect("a picture");
            let found = difference(&picture, &expected, view.format());
            let is_new = difference(&picture, &bare, view.format()).channels > 0;
            if is_new || begin.elapsed().as_secs() > 60 {
                break found;
            }
        };
        eprintln!("{hdr} {msaa:?}: {found:?}");
        assert_alike(&found, view.hdr);
    }
}

#[test]
fn tracks_are_the_native_hosts_and_follow_their_entities() {
    let Some(host) = Native::open() else { return };
    for (hdr, msaa) in [(false, Msaa::Sample4), (true, Msaa::Off)] {
        let view = from_afar(hdr, msaa);
        let mut app = scene::app(&view);
        let image = headless::target(&mut app, SIZE, view.format());
        scene::camera(&mut app, &view, &image, None);
        let bare = headless::draw(&mut app, &image).expect("a picture");
        let beside = Beside {
            tracks: vec![track()],
            stations: vec![station()],
            lines: vec![graticule()],
            ..Beside::default()
        };
        let expected = native(&host, &view, &beside);
        assert!(changed(&expected, &bare, &view) > 2000);
        let world = app.world_mut();
        let satellite = world.spawn(track()).id();
        world.spawn(EarthStation(station()));
        let lines = world.spawn(EarthLines::new(graticule())).id();
        let found = difference(&grown(&mut app, &image), &expected, view.format());
        eprintln!("{hdr} {msaa:?}: {found:?}");
        assert_alike(&found, view.hdr);

        // One satellite disappears, and another appears in its place.
        app.world_mut().despawn(satellite);
        app.world_mut().despawn(lines);
        let fewer = Beside {
            stations: vec![station()],
            ..Beside::default()
        };
        let expected = native(&host, &view, &fewer);
        let found = difference(&grown(&mut app, &image), &expected, view.format());
        assert_alike(&found, view.hdr);
        let mut other = track();
        other.style.color = [255, 0, 0];
        other.style.ground_track = None;
        app.world_mut().spawn(other.clone());
        let other = Beside {
            tracks: vec![other],
            stations: vec![station()],
            ..Beside::default()
        };
        let expected = native(&host, &view, &other);
        let found = difference(&grown(&mut app, &image), &expected, view.format());
        assert_alike(&found, view.hdr);
    }
}

#[test]
fn meshes_hide_stars_and_tracks_and_each_camera_has_its_own() {
    if Native::open().is_none() {
        return;
    }
    let view = from_afar(true, Msaa::Off);
    let night = by_night(true, Msaa::Off);
    let mut app = scene::app(&view);
    let at = earth(&mut app);
    app.world_mut()
        .entity_mut(at)
        .insert(EarthCelestial::default());
    app.world_mut().spawn(track());
    app.world_mut().spawn(EarthLines::new(graticule()));
    // A split screen: the distant view on the left, the level view on the right.
    let turned = View {
        transform: night.transform,
        ..view
    };
    let screen = headless::target(&mut app, (2 * SIZE.0, SIZE.1), view.format());
    let size = UVec2::from(SIZE);
    scene::camera(&mut app, &view, &screen, Some((UVec2::ZERO, size)));
    let corner = UVec2::new(SIZE.0, 0);
    scene::camera(&mut app, &turned, &screen, Some((corner, size)));
    let both = grown(&mut app, &screen);
    for (index, view) in [view, turned].into_iter().enumerate() {
        let mut alone = scene::app(&view);
        let at = earth(&mut alone);
        alone
            .world_mut()
            .entity_mut(at)
            .insert(EarthCelestial::default());
        alone.world_mut().spawn(track());
        alone.world_mut().spawn(EarthLines::new(graticule()));
        let image = headless::target(&mut alone, SIZE, view.format());
        scene::camera(&mut alone, &view, &image, None);
        let expected = grown(&mut alone, &image);
        let half = part(&both, (SIZE.0 * index as u32, 0), SIZE);
        let found = difference(&half, &expected, view.format());
        eprintln!("camera {index}: {found:?}");
        assert_alike(&found, view.hdr);
    }

    // A black wall in front of the left camera, wider than its image.
    let wall = view.transform.forward() * 50.0;
    block(&mut app, Vec3::new(400.0, 1.0, 400.0), wall, Color::BLACK);
    let hidden = part(&grown(&mut app, &screen), (0, 0), SIZE);
    let light = channels(&hidden, view.format());
    let brightest = light.into_iter().fold(0.0, f64::max);
    assert!(brightest == 0.0, "{brightest} shines through a wall");
}

#[test]
fn a_style_without_meaning_is_a_fault_until_it_is_mended() {
    if Native::open().is_none() {
        return;
    }
    let view = from_afar(false, Msaa::Off);
    let mut app = scene::app(&view);
    let image = headless::target(&mut app, SIZE, view.format());
    scene::camera(&mut app, &view, &image, None);
    let mut broken = track();
    broken.style.width_px = f32::NAN;
    let satellite = app.world_mut().spawn(broken).id();
    headless::wait(&mut app, |status| {
        matches!(status.fault(), Some(EarthFault::Tracks(_)))
    })
    .expect("a fault");
    app.world_mut().entity_mut(satellite).insert(track());
    headless::wait(&mut app, EarthCameraStatus::is_drawn).expect("mended");
    let at = earth(&mut app);
    let dark = EarthCelestial {
        star_gain: f64::NAN,
        ..EarthCelestial::default()
    };
    app.world_mut().entity_mut(at).insert(dark);
    headless::wait(&mut app, |status| {
        matches!(status.fault(), Some(EarthFault::Celestial(_)))
    })
    .expect("a fault");
    app.world_mut()
        .entity_mut(at)
        .insert(EarthCelestial::default());
    headless::wait(&mut app, EarthCameraStatus::is_drawn).expect("mended");
}
