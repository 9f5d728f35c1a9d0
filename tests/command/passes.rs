//! `terrella orbit --passes`: the same passes in every layout, and rejections.

use crate::Place;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Orientation, utc_from_rfc3339};
use terrella_orbit::{Feed, Frame, Sgp4Feed};

/// Elevation of the built-in space station over 33.5° S, 70.25° W, 520 m, degrees.
fn elevation_deg(epoch: Epoch) -> f64 {
    let station = Sgp4Feed::built_in_iss().expect("built in");
    let state = station.state_at(epoch).expect("known");
    let itrf = state.in_frame(Frame::Itrf, &Orientation::default());
    let place = Geodetic::from_degrees(-33.5, -70.25, 520.0);
    let line = itrf.position_m - Ellipsoid::WGS84.itrf_from_geodetic(place);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    (line.dot(up) / line.length()).asin().to_degrees()
}

#[test]
fn passes_are_where_the_satellite_is_and_the_same_in_every_layout() {
    let place = Place::new();
    place.scene("iss.toml", "[time]\nduration_s = 1800\n");
    let ask = |more: &[&str]| {
        let asked = [
            "orbit",
            "iss.toml",
            "--passes",
            "-33.5,-70.25,520",
            "--days",
            "2",
            "--min-elevation",
            "20",
        ];
        place.printed(&[&asked[..], more].concat())
    };
    let csv = ask(&["--csv"]);
    let rows: Vec<Vec<&str>> = csv
        .lines()
        .skip(1)
        .map(|row| row.split(',').collect())
        .collect();
    assert!(rows.len() > 2, "{csv}");
    let json: serde_json::Value = serde_json::from_str(&ask(&["--json"])).expect("JSON");
    let listed = json["passes"].as_array().expect("an array");
    assert_eq!(
        (listed.len(), json["name"].as_str()),
        (rows.len(), Some("ISS (ZARYA)"))
    );
    let text = ask(&[]);
    for (row, one) in rows.iter().zip(listed) {
        let [begin, highest, end] = [1, 4, 8].map(|column| row[column]);
        assert_eq!(one["begin_utc"].as_str(), Some(begin));
        assert!(
            text.contains(begin) && text.contains(highest) && text.contains(end),
            "{text}"
        );
        let at = |text| elevation_deg(utc_from_rfc3339(text).expect("a date"));
        // To a millisecond: the elevation changes by less than a degree in a second.
        assert!((at(begin) - 20.0).abs() < 0.002, "{row:?}");
        assert!((at(end) - 20.0).abs() < 0.002, "{row:?}");
        let most: f64 = row[6].parse().expect("a number");
        assert!(most > 20.0 && (at(highest) - most).abs() < 0.001, "{row:?}");
    }
    // Without --days the scene's own half an hour is looked through.
    let short = place.printed(&["orbit", "iss.toml", "--passes", "90,0"]);
    assert!(
        short.contains("12:00:00.000Z to 2018-01-15T12:30:00.000Z") && short.ends_with("none\n"),
        "{short}"
    );
}

/// Vienna in the days of the elements, as in the tests of the library.
#[test]
fn visible_times_are_printed_in_every_layout() {
    let place = Place::new();
    place.scene("iss.toml", "[time]\nstart = \"2018-01-25T00:00:00Z\"\n");
    let ask = |more: &[&str]| {
        let asked = [
            "orbit",
            "iss.toml",
            "--passes",
            "48.2,16.4,200",
            "--days",
            "1",
        ];
        place.printed(&[&asked[..], more].concat())
    };
    let bright = ["--standard-magnitude", "-1.8"];
    let json = ask(&[&bright[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let listed = json["passes"].as_array().expect("an array");
    let seen: Vec<_> = listed
        .iter()
        .flat_map(|one| one["visible"].as_array().expect("an array"))
        .collect();
    let [visible] = seen[..] else {
        panic!("{seen:?}");
    };
    let time = |key: &str| visible[key].as_str().expect("a time");
    assert!(
        time("begin_utc").starts_with("2018-01-25T17:12:4"),
        "{visible}"
    );
    assert!(
        time("end_utc").starts_with("2018-01-25T17:13:4"),
        "{visible}"
    );
    let magnitude = visible["magnitude"].as_f64().expect("a magnitude");
    assert!((magnitude + 1.573).abs() < 0.02, "{visible}");
    let csv = ask(&[&bright[..], &["--csv"]].concat());
    let rows: Vec<Vec<_>> = csv.lines().map(|row| row.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == 16), "{csv}");
    assert_eq!(rows.len(), listed.len() + 1);
    for (row, one) in rows.iter().skip(1).zip(listed) {
        let duration: f64 = row[11].parse().expect("seconds");
        assert!((duration - one["duration_s"].as_f64().expect("seconds")).abs() < 0.001);
    }
    let found = rows.iter().skip(1).find(|row| !row[12].is_empty());
    let found = found.expect("the visible one");
    assert_eq!(
        found[12..15],
        ["begin_utc", "end_utc", "brightest_utc"].map(time)
    );
    assert_eq!(found[15], format!("{magnitude:.2}"));
    // An hour later by the clocks of Vienna.
    let text = ask(&[&bright[..], &["--time-zone", "+01:00"]].concat());
    let there = time("begin_utc")
        .replace("T17", "T18")
        .replace('Z', "+01:00");
    let line = format!("  visible {there} to 2018-01-25T18:13:4");
    assert!(
        text.contains(&line) && text.contains("magnitude -1.6"),
        "{text}"
    );
    assert!(!text.contains("00Z"), "{text}");
    let text = ask(&[]);
    assert!(
        text.contains("  visible ") && !text.contains("magnitude"),
        "{text}"
    );
    // Its peak is magnitude −1.57.
    let text = ask(&[&bright[..], &["--max-magnitude", "-1.5"]].concat());
    assert!(text.contains("  visible "), "{text}");
    let text = ask(&[&bright[..], &["--max-magnitude", "-1.7"]].concat());
    assert!(
        !text.contains("  visible ") && text.contains("fainter than magnitude -1.7"),
        "{text}"
    );
}

#[test]
fn start_moves_tables_and_is_named_where_at_has_no_meaning() {
    let place = Place::new();
    place.scene("iss.toml", "[time]\nduration_s = 1800\n");
    let start = ["orbit", "iss.toml", "--start", "2018-01-16T00:00:00Z"];
    let passes = ["--passes", "48.2,16.4"];
    let text = place.printed(&[&start[..], &passes].concat());
    assert!(
        text.contains("2018-01-16T00:00:00.000Z to 2018-01-16T00:30:00.000Z"),
        "{text}"
    );
    let text = place.printed(&[&start[..], &["--csv"]].concat());
    let row = text.lines().nth(1).expect("a row");
    assert!(row.contains(",2018-01-16T00:00:00"), "{row}");
    // The built-in station has a stand-in at other dates.
    place.printed(&[&["orbit", "iss.toml", "--start", "now"], &passes[..]].concat());
    for more in [&passes[..], &["--events"], &["--days", "2"]] {
        let reported = place.fail(2, &[&["orbit", "iss.toml", "--at", "now"], more].concat());
        assert!(reported.contains("--start now"), "{reported}");
    }
    place.fail(2, &[&start[..], &["--at", "now"]].concat());
}

#[test]
fn what_is_no_place_or_no_time_is_rejected() {
    let place = Place::new();
    place.scene("iss.toml", "[time]\nduration_s = 1800\n");
    for bad in [
        &["--passes", "91,0"][..],
        &["--passes", "48.2"],
        &["--passes", "48.2,16.4", "--min-elevation", "90"],
        &["--passes", "48.2,16.4", "--days", "0"],
        &["--passes", "48.2,16.4", "--oem", "a.oem"],
        &["--min-elevation", "5"],
        &["--standard-magnitude", "-1.8"],
        &["--passes", "48.2,16.4", "--standard-magnitude", "bright"],
        &["--passes", "48.2,16.4", "--max-magnitude", "4"],
        &["--passes", "48.2,16.4", "--time-zone", "CET"],
        &["--passes", "48.2,16.4", "--time-zone", "+01:00", "--csv"],
    ] {
        let rejection = place.fail(2, &[&["orbit", "iss.toml"][..], bad].concat());
        assert!(rejection.contains("--"), "{rejection}");
    }
    let rejection = place.fail(2, &["orbit", "small.toml", "--passes", "0,0"]);
    assert!(rejection.contains("satellite"), "{rejection}");
    let help = place.printed(&["orbit", "--help"]);
    assert!(help.contains("--min-elevation"), "{help}");
}
