//! Start of a scene, and runs without a scene: files of orbits, the built-in scene.

use crate::{Place, names, words};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use terrella::frames::{Epoch, utc_from_rfc3339};

/// Noon of 25 November 2026: day 329.5.
const NOON: &str = "2026-11-25T12:00:00.000Z";
const STATION: [&str; 3] = [
    "ISS (ZARYA)",
    "1 25544U 98067A   26329.50000000  .00016717  00000-0  10270-3 0  999",
    "2 25544  51.6400 208.9163 0006703  69.9862  25.2906 15.50000000 1234",
];
/// Six hours of 24 November: day 328.25.
const WEATHER: [&str; 3] = [
    "NOAA 20",
    "1 43013U 17073A   26328.25000000  .00000100  00000-0  70000-4 0  999",
    "2 43013  98.7400 300.9163 0001203  69.9862 290.2906 14.19500000 1234",
];

/// Two-line elements with their checksums: digits count as themselves, minus signs as 1.
fn elements(set: [&str; 3]) -> String {
    let lines = set.iter().enumerate().map(|(index, line)| {
        let value = |c: char| c.to_digit(10).unwrap_or(u32::from(c == '-'));
        let sum: u32 = line.chars().map(value).sum();
        match index {
            0 => format!("{line}\n"),
            _ => format!("{line}{}\n", sum % 10),
        }
    });
    lines.collect()
}

/// A file of `config/orbits/`, which begins at noon of 15 January 2018, moved to November 2026.
fn moved(name: &str) -> String {
    let path = std::path::Path::new(crate::REPOSITORY).join("config/orbits");
    let text = std::fs::read_to_string(path.join(name)).expect("reads");
    text.replace("2018-01-15", "2026-11-25")
}

/// A folder with a file of each kind. None of them is known in 2018.
fn orbits() -> Place {
    let place = Place::new();
    place.scene("my.tle", &elements(STATION));
    place.scene("my.txt", &elements(STATION));
    place.scene("my.omm", &moved("polar.omm"));
    place.scene("my.oem", &moved("falling.oem"));
    place.scene("my.czml", &moved("low.czml"));
    place.scene("my.csv", &moved("low.csv"));
    place.scene(
        "my.json",
        "[{\"OBJECT_NAME\":\"POLAR\",\"OBJECT_ID\":\"2026-001A\",\"EPOCH\":\"2026-11-25T12:00:00.000\",\"MEAN_MOTION\":14.5,\
         \"ECCENTRICITY\":0.001,\"INCLINATION\":98.2,\"RA_OF_ASC_NODE\":60,\"ARG_OF_PERICENTER\":90,\"MEAN_ANOMALY\":0,\
         \"NORAD_CAT_ID\":99999,\"BSTAR\":0.0001,\"MEAN_MOTION_DOT\":0,\"MEAN_MOTION_DDOT\":0}]",
    );
    place.scene("two.tle", &(elements(STATION) + &elements(WEATHER)));
    place
}

/// Output of the check of a scene, and the time of its first state.
fn checked(place: &Place, arguments: &[&str]) -> String {
    let output = place.succeed(&[&["check"], arguments].concat());
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn first_state(place: &Place, arguments: &[&str]) -> String {
    let output = place.succeed(&[&["orbit"], arguments, &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    json["states"][0]["epoch_utc"]
        .as_str()
        .expect("an epoch")
        .to_owned()
}

#[test]
fn a_scene_without_a_start_begins_at_its_satellites_own_time() {
    let place = orbits();
    for (source, file, reported) in [
        ("tle", "my.tle", "epoch of the elements of ISS (ZARYA)"),
        ("omm", "my.omm", "epoch of the elements of POLAR"),
        ("oem", "my.oem", "first state of Falling"),
        ("czml", "my.czml", "first state of Low"),
        ("csv", "my.csv", "first state of Low"),
    ] {
        let text = format!("[orbit]\nsource = \"{source}\"\nfile = \"{file}\"\n");
        place.scene("a.toml", &text);
        assert_eq!(first_state(&place, &["a.toml"]), NOON, "{file}");
        let summary = checked(&place, &["a.toml"]);
        let line = summary.lines().find(|line| line.contains("  start "));
        let line = line.expect("a line of the start");
        assert!(line.contains("2026-11-25T12:00:00Z"), "{line}");
        assert!(line.contains(reported), "{line}");
        // Explicit values take precedence.
        let given = format!("[time]\nstart = \"2026-11-25T12:30:00Z\"\nduration_s = 60\n{text}");
        place.scene("a.toml", &given);
        assert_eq!(
            first_state(&place, &["a.toml"]),
            "2026-11-25T12:30:00.000Z",
            "{file}"
        );
        assert!(checked(&place, &["a.toml"]).contains("line 2 of the file"));
    }
    let motion = "[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\n";
    place.scene("a.toml", motion);
    assert_eq!(first_state(&place, &["a.toml"]), "2018-01-15T12:00:00.000Z");
    let epoch = format!("{motion}epoch = \"{NOON}\"\nname = \"Mine\"\n");
    place.scene("a.toml", &epoch);
    assert_eq!(first_state(&place, &["a.toml"]), NOON);
    assert!(checked(&place, &["a.toml"]).contains("epoch of Mine"));
    // Without any of its own: as usual.
    place.scene("a.toml", "");
    assert_eq!(first_state(&place, &["a.toml"]), "2018-01-15T12:00:00.000Z");
    assert!(checked(&place, &["a.toml"]).contains("\"2018-01-15T12:00:00Z\"       default"));
}

#[test]
fn several_satellites_begin_with_the_one_that_is_followed() {
    let place = orbits();
    let two = "[[orbit]]\nfile = \"my.tle\"\n[[orbit]]\nfile = \"two.tle\"\nname = \"NOAA 20\"\n";
    place.scene("a.toml", two);
    assert_eq!(first_state(&place, &["a.toml"]), NOON);
    place.scene("a.toml", &format!("{two}[camera]\nfollow = \"NOAA 20\"\n"));
    assert_eq!(first_state(&place, &["a.toml"]), "2026-11-24T06:00:00.000Z");
    // A motion without an epoch flies at any time, and its start is then the scene's.
    for source in ["kepler", "numerical"] {
        let motion = format!("[[orbit]]\nsource = \"{source}\"\nperiapsis_km = 7000\n");
        let text = format!("[time]\nduration_s = 60\n{motion}[[orbit]]\nfile = \"my.tle\"\n");
        place.scene("a.toml", &text);
        assert_eq!(first_state(&place, &["a.toml"]), NOON);
        let json = place
            .succeed(&["orbit", "a.toml", "--json", "--frame", "gcrf"])
            .stdout;
        let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
        let x_km = json["states"][0]["position_km"][0].as_f64();
        assert!((x_km.expect("a number") - 7000.0).abs() < 1e-6, "{json}");
    }
    // Backwards, states begin with the last.
    let csv = "[time]\nspeed = -60\n[orbit]\nsource = \"csv\"\nfile = \"my.csv\"\n";
    place.scene("a.toml", csv);
    let summary = checked(&place, &["a.toml"]);
    assert!(summary.contains("last state of Low"), "{summary}");
    // The built-in station flies a stand-in at that time.
    place.scene("a.toml", "[[orbit]]\nfile = \"my.tle\"\n[[orbit]]\n");
    let reported = words(&place.succeed(&["check", "a.toml"]));
    assert!(reported.contains("ISS stand-in is not where"), "{reported}");
}

#[test]
fn options_set_keys_in_place_of_the_scene_and_without_one() {
    let place = orbits();
    place.scene(
        "a.toml",
        "[orbit]\nfile = \"my.tle\"\n[time]\nduration_s = 5\n",
    );
    let later = "time.start=2026-11-25T13:00:00Z";
    for file in ["a.toml", "my.tle"] {
        let state = first_state(&place, &[file, "--set", later]);
        assert_eq!(state, "2026-11-25T13:00:00.000Z", "{file}");
        let summary = checked(&place, &[file, "--set", "time.duration_s=70"]);
        assert!(
            summary.contains("duration_s         70                           --set"),
            "{summary}"
        );
    }
}

#[test]
fn files_of_orbits_are_flown_without_a_scene() {
    let place = orbits();
    for file in [
        "my.tle", "my.txt", "my.omm", "my.oem", "my.czml", "my.csv", "my.json",
    ] {
        assert_eq!(first_state(&place, &[file]), NOON, "{file}");
        let summary = checked(&place, &[file]);
        assert!(summary.contains("2026-11-25T12:00:00Z"), "{summary}");
        assert!(
            summary.contains("\nlight\n  the satellite is "),
            "{summary}"
        );
    }
    let small = ["--size", "32x18"];
    place.succeed(&[&["frame", "my.tle", "-o", "a.png"], &small[..]].concat());
    place.succeed(&[&["frame", "my.csv", "-o", "b.png"], &small[..]].concat());
    let film = ["play", "my.tle", "--frames", "film", "--range", "0..2"];
    place.succeed(&[&film[..], &small].concat());
    assert_eq!(
        names(&place.path("film")),
        ["frame_00000.png", "frame_00001.png", "frames.json"]
    );
    // Another satellite is another film.
    place.succeed(&[&film[..], &small, &["--resume"]].concat());
    place.scene("my.tle", &elements(WEATHER));
    let reported = place.fail(1, &[&film[..], &small, &["--resume"]].concat());
    assert!(
        reported.contains("changed files: my.tle (orbit.file)"),
        "{reported}"
    );
}

#[test]
fn one_of_several_satellites_is_chosen_by_name_or_number() {
    let place = orbits();
    let reported = place.fail(1, &["check", "two.tle"]);
    for word in ["ISS (ZARYA) (25544", "NOAA 20 (43013", "by --satellite"] {
        assert!(reported.contains(word), "no {word}: {reported}");
    }
    for chosen in ["noaa 20", "43013"] {
        let summary = checked(&place, &["two.tle", "--satellite", chosen]);
        assert!(summary.contains("2026-11-24T06:00:00Z"), "{summary}");
    }
    let reported = place.fail(1, &["play", "two.tle", "--satellite", "NOAA 21"]);
    assert!(
        reported.contains("nearest name is \"NOAA 20\""),
        "{reported}"
    );
    let both = ["--satellite", "25544", "--satellite", "43013"];
    let output = place.succeed(&[&["orbit", "two.tle"], &both[..], &["--csv"]].concat());
    let table = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(table.contains("NOAA 20") && table.contains("ISS (ZARYA)"));
    // They are of one film as long as they are the same.
    let film = [
        "play", "two.tle", "--frames", "a", "--range", "0..1", "--size", "32x18",
    ];
    let one = ["--satellite", "25544"];
    place.succeed(&[&film[..], &one].concat());
    let reported = place.fail(1, &[&film[..], &both, &["--resume"]].concat());
    assert!(reported.contains("the scene has changed"), "{reported}");
    // For scenes the message refers to the scene.
    let reported = place.fail(2, &["check", "small.toml", "--satellite", "X"]);
    assert!(reported.contains("follow under [camera]"), "{reported}");
}

#[test]
fn what_is_neither_a_scene_nor_a_file_of_orbits_is_said_to_be_so() {
    let place = Place::new();
    place.scene("notes.txt", "Dear all,\nsee you.\n");
    place.scene("data.json", "{\"name\": \"x\", \"version\": 1}\n");
    place.scene("page.html", "<html><body>404</body></html>\n");
    place.scene("other.kvn", "CCSDS_XYZ_VERS = 1.0\nORIGINATOR = X\n");
    std::fs::write(place.path("a.bin"), [0xff_u8, 0xd8, 0xff, 0x00]).expect("writes");
    for file in ["notes.txt", "data.json", "page.html", "other.kvn", "a.bin"] {
        for command in ["check", "play", "orbit"] {
            let reported = place.fail(2, &[command, file]);
            assert!(reported.contains(file), "{reported}");
            assert!(reported.contains("nor is it an orbit file"), "{reported}");
        }
    }
    // A known but unsupported message is named, with the remedy.
    place.scene("re-entry.txt", "CCSDS_RDM_VERS = 1.0\nORIGINATOR = X\n");
    let reported = place.fail(1, &["check", "re-entry.txt"]);
    assert!(reported.contains("(RDM) has a prediction"), "{reported}");
    place.scene("sat.txt", "CCSDS_OCM_VERS = 3.0\nORIGINATOR = X\n");
    for command in ["check", "play", "orbit"] {
        let reported = place.fail(1, &[command, "sat.txt"]);
        assert!(
            reported.contains("(OCM) is not read; export its trajectory as an OEM"),
            "{reported}"
        );
    }
    // Files with a known extension must have its format, scenes too.
    place.scene("a.tle", "nothing\n");
    let reported = place.fail(1, &["check", "a.tle"]);
    assert!(
        reported.contains("a.tle:1: \"nothing\" is neither an element line"),
        "{reported}"
    );
    place.scene("a.csv", "a,b\n1,2\n");
    assert!(place.fail(1, &["check", "a.csv"]).contains("no ephemeris"));
    place.scene("a.toml", &elements(STATION));
    let reported = place.fail(2, &["check", "a.toml"]);
    assert!(
        reported.contains("is not TOML") && !reported.contains("orbits"),
        "{reported}"
    );
    let reported = place.fail(2, &["check", "missing.tle"]);
    assert!(reported.contains("or of an orbit file"), "{reported}");
}

#[test]
fn the_scene_that_comes_with_the_program_is_flown_from_any_folder() {
    let place = Place::new();
    let summary = checked(&place, &[]);
    assert!(summary.contains("config/iss.toml (built in)"), "{summary}");
    assert!(summary.contains("ISS (ZARYA)"), "{summary}");
    place.succeed(&["frame", "-o", "a.png", "--size", "32x18"]);
    let film = [
        "play", "--frames", "film", "--range", "0..1", "--size", "32x18",
    ];
    place.succeed(&film);
    place.succeed(&[&film[..], &["--resume"]].concat());
    // As from its file.
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/iss.toml");
    place.succeed(&["frame", file, "-o", "b.png", "--size", "32x18"]);
    let read = |name| std::fs::read(place.path(name)).expect("reads");
    assert!(read("a.png") == read("b.png"));
}

#[test]
fn now_is_the_time_of_the_systems_clock() {
    let place = orbits();
    let clock = || SystemTime::now().duration_since(UNIX_EPOCH);
    let posix = utc_from_rfc3339("1970-01-01T00:00:00Z").expect("a date");
    let before = clock().expect("after 1970");
    place.scene("now.toml", "[time]\nstart = \"now\"\nduration_s = 60\n");
    let first = utc_from_rfc3339(&first_state(&place, &["now.toml"])).expect("a date");
    // POSIX leaves out the 37 leap seconds, the epochs count them from 1970 on.
    let since = |epoch: Epoch| epoch.to_utc_seconds() - posix.to_utc_seconds();
    let (least, most) = (
        before.as_secs_f64() - 1.0,
        clock().expect("so").as_secs_f64(),
    );
    let reported = since(first);
    assert!(
        (least..=most).contains(&reported),
        "{reported} from {least} to {most}"
    );
    assert!(checked(&place, &["now.toml"]).contains("line 2 of the file, \"now\""));
    let at = first_state(&place, &["now.toml", "--at", "now"]);
    let at = since(utc_from_rfc3339(&at).expect("a date"));
    assert!((least..=most + 60.0).contains(&at), "{at}");
    // Nowhere else.
    place.scene("a.toml", "[time]\nstart = \"Now\"\n");
    assert!(place.fail(2, &["check", "a.toml"]).contains("[time] start"));
    let motion = "[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\nepoch = \"now\"\n";
    place.scene("a.toml", motion);
    assert!(
        place
            .fail(2, &["check", "a.toml"])
            .contains("[orbit] epoch")
    );
}

#[test]
fn films_of_now_are_not_mixed() {
    let place = Place::new();
    let text = crate::SMALL.replace("[time]", "[time]\nstart = \"now\"");
    place.scene("now.toml", &text);
    let film = ["play", "now.toml", "--frames", "a"];
    place.succeed(&[&film[..], &["--range", "0..1"]].concat());
    let page = std::fs::read_to_string(place.path("a/frames.json")).expect("a page");
    let page: serde_json::Value = serde_json::from_str(&page).expect("JSON");
    let start = page["start_utc"].as_str().expect("a start").to_owned();
    assert_eq!(page["film"]["start_utc"], start.as_str());
    std::thread::sleep(Duration::from_millis(1_100));
    let reported = place.fail(1, &[&film[..], &["--resume"]].concat());
    assert!(
        reported.contains(&format!("it begins at {start}")),
        "{reported}"
    );
    assert!(reported.contains(&format!("--start {start}")), "{reported}");
    // According to the message.
    place.succeed(&[&film[..], &["--resume", "--start", &start]].concat());
    let page = std::fs::read_to_string(place.path("a/frames.json")).expect("a page");
    let page: serde_json::Value = serde_json::from_str(&page).expect("JSON");
    assert_eq!(page["frames"].as_array().expect("a list").len(), 4);
    assert_eq!(page["frames"][0]["utc"], start.as_str());
    // A film's start of the command line is its own too.
    let other = ["--resume", "--start", "2026-01-01T00:00:00Z"];
    assert!(
        place
            .fail(1, &[&film[..], &other].concat())
            .contains("it begins at")
    );
    let live = "[orbit]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:0\"\n";
    place.scene("live.toml", live);
    let reported = place.fail(2, &["play", "live.toml", "--start", "now"]);
    assert!(reported.contains("simulator sets the time"), "{reported}");
}

/// An equatorial circle of 6778 km at the equinox, at noon over it and half a revolution later: light from start, shadow from
/// start.
fn equinox(true_anomaly_deg: u32, duration_s: u32) -> String {
    format!(
        "[time]\nstart = \"2018-03-20T16:15:00Z\"\nduration_s = {duration_s}\nspeed = 300\nframe_rate_hz = 10\n\
         [orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 6778\ntrue_anomaly_deg = {true_anomaly_deg}\n\
         [earth]\nnormals = false\nnight_lights = false\n[output]\nsize = [64, 36]\nsamples = 1\n"
    )
}

#[test]
fn a_films_light_size_and_encoder_are_reported_before_and_its_files_after() {
    let place = Place::new();
    // A revolution takes 5553.6 s; 39.1 % of it is behind the disc, and 0.1 % in the penumbra.
    place.scene("round.toml", &equinox(0, 5554));
    let film = [
        "play",
        "round.toml",
        "--video",
        "a.mp4",
        "--encoder",
        "builtin",
    ];
    let output = place.succeed(&film);
    let said = words(&output);
    assert!(output.stdout.is_empty());
    for word in [
        "film: 185 frames of 64 × 36 pixels: 18.5 s at 10 frames a second",
        "video: a.mp4, encoded by the built-in encoder, OpenH264",
        "light: the satellite is in the Earth's shadow for 39 % of the film, in sunlight until 2018-03-20T16:4",
        "light: the ground below is in night for 50 % of the film, in daylight until 2018-03-20T16:38:",
    ] {
        assert!(said.contains(word), "no {word}: {said}");
    }
    let bytes = std::fs::metadata(place.path("a.mp4")).expect("there").len();
    let after = said.lines().last().expect("a line");
    assert!(after.starts_with("a.mp4: "), "{after}");
    assert!(after.contains(&format!("{bytes} bytes")), "{after}");
    assert!(
        after.contains("185 frames") && after.ends_with(" s"),
        "{after}"
    );
    let quiet = place.succeed(&[&["-q"], &film[..]].concat());
    assert_eq!(words(&quiet), "");
    // All of it dark.
    place.scene("dark.toml", &equinox(180, 60));
    let said = words(&place.succeed(&["play", "dark.toml", "--frames", "dark"]));
    for word in [
        "images: in dark, PNG",
        "light: the satellite is in the Earth's shadow all the time, in sunlight from 2018-03-20T16:3",
        "light: the ground below is in night all the time, in daylight from 2018-03-20T16:38:",
        "light: the film begins in the dark; --start 2018-03-20T16:38:",
        "2 images",
    ] {
        assert!(said.contains(word), "no {word}: {said}");
    }
    let picture = |n| std::fs::metadata(place.path("dark").join(format!("frame_0000{n}.png")));
    let bytes: u64 = [0, 1]
        .map(|n| picture(n).expect("there").len())
        .iter()
        .sum();
    assert!(said.contains(&format!("{bytes} bytes")), "{bytes}: {said}");
    let said = words(&place.succeed(&["play", "dark.toml", "--frames", "dark", "--resume"]));
    assert!(said.contains("all frames are already rendered"), "{said}");
}

#[test]
fn a_picture_of_night_says_when_it_is_day() {
    let place = orbits();
    let frame = |file: &str, more: &[&str]| {
        let frame = ["frame", file, "-o", "a.png", "--size", "32x18"];
        words(&place.succeed(&[&frame[..], more].concat()))
    };
    // The Sun is at 241° of right ascension. With a node of 208.9° the station is at 307.6°, with one of 142.9° below the Sun, with one of 322.9°
    // on the far side.
    let with_node = |node: &str| {
        let line = STATION[2].replace("208.9163", node);
        elements([STATION[0], STATION[1], &line])
    };
    place.scene("my.tle", &with_node("142.9163"));
    // In daylight only the written file is reported.
    let is_picture_alone = |said: &str| {
        let line = said.strip_suffix(" s\n").unwrap_or_default();
        line.starts_with("a.png: 32 × 18 pixels, ") && line.lines().count() == 1
    };
    let said = frame("my.tle", &[]);
    assert!(is_picture_alone(&said), "{said}");
    let quiet = words(&place.succeed(&["-q", "frame", "my.tle", "-o", "a.png"]));
    assert_eq!(quiet, "");
    place.scene("my.tle", &with_node("322.9163"));
    let said = frame("my.tle", &[]);
    let from = said.split("--at ").nth(1);
    let said_so = said.contains("the ground below is in night at 2026-11-25T12:00:00Z");
    let from = from
        .filter(|_| said_so)
        .and_then(|from| from.lines().next());
    let from = from.unwrap_or_else(|| panic!("{said}"));
    // At the time in the message it is day, and there is no message for an explicit time.
    let day = frame("my.tle", &["--at", from.trim()]);
    assert!(is_picture_alone(&day), "{day}");
    let json = place.succeed(&["orbit", "my.tle", "--json", "--at", from.trim()]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!(json["states"][0]["light"], "sunlit");
}

#[cfg(target_os = "linux")]
#[test]
fn windows_open_on_files_of_orbits_and_on_nothing() {
    let Some(display) = crate::window::Display::start() else {
        return;
    };
    let place = orbits();
    for scene in [&["my.tle"][..], &["my.oem"], &[]] {
        let arguments = [
            &["play"],
            scene,
            &["--for-seconds", "1", "--size", "160x90", "-v"],
        ];
        let output = place
            .command(&arguments.concat())
            .env("DISPLAY", &display.name)
            .output()
            .expect("starts");
        let said = words(&output);
        assert_eq!(output.status.code(), Some(0), "{scene:?}: {said}");
        assert!(said.contains("window on"), "{scene:?}: {said}");
    }
}
