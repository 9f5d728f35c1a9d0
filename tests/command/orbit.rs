//! `terrella orbit`: tables that read back, messages that other scenes fly, rejections.

use crate::{Place, words};
use std::path::{Path, PathBuf};
use terrella::frames::{Duration, EarthOrientation, Ellipsoid, Orientation, utc_from_rfc3339};
use terrella_orbit::{Catalogue, Ephemerides, EphemerisFeed, Feed, Frame, Sgp4Feed};
use terrella_play::Flight;
use terrella_play::scene::Scene;

fn config(name: &str) -> PathBuf {
    Path::new(crate::REPOSITORY).join("config").join(name)
}

/// The one satellite of a printed table.
pub fn read_table(text: &str) -> EphemerisFeed {
    let origin = Path::new("printed.csv");
    let read = Ephemerides::from_text(text, origin, true);
    let feeds = read.unwrap_or_else(|error| panic!("{error}\n{text}"));
    feeds.into_one(origin, None).expect("one satellite")
}

/// The default scene from its start, half an hour.
const STATION: &str = "[time]\nduration_s = 1800\nspeed = 60\n";

#[test]
fn csv_reads_back_bit_for_bit_in_every_frame() {
    let place = Place::new();
    place.scene("iss.toml", STATION);
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    for frame in Frame::ALL {
        let name = frame.name().to_lowercase();
        let text = place.printed(&[
            "orbit",
            "iss.toml",
            "--every",
            "250.1234567",
            "--include-end",
            "--csv",
            "--frame",
            &name,
        ]);
        let mut lines = text.lines();
        assert_eq!(
            lines.next(),
            Some(
                "name,frame,epoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s,lat_deg,lon_deg,height_km,error_m,light"
            )
        );
        let feed = read_table(&text);
        assert_eq!(feed.name(), "ISS (ZARYA)");
        let samples = &feed.segments()[0].samples;
        assert_eq!(samples.frame(), frame);
        // Eight steps of more digits than milliseconds, and the scene's end.
        assert_eq!(samples.len(), 9);
        for (sample, row) in samples.samples().zip(lines) {
            let state = iss.state_at(sample.epoch).expect("in reach");
            let there = state.in_frame(frame, &Orientation::default());
            assert_eq!(sample.position_m, there.position_m, "{frame:?}");
            assert_eq!(sample.velocity_m_s, Some(there.velocity_m_s), "{frame:?}");
            let ground = Ellipsoid::WGS84.geodetic_from_itrf(state.position_itrf_m());
            let columns: Vec<f64> = row
                .split(',')
                .skip(9)
                .filter_map(|c| c.parse().ok())
                .collect();
            let [lat, lon, height] = columns.as_slice() else {
                panic!("{row}");
            };
            assert!((lat - ground.lat_rad.to_degrees()).abs() < 1e-7);
            assert!((lon - ground.lon_rad.to_degrees()).abs() < 1e-7);
            assert!((height - ground.height_m / 1e3).abs() < 1e-5);
        }
        let last = samples.samples().last().map(|sample| sample.epoch);
        assert_eq!(last, utc_from_rfc3339("2018-01-15T12:30:00Z").ok());
    }
}

#[test]
fn one_instant_is_printed_in_words_and_json() {
    let place = Place::new();
    place.scene("iss.toml", STATION);
    // An instant outside the scene, inside the elements' reach.
    let at = ["orbit", "iss.toml", "--at", "2018-01-20T00:00:00Z"];
    let text = place.printed(&[&at[..], &["--frame", "geodetic"]].concat());
    let [head, row] = text.lines().collect::<Vec<_>>()[..] else {
        panic!("{text}");
    };
    assert!(
        head.contains("ISS (ZARYA)") && head.contains("latitude"),
        "{head}"
    );
    let json = place.printed(&[&at[..], &["--frame", "teme", "--json"]].concat());
    let document: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(document["frame"], "TEME");
    let state = &document["states"][0];
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    let epoch = utc_from_rfc3339("2018-01-20T00:00:00Z").expect("a date");
    let meant = iss.state_at(epoch).expect("in reach").position_m / 1e3;
    let x = state["position_km"][0].as_f64().expect("a number");
    assert!((x - meant.x).abs() < 1e-9, "{x}");
    let lat = format!("{:.6}", state["lat_deg"].as_f64().expect("a number"));
    assert!(row.contains(&lat), "{lat} is not in {row}");
}

#[test]
fn an_ephemeris_message_flies_as_the_satellite_does() {
    let place = Place::new();
    place.scene("iss.toml", STATION);
    for frame in ["teme", "gcrf", "eme2000", "itrf"] {
        let output = place.succeed(&[
            "orbit", "iss.toml", "--every", "60", "--frame", frame, "--oem", "iss.oem",
        ]);
        assert!(words(&output).contains("31 states"), "{}", words(&output));
        place.scene(
            "again.toml",
            &format!("{STATION}[orbit]\nsource = \"oem\"\nfile = \"iss.oem\"\n"),
        );
        let scene = Scene::load(&place.path("again.toml")).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        let iss = Sgp4Feed::built_in_iss().expect("built in");
        let start = flight.scene().time.start;
        let mut worst_m = 0.0_f64;
        for k in 0..=179 {
            let epoch = start + Duration::from_seconds(10.05 * f64::from(k));
            let (name, state) = flight.states_at(epoch).next().expect("one satellite");
            assert_eq!(name, "ISS (ZARYA)");
            let apart = state.expect("covered").position_itrf_m()
                - iss.state_at(epoch).expect("in reach").position_itrf_m();
            worst_m = worst_m.max(apart.length());
        }
        println!("{frame}: {worst_m} m");
        // Through states a minute apart the 7th degree is good to millimetres; SGP4's own velocity is no exact derivative
        // of its positions, by up to 1.6 cm/s, half a metre in the windows at the ends.
        assert!(worst_m < 1.0, "{frame}: {worst_m} m");
    }
    // The reported interpolation error of distant states equals that of a reader half-way between them.
    let output = place.succeed(&["orbit", "iss.toml", "--every", "300", "--oem", "iss.oem"]);
    let reported = words(&output);
    let reported_m = reported
        .split_whitespace()
        .rev()
        .nth(1)
        .and_then(|word| word.parse::<f64>().ok());
    let read = Ephemerides::from_file(&place.path("iss.oem"), true).expect("an OEM");
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    let mut worst_m = 0.0_f64;
    for k in 0..6 {
        let epoch =
            read.feeds[0].validity().0 + Duration::from_seconds(300.0 * f64::from(k) + 150.0);
        let [a, b] = [&read.feeds[0] as &dyn Feed, &iss]
            .map(|feed| feed.state_at(epoch).expect("covered").position_itrf_m());
        worst_m = worst_m.max((a - b).length());
    }
    assert!(worst_m > 1.0, "{worst_m} m");
    assert!(
        reported_m.is_some_and(|reported_m| (reported_m - worst_m).abs() < 1e-3),
        "{reported}: {worst_m} m"
    );
    assert_eq!(
        place.names(),
        ["again.toml", "iss.oem", "iss.toml", "small.toml"]
    );
}

#[test]
fn an_element_message_holds_the_elements() {
    let place = Place::new();
    place.scene("iss.toml", STATION);
    place.succeed(&["orbit", "iss.toml", "--omm", "iss.omm"]);
    let read = Catalogue::from_file(&place.path("iss.omm"), true).expect("an OMM");
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    assert_eq!(read.feeds[0].elements(), iss.elements());
    let kepler = "[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\n";
    place.scene("kepler.toml", kepler);
    let rejection = place.fail(2, &["orbit", "kepler.toml", "--omm", "kepler.omm"]);
    assert!(rejection.contains("--oem"), "{rejection}");
    assert!(!place.path("kepler.omm").exists());
}

#[test]
fn every_source_has_a_scene_that_flies() {
    let place = Place::new();
    for name in ["omm", "oem", "czml", "csv", "kepler", "numerical"] {
        let path = config(&format!("{name}.toml"));
        let path_text = path.display().to_string();
        let text = place.printed(&["orbit", &path_text, "--include-end", "--csv"]);
        let feed = read_table(&text);
        let heights = text
            .lines()
            .skip(1)
            .filter_map(|row| row.rsplit(',').nth(2)?.parse().ok());
        let heights: Vec<f64> = heights.collect();
        assert!(heights.len() > 40, "{name}: {} rows", heights.len());
        assert!(
            heights.iter().all(|km| (50.0..2000.0).contains(km)),
            "{name}: {heights:?}"
        );
        let scene = Scene::load(&path).expect("a good scene");
        let (first, last) = feed.validity();
        assert_eq!(
            (first, last),
            (scene.time.start, scene.time.end()),
            "{name}"
        );
        let summary = place.printed(&["check", &path.display().to_string()]);
        assert!(summary.contains(&format!("\"{name}\"")), "{summary}");
    }
    // The second satellite of a scene, by name.
    let kepler = config("kepler.toml").display().to_string();
    let long = place.printed(&["orbit", &kepler, "--csv", "--satellite", "long"]);
    assert_eq!(read_table(&long).name(), "Long");
    let rejection = place.fail(2, &["orbit", &kepler, "--satellite", "Lang"]);
    assert!(rejection.contains("did you mean \"Long\"?"), "{rejection}");
}

/// Files written from one scene and flown by another give the same states.
#[test]
fn the_files_of_the_scenes_are_of_the_scenes_that_they_name() {
    for (made, from, within_m) in [
        ("oem.toml", "numerical.toml", 0.01),
        ("csv.toml", "kepler.toml", 0.1),
        ("czml.toml", "kepler.toml", 1.0),
    ] {
        let open = |name: &str| {
            let scene = Scene::load(&config(name)).expect("a good scene");
            Flight::open(scene).unwrap_or_else(|error| panic!("{error}"))
        };
        let (made_flight, from_flight) = (open(made), open(from));
        let time = &made_flight.scene().time;
        let mut worst_m = 0.0_f64;
        for k in 0..=1000 {
            let epoch =
                time.start + Duration::from_seconds(time.duration_s * f64::from(k) / 1000.0);
            let [a, b] = [&made_flight, &from_flight].map(|flight| {
                let feed = flight.feed().expect("a satellite");
                feed.state_at(epoch).expect("covered").position_itrf_m()
            });
            worst_m = worst_m.max((a - b).length());
        }
        println!("{made}: {worst_m} m");
        assert!(worst_m < within_m, "{made}: {worst_m} m");
    }
}

#[test]
fn instants_outside_are_rejected_with_the_interval() {
    let place = Place::new();
    let late = ["--at", "2030-01-01T00:00:00Z"];
    for (name, first) in [
        ("iss.toml", "2017-12-21T21:33:14"),
        ("oem.toml", "2018-01-15T12:00:00.000Z"),
        ("numerical.toml", "2018-01-15T11:59:00.000Z"),
    ] {
        let path = config(name).display().to_string();
        let rejection = place.fail(2, &["orbit", &path, late[0], late[1]]);
        assert!(rejection.contains(first), "{rejection}");
    }
}

#[test]
fn files_that_cannot_be_written_are_found_before_the_run() {
    let place = Place::new();
    place.scene("iss.toml", STATION);
    // The scene is not even read: it is not there.
    for option in ["--oem", "--omm"] {
        let extension = option.trim_start_matches('-');
        let file = format!("iss.toml/iss.{extension}");
        let rejection = place.fail(1, &["orbit", "nowhere.toml", option, &file]);
        assert!(rejection.contains("a file of that name"), "{rejection}");
    }
    let rejection = place.fail(1, &["orbit", "iss.toml", "--oem", "iss.csv"]);
    assert!(rejection.contains("iss.oem"), "{rejection}");
    let rejection = place.fail(
        1,
        &["orbit", "iss.toml", "--oem", "iss.oem", "--frame", "pef"],
    );
    assert!(rejection.contains("--frame itrf"), "{rejection}");
    place.fail(2, &["orbit", "iss.toml", "--every", "0"]);
    let rejection = place.fail(2, &["orbit", "iss.toml", "--every", "0.0001"]);
    assert!(rejection.contains("rows"), "{rejection}");
    let rejection = place.fail(2, &["orbit", "small.toml"]);
    assert!(rejection.contains("no satellite"), "{rejection}");
    assert_eq!(place.names(), ["iss.toml", "small.toml"]);
}

#[test]
fn sources_and_starts_that_cannot_be_are_reported_at_the_line_of_the_scene() {
    let place = Place::new();
    let station = std::fs::read_to_string(config("orbits/iss.tle")).expect("the elements");
    std::fs::write(place.path("iss.tle"), &station).expect("writes");
    place.scene(
        "wrong.toml",
        "[orbit]\nsource = \"omm\"\nfile = \"iss.tle\"\n",
    );
    let rejection = place.fail(2, &["check", "wrong.toml"]);
    for needle in [
        "wrong.toml:2: [orbit] source",
        "two-line elements",
        "source = \"tle\"",
    ] {
        assert!(rejection.contains(needle), "{needle} is not in {rejection}");
    }
    place.scene(
        "low.toml",
        "[[orbit]]\n[[orbit]]\nsource = \"numerical\"\nsemi_major_axis_km = 6300\n",
    );
    let rejection = place.fail(2, &["check", "low.toml"]);
    assert!(
        rejection.contains("low.toml:3: [orbit] source"),
        "{rejection}"
    );
    assert!(rejection.contains("ground"), "{rejection}");
    // It has met the ground before the scene begins.
    place.scene(
        "fallen.toml",
        "[time]\nstart = 2018-01-15T12:00:00Z\n[orbit]\nsource = \"numerical\"\nsemi_major_axis_km = 6538\narea_m2 = 40\nepoch = 2018-01-15T06:00:00Z\n",
    );
    let rejection = place.fail(2, &["check", "fallen.toml"]);
    assert!(
        rejection.contains("[time] start") && rejection.contains("choose a start"),
        "{rejection}"
    );
    assert!(!rejection.contains("newer elements"), "{rejection}");
}

#[test]
fn a_corrupt_record_of_another_satellite_is_passed_over_unless_strict() {
    let place = Place::new();
    let station = std::fs::read_to_string(config("orbits/iss.tle")).expect("the elements");
    let corrupt = std::fs::read_to_string(config("orbits/molniya.tle"))
        .expect("the elements")
        .replace("62.4528", "62.4529");
    std::fs::write(place.path("two.tle"), station + &corrupt).expect("writes");
    let scene = "[orbit]\nfile = \"two.tle\"\n";
    place.scene("loose.toml", &format!("{scene}name = \"25544\"\n"));
    let reported = place.printed(&["check", "loose.toml"]);
    assert!(
        reported.contains("skipped") && reported.contains("checksum"),
        "{reported}"
    );
    place.scene(
        "strict.toml",
        &format!("{scene}name = \"25544\"\nstrict = true\n"),
    );
    let rejection = place.fail(1, &["check", "strict.toml"]);
    assert!(
        rejection.contains("two.tle:8") && rejection.contains("checksum"),
        "{rejection}"
    );
    // Which is the only one cannot be known.
    place.scene("any.toml", scene);
    place.fail(1, &["check", "any.toml"]);
}

/// A row of finals2000A, with the columns that are read.
fn finals_row(day: u32, mjd: u32, x: f64, y: f64, ut1: f64) -> String {
    format!("1801{day:02} {mjd}.00 I {x:9.6} 0.000000 {y:9.6} 0.000000  I{ut1:10.7} 0.0000000\n")
}

#[test]
fn the_table_of_orientation_moves_places_on_the_ground() {
    let place = Place::new();
    let rows: String = (0..3)
        .map(|k| finals_row(15 + k, 58_133 + k, 0.3, -0.2, 0.5))
        .collect();
    std::fs::write(place.path("finals"), &rows).expect("writes");
    let table = EarthOrientation::from_file(&place.path("finals")).expect("a table");
    place.scene("plain.toml", STATION);
    let with = STATION.replace("[time]\n", "[time]\norientation = \"finals\"\n");
    place.scene("with.toml", &with);
    let [plain, with] = ["plain.toml", "with.toml"]
        .map(|scene| read_table(&place.printed(&["orbit", scene, "--csv", "--frame", "itrf"])));
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    let pairs = plain.segments()[0]
        .samples
        .samples()
        .zip(with.segments()[0].samples.samples());
    let mut moved_m = 0.0_f64;
    for (plain, with) in pairs {
        let orientation = table.at(plain.epoch).expect("in the table");
        let state = iss.state_at(plain.epoch).expect("in reach");
        let meant = state.in_frame(Frame::Itrf, &orientation);
        assert_eq!(with.position_m, meant.position_m);
        moved_m = moved_m.max((with.position_m - plain.position_m).length());
    }
    // Half a second of the Earth's rotation, 7.3e-5 rad/s at up to 6780 km.
    assert!((150.0..260.0).contains(&moved_m), "{moved_m} m");

    // Images use the same source.
    let open = |name: &str| {
        let scene = Scene::load(&place.path(name)).expect("a good scene");
        Flight::open(scene).expect("opens")
    };
    let (plain, with) = (open("plain.toml"), open("with.toml"));
    let start = plain.scene().time.start;
    let eyes = [&plain, &with].map(|flight| flight.at(start, 1.5).expect("a view").satellite);
    let [Some(plain), Some(with)] = eyes else {
        panic!("no satellite");
    };
    let turned = (plain.place.lon_rad - with.place.lon_rad).abs();
    assert!((3e-5..4.5e-5).contains(&turned), "{turned}");

    let reported = place.printed(&["check", "plain.toml"]);
    assert!(reported.contains("420 m"), "{reported}");
    let reported = place.printed(&["check", "with.toml"]);
    assert!(
        reported.contains("measured until") && !reported.contains("420 m"),
        "{reported}"
    );
    place.scene(
        "late.toml",
        "[time]\nstart = \"2018-01-16T23:00:00Z\"\nduration_s = 5000\norientation = \"finals\"\n",
    );
    let rejection = place.fail(2, &["check", "late.toml"]);
    assert!(
        rejection.contains("late.toml:4: [time] orientation"),
        "{rejection}"
    );
    assert!(rejection.contains("2018-01-17T00:00:00Z"), "{rejection}");
}

#[test]
fn cameras_fly_with_the_satellite_that_is_named() {
    let place = Place::new();
    let two = "[[orbit]]\n[[orbit]]\nsource = \"kepler\"\nname = \"High\"\nperiapsis_km = 26000\n";
    let height_km = |name: &str, scene: &str| {
        place.scene(name, scene);
        let scene = Scene::load(&place.path(name)).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        assert_eq!(flight.satellites().len(), 2);
        let moment = flight.at(flight.scene().time.start, 1.5).expect("a view");
        moment.satellite.expect("a satellite").place.height_m / 1e3
    };
    let first = height_km("first.toml", two);
    assert!((380.0..440.0).contains(&first), "{first}");
    let named = height_km("named.toml", &format!("{two}[camera]\nfollow = \"high\"\n"));
    assert!((19_600.0..19_700.0).contains(&named), "{named}");
    place.scene(
        "nobody.toml",
        &format!("{two}[camera]\nfollow = \"Hihg\"\n"),
    );
    let rejection = place.fail(2, &["check", "nobody.toml"]);
    assert!(
        rejection.contains("nobody.toml:7: [camera] follow"),
        "{rejection}"
    );
    assert!(rejection.contains("did you mean \"High\"?"), "{rejection}");
}

/// A satellite that is not followed may come and go.
#[test]
fn satellites_that_are_not_followed_need_not_be_known_throughout() {
    let place = Place::new();
    let oem = config("orbits/falling.oem").display().to_string();
    let scene = format!(
        "[time]\nduration_s = 6000\n[[orbit]]\n[[orbit]]\nsource = \"oem\"\nfile = \"{oem}\"\n"
    );
    place.scene("two.toml", &scene);
    let flight = Flight::open(Scene::load(&place.path("two.toml")).expect("a good scene"));
    let flight = flight.expect("opens");
    let (start, end) = (flight.scene().time.start, flight.scene().time.end());
    let known = |epoch| -> Vec<(String, bool)> {
        let states = flight.states_at(epoch);
        states
            .map(|(name, state)| (name.to_owned(), state.is_ok()))
            .collect()
    };
    let both = |falling| {
        vec![
            ("ISS (ZARYA)".to_owned(), true),
            ("Falling".to_owned(), falling),
        ]
    };
    assert_eq!(known(start), both(true));
    assert_eq!(known(end), both(false));
    assert!(flight.at(end, 1.5).is_ok());
    // Followed, it must be.
    place.scene(
        "led.toml",
        &format!("{scene}[camera]\nfollow = \"falling\"\n"),
    );
    let rejection = place.fail(2, &["check", "led.toml"]);
    assert!(rejection.contains("2018-01-15T13:10:00Z"), "{rejection}");
}

#[test]
fn burns_change_a_motion_and_its_events_are_reported() {
    let place = Place::new();
    // A circle of 7000 km about a point: 5829 s a turn, twice in the scene's time.
    let scene = |more: &str| {
        format!(
            "[time]\nduration_s = 12000\n[orbit]\nsource = \"numerical\"\nname = \"Probe\"\nsemi_major_axis_km = 7000\n\
             inclination_deg = 60\ntrue_anomaly_deg = 10\ngravity_degree = 0\ndrag = false\nsun = false\nmoon = false\nradiation = false\n{more}\n"
        )
    };
    // 100 m/s forwards, the other side of the orbit rises by 4 a/v Δv = 371 km.
    let burn = "burns = [{ start = \"2018-01-15T12:10:00Z\", duration_s = 100, acceleration_m_s2 = [1, 0, 0] }]";
    place.scene("plain.toml", &scene(""));
    place.scene("burn.toml", &scene(burn));
    place.scene(
        "events.toml",
        &scene("events = [\"nodes\", \"eclipses\"]\nmethod = \"explicit\""),
    );
    // Half a turn of the new orbit, about 6029 s, after the middle of the burn at 650 s.
    let radius_km = |file: &str| {
        let at = "2018-01-15T13:01:04Z";
        let text = place.printed(&["orbit", file, "--at", at, "--frame", "gcrf", "--csv"]);
        let row = text.lines().nth(1).expect("a row");
        let numbers = row.split(',').skip(3).take(3);
        let numbers = numbers.map(|number| number.parse::<f64>().expect("a number"));
        numbers.map(|x| x * x).sum::<f64>().sqrt()
    };
    let (plain, burnt) = (radius_km("plain.toml"), radius_km("burn.toml"));
    assert!((plain - 7000.0).abs() < 1e-3, "{plain}");
    assert!((burnt - 7371.0).abs() < 15.0, "{burnt}");
    let reported = place.printed(&["orbit", "events.toml", "--events", "--csv"]);
    let rows: Vec<Vec<&str>> = reported
        .lines()
        .skip(1)
        .map(|row| row.split(',').collect())
        .collect();
    let of = |kind: &str| rows.iter().filter(|row| row[2] == kind).count();
    assert_eq!(reported.lines().next(), Some("name,epoch_utc,event"));
    assert!(rows.iter().all(|row| row[0] == "Probe"), "{reported}");
    // From 10° past the ascending node on, two turns and a bit.
    assert_eq!(
        (of("ascending node"), of("descending node")),
        (2, 2),
        "{reported}"
    );
    assert_eq!(
        (of("periapsis"), of("apoapsis"), of("impact")),
        (0, 0, 0),
        "{reported}"
    );
    assert_eq!(of("eclipse begins"), of("eclipse ends"), "{reported}");
    assert!(of("eclipse begins") >= 1, "{reported}");
    assert!(
        rows.windows(2).all(|pair| pair[0][1] <= pair[1][1]),
        "in order of time"
    );
    // The shadow of the ellipsoid beside that of the force model's sphere.
    assert!(
        of("umbra begins") >= 1 && of("penumbra ends") >= 1,
        "{reported}"
    );
}
