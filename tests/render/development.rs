//! Light that all layers add up and that is developed once.

use crate::common::{self, Rig, day_only, down, map, tilted};
use glam::DVec3;
use image::RgbaImage;
use std::time::Duration;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::offscreen::PictureTextures;
use terrella::{
    Development, Earth, EarthError, EarthOptions, Exposure, EyeView, FrameRequest, FrameTargets,
    Grade, Grain, OffscreenEarth, PassFormat, Response, ScaledTarget, Shading, Sky, Tone,
    exposure_factor,
};

const SIZE: (u32, u32) = (96, 54);
const DAY_EV: f64 = 0.5;
const TWILIGHT_EV: f64 = 6.0;

fn options(ev: f64) -> EarthOptions {
    let day = map(128, |lat, lon| {
        let wave = |angle: f64| (127.5 + 127.5 * angle.to_radians().sin()) as u8;
        [wave(9.0 * lon), wave(7.0 * lat), wave(5.0 * (lat + lon))]
    });
    let mut options = EarthOptions::new(day_only(day));
    options.exposure = Exposure::Ev(ev);
    options.light.airglow = true;
    options.light.night_gain = 200_000.0;
    options.light.night_fades_by_day = false;
    options
}

/// The limb towards a Sun that has set: the air beside the Earth and the airglow, which is behind and before it, are about as bright.
fn twilight() -> (EyeView, Sky) {
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    let place = Geodetic::from_degrees(0.0, 0.0, 4e5);
    let view = tilted(place, 90.0, -20.0, 40.0, aspect);
    (
        view,
        Sky::new(Ellipsoid::normal(0.0, f64::to_radians(120.0))),
    )
}

fn day() -> (EyeView, Sky) {
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    let view = down(Geodetic::from_degrees(10.0, 10.0, 2e6), 30.0, aspect);
    (view, Sky::new(DVec3::new(0.9, 0.4, 0.1).normalize()))
}

fn developed(options: &EarthOptions, (view, sky): &(EyeView, Sky)) -> RgbaImage {
    let gpu = common::gpu().clone();
    let mut earth = OffscreenEarth::new(gpu, options.clone(), SIZE).expect("sound options");
    let mut rgba = vec![0; (4 * SIZE.0 * SIZE.1) as usize];
    earth
        .draw_color(view, sky, Duration::ZERO, &mut rgba)
        .expect("a picture");
    RgbaImage::from_raw(SIZE.0, SIZE.1, rgba).expect("of that size")
}

fn in_pass(options: &EarthOptions, (view, sky): &(EyeView, Sky)) -> RgbaImage {
    let mut rig = Rig::new(options, SIZE);
    rig.draw_complete(view, sky.sun_itrf).0
}

/// Lines of the airglow as a camera records them: mixed with white of their luminance until the darkest channel has 0.3 of the brightest.
fn as_photographed(line: DVec3) -> DVec3 {
    let grey = line.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let share = |white: f64| {
        let mixed = line.lerp(DVec3::splat(grey), white);
        mixed.min_element() - 0.3 * mixed.max_element()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        match share(middle) < 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    line.lerp(DVec3::splat(grey), high)
}

/// Codes of the light itself by the curve's twin on the processor, not rounded.
fn codes(options: &EarthOptions, (view, sky): &(EyeView, Sky)) -> Vec<DVec3> {
    let drawn = |options: &EarthOptions| {
        let texels = Rig::of_light(options, SIZE).draw_light(view, sky.sun_itrf);
        let light =
            |[red, green, blue, _]: [f32; 4]| DVec3::from([red, green, blue].map(f64::from));
        texels.into_iter().map(light).collect::<Vec<_>>()
    };
    let mut without_glow = options.clone();
    without_glow.light.airglow = false;
    let light = drawn(options).into_iter().zip(drawn(&without_glow));
    let Exposure::Ev(ev) = options.exposure else {
        panic!("a fixed exposure");
    };
    let factor = exposure_factor(ev);
    let code = |(all, rest): (DVec3, DVec3)| {
        let glow = (all - rest).max(DVec3::ZERO);
        let shown = options.tone.shown(factor * (rest + as_photographed(glow)));
        shown.map(|value| match value <= 0.003_130_8 {
            true => 255.0 * 12.92 * value,
            false => 255.0 * (1.055 * value.powf(1.0 / 2.4) - 0.055),
        })
    };
    light.map(code).collect()
}

fn furthest(picture: &RgbaImage, codes: &[DVec3]) -> f64 {
    let pixels = picture.pixels().zip(codes);
    let off = pixels.map(|(pixel, code)| {
        let [red, green, blue, _] = pixel.0.map(f64::from);
        (DVec3::new(red, green, blue) - *code).abs().max_element()
    });
    off.fold(0.0, f64::max)
}

#[test]
fn a_picture_is_the_development_of_the_sum_of_its_layers() {
    let responses = include_str!("../data/responses.txt");
    let measured = ["gamma 2.2", "slide"].map(|name| {
        let response = Response::read(responses, Some(name)).expect("a response");
        Tone::Measured(response)
    });
    for tone in Tone::ALL.into_iter().chain(measured) {
        for (view, ev) in [(twilight(), TWILIGHT_EV), (day(), DAY_EV)] {
            let options = EarthOptions {
                tone,
                ..options(ev)
            };
            let off = furthest(&developed(&options, &view), &codes(&options, &view));
            println!("{tone:?}: {off:.2} codes");
            // Half a code of dithering, half of rounding; the air's light is interpolated between vertices within half a code.
            assert!(off < 1.3, "{tone:?}: {off} codes");
        }
    }
    // Layers that are developed one by one are not, or this test could not fail.
    let options = options(TWILIGHT_EV);
    let off = furthest(
        &in_pass(&options, &twilight()),
        &codes(&options, &twilight()),
    );
    println!("in the pass: {off:.2} codes");
    assert!(off > 4.0, "{off}");
}

#[test]
fn both_ways_show_the_same_where_one_layer_stands_alone() {
    let options = options(DAY_EV);
    let (after, before) = (developed(&options, &day()), in_pass(&options, &day()));
    let codes = after.as_raw().iter().zip(before.as_raw());
    let off = codes.map(|(a, b)| a.abs_diff(*b)).max();
    assert!(off <= Some(1), "{off:?}");
}

/// Light that hardly changes along a row changes its code from pixel to pixel all the same.
#[test]
fn faint_light_is_dithered() {
    let picture = developed(&options(TWILIGHT_EV), &twilight());
    let longest_run = |y: u32| {
        let codes: Vec<u8> = (0..SIZE.0).map(|x| picture.get_pixel(x, y)[1]).collect();
        let runs = codes.chunk_by(|a, b| a == b);
        runs.filter(|run| (2..250).contains(&run[0]))
            .map(<[u8]>::len)
            .max()
    };
    let mut runs = Vec::from_iter((0..SIZE.1).filter_map(longest_run));
    runs.sort_unstable();
    println!("{runs:?}");
    // Whole rows would be of one code without it, and rows whose light is just a code's are so with it.
    assert!(runs.len() > 20 && runs[runs.len() / 2] < 12, "{runs:?}");
}

#[test]
fn light_that_is_developed_later_wants_a_float_target_and_sunlight() {
    let gpu = common::gpu();
    let create =
        |options: EarthOptions| terrella::Earth::new(&gpu.device, &gpu.queue, &options).map(|_| ());
    let wrong = EarthOptions {
        development: Development::AfterPass,
        color_format: FrameTargets::COLOR,
        ..options(DAY_EV)
    };
    let error = create(wrong.clone()).expect_err("eight bits hold no light");
    assert!(matches!(error, EarthError::Development { .. }), "{error}");
    assert!(error.to_string().contains("Rgba16Float"), "{error}");
    let float = EarthOptions {
        color_format: ScaledTarget::LIGHT,
        ..wrong
    };
    create(float.clone()).expect("a float target");
    let paper = EarthOptions {
        shading: Shading::Paper,
        ..float.clone()
    };
    create(paper).expect_err("the paper's display values are no light");
    let responses = include_str!("../data/responses.txt");
    let response = Response::read(responses, Some("slide")).expect("a response");
    let measured = |options| EarthOptions {
        tone: Tone::Measured(response),
        ..options
    };
    create(measured(float.clone())).expect("applied after the pass");
    let error = create(measured(options(DAY_EV))).expect_err("no pass applies it");
    assert!(matches!(error, EarthError::Response("slide")), "{error}");
    let graded = |options, strength| EarthOptions {
        grade: Grade {
            white_balance: None,
            grain: Grain {
                strength,
                ..Grain::NONE
            },
        },
        ..options
    };
    create(graded(float.clone(), 0.02)).expect("applied after the pass");
    let error = create(graded(options(DAY_EV), 0.02)).expect_err("no pass applies it");
    assert!(matches!(error, EarthError::GradeInPass), "{error}");
    let error = create(graded(float, 0.08)).expect_err("out of range");
    assert!(error.to_string().contains("grain is 0.08"), "{error}");
}

/// Frames of 1280 × 720 with all maps of the starter pack, at full and at half scale: shown in the pass, developed after it, and with bloom.
/// The ways take turns, and quotients are of frames that follow each other.
#[test]
#[ignore = "measures times: cargo test --test render composition_and_bloom -- --ignored --nocapture"]
fn composition_and_bloom_cost_little() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("textures");
    let layers = terrella::load_layers(&folder, Default::default()).expect("the starter pack");
    let (size, gpu) = ((1280, 720), common::gpu());
    // A sunlit horizon from the space station's height.
    let view = tilted(
        Geodetic::from_degrees(12.0, -95.0, 4e5),
        40.0,
        -30.0,
        60.0,
        16.0 / 9.0,
    );
    let sky = Sky::new(Ellipsoid::normal(0.2, f64::to_radians(-70.0)));
    println!("--- begin csv");
    println!(
        "drawn at,way,\"frame, ms\",\"÷ the way before, median\",quartiles,\"textures of the picture, MB\""
    );
    let mut ratios = Vec::new();
    for drawn_size in [(1280, 720), (640, 360)] {
        let made = |is_developed: bool, strength: f64| {
            let mut options = EarthOptions::new(layers.clone());
            options.color_format = FrameTargets::COLOR;
            if is_developed {
                options.develop_after_pass(FrameTargets::COLOR);
            }
            options.bloom.strength = strength;
            let pass = options.pass_format();
            let textures = PictureTextures::new(gpu, &pass, FrameTargets::COLOR, size, drawn_size);
            let earth = Earth::new(&gpu.device, &gpu.queue, &options);
            (
                earth.expect("sound options"),
                textures.expect("a device with room"),
            )
        };
        let mut ways = [made(false, 0.0), made(true, 0.0), made(true, 0.03)];
        let mut frame_ms = |way: usize| {
            let (earth, textures) = &mut ways[way];
            let begin = std::time::Instant::now();
            earth.prepare(&gpu.queue, FrameRequest::new(&view, &sky, drawn_size));
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            earth.render(&mut textures.begin_pass(&mut encoder));
            textures.finish(&mut encoder, None);
            gpu.queue.submit([encoder.finish()]);
            let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
            waited.expect("the device answers");
            1e3 * begin.elapsed().as_secs_f64()
        };
        let mut rounds: Vec<[f64; 3]> = (0..62).map(|_| [0, 1, 2].map(&mut frame_ms)).collect();
        // The first ones compile.
        rounds.drain(..2);
        let quartiles = |value: &dyn Fn(&[f64; 3]) -> f64| {
            let mut values: Vec<_> = rounds.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            [1, 2, 3].map(|quarter| values[quarter * values.len() / 4])
        };
        let names = ["one pass", "developed once", "with bloom"];
        for (way, name) in names.into_iter().enumerate() {
            let [_, ms, _] = quartiles(&|frame| frame[way]);
            let (earth, _) = &ways[way];
            let mb = 1e-6 * drawn_bytes(&earth.format(), size, drawn_size) as f64;
            let (scale, of_before) = (drawn_size.0 as f64 / size.0 as f64, way.checked_sub(1));
            let (median, spread) = match of_before {
                Some(before) => {
                    let [low, median, high] = quartiles(&|frame| frame[way] / frame[before]);
                    ratios.push((drawn_size, name, median));
                    (format!("{median:.3}"), format!("{low:.2}–{high:.2}"))
                }
                None => ("–".to_owned(), "–".to_owned()),
            };
            println!("{scale} of the size,{name},{ms:.1},{median},{spread},{mb:.1}");
        }
    }
    println!("--- end csv");
    for (drawn_size, way, ratio) in ratios {
        let most = if way == "with bloom" { 1.2 } else { 1.05 };
        // Half the size has a quarter of the frame, and the last pass enlarges it either way.
        if drawn_size == size {
            assert!(ratio < most, "{way}: {ratio}");
        }
    }
}

/// Size of the textures of an 8-bit image without multisampling, bytes: itself, its depth, and the intermediate texture.
fn drawn_bytes(pass: &PassFormat, size: (u32, u32), drawn_size: (u32, u32)) -> u64 {
    let pixels = |(width, height): (u32, u32)| u64::from(width) * u64::from(height);
    let is_developed = pass.development == Development::AfterPass;
    let between = match (is_developed, size == drawn_size) {
        (true, _) => pixels(drawn_size) * (8 + 4),
        (false, true) => 0,
        (false, false) => pixels(drawn_size) * (4 + 4),
    };
    let bloom = if is_developed {
        pass.bloom.texture_bytes(drawn_size)
    } else {
        0
    };
    pixels(size) * (4 + 4) + between + bloom
}
