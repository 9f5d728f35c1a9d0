//! Maps that change with the date: selection, blending, and errors in their files.

use crate::Place;
use image::{GrayImage, Luma, Rgb, RgbImage};
use std::path::Path;
use std::time::Duration;
use terrella::frames::utc_from_rfc3339;
use terrella::internals::gpu::{BcSupport, GpuContext};
use terrella_play::scene::Scene;
use terrella_play::{Flight, OffscreenRenderer};

const SIZE: (u32, u32) = (96, 54);
const WAIT: Duration = Duration::from_secs(20);

/// A folder of maps: a dark day map, and clouds of three hours, the middle one damaged.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let day = RgbImage::from_fn(128, 64, |x, y| Rgb([40, (x / 2) as u8, y as u8]));
    day.save(path("day.png")).expect("writes");
    let clouds = |shift: u32| {
        let stripe = move |x: u32, y: u32| {
            Luma([if (x / 8 + y / 8 + shift).is_multiple_of(2) {
                220
            } else {
                0
            }])
        };
        GrayImage::from_fn(128, 64, stripe)
    };
    clouds(0).save(path("0.png")).expect("writes");
    clouds(1).save(path("6.png")).expect("writes");
    std::fs::write(path("12.png"), b"no picture").expect("writes");
    GrayImage::new(64, 32)
        .save(path("small.png"))
        .expect("writes");
    folder
}

fn text(start: &str, more: &str) -> String {
    format!(
        "[time]\nstart = \"{start}\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 10\nlon_deg = 20\nheight_km = 9000\n\
         [earth]\ntextures = \".\"\nnormals = false\nnight_lights = false\nwater = false\n{more}\n\
         [output]\nsize = [{}, {}]\n[sky]\nstars = false\n",
        SIZE.0, SIZE.1
    )
}

const HOURS: &str = "cloud_maps = [{ date = \"2018-06-01T06:00:00Z\", file = \"0.png\" }, { date = \"2018-06-01T12:00:00Z\", file = \"6.png\" }]";

fn flight(folder: &Path, start: &str, more: &str) -> Flight {
    let scene = Scene::from_toml(&text(start, more), &folder.join("scene.toml"));
    Flight::open(scene.expect("a good scene")).expect("opens")
}

/// The pictures of some instants, by one renderer, one after the other.
fn pictures(flight: &Flight, instants: &[&str]) -> Vec<Vec<u8>> {
    let gpu = pollster::block_on(GpuContext::open(None)).expect("an adapter");
    let options = flight.earth_options(gpu.bc_support()).expect("maps");
    let mut renderer = OffscreenRenderer::open(gpu, options, SIZE).expect("a renderer");
    renderer.show_dated_maps(flight).expect("threads");
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    instants
        .iter()
        .map(|instant| {
            let epoch = utc_from_rfc3339(instant).expect("a date");
            let moment = flight.at(epoch, aspect).expect("a moment");
            renderer.draw_complete(&moment, WAIT);
            renderer.read().expect("a picture").into_raw()
        })
        .collect()
}

/// The largest difference, and the mean.
fn apart(a: &[u8], b: &[u8]) -> (u8, f64) {
    let each = || a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let sum: u64 = each().map(u64::from).sum();
    (each().max().unwrap_or(0), sum as f64 / a.len() as f64)
}

#[test]
fn each_instant_has_the_maps_of_its_date() {
    let folder = folder();
    let noon = "2018-06-01T12:00:00Z";
    let instants = [
        "2018-06-01T03:00:00Z",
        "2018-06-01T07:30:00Z",
        "2018-06-01T10:30:00Z",
        noon,
        "2018-06-01T13:00:00Z",
        "2018-06-01T07:30:00Z",
    ];
    let played = pictures(&flight(folder.path(), noon, HOURS), &instants);
    for (instant, played) in instants.iter().zip(&played) {
        // A scene that begins then is drawn with the blend of the maps, computed on the CPU.
        let begun = flight(folder.path(), instant, HOURS);
        let gpu = pollster::block_on(GpuContext::open(None)).expect("an adapter");
        let options = begun.earth_options(gpu.bc_support()).expect("maps");
        let mut renderer = OffscreenRenderer::open(gpu, options, SIZE).expect("a renderer");
        let epoch = utc_from_rfc3339(instant).expect("a date");
        let moment = begun.at(epoch, 96.0 / 54.0).expect("a moment");
        renderer.draw_complete(&moment, WAIT);
        let begun = renderer.read().expect("a picture").into_raw();
        let (most, mean) = apart(played, &begun);
        assert!(most <= 3 && mean < 0.3, "{instant}: {most} {mean}");
    }
    assert!(apart(&played[0], &played[3]).1 > 10.0, "the maps differ");
    assert!(
        apart(&played[1], &played[2]).1 > 4.0,
        "they pass into each other"
    );
    assert!(played[1] == played[5], "back in time it is the same");
    // Without fading, a map stays until the next one's date.
    let hard = format!("{HOURS}\nmap_fade = false");
    let hard = pictures(
        &flight(folder.path(), noon, &hard),
        &["2018-06-01T11:59:59Z", noon],
    );
    let alone = |file: &str| {
        let more =
            format!("cloud_maps = [{{ date = \"2018-01-01T00:00:00Z\", file = \"{file}\" }}]");
        pictures(
            &flight(folder.path(), noon, &more),
            &["2018-06-01T11:59:59Z", noon],
        )
    };
    assert!(hard[0] == alone("0.png")[0] && hard[1] == alone("6.png")[1]);
}

#[test]
fn months_are_those_of_every_year() {
    let folder = folder();
    let name = |month: usize| format!("\"{}\"", if month == 5 { "6.png" } else { "0.png" });
    let names: Vec<_> = (0..12).map(name).collect();
    let more = format!("cloud_maps = [{}]", names.join(", "));
    let flight = flight(folder.path(), "2018-06-16T00:00:00Z", &more);
    let cover = |date: &str| {
        let epoch = utc_from_rfc3339(date).expect("a date");
        let options = flight
            .earth_options_at(epoch, BcSupport::None)
            .expect("maps");
        options.layers.clouds.expect("clouds").levels[0][0]
    };
    let covers = [
        "2018-05-16T12:00:00Z",
        "2018-06-16T00:00:00Z",
        "2030-06-16T00:00:00Z",
        "2018-07-16T12:00:00Z",
    ]
    .map(cover);
    assert_eq!(covers, [220, 0, 0, 220]);
    assert_eq!(cover("2018-05-31T18:00:00Z"), 110);
}

#[test]
fn files_that_are_no_maps_are_named_and_what_is_drawn_stays() {
    let folder = folder();
    let first = "{ date = \"2018-06-01T06:00:00Z\", file = \"0.png\" }";
    let with = |file: &str| {
        format!("cloud_maps = [{first}, {{ date = \"2018-06-01T12:00:00Z\", file = \"{file}\" }}]")
    };
    // At the start it is an error, later a warning.
    let damaged = with("12.png");
    let late = flight(folder.path(), "2018-06-01T12:00:00Z", &damaged);
    let error = late.earth_options(BcSupport::None).expect_err("no picture");
    assert!(error.to_string().contains("12.png"), "{error}");
    let early = flight(folder.path(), "2018-06-01T06:00:00Z", &damaged);
    let drawn = pictures(&early, &["2018-06-01T06:00:00Z", "2018-06-01T09:00:00Z"]);
    let whole = flight(folder.path(), "2018-06-01T06:00:00Z", &with("0.png"));
    assert!(drawn == pictures(&whole, &["2018-06-01T06:00:00Z", "2018-06-01T09:00:00Z"]));
    let unlike = flight(folder.path(), "2018-06-01T09:00:00Z", &with("small.png"));
    let error = unlike
        .earth_options(BcSupport::None)
        .expect_err("unlike")
        .to_string();
    assert!(
        error.contains("small.png") && error.contains("map_fade"),
        "{error}"
    );
    let hard = format!("{}\nmap_fade = false", with("small.png"));
    flight(folder.path(), "2018-06-01T12:00:00Z", &hard)
        .earth_options(BcSupport::None)
        .expect("one at a time");
}

#[test]
fn the_command_draws_and_shows_them() {
    let folder = folder();
    let place = Place::new();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text("2018-06-01T09:00:00Z", HOURS)).expect("writes");
    let scene = scene.to_str().expect("text");
    let shown = place.succeed(&["check", scene]);
    let shown = String::from_utf8_lossy(&shown.stdout);
    assert!(
        shown.contains("cloud_maps") && shown.contains("6.png"),
        "{shown}"
    );
    place.succeed(&["frame", scene, "-o", "a.png"]);
    place.succeed(&["frame", scene, "--renderer", "reference", "-o", "b.png"]);
    let read = |name: &str| {
        image::open(place.path(name))
            .expect("a picture")
            .to_rgb8()
            .into_raw()
    };
    let (_, mean) = apart(&read("a.png"), &read("b.png"));
    assert!(mean < 2.0, "the reference draws the same clouds: {mean}");
}

/// A file that is no map is a warning when its hour comes, and in a strict scene an error before anything is drawn.
#[test]
fn a_strict_scene_looks_at_all_maps_of_its_span_first() {
    let folder = folder();
    let maps = HOURS.replace(
        "]",
        ", { date = \"2018-06-01T18:00:00Z\", file = \"12.png\" }]",
    );
    let gpu = || pollster::block_on(GpuContext::open(None)).expect("an adapter");
    let shown = |duration_s: f64, more: &str| {
        let text = text("2018-06-01T07:00:00Z", &format!("{maps}\n{more}"));
        let scene = Scene::from_toml(&text, &folder.path().join("scene.toml"));
        let mut scene = scene.expect("a good scene");
        scene.time.duration_s = duration_s;
        let flight = Flight::open(scene).expect("opens");
        let gpu = gpu();
        let options = flight.earth_options(gpu.bc_support()).expect("maps");
        let mut renderer = OffscreenRenderer::open(gpu, options, SIZE).expect("a renderer");
        renderer.show_dated_maps(&flight)
    };
    shown(43_200.0, "").expect("reported when it comes");
    let error = shown(43_200.0, "strict = true").expect_err("a file that is no map");
    assert!(error.to_string().contains("12.png"), "{error}");
    shown(3600.0, "strict = true").expect("it is not drawn with that file");
}
