//! Stills, their numbers, and frames.

use crate::{Place, REPOSITORY, names, png_size};
use std::path::Path;
use terrella::frames::Duration;
use terrella::internals::earth::night_gain_in;
use terrella_play::scene::Scene;
use terrella_play::{Flight, Moment, OffscreenRenderer};

#[test]
fn a_still_has_its_size_and_exactly_the_numbers_of_the_contract() {
    let place = Place::new();
    let at = "2018-03-20T12:00:00Z";
    place.succeed(&[
        "frame",
        "small.toml",
        "-o",
        "a.png",
        "--stats",
        "a.json",
        "--size",
        "80x50",
        "--at",
        at,
    ]);
    assert_eq!(png_size(&place.path("a.png")), (80, 50));
    assert_eq!(place.names(), ["a.json", "a.png", "small.toml"]);
    let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut keys: Vec<_> = stats
        .as_object()
        .expect("a table")
        .keys()
        .cloned()
        .collect();
    keys.sort();
    assert_eq!(
        keys,
        [
            "adapter",
            "backend",
            "blocks_drawn",
            "blocks_visible",
            "draw_calls",
            "epoch",
            "eye",
            "features_off",
            "features_on",
            "frame_ms",
            "prepare_ms",
            "size",
            "sun",
            "texture_bytes",
            "triangles",
        ]
    );
    assert_eq!(stats["size"], serde_json::json!([80, 50]));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    assert!((number(&stats["eye"]["lat_deg"]) - 20.0).abs() < 1e-9);
    assert!((number(&stats["eye"]["lon_deg"]) - 15.0).abs() < 1e-9);
    assert!((number(&stats["eye"]["height_km"]) - 12_000.0).abs() < 1e-6);
    // The day of the equinox, 16:15 UTC: the Sun over the equator, and near 0° E at noon.
    assert!(number(&stats["sun"]["lat_deg"]).abs() < 0.5);
    assert!(number(&stats["sun"]["lon_deg"]).abs() < 4.0);
    assert_eq!(stats["epoch"], "2018-03-20T12:00:00.000Z");
    assert!(number(&stats["frame_ms"]) >= number(&stats["prepare_ms"]));
    let (visible, drawn) = (
        number(&stats["blocks_visible"]),
        number(&stats["blocks_drawn"]),
    );
    assert!(visible >= drawn && drawn > 0.0, "{visible} {drawn}");
    assert_eq!(
        stats["features_on"],
        serde_json::json!([
            "clouds",
            "water",
            "detail",
            "directional_reflectance",
            "eclipses",
            "atmosphere",
            "stars",
            "sun",
            "moon"
        ])
    );
    assert_eq!(
        stats["features_off"],
        serde_json::json!([
            "normals",
            "night_lights",
            "cloud_shadows",
            "moonlight",
            "milky_way",
            "glare"
        ])
    );
}

/// Height, width and values of a NumPy array of 32-bit floats, three to a pixel.
pub fn numpy(path: &Path) -> (usize, usize, Vec<f32>) {
    let bytes = std::fs::read(path).expect("reads");
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!(end % 64, 0);
    let header = std::str::from_utf8(&bytes[10..end]).expect("text");
    assert!(header.contains("'descr': '<f4'") && header.contains("'fortran_order': False"));
    let shape = header.split("'shape': (").nth(1).expect("a shape");
    let numbers = shape.split(')').next().expect("an end").split(',');
    let shape: Vec<usize> = numbers
        .map(|n| n.trim().parse().expect("a number"))
        .collect();
    assert_eq!((shape.len(), shape[2]), (3, 3), "{header}");
    let values = bytes[end..].as_chunks::<4>().0.iter();
    let values: Vec<f32> = values.map(|bytes| f32::from_le_bytes(*bytes)).collect();
    assert_eq!(values.len(), shape[0] * shape[1] * 3);
    (shape[0], shape[1], values)
}

/// A folder of maps: a white sheet round the Earth, and nothing else.
fn white_maps(place: &Place) {
    std::fs::create_dir(place.path("white")).expect("made");
    let white = image::RgbImage::from_pixel(8, 4, image::Rgb([255; 3]));
    white.save(place.path("white/day.png")).expect("writes");
}

#[test]
fn light_is_written_as_an_array_in_which_a_white_sheet_is_one() {
    let place = Place::new();
    white_maps(&place);
    // The Sun over the equator; the eye at the subsolar point.
    let scene = "[camera]\nmode = \"geodetic\"\nlat_deg = 0\nlon_deg = 1.9\nheight_km = 500\nfov_deg = 1\n\
        [time]\nstart = \"2018-03-20T12:00:00Z\"\n\
        [earth]\ntextures = \"white\"\natmosphere = \"none\"\ndirectional_reflectance = false\n[output]\nsize = [30, 20]\nexposure_ev = -7.5\n";
    place.scene("white.toml", scene);
    place.succeed(&["frame", "white.toml", "-o", "a.png", "--radiance", "a.npy"]);
    place.succeed(&["frame", "white.toml", "-o", "b.png", "--radiance", "b.exr"]);
    assert_eq!(
        place.names(),
        [
            "a.npy",
            "a.png",
            "b.exr",
            "b.png",
            "small.toml",
            "white",
            "white.toml"
        ]
    );
    let (height, width, values) = numpy(&place.path("a.npy"));
    assert_eq!((height, width), (20, 30));
    for value in &values {
        assert!((value - 1.0).abs() < 1e-3, "{value}");
    }
    // The last channel of the last row, R, comes last.
    let exr = std::fs::read(place.path("b.exr")).expect("reads");
    assert_eq!(exr[..4], [0x76, 0x2f, 0x31, 0x01]);
    let last = exr[exr.len() - 4..].try_into().expect("four bytes");
    assert_eq!(f32::from_le_bytes(last), values[values.len() - 3]);
}

#[test]
fn light_is_rejected_where_it_cannot_be_written() {
    let place = Place::new();
    let frame = |radiance: &str, code, more: &[&str]| {
        let mut arguments = vec!["frame", "small.toml", "-o", "a.png", "--radiance", radiance];
        arguments.extend(more);
        place.fail(code, &arguments)
    };
    for name in ["a.png", "a.tiff", "a"] {
        let words = frame(name, 1, &[]);
        assert!(words.contains(".npy") && words.contains(".exr"), "{words}");
    }
    assert!(frame("small.toml/a.npy", 1, &[]).contains("a file of that name"));
    let words = frame("a.npy", 2, &["--renderer", "reference"]);
    assert!(words.contains("--radiance"), "{words}");
    assert_eq!(place.names(), ["small.toml"]);
}

#[test]
fn missing_folders_of_files_are_made() {
    let place = Place::new();
    place.succeed(&["frame", "small.toml", "-o", "new/deep/a.png"]);
    assert_eq!(names(&place.path("new/deep")), ["a.png"]);
    let video = ["play", "small.toml", "--video", "films/a.mp4"];
    place.succeed(&[&video[..], &["--encoder", "builtin"]].concat());
    assert_eq!(names(&place.path("films")), ["a.mp4"]);
}

#[test]
fn a_map_that_is_not_there_is_left_out_and_reported() {
    let place = Place::new();
    white_maps(&place);
    place.scene("loose.toml", "[earth]\ntextures = \"white\"\n");
    place.scene(
        "strict.toml",
        "[earth]\ntextures = \"white\"\nstrict = true\n",
    );
    let checked = place.succeed(&["check", "loose.toml"]);
    let checked = String::from_utf8_lossy(&checked.stdout).into_owned();
    let reported = checked
        .split("missing, so left out")
        .nth(1)
        .expect("reported");
    assert!(
        reported.contains("clouds") && reported.contains("night_lights.png"),
        "{reported}"
    );
    let drawn = place.succeed(&[
        "frame",
        "loose.toml",
        "-o",
        "a.png",
        "--stats",
        "a.json",
        "--size",
        "64x36",
    ]);
    let warned = String::from_utf8_lossy(&drawn.stderr).into_owned();
    assert!(warned.contains("clouds.png is missing"), "{warned}");
    let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let missing = stats["layers_missing"].as_array().expect("a list");
    assert!(missing.contains(&"clouds".into()), "{missing:?}");
    for arguments in [
        &["check", "strict.toml"][..],
        &["frame", "strict.toml", "-o", "b.png"],
    ] {
        let words = place.fail(2, arguments);
        assert!(
            words.contains("strict") && words.contains("clouds"),
            "{words}"
        );
    }
}

#[test]
fn a_metered_exposure_is_reported_and_the_same_each_time() {
    let place = Place::new();
    let scene = crate::SMALL.replace("[output]", "[output]\nexposure_ev = \"auto\"");
    place.scene("auto.toml", &scene);
    let frame = |name: &str| {
        let (png, json) = (format!("{name}.png"), format!("{name}.json"));
        place.succeed(&["frame", "auto.toml", "-o", &png, "--stats", &json]);
        let text = std::fs::read_to_string(place.path(&json)).expect("reads");
        let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let ev = stats["exposure_ev"].as_f64().expect("reported");
        (std::fs::read(place.path(&png)).expect("reads"), ev)
    };
    let (picture, ev) = frame("a");
    assert!((-4.0..=5.0).contains(&ev), "{ev}");
    assert!((picture, ev) == frame("b"));
}

#[test]
fn the_minimal_scene_pays_for_the_day_map_alone() {
    let place = Place::new();
    let scenes = Path::new(crate::REPOSITORY).join("config");
    let stats = |name: &str| -> serde_json::Value {
        let scene = scenes.join(name).with_extension("toml");
        let scene = scene.to_str().expect("UTF-8");
        place.succeed(&[
            "frame", scene, "-o", "a.png", "--stats", "a.json", "--size", "64x36",
        ]);
        let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
        serde_json::from_str(&text).expect("JSON")
    };
    let (minimal, iss) = (stats("minimal"), stats("iss"));
    let maps = ["clouds", "normals", "night_lights", "water"];
    let effects = [
        "cloud_shadows",
        "detail",
        "directional_reflectance",
        "moonlight",
    ];
    let eclipses = ["eclipses"];
    let air = ["atmosphere"];
    let whole_sky = ["stars", "milky_way", "sun", "moon", "glare"];
    let all = [&maps[..], &effects, &eclipses, &air, &whole_sky].concat();
    assert_eq!(minimal["features_on"], serde_json::json!([]));
    assert_eq!(minimal["features_off"], serde_json::json!(all));
    // The shipped scene has the full look.
    assert_eq!(iss["features_on"], serde_json::json!(all));
    assert_eq!(iss["features_off"], serde_json::json!([]));
    // The day map's levels, four bytes a texel, and not one byte more.
    let width = u64::from(crate::DAY_WIDTH);
    let day: u64 = (0..=width.ilog2())
        .map(|level| 4 * (width >> level).max(1) * ((width / 2) >> level).max(1))
        .sum();
    assert_eq!(minimal["texture_bytes"], day);
    assert!(iss["texture_bytes"].as_u64().expect("bytes") > day + 4_000_000);
}

#[test]
fn the_same_still_twice_is_the_same_file() {
    let place = Place::new();
    place.succeed(&["frame", "small.toml", "-o", "a.png"]);
    place.succeed(&["frame", "small.toml", "-o", "b.png"]);
    let read = |name| std::fs::read(place.path(name)).expect("reads");
    assert_eq!(read("a.png"), read("b.png"));
    // Not a black picture.
    let picture = image::open(place.path("a.png")).expect("opens").to_rgb8();
    assert!(picture.pixels().any(|pixel| pixel[2] > 60));
}

#[test]
fn frames_are_numbered_whole_and_not_mixed_with_others() {
    let place = Place::new();
    let arguments = ["play", "small.toml", "--frames", "out/frames"];
    place.succeed(&arguments);
    let frames = place.path("out/frames");
    let expected = [
        "frame_00000.png",
        "frame_00001.png",
        "frame_00002.png",
        "frame_00003.png",
        "frames.json",
    ];
    assert_eq!(names(&frames), expected);
    for name in &expected[..4] {
        assert_eq!(png_size(&frames.join(name)), (64, 36));
    }
    let words = place.fail(1, &arguments);
    assert!(words.contains("--overwrite"), "{words}");
    place.succeed(&[&arguments[..], &["--overwrite"]].concat());
    assert_eq!(names(&frames), expected);
}

/// A scene of the built-in space station with a small picture.
fn station(mode: &str, samples: u32) -> String {
    format!(
        "[time]\nstart = \"2018-01-15T12:00:00Z\"\n[camera]\nmode = \"{mode}\"\n\
         [earth]\nclouds = false\nnormals = false\nnight_lights = false\n\
         [output]\nsize = [96, 54]\nsamples = {samples}\ntone = \"neutral\"\n"
    )
}

/// A revolution of it, a moment each minute. It begins in the Earth's shadow.
fn revolution(flight: &Flight) -> Vec<(Moment, f64)> {
    let start = flight.scene().time.start;
    (0..93)
        .map(|minute| start + Duration::from_seconds(f64::from(60 * minute)))
        .map(|epoch| flight.at(epoch, 96.0 / 54.0).expect("a moment"))
        .map(|moment| (moment, moment.craft.expect("a craft to chase").sunlight))
        .collect()
}

#[test]
fn a_chase_picture_has_the_craft_in_its_middle_lit_from_the_right_side() {
    for samples in [1, 4] {
        let scene = Scene::from_toml(&station("chase", samples), Path::new("a.toml"));
        let flight = Flight::open(scene.expect("a scene")).expect("opens");
        let gpu = pollster::block_on(terrella::internals::gpu::GpuContext::open(None))
            .expect("an adapter");
        let options = flight.earth_options(gpu.bc_support()).expect("maps");
        let mut picture = OffscreenRenderer::open(gpu, options, (96, 54)).expect("an adapter");
        // The same moment with and without the craft: where they differ is the craft.
        let mut brightness = |moment: &Moment| {
            let with = picture.draw(moment);
            let seen = picture.read().expect("reads");
            let without = picture.draw(&Moment {
                craft: None,
                ..*moment
            });
            let bare = picture.read().expect("reads");
            assert_eq!(with.draw_calls, without.draw_calls + 1);
            assert!(with.triangles > without.triangles + 100);
            let craft: Vec<_> = seen
                .enumerate_pixels()
                .filter(|(x, y, pixel)| *pixel != bare.get_pixel(*x, *y))
                .collect();
            assert!(craft.len() > 100, "{samples}: {} pixels", craft.len());
            for (x, y, _) in &craft {
                assert!((15..81).contains(x) && (15..39).contains(y), "{x} {y}");
            }
            let middle = craft.iter().any(|(x, y, _)| (*x, *y) == (48, 27));
            assert!(middle, "{samples}: nothing in the middle");
            let light = craft.iter().map(|(.., pixel)| f64::from(pixel[1]));
            light.sum::<f64>() / craft.len() as f64
        };
        // The craft is seen from behind: dark against the rising Sun, bright before the Sun sets behind the eye.
        let moments = revolution(&flight);
        let lit = |(_, light): &&(Moment, f64)| *light == 1.0;
        let sunrise = moments.iter().find(lit).expect("a day");
        let sunset = moments.iter().rev().find(lit).expect("a day");
        let night = &moments[0];
        assert_eq!(night.1, 0.0, "the revolution begins in shadow");
        let [sunrise, sunset, night] = [sunrise, sunset, night].map(|(m, _)| brightness(m));
        assert!(
            sunset > 80.0 && sunrise < 30.0 && night < 15.0,
            "{samples}: {sunset} {sunrise} {night}"
        );
    }
}

#[test]
fn only_a_chase_draws_the_craft() {
    let place = Place::new();
    for (mode, crafts) in [("nadir", 0), ("horizon", 0), ("chase", 1)] {
        let no_sky = "[sky]\nstars = false\nsun = false\nmoon = false\n";
        place.scene("station.toml", &(station(mode, 1) + no_sky));
        place.succeed(&["frame", "station.toml", "-o", "a.png", "--stats", "a.json"]);
        let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
        let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let number = |key: &str| stats[key].as_u64().expect("a number");
        // One for each block, one for the air.
        assert_eq!(
            number("draw_calls"),
            number("blocks_drawn") + 1 + crafts,
            "{mode}"
        );
    }
}

/// The demo's ground has black and white in it, and no star shines beside it: neither a picture without stars differs.
#[test]
fn the_demo_has_the_contrast_of_a_photograph_and_no_star_beside_the_earth() {
    let place = Place::new();
    let demo = format!("{REPOSITORY}/config/iss.toml");
    let frame = |name: &str, more: &[&str]| {
        let ask = ["frame", &demo, "-o", name, "--size", "320x180"];
        place.succeed(&[&ask[..], more].concat());
        image::open(place.path(name)).expect("a PNG").to_rgb8()
    };
    let shown = frame("a.png", &["--truth", "truth"]);
    let starless = ["--set", "sky.stars=false", "--set", "sky.milky_way=false"];
    let starless = frame("b.png", &starless);
    let codes = shown.as_raw().iter().zip(starless.as_raw());
    let star = codes.map(|(a, b)| a.abs_diff(*b)).max();
    // Behind the header of the array, 64-bit floats.
    let lat = std::fs::read(place.path("truth/lat_deg.npy")).expect("reads");
    let lat = &lat[lat.len() - 8 * 320 * 180..];
    let is_ground = lat.as_chunks::<8>().0.iter();
    let is_ground = is_ground.map(|bytes| f64::from_le_bytes(*bytes).is_finite());
    let ground = shown.pixels().zip(is_ground).filter(|(_, is)| *is);
    let percentile = |value: fn([f64; 3]) -> f64, part: f64| {
        let mut values: Vec<f64> = ground
            .clone()
            .map(|(pixel, _)| value(pixel.0.map(f64::from)))
            .collect();
        values.sort_by(f64::total_cmp);
        values[(part * values.len() as f64) as usize]
    };
    let luma = |[red, green, blue]: [f64; 3]| 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let brightest = |code: [f64; 3]| code.into_iter().fold(0.0, f64::max);
    let (dark, bright) = (percentile(luma, 0.01), percentile(brightest, 0.99));
    println!("ground from {dark:.1} to {bright:.1} of 255, stars {star:?}");
    assert!(dark < 30.0 && bright > 235.0, "{dark} {bright}");
    assert!(star <= Some(2), "{star:?}");
}

/// The veil about the Sun has no steps: its code changes from pixel to pixel.
#[test]
fn the_suns_veil_is_dithered() {
    let place = Place::new();
    let scene = "[time]\nstart = \"2018-03-20T00:40:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = -20\nlon_deg = 66\nheight_km = 410\n\
                 heading_deg = 100\npitch_deg = -20\nfov_deg = 40\n[sky]\nstars = false\nglare = true\n[output]\nsize = [320, 180]\nsamples = 1\nexposure_ev = 1\n";
    place.scene("sun.toml", scene);
    place.succeed(&["frame", "sun.toml", "-o", "a.png"]);
    let picture = image::open(place.path("a.png")).expect("a PNG").to_rgb8();
    // Above the limb.
    let rows = (0..60).map(|y| (0..320).map(|x| picture.get_pixel(x, y)[1]).collect());
    let rows: Vec<Vec<u8>> = rows.collect();
    let runs = rows.iter().flat_map(|row| row.chunk_by(|a, b| a == b));
    let mut runs: Vec<_> = runs
        .filter(|run| (2..250).contains(&run[0]))
        .map(<[u8]>::len)
        .collect();
    runs.sort_unstable();
    let (median, longest) = (runs[runs.len() / 2], runs[runs.len() - 1]);
    println!(
        "{} runs, half of them of {median}, the longest of {longest} pixels",
        runs.len()
    );
    assert!(
        runs.len() > 1000 && median <= 2 && longest <= 24,
        "{median} {longest}"
    );
}

/// By the rule of thumb a sheet in the Sun takes 1/100 s at f/16. At 1/4000 s the Sun's disc alone is white, and what the lens scatters about
/// it is little, with the spikes of an aperture too.
#[test]
fn the_suns_core_is_small_at_a_4000th_of_a_second() {
    let place = Place::new();
    let exposure_ev = (100.0_f64 / 4000.0).log2();
    for (lens, most_bright) in [("", 0.02), ("[lens]\nblades = 6\nf_number = 16\n", 0.04)] {
        let scene = format!(
            "[time]\nstart = \"2018-03-20T03:40:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = -20\nlon_deg = 66\nheight_km = 410\n\
             look_at = \"sun\"\nfov_deg = 10\n[sky]\nstars = false\nglare = true\n{lens}[output]\nsize = [640, 360]\nsamples = 1\nbloom = 0.03\n\
             exposure_ev = {exposure_ev}\n"
        );
        place.scene("sun.toml", &scene);
        place.succeed(&["frame", "sun.toml", "-o", "a.png"]);
        let picture = image::open(place.path("a.png")).expect("a PNG").to_rgb8();
        let count = |is: &dyn Fn([u8; 3]) -> bool| picture.pixels().filter(|p| is(p.0)).count();
        let white = count(&|code| code.into_iter().min() >= Some(250)) as f64;
        let bright = count(&|code| code.into_iter().max() >= Some(20)) as f64 / (640.0 * 360.0);
        let across = 2.0 * (white / std::f64::consts::PI).sqrt();
        // The Sun is 0.535° wide on that day, and a pixel at the axis tan 5° / 180.
        let disc = 0.535_f64.to_radians() / (5.0_f64.to_radians().tan() / 180.0);
        println!("white: {across:.1} pixels, disc {disc:.1}; {bright:.4} brighter than 20");
        assert!((0.9..1.25).contains(&(across / disc)), "{across} {disc}");
        assert!(bright < most_bright, "{bright}");
    }
}

/// From day into night and into sunrise at 24 frames a second and 30 times real time, metered as a film is and not drawn: the exposure
/// changes slowly, and one way at a time.
#[test]
fn the_exposure_of_a_film_neither_jumps_nor_pumps() {
    let orbit = format!("file = \"{REPOSITORY}/config/orbits/iss.tle\"");
    let film = |start: &str| {
        let text = format!(
            "[time]\nstart = \"{start}\"\nduration_s = 600\nspeed = 30\nframe_rate_hz = 24\n[orbit]\n{orbit}\n[camera]\nmode = \"horizon\"\n\
             fov_deg = 60\n[earth]\nlook = \"full\"\n[output]\nexposure_ev = \"auto\"\n"
        );
        let scene = Scene::from_toml(&text, Path::new("a.toml")).expect("a scene");
        let time = scene.time.clone();
        let flight = Flight::open(scene).expect("opens");
        let gpu = terrella::internals::gpu::GpuContext::open(None);
        let gpu = pollster::block_on(gpu).expect("an adapter");
        let options = flight.earth_options(gpu.bc_support()).expect("maps");
        let size = (32, 18);
        let mut renderer = OffscreenRenderer::open(gpu, options.clone(), size).expect("opens");
        let request = terrella_play::ViewRequest {
            mode: flight.scene().camera.mode,
            look: Default::default(),
            aspect: renderer.aspect(),
        };
        let frames = (0..time.frame_count()).map(|index| {
            let epoch = terrella_play::clock::frame_epoch(&time, index);
            let moment = flight.view_at(epoch, &request).expect("a moment");
            let ev = renderer.follow_light(&moment, 1.0 / time.frame_rate_hz);
            let gain = night_gain_in(&options, &moment.view, &moment.sky);
            let ev = ev.expect("in its range").expect("it is metered");
            (ev, gain.expect("a picture").log2())
        });
        frames.collect::<(Vec<f64>, Vec<f64>)>()
    };
    for (name, start) in [
        ("into night", "2018-01-14T13:45:00Z"),
        ("into sunrise", "2018-01-14T14:32:00Z"),
    ] {
        let (evs, gains) = film(start);
        // The gain of the lights of the night goes one way, over whole seconds of the film.
        let rises = name == "into night";
        let steps = gains.windows(2).map(|pair| match rises {
            true => pair[1] - pair[0],
            false => pair[0] - pair[1],
        });
        let steps = Vec::from_iter(steps);
        let [fewest, most_gain] =
            [f64::min, f64::max].map(|of| steps.iter().copied().reduce(of).expect("frames"));
        let (first, last) = (gains[0], gains[gains.len() - 1]);
        println!(
            "{name}: gains of 2^{first:.1} to 2^{last:.1}, {fewest:.2} to {most_gain:.2} a frame"
        );
        assert!((first - last).abs() > 10.0, "{name}: {first} {last}");
        assert!(
            fewest > -0.2 && most_gain < 1.0,
            "{name}: {fewest} {most_gain}"
        );
        let steps: Vec<_> = evs.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let most = steps
            .iter()
            .fold(0.0_f64, |most, step| most.max(step.abs()));
        // Turns after a change of a tenth of a value.
        let (mut turns, mut extreme, mut rises) = (0, evs[0], None);
        for ev in &evs {
            match rises {
                Some(true) if *ev > extreme => extreme = *ev,
                Some(false) if *ev < extreme => extreme = *ev,
                _ if (ev - extreme).abs() > 0.1 => {
                    turns += usize::from(rises.is_some());
                    (rises, extreme) = (Some(*ev > extreme), *ev);
                }
                _ => {}
            }
        }
        let (least, greatest) = evs
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), ev| (a.min(*ev), b.max(*ev)));
        println!(
            "{name}: {least:.2} to {greatest:.2} EV, {most:.3} a frame at most, {turns} turns"
        );
        assert!(most < 0.15, "{name}: {most}");
        assert!(turns <= 4, "{name}: {turns}");
        assert!(greatest - least > 1.0, "{name}: something changes");
    }
}
