//! Orbit parameter messages at the command line and in scenes.

use crate::Place;
use crate::orbit::read_table;
use terrella::frames::utc_from_rfc3339;
use terrella_orbit::{Ephemerides, Feed};

const STATE: &str = "CCSDS_OPM_VERS = 2.0\nOBJECT_NAME = SAT\nOBJECT_ID = 2018-001A\nCENTER_NAME = EARTH\nREF_FRAME = EME2000\n\
    TIME_SYSTEM = UTC\nEPOCH = 2018-01-01T00:00:00\nX = 6778.137\nY = 0\nZ = 0.5\nX_DOT = 0\nY_DOT = 4.7\nZ_DOT = 6.05\n";
const BURN: &str = "MAN_EPOCH_IGNITION = 2018-01-01T00:30:00\nMAN_DURATION = 0\nMAN_DELTA_MASS = 0\nMAN_REF_FRAME = TNW\n\
    MAN_DV_1 = 0.1\nMAN_DV_2 = 0\nMAN_DV_3 = 0\n";

#[test]
fn a_parameter_message_is_flown_from_its_state() {
    let place = Place::new();
    place.scene("sat.opm", &format!("{STATE}{BURN}"));
    // The format is detected from the text; the scene begins with the state.
    let arguments = ["orbit", "sat.opm", "--frame", "eme2000", "--csv"];
    let feed = read_table(&place.printed(&arguments));
    let (first, last) = feed.validity();
    assert_eq!(
        first,
        utc_from_rfc3339("2018-01-01T00:00:00Z").expect("a date")
    );
    assert!((last - first).to_seconds() > 5000.0);
    let state = feed.state_at(first).expect("known");
    assert!((state.position_m.x - 6_778_137.0).abs() < 1e-6, "{state:?}");
    assert!((state.velocity_m_s.z - 6050.0).abs() < 1e-9, "{state:?}");
    // Without the impulse the speed is 100 m/s less after it.
    place.scene("coasting.opm", STATE);
    let coasting =
        read_table(&place.printed(&["orbit", "coasting.opm", "--frame", "eme2000", "--csv"]));
    let at = utc_from_rfc3339("2018-01-01T00:30:00Z").expect("a date");
    let [pushed, coasting] =
        [&feed, &coasting].map(|feed| feed.state_at(at).expect("known").velocity_m_s.length());
    assert!(
        (pushed - coasting - 100.0).abs() < 1e-3,
        "{pushed} {coasting}"
    );

    // For another source it is an error that names the right one; an explicit scene may begin before the state.
    place.scene(
        "wrong.toml",
        "[orbit]\nsource = \"oem\"\nfile = \"sat.opm\"\n",
    );
    let error = place.fail(1, &["check", "wrong.toml"]);
    assert!(error.contains("source = \"opm\""), "{error}");
    place.scene(
        "before.toml",
        "[time]\nstart = \"2017-12-31T23:00:00Z\"\n[orbit]\nsource = \"opm\"\nfile = \"sat.opm\"\nname = \"2018-001A\"\n",
    );
    let checked = place.printed(&["check", "before.toml"]);
    assert!(
        checked.contains("orbit parameter message, integrated: 2018-001A of"),
        "{checked}"
    );
    let known = "known          2017-12-31T22:59:00";
    assert!(checked.contains(known), "{checked}");
}

#[test]
fn messages_are_written_in_segments_with_the_designator() {
    let place = Place::new();
    place.scene("sat.opm", &format!("{STATE}{BURN}"));
    place.succeed(&[
        "orbit", "sat.opm", "--every", "97", "--frame", "gcrf", "--oem", "sat.oem",
    ]);
    let read = Ephemerides::from_file(&place.path("sat.oem"), true).expect("an OEM");
    let feed = &read.feeds[0];
    assert_eq!(feed.object_id(), Some("2018-001A"));
    let at = utc_from_rfc3339("2018-01-01T00:30:00Z").expect("a date");
    let [before, behind] = feed.segments() else {
        panic!("{} segments", feed.segments().len());
    };
    assert_eq!((before.usable.1, behind.usable.0), (at, at));
    assert!(feed.gaps().is_empty());
    // The impulse is between the segments: 100 m/s.
    let speed = |samples: &terrella_orbit::interpolated::InterpolatedStates| {
        samples.state_at(at).expect("known").velocity_m_s.length()
    };
    let change = speed(&behind.samples) - speed(&before.samples);
    assert!((change - 100.0).abs() < 1e-3, "{change}");
    // Between the states it is as good as without an impulse: the message that is read is the satellite of the first one.
    place.succeed(&[
        "orbit",
        "sat.oem",
        "--every",
        "61",
        "--frame",
        "gcrf",
        "--oem",
        "again.oem",
    ]);
    let again = Ephemerides::from_file(&place.path("again.oem"), true).expect("an OEM");
    let again = &again.feeds[0];
    assert_eq!(
        (again.object_id(), again.segments().len()),
        (Some("2018-001A"), 2)
    );
    let flown = place.printed(&[
        "orbit", "sat.opm", "--every", "13", "--frame", "gcrf", "--csv",
    ]);
    let mut worst_m = 0.0_f64;
    for sample in read_table(&flown).segments()[0].samples.samples() {
        let state = again.state_at(sample.epoch).expect("known");
        worst_m = worst_m.max(state.position_m.distance(sample.position_m));
    }
    assert!(worst_m < 0.5, "{worst_m}");
}
