//! Snow and sea ice of the time of year.

use crate::Place;
use std::path::Path;

fn scene(start: &str, lat_deg: f64, lon_deg: f64) -> String {
    format!(
        "[time]\n{start}\n[camera]\nmode = \"geodetic\"\nlat_deg = {lat_deg}\nlon_deg = {lon_deg}\nheight_km = 800\npitch_deg = -90\n\
         [earth]\nclouds = false\nnight_lights = false\n[output]\nsize = [64, 36]\nsamples = 1\nexposure_ev = 0\n"
    )
}

/// The picture of a scene with the starter pack's maps.
fn picture(place: &Place, scene: &str, more: &[&str]) -> Vec<u8> {
    place.scene("scene.toml", scene);
    let arguments = [&["frame", "scene.toml", "--output", "out.png"], more].concat();
    let mut command = place.command(&arguments);
    let maps = Path::new(crate::REPOSITORY).join("textures");
    let output = command.env("TERRELLA_TEXTURES", maps).output();
    let output = output.expect("the command starts");
    assert!(output.status.success(), "{}", crate::words(&output));
    let picture = image::open(place.path("out.png")).expect("a picture");
    picture.into_rgb8().into_raw()
}

fn mean(picture: &[u8]) -> f64 {
    picture.iter().map(|code| f64::from(*code)).sum::<f64>() / picture.len() as f64
}

const WITHOUT: [&str; 2] = ["--set", "earth.seasons=false"];

#[test]
fn the_arctic_ocean_is_frozen_and_the_tropics_are_not() {
    let place = Place::new();
    let spring = "start = \"2018-05-10T22:00:00Z\"";
    let arctic = scene(spring, 78.0, -150.0);
    let (ice, open) = (
        mean(&picture(&place, &arctic, &[])),
        mean(&picture(&place, &arctic, &WITHOUT)),
    );
    assert!(ice > 1.8 * open, "{ice} {open}");
    let tropics = scene(spring, 0.0, -150.0);
    assert!(picture(&place, &tropics, &[]) == picture(&place, &tropics, &WITHOUT));
}

#[test]
fn the_instant_of_the_picture_chooses_the_month() {
    let place = Place::new();
    // Hudson Bay: frozen in May, open in September.
    let sea = scene("start = \"2018-05-10T18:00:00Z\"", 59.0, -85.0);
    let apart = |instant: &str| {
        let at = ["--at", instant];
        let with = picture(&place, &sea, &at);
        mean(&with) / mean(&picture(&place, &sea, &[&at[..], &WITHOUT].concat()))
    };
    let (may, september) = (apart("2018-05-10T18:00:00Z"), apart("2018-09-10T18:00:00Z"));
    assert!(may > 1.5 && september < 1.1, "{may} {september}");
}

#[test]
fn a_scene_without_a_date_has_no_season() {
    let place = Place::new();
    let south = scene("", -65.0, 0.0);
    let south = format!("{south}[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\n");
    assert!(picture(&place, &south, &[]) == picture(&place, &south, &WITHOUT));
    let at = ["--at", "2018-09-15T12:00:00Z"];
    let without = picture(&place, &south, &[&at[..], &WITHOUT].concat());
    assert!(mean(&picture(&place, &south, &at)) > 1.5 * mean(&without));
}
