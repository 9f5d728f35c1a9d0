//! Films as folders of frames: ranges, going on with a film, its page.

use crate::{Place, SMALL, names, words};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

/// The page of a folder of frames: good JSON whenever it is read.
pub fn page(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("frames.json")).expect("a page");
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn indices(page: &Value) -> Vec<u64> {
    let frames = page["frames"].as_array().expect("a list");
    let index = |frame: &Value| frame["index"].as_u64().expect("a number");
    frames.iter().map(index).collect()
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The same files with the same bytes.
fn assert_same_folders(a: &Path, b: &Path) {
    let names_of_a = names(a);
    assert_eq!(names_of_a, names(b));
    for name in names_of_a {
        assert!(bytes(&a.join(&name)) == bytes(&b.join(&name)), "{name}");
    }
}

fn frame(number: u64) -> String {
    format!("frame_{number:05}.png")
}

#[test]
fn a_range_gives_the_frames_of_the_whole_film() {
    let place = Place::new();
    // Metered exposure is followed through the frames before, drawn or not.
    let auto = SMALL.replace("[output]", "[output]\nexposure_ev = \"auto\"");
    place.scene(
        "auto.toml",
        &auto
            .replace("speed = 10", "speed = 3000")
            .replace("duration_s = 4", "duration_s = 1800"),
    );
    place.succeed(&["play", "auto.toml", "--frames", "all"]);
    place.succeed(&["play", "auto.toml", "--frames", "some", "--range", "3..=4"]);
    assert_eq!(
        names(&place.path("some")),
        [&frame(3), &frame(4), "frames.json"]
    );
    let (all, some) = (page(&place.path("all")), page(&place.path("some")));
    assert_eq!(
        (indices(&all), indices(&some)),
        ((0..6).collect(), vec![3, 4])
    );
    for n in [3, 4] {
        let of = |folder: &str| bytes(&place.path(folder).join(frame(n)));
        assert_eq!(of("all"), of("some"), "{n}");
        assert_eq!(all["frames"][n as usize], some["frames"][n as usize - 3]);
    }
    let ev = |n: usize| all["frames"][n]["exposure_ev"].as_f64().expect("a number");
    assert!(ev(0) != ev(3), "the exposure changes");
    // For a video too.
    place.succeed(&[
        "play",
        "auto.toml",
        "--video",
        "a.mp4",
        "--range",
        "1..3",
        "--encoder",
        "builtin",
    ]);
    let words = place.fail(
        2,
        &["play", "auto.toml", "--frames", "x", "--range", "5..7"],
    );
    assert!(
        words.contains("5..7") && words.contains("are 0 to 5"),
        "{words}"
    );
    assert!(!place.path("x").exists());
}

#[test]
fn the_page_tells_each_frames_time_and_camera() {
    let place = Place::new();
    place.succeed(&["play", "small.toml", "--frames", "a"]);
    let page = page(&place.path("a"));
    assert_eq!(page["format"], "terrella frames 1");
    assert_eq!(
        (&page["frame_count"], &page["speed"]),
        (&4.into(), &10.0.into())
    );
    assert_eq!(page["film"]["size"], serde_json::json!([64, 36]));
    let third = &page["frames"][2];
    assert_eq!(third["utc"], "2018-01-15T12:00:02.000Z");
    assert_eq!(third["tai"], "2018-01-15T12:00:39.000");
    assert_eq!(third["elapsed_ns"], 2_000_000_000_i64);
    assert_eq!(
        (&third["file"], &third["exposure_ev"]),
        (&frame(2).into(), &0.5.into())
    );
    let eye = third["camera"]["eye_itrf_m"].as_array().expect("a place");
    let eye: Vec<_> = eye
        .iter()
        .map(|part| part.as_f64().expect("a number"))
        .collect();
    // 12 000 km above 20° N, 15° E, looking straight down.
    let distance_m = eye.iter().map(|part| part * part).sum::<f64>().sqrt();
    assert!((distance_m - 18.376e6).abs() < 2e3, "{distance_m}");
    assert!((eye[1].atan2(eye[0]).to_degrees() - 15.0).abs() < 1e-9);
    assert_eq!(
        third["camera"]["fov_y_deg"].as_f64().map(f64::round),
        Some(45.0)
    );
    assert_eq!(third["bytes"], bytes(&place.path("a").join(frame(2))).len());
}

#[test]
fn a_film_goes_on_where_it_was_left() {
    let place = Place::new();
    let play = ["play", "small.toml", "--frames", "a"];
    place.succeed(&[&play[..], &["--range", "1..3"]].concat());
    let kept = bytes(&place.path("a").join(frame(1)));
    let modified = |n| {
        let found = std::fs::metadata(place.path("a").join(frame(n))).expect("there");
        found.modified().expect("a time")
    };
    let drawn = modified(1);
    // One that is corrupt is drawn again, one that is not of the page too.
    let corrupt = place.path("a").join(frame(2));
    std::fs::write(&corrupt, &bytes(&corrupt)[..100]).expect("writes");
    std::fs::write(place.path("a").join(frame(3)), &kept).expect("writes");
    let output = place.succeed(&[&["-v"], &play[..], &["--resume"]].concat());
    assert!(
        words(&output).contains("1 frames are already rendered"),
        "{}",
        words(&output)
    );
    assert_eq!(indices(&page(&place.path("a"))), [0, 1, 2, 3]);
    assert_eq!(
        modified(1),
        drawn,
        "a frame that was there is not written again"
    );
    assert!(!words(&output).contains("may differ slightly"));
    // As if drawn in one go.
    place.succeed(&["play", "small.toml", "--frames", "b"]);
    assert_same_folders(&place.path("a"), &place.path("b"));
    // Nothing is left to do.
    let output = place.succeed(&[&["-v"], &play[..], &["--resume"]].concat());
    assert!(
        words(&output).contains("all frames are already rendered"),
        "{}",
        words(&output)
    );
}

#[test]
fn films_are_not_mixed() {
    let place = Place::new();
    let play = ["play", "small.toml", "--frames", "a"];
    place.succeed(&[&play[..], &["--range", "0..1"]].concat());
    let before = bytes(&place.path("a").join("frames.json"));
    let resume = [&play[..], &["--resume"]].concat();
    let words = place.fail(1, &[&resume[..], &["--size", "80x50"]].concat());
    assert!(
        words.contains("64 × 36 pixels, these 80 × 50") && words.contains("--overwrite"),
        "{words}"
    );
    place.scene("small.toml", &SMALL.replace("lat_deg = 20", "lat_deg = 21"));
    let words = place.fail(1, &resume);
    assert!(words.contains("the scene has changed"), "{words}");
    place.scene("small.toml", SMALL);
    for (corrupt, reported) in [
        (&b"{"[..], "no page of frames"),
        (b"{\"format\": \"other\"}", "its format is \"other\""),
        (b"[1]", "no page of frames"),
        (
            b"{\"format\": \"terrella frames 1\", \"film\": {\"program\": \"terrella 0.0.1\"}}",
            "by terrella 0.0.1",
        ),
    ] {
        std::fs::write(place.path("a/frames.json"), corrupt).expect("writes");
        let words = place.fail(1, &resume);
        assert!(
            words.contains(reported) && words.contains("--overwrite"),
            "{words}"
        );
    }
    std::fs::remove_file(place.path("a/frames.json")).expect("removes");
    assert!(place.fail(1, &resume).contains("no frames.json"));
    std::fs::write(place.path("a/frames.json"), before).expect("writes");
    let output = place.succeed(&resume);
    assert!(!crate::words(&output).contains("may differ"), "one adapter");
    // Frames of another adapter are kept, with a warning.
    let text = std::fs::read_to_string(place.path("a/frames.json")).expect("reads");
    let adapter = page(&place.path("a"))["adapter"].to_string();
    std::fs::write(
        place.path("a/frames.json"),
        text.replace(&adapter, "\"another\""),
    )
    .expect("writes");
    std::fs::remove_file(place.path("a").join(frame(3))).expect("removes");
    let output = place.succeed(&resume);
    assert!(
        crate::words(&output).contains("rendered by another"),
        "{}",
        crate::words(&output)
    );
    let words = place.fail(1, &play);
    assert!(
        words.contains("--overwrite") && words.contains("--resume"),
        "{words}"
    );
}

/// A truncated page keeps its entries up to the cut, and the film becomes that of a single run.
#[test]
fn a_film_whose_page_is_cut_goes_on() {
    let place = Place::new();
    place.succeed(&["play", "small.toml", "--frames", "whole"]);
    let text = bytes(&place.path("whole/frames.json"));
    let list = text
        .windows(11)
        .position(|part| part == b"\"frames\": [")
        .expect("a list");
    let ends: Vec<_> = (list..text.len()).filter(|n| text[*n] == b'\n').collect();
    // The list begins; in, just before and just behind the second entry; behind all entries; before the last brace.
    for (cut, kept) in [
        (ends[0], 0),
        (ends[1] + 90, 1),
        (ends[2] - 2, 1),
        (ends[2] - 1, 2),
        (ends[2] + 1, 2),
        (ends[4], 4),
        (text.len() - 2, 4),
    ] {
        let _ = std::fs::remove_dir_all(place.path("a"));
        std::fs::create_dir(place.path("a")).expect("made");
        for name in names(&place.path("whole")) {
            std::fs::copy(place.path("whole").join(&name), place.path("a").join(&name))
                .expect("copies");
        }
        std::fs::write(place.path("a/frames.json"), &text[..cut]).expect("writes");
        let output = place.succeed(&["-v", "play", "small.toml", "--frames", "a", "--resume"]);
        let said = format!("truncated or corrupt; the {kept} frames that it still lists are kept");
        assert!(words(&output).contains(&said), "{cut}: {}", words(&output));
        assert_same_folders(&place.path("whole"), &place.path("a"));
    }
    // A page that is cut before its first frame does not identify the film.
    std::fs::write(place.path("a/frames.json"), &text[..list - 100]).expect("writes");
    let words = place.fail(1, &["play", "small.toml", "--frames", "a", "--resume"]);
    assert!(
        words.contains("its beginning is cut off") && words.contains("--overwrite"),
        "{words}"
    );
}

/// Killed in the middle: the page is good, and the film goes on from there to the same frames.
#[cfg(unix)]
#[test]
fn a_film_that_is_killed_goes_on() {
    let place = Place::new();
    place.scene(
        "long.toml",
        &SMALL.replace("duration_s = 4", "duration_s = 60"),
    );
    let play = ["play", "long.toml", "--frames", "a"];
    let mut child = place.command(&play).spawn().expect("starts");
    let begin = Instant::now();
    while !place.path("a").join(frame(5)).exists() {
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "no frames in a minute"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().expect("stops");
    child.wait().expect("ends");
    let done = indices(&page(&place.path("a"))).len();
    assert!((5..60).contains(&done), "{done}");
    let output = place.succeed(&[&["-v"], &play[..], &["--resume"]].concat());
    let said = format!("{done} frames are already rendered");
    assert!(words(&output).contains(&said), "{}", words(&output));
    place.succeed(&["play", "long.toml", "--frames", "b"]);
    assert_same_folders(&place.path("a"), &place.path("b"));
}

/// A file size limit, which acts like a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_keeps_what_was_done() {
    let place = Place::new();
    place.scene(
        "long.toml",
        &SMALL.replace("duration_s = 4", "duration_s = 60"),
    );
    let full = |blocks: u32| {
        let script = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec {} -q play long.toml --frames a --resume",
            env!("CARGO_BIN_EXE_terrella")
        );
        let mut shell = std::process::Command::new("sh");
        let output = shell
            .args(["-c", &script])
            .current_dir(place.path(""))
            .env("TERRELLA_TEXTURES", crate::small_maps::folder())
            .output();
        let output = output.expect("a shell");
        assert_eq!(output.status.code(), Some(1), "{}", words(&output));
        words(&output)
    };
    // The page grows over it.
    let said = full(24);
    assert!(
        said.contains("frames.json")
            && said.contains("free some space")
            && said.contains("--resume"),
        "{said}"
    );
    let done = indices(&page(&place.path("a")));
    assert!((3..60).contains(&done.len()), "{done:?}");
    // The frame after them is there and not on the page; nothing is half there.
    for name in names(&place.path("a"))
        .iter()
        .filter(|name| name.starts_with("frame_"))
    {
        assert_eq!(crate::png_size(&place.path("a").join(name)), (64, 36));
    }
    // A frame itself does not fit; the beginning of the page, of less than 2 KB, does.
    std::fs::remove_dir_all(place.path("a")).expect("removes");
    let said = full(4);
    assert!(
        said.contains("frame_00000.png") && said.contains("free some space"),
        "{said}"
    );
    assert_eq!(names(&place.path("a")), ["frames.json"]);
    place.succeed(&["play", "long.toml", "--frames", "a", "--resume"]);
    assert_eq!(indices(&page(&place.path("a"))).len(), 60);
}

/// Exposure does not carry over from one shot to the next: the eye of a camera needs no time for a cut.
#[test]
fn a_cut_is_exposed_at_once() {
    let place = Place::new();
    let scene = |keys: &str| {
        format!(
            "[time]\nstart = \"2018-06-21T10:00:00Z\"\nduration_s = 1\nspeed = 1\nframe_rate_hz = 4\n[camera]\nmode = \"geodetic\"\n{keys}\n\
             [output]\nsize = [64, 36]\nexposure_ev = \"auto\"\n"
        )
    };
    // Night over the Pacific, then noon over the Sahara.
    let day = "lat_deg = 22, lon_deg = 12, height_km = 2000, heading_deg = 0, pitch_deg = -90";
    let both = format!(
        "keys = [{{ time_s = 0, lat_deg = -20, lon_deg = -160, height_km = 2000, heading_deg = 0, pitch_deg = -90 }}, \
         {{ time_s = 0.5, {day}, cut = true }}]"
    );
    place.scene("both.toml", &scene(&both));
    place.scene(
        "day.toml",
        &scene(&format!("keys = [{{ time_s = 0.5, {day} }}]")),
    );
    let exposures = |name: &str| {
        place.succeed(&["play", &format!("{name}.toml"), "--frames", name]);
        let page = page(&place.path(name));
        let of = |frame: &serde_json::Value| frame["exposure_ev"].as_f64().expect("a number");
        Vec::from_iter(page["frames"].as_array().expect("frames").iter().map(of))
    };
    let (both, day) = (exposures("both"), exposures("day"));
    assert!(both[1] > day[1] + 3.0, "{both:?} {day:?}");
    assert!((both[2] - day[2]).abs() < 1e-3, "{both:?} {day:?}");
}
