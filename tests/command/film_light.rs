//! Film images made of light: formats, alpha, supersampling, motion blur.

use crate::{Place, REPOSITORY, SMALL, names};
use image::DynamicImage;
use std::path::Path;

/// Channels of an OpenEXR picture of ours, in the order of their names, and their floats line by line: width and pixels.
fn exr(path: &Path, channels: usize, (width, height): (usize, usize)) -> Vec<Vec<f32>> {
    let bytes = std::fs::read(path).expect("reads");
    assert_eq!(bytes[..4], [0x76, 0x2f, 0x31, 0x01]);
    let line = 8 + 4 * width * channels;
    let data = &bytes[bytes.len() - line * height..];
    let mut pixels = vec![Vec::new(); width * height];
    for (y, line) in data.chunks_exact(line).enumerate() {
        assert_eq!(line[..4], (y as u32).to_le_bytes());
        let floats = line[8..].as_chunks::<4>().0.iter();
        for (n, bytes) in floats.enumerate() {
            pixels[y * width + n % width].push(f32::from_le_bytes(*bytes));
        }
    }
    pixels
}

fn largest_difference(a: &[Vec<f32>], b: &[Vec<f32>]) -> f32 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn open(path: &Path) -> DynamicImage {
    image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Light that the processor exposes and encodes is what the adapter shows.
#[test]
fn sixteen_bits_are_the_eight_that_a_screen_gets() {
    let place = Place::new();
    place.succeed(&["frame", "small.toml", "-o", "a.png"]);
    place.succeed(&["frame", "small.toml", "-o", "b.png", "--format", "png16"]);
    place.succeed(&[
        "frame",
        "small.toml",
        "-o",
        "c.png",
        "--shutter",
        "1e-9",
        "--subframes",
        "1",
    ]);
    let (eight, sixteen) = (open(&place.path("a.png")), open(&place.path("b.png")));
    assert_eq!(sixteen.color(), image::ColorType::Rgb16);
    let (eight, sixteen) = (eight.to_rgb8(), sixteen.to_rgb16());
    let developed = open(&place.path("c.png")).to_rgb8();
    let mut brightest = 0;
    for ((a, b), c) in eight.pixels().zip(sixteen.pixels()).zip(developed.pixels()) {
        for ((a, b), c) in a.0.iter().zip(b.0).zip(c.0) {
            brightest = brightest.max(*a);
            // Half a step of dithering, half of rounding; where stars are, more.
            let fine = f64::from(b) / 257.0;
            assert!((f64::from(*a) - fine).abs() < 1.6, "{a} {fine}");
            assert!(a.abs_diff(c) <= 1, "{a} {c}: dithered alike");
        }
    }
    assert!(brightest > 100, "not a black picture");
}

/// The processor scatters light as the adapter does.
#[test]
fn bloom_of_a_film_is_that_of_a_picture() {
    let place = Place::new();
    let frame = |name: &str, more: &[&str]| {
        place.succeed(&[&["frame", "small.toml", "-o", name], more].concat());
        open(&place.path(name)).to_rgb8()
    };
    let wide = ["--set", "output.bloom=0.4"];
    let sharp = frame("sharp.png", &[]);
    let adapter = frame("adapter.png", &wide);
    let open_shutter = ["--shutter", "1e-9", "--subframes", "1"];
    let processor = frame("processor.png", &[&wide[..], &open_shutter].concat());
    let farthest = |a: &image::RgbImage, b: &image::RgbImage| {
        let pairs = a.as_raw().iter().zip(b.as_raw());
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default()
    };
    let scattered = farthest(&sharp, &adapter);
    assert!(scattered > 4, "it is seen: {scattered} codes");
    // Of 11 bits a channel between, which are mixed again and again.
    let apart = farthest(&adapter, &processor);
    assert!(apart <= 2, "{apart} codes");
    // Light itself is not what a lens makes of it.
    place.succeed(&["frame", "small.toml", "-o", "a.exr", "--format", "exr"]);
    place.succeed(
        &[
            &["frame", "small.toml", "-o", "b.exr", "--format", "exr"],
            &wide[..],
        ]
        .concat(),
    );
    let [a, b] = ["a.exr", "b.exr"].map(|name| std::fs::read(place.path(name)).expect("reads"));
    assert!(a == b, "EXR is light before the lens");
}

/// The processor develops light as the adapter does, and light itself is not developed.
#[test]
fn development_of_a_film_is_that_of_a_picture() {
    let place = Place::new();
    let responses = Path::new(REPOSITORY).join("tests/data/responses.txt");
    let responses = responses.to_str().expect("unicode");
    let gamma = format!("output.tone={{ file = {responses:?}, name = \"gamma 2.2\" }}");
    let slide = format!("output.tone={{ file = {responses:?}, name = \"slide\" }}");
    let frame = |name: &str, more: &[&str]| {
        place.succeed(&[&["frame", "small.toml", "-o", name], more].concat());
        open(&place.path(name)).to_rgb8()
    };
    let plain = frame("plain.png", &[]);
    let farthest = |a: &image::RgbImage, b: &image::RgbImage| {
        let pairs = a.as_raw().iter().zip(b.as_raw());
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default()
    };
    let exr = |name: &str, more: &[&str]| {
        let float = ["frame", "small.toml", "-o", name, "--format", "exr"];
        place.succeed(&[&float, more].concat());
        std::fs::read(place.path(name)).expect("reads")
    };
    let light = exr("light.exr", &[]);
    let open_shutter = ["--shutter", "1e-9", "--subframes", "1"];
    let grained = "output.grain=0.07".to_owned();
    let balanced = "output.white_balance_k=3200".to_owned();
    for set in [gamma, slide, grained, balanced] {
        let set = ["--set", set.as_str()];
        let adapter = frame("adapter.png", &set);
        let processor = frame("processor.png", &[&set[..], &open_shutter].concat());
        let seen = farthest(&plain, &adapter);
        assert!(seen > 8, "{set:?} is seen: {seen} codes");
        let apart = farthest(&adapter, &processor);
        println!("{set:?}: {apart} codes apart, {seen} from the default");
        assert!(apart <= 1, "{set:?}: {apart} codes");
        assert!(
            exr("set.exr", &set) == light,
            "{set:?}: EXR is light itself"
        );
    }
}

const GRADED: [&str; 4] = [
    "--set",
    "output.grain=0.07",
    "--set",
    "output.white_balance_k=3200",
];

#[test]
fn radiance_and_truth_have_no_white_balance_and_no_grain() {
    let place = Place::new();
    let draw = |folder: &str, more: &[&str]| {
        let (npy, png) = (format!("{folder}.npy"), format!("{folder}.png"));
        let ask = [
            "frame",
            "small.toml",
            "-o",
            &png,
            "--radiance",
            &npy,
            "--truth",
            folder,
        ];
        place.succeed(&[&ask[..], more].concat());
    };
    draw("plain", &[]);
    draw("graded", &GRADED);
    let read = |name: String| std::fs::read(place.path(&name)).expect("reads");
    assert!(read("plain.npy".into()) == read("graded.npy".into()));
    assert!(read("plain.png".into()) != read("graded.png".into()));
    let layers = names(&place.path("plain"));
    let arrays: Vec<_> = layers
        .iter()
        .filter(|name| name.ends_with(".npy"))
        .collect();
    assert!(arrays.len() > 4, "{layers:?}");
    for name in arrays {
        assert!(
            read(format!("plain/{name}")) == read(format!("graded/{name}")),
            "{name}"
        );
    }
}

/// The same in each run, different in each frame, and equal to that of an image at the same time.
#[test]
fn grain_is_that_of_the_frame() {
    let place = Place::new();
    let film = |folder: &str, more: &[&str]| {
        let ask = ["play", "small.toml", "--frames", folder, "--range", "0..2"];
        place.succeed(&[&ask[..], more].concat());
        [0, 1].map(|n| open(&place.path(&format!("{folder}/frame_0000{n}.png"))).to_rgb8())
    };
    let grain = [
        "--set",
        "output.grain=0.07",
        "--set",
        "output.grain_size_px=2",
    ];
    let (plain, first, again) = (
        film("plain", &[]),
        film("first", &grain),
        film("again", &grain),
    );
    assert!(first == again, "a function of pixel, seed and frame");
    let differences = |a: &image::RgbImage, b: &image::RgbImage| {
        let pairs = a.as_raw().iter().zip(b.as_raw());
        pairs.filter(|(a, b)| a.abs_diff(**b) > 5).count()
    };
    let [moved, regrained] = [&plain, &first].map(|[a, b]| differences(a, b));
    assert!(regrained > 10 * moved + 100, "{regrained} {moved}");
    place.succeed(&[&["frame", "small.toml", "-o", "one.png"], &grain[..]].concat());
    assert!(open(&place.path("one.png")).to_rgb8() == first[0]);
    let seeded = [&grain[..], &["--set", "output.grain_seed=1"]].concat();
    assert!(differences(&film("seeded", &seeded)[0], &first[0]) > 100);
}

/// N × N pixels for one are the mean of the light of a picture N times as large.
#[test]
fn many_pixels_for_one_are_the_mean_of_their_light() {
    let place = Place::new();
    let frame = |name: &str, more: &[&str]| {
        place.succeed(
            &[
                &["frame", "small.toml", "-o", name, "--format", "exr"],
                more,
            ]
            .concat(),
        );
    };
    for (side, size) in [(2, "128x72"), (4, "256x144")] {
        frame("one.exr", &["--supersample", &side.to_string()]);
        frame("large.exr", &["--size", size]);
        let one = exr(&place.path("one.exr"), 3, (64, 36));
        let large = exr(&place.path("large.exr"), 3, (64 * side, 36 * side));
        let mut mean = vec![vec![0.0; 3]; 64 * 36];
        for (n, pixel) in large.iter().enumerate() {
            let (x, y) = (n % (64 * side) / side, n / (64 * side) / side);
            for (sum, value) in mean[y * 64 + x].iter_mut().zip(pixel) {
                *sum += value / (side * side) as f32;
            }
        }
        let off = largest_difference(&one, &mean);
        assert!(off < 1e-5, "{side}: {off}");
    }
    // One sample a pixel gives another image.
    frame("plain.exr", &[]);
    let one = exr(&place.path("one.exr"), 3, (64, 36));
    assert!(largest_difference(&one, &exr(&place.path("plain.exr"), 3, (64, 36))) > 0.01);
}

/// Two instants of an open shutter are the mean of two frames of a film of four times the rate.
#[test]
fn an_open_shutter_gathers_the_light_of_its_instants() {
    let place = Place::new();
    let fast = SMALL
        .replace("duration_s = 4", "duration_s = 2000")
        .replace("speed = 10", "speed = 10000");
    place.scene("slow.toml", &fast);
    place.scene(
        "fast.toml",
        &fast.replace("frame_rate_hz = 10", "frame_rate_hz = 40"),
    );
    let exr_of = |path: &str| exr(&place.path(path), 3, (64, 36));
    let play = |scene: &str, folder: &str, more: &[&str]| {
        let common = ["play", scene, "--frames", folder, "--format", "exr"];
        place.succeed(&[&common[..], more].concat());
    };
    play(
        "slow.toml",
        "blurred",
        &["--shutter", "1", "--subframes", "2"],
    );
    play("fast.toml", "sharp", &[]);
    let (a, b) = (
        exr_of("sharp/frame_00001.exr"),
        exr_of("sharp/frame_00003.exr"),
    );
    let mean: Vec<Vec<f32>> = a
        .iter()
        .zip(&b)
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect())
        .collect();
    let blurred = exr_of("blurred/frame_00000.exr");
    assert!(largest_difference(&blurred, &mean) < 1e-6);
    assert!(largest_difference(&blurred, &a) > 0.01, "something moves");
    let page = crate::films::page(&place.path("blurred"));
    let frame = &page["frames"][1];
    assert_eq!(
        frame["shutter_ns"],
        serde_json::json!([1_000_000_000_000_i64, 2_000_000_000_000_i64])
    );
    assert_eq!(page["film"]["pictures"]["shutter"]["subframes"], 2);
}

/// In a static view, an open shutter changes nothing.
#[test]
fn what_stands_still_is_not_blurred() {
    let place = Place::new();
    // Ten nanoseconds from frame to frame.
    let still = SMALL
        .replace("duration_s = 4", "duration_s = 4e-8")
        .replace("speed = 10", "speed = 1e-7");
    place.scene("still.toml", &still);
    let play = |folder: &str, more: &[&str]| {
        let common = [
            "play",
            "still.toml",
            "--frames",
            folder,
            "--format",
            "exr",
            "--range",
            "0..1",
        ];
        place.succeed(&[&common[..], more].concat());
        std::fs::read(place.path(folder).join("frame_00000.exr")).expect("reads")
    };
    let sharp = play("sharp", &[]);
    assert!(sharp == play("blurred", &["--shutter", "0.5", "--subframes", "7"]));
}

#[test]
fn space_is_transparent_with_alpha() {
    let place = Place::new();
    place.succeed(&[
        "frame",
        "small.toml",
        "-o",
        "a.png",
        "--format",
        "png16",
        "--alpha",
    ]);
    place.succeed(&[
        "frame",
        "small.toml",
        "-o",
        "b.exr",
        "--format",
        "exr",
        "--alpha",
    ]);
    place.succeed(&[
        "play",
        "small.toml",
        "--frames",
        "c",
        "--alpha",
        "--range",
        "0..1",
    ]);
    assert_eq!(names(&place.path("c")), ["frame_00000.png", "frames.json"]);
    let eight = open(&place.path("c/frame_00000.png"));
    assert_eq!(eight.color(), image::ColorType::Rgba8);
    let (eight, sixteen) = (eight.to_rgba8(), open(&place.path("a.png")).to_rgba16());
    let light = exr(&place.path("b.exr"), 4, (64, 36));
    let at = |x: u32, y: u32| {
        (
            eight.get_pixel(x, y)[3],
            sixteen.get_pixel(x, y)[3],
            light[(y * 64 + x) as usize][0],
        )
    };
    assert_eq!(at(0, 0), (0, 0, 0.0), "space");
    assert_eq!(at(32, 18), (255, 65535, 1.0), "ground");
    // The halo hides a part.
    assert!(light.iter().any(|pixel| pixel[0] > 0.01 && pixel[0] < 0.9));
    // Light does not change by it: premultiplied, over black.
    place.scene(
        "dark.toml",
        &format!("{SMALL}[sky]\nstars = false\nsun = false\nmoon = false\n"),
    );
    place.succeed(&["frame", "dark.toml", "-o", "d.exr", "--format", "exr"]);
    let opaque = exr(&place.path("d.exr"), 3, (64, 36));
    let light: Vec<_> = light.iter().map(|pixel| pixel[1..].to_vec()).collect();
    assert!(largest_difference(&light, &opaque) < 1e-6);
}

#[test]
fn films_of_light_are_rejected_where_there_is_none() {
    let place = Place::new();
    let frames = |scene: &str, more: &[&str]| {
        place.fail(2, &[&["play", scene, "--frames", "a"], more].concat())
    };
    place.scene(
        "tracks.toml",
        "[tracks]\ntrail = true\n[time]\nduration_s = 60\n",
    );
    let words = frames("tracks.toml", &["--format", "exr"]);
    assert!(
        words.contains("tracks and names") && words.contains("trail"),
        "{words}"
    );
    place.scene(
        "paper.toml",
        &SMALL.replace("[earth]", "[earth]\nlook = \"paper\""),
    );
    let words = frames("paper.toml", &["--supersample", "2"]);
    assert!(words.contains("paper's shading"), "{words}");
    place.scene(
        "small_scale.toml",
        &format!("{SMALL}[quality]\nscale = 0.5\n"),
    );
    let words = frames("small_scale.toml", &["--alpha"]);
    assert!(words.contains("scale"), "{words}");
    for more in [
        &["--supersample", "3"][..],
        &["--shutter", "0"],
        &["--shutter", "1.1"],
        &["--shutter", "nan"],
        &["--subframes", "4"],
        &["--shutter", "0.5", "--subframes", "0"],
        &["--shutter", "0.5", "--subframes", "257"],
        &["--format", "tiff"],
        &["--alpha", "--video", "a.mp4"],
    ] {
        frames("small.toml", more);
    }
    for arguments in [
        &["play", "small.toml", "--supersample", "2"][..],
        &["play", "small.toml", "--video", "a.mp4", "--format", "exr"],
        &[
            "frame",
            "small.toml",
            "-o",
            "a.png",
            "--renderer",
            "reference",
            "--alpha",
        ],
    ] {
        place.fail(2, arguments);
    }
    let words = place.fail(
        1,
        &["frame", "small.toml", "-o", "a.png", "--format", "exr"],
    );
    assert!(words.contains("a.exr"), "{words}");
    assert!(!place.path("a").exists() && !place.path("a.png").exists());
    // A film of another format is another film.
    place.succeed(&["play", "small.toml", "--frames", "b", "--range", "0..1"]);
    let words = place.fail(
        1,
        &[
            "play",
            "small.toml",
            "--frames",
            "b",
            "--resume",
            "--format",
            "png16",
        ],
    );
    assert!(words.contains("another --format"), "{words}");
}
