//! Gains of stars and of the lights of the night: they fall where a picture shows daylight, unless a key asks for them.

use crate::Place;
use image::RgbImage;

/// Dusk over Europe and Africa: half of the ground is lit.
const DUSK: &str = "[time]\nstart = \"2018-03-20T18:00:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 25\nlon_deg = 5\nheight_km = 6000\nfov_deg = 60\n";
/// Midnight over the Alps, without a Moon.
const NIGHT: &str = "[time]\nstart = \"2018-03-17T23:40:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 45\nlon_deg = 8\nheight_km = 600\nheading_deg = 0\npitch_deg = -45\nfov_deg = 60\n";
/// Half of the Earth, farther away than the Moon.
const FAR: &str = "[time]\nstart = \"2018-03-20T18:00:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 25\nlon_deg = 5\nheight_km = 400000\nfov_deg = 60\n";
/// Up from the ground, an hour before noon.
const DAY_SKY: &str = "[time]\nstart = \"2018-03-20T11:00:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 45\nlon_deg = 8\nheight_km = 0.5\npitch_deg = 70\nfov_deg = 60\n";

fn draw(place: &Place, scene: &str, sets: &[&str]) -> RgbImage {
    place.scene("a.toml", scene);
    let mut ask = vec!["frame", "a.toml", "-o", "a.png", "--size", "160x90"];
    for set in sets {
        ask.extend(["--set", *set]);
    }
    place.succeed(&ask);
    image::open(place.path("a.png")).expect("a PNG").to_rgb8()
}

fn farthest(a: &RgbImage, b: &RgbImage) -> u8 {
    let pairs = a.as_raw().iter().zip(b.as_raw());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default()
}

#[test]
fn cities_and_airglow_do_not_shine_beside_the_sunlit_earth() {
    let place = Place::new();
    let off = ["earth.night_lights=false", "earth.airglow=false"];
    for ev in ["0.5", "2", "\"auto\""] {
        let look = format!("{DUSK}[earth]\nairglow = true\n[output]\nexposure_ev = {ev}\n");
        let shown = draw(&place, &look, &[]);
        let least = farthest(&shown, &draw(&place, &look, &off));
        let asked = draw(&place, &look, &["earth.night_gain=150000"]);
        let most = farthest(
            &asked,
            &draw(
                &place,
                &look,
                &[&off[..], &["earth.night_gain=150000"]].concat(),
            ),
        );
        println!("{ev} EV: {least} codes, {most} where a key asks for them");
        assert!(least <= 2, "{ev}: {least}");
        assert!(most > 60, "{ev}: {most}");
    }
}

#[test]
fn a_night_without_moon_has_its_whole_gain_where_there_are_no_cities() {
    let place = Place::new();
    let at_sea = NIGHT
        .replace("lat_deg = 45", "lat_deg = -45")
        .replace("lon_deg = 8", "lon_deg = -10");
    for (look, gain, night) in [("standard", "150000", NIGHT), ("full", "400000", &at_sea)] {
        let scene = format!("{night}[earth]\nlook = \"{look}\"\n");
        let shown = draw(&place, &scene, &[]);
        let asked = draw(&place, &scene, &[&format!("earth.night_gain={gain}")]);
        assert!(shown == asked, "{look}");
        let dark = draw(&place, &scene, &["earth.night_gain=1"]);
        let lit = farthest(&shown, &dark);
        assert!(lit > if night == NIGHT { 60 } else { 5 }, "{look}: {lit}");
    }
    let scene = format!("{NIGHT}[earth]\nlook = \"full\"\n");
    let sum = |sets: &[&str]| {
        let picture = draw(&place, &scene, sets);
        picture
            .as_raw()
            .iter()
            .map(|code| u64::from(*code))
            .sum::<u64>()
    };
    let gains = ["earth.night_gain=40000", "earth.night_gain=200000"];
    let (least, shown, most) = (sum(&gains[..1]), sum(&[]), sum(&gains[1..]));
    assert!((least..most).contains(&shown), "{least} {shown} {most}");
}

#[test]
fn no_star_shines_beside_a_far_earth_or_in_the_day_sky() {
    let place = Place::new();
    let off = ["sky.stars=false", "sky.milky_way=false"];
    for (name, scene) in [("far", FAR), ("day sky", DAY_SKY), ("dusk", DUSK)] {
        let scene = format!("{scene}[earth]\nlook = \"full\"\n");
        let starless = draw(&place, &scene, &off);
        let least = farthest(&draw(&place, &scene, &[]), &starless);
        let most = farthest(&draw(&place, &scene, &["sky.star_gain=1e6"]), &starless);
        println!("{name}: {least} codes, {most} where a key asks for them");
        assert!(least <= 2, "{name}: {least}");
        assert!(most > 20, "{name}: {most}");
    }
}

/// Files of light have no exposure: their light is the truth times the same gain by day and by night.
#[test]
fn files_of_light_keep_the_gains() {
    let place = Place::new();
    place.scene("a.toml", &format!("{DUSK}[earth]\nairglow = true\n"));
    let light = |name: &str, sets: &[&str]| {
        let mut ask = vec![
            "frame",
            "a.toml",
            "-o",
            "a.png",
            "--size",
            "160x90",
            "--radiance",
            name,
        ];
        for set in sets {
            ask.extend(["--set", *set]);
        }
        place.succeed(&ask);
        std::fs::read(place.path(name)).expect("reads")
    };
    let usual = light("a.npy", &[]);
    let asked = ["earth.night_gain=150000", "sky.star_gain=40000"];
    assert!(usual == light("b.npy", &asked));
    assert!(usual != light("c.npy", &["earth.night_gain=1"]));
    assert!(usual != light("d.npy", &["sky.star_gain=1"]));
}
