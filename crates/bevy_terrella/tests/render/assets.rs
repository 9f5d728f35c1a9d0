//! Maps read by Bevy's `AssetServer`.

use crate::compare::{channels, difference};
use crate::headless;
use crate::native::Native;
use crate::scene::{self, SIZE, View};
use bevy::prelude::*;
use bevy_terrella::{Earth, EarthCameraStatus, EarthCelestial, EarthFault, EarthMaps};
use terrella::{LayerSelection, find_textures};

/// A view of the night side, where city lights show.
fn night() -> View {
    View {
        epoch: terrella::frames::Epoch::from_gregorian_utc(2018, 1, 20, 22, 0, 0, 0),
        hdr: true,
        ..View::station()
    }
}

fn app(view: &View, maps: EarthMaps) -> (App, Handle<Image>) {
    let folder = find_textures().expect("the starter maps");
    let assets = AssetPlugin {
        // The parent of the map folder.
        file_path: folder.parent().expect("a folder").display().to_string(),
        ..default()
    };
    let app = headless::app_with_assets(assets);
    let mut app = scene::app_of(app, view, Earth::new(maps));
    let image = headless::target(&mut app, SIZE, view.format());
    scene::camera(&mut app, view, &image, None);
    let mut earths = app.world_mut().query_filtered::<Entity, With<Earth>>();
    let earth = earths.single(app.world()).expect("one Earth");
    app.world_mut()
        .entity_mut(earth)
        .insert(EarthCelestial::default());
    (app, image)
}

#[test]
fn assets_give_the_picture_of_the_folder() {
    if Native::open().is_none() {
        return;
    }
    let folder = find_textures().expect("the starter maps");
    let name = folder.file_name().expect("a name").to_string_lossy();
    let day = View {
        hdr: true,
        ..View::station()
    };
    for view in [day, night()] {
        let of = |maps| {
            let (mut app, image) = app(&view, maps);
            headless::draw(&mut app, &image).expect("a picture")
        };
        let expected = of(EarthMaps::Folder(folder.clone(), LayerSelection::default()));
        let found = of(EarthMaps::assets(name.to_string()));
        let light = channels(&expected, view.format());
        let brightest = light.into_iter().fold(0.0, f64::max);
        assert!(brightest > 1e-3, "{brightest}");
        let found = difference(&found, &expected, view.format());
        assert!(found.channels == 0, "{found:?}");
    }
}

#[test]
fn assets_that_are_not_there_are_a_fault_that_says_where() {
    if Native::open().is_none() {
        return;
    }
    let (mut app, _) = app(&night(), EarthMaps::assets("nowhere/earth"));
    headless::wait(&mut app, |status| {
        matches!(status.fault(), Some(EarthFault::Assets { .. }))
    })
    .expect("a fault");
    let mut statuses = app.world_mut().query::<&EarthCameraStatus>();
    let status = statuses.single(app.world()).expect("one camera");
    let message = status.fault().expect("a fault").to_string();
    assert!(message.contains("nowhere/earth"), "{message}");
    assert!(message.contains("day.jpg"), "{message}");
}
