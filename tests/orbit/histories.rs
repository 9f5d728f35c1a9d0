//! Element sets as archives and catalogues have them: several epochs of one satellite, sets that come twice, records that are wrong,
//! and texts in other encodings.

use crate::{ISS, edited, from_text};
use std::path::Path;
use terrella_frames::Duration;
use terrella_orbit::{Catalogue, Feed, OrbitError, TleFeed};

fn read(text: &str, is_strict: bool) -> Result<Catalogue, OrbitError> {
    Catalogue::from_text(text, Path::new("sets.tle"), is_strict)
}

/// A set of the station at a day of 2018 and with a mean anomaly.
fn set(day: &str, anomaly: &str) -> String {
    let lines = [
        edited(ISS[0], 19, &format!("18{day}")),
        edited(ISS[1], 44, anomaly),
    ];
    format!("HIST\n{}\n{}\n", lines[0], lines[1])
}

fn three() -> [String; 3] {
    [
        set("020.50000000", " 39.5332"),
        set("024.50000000", " 80.0000"),
        set("030.50000000", "120.0000"),
    ]
}

#[test]
fn the_set_nearest_to_the_instant_is_used() {
    let sets = three();
    let alone: Vec<TleFeed> = sets
        .iter()
        .map(|one| from_text(one, None).unwrap())
        .collect();
    let shuffled = [&sets[2], &sets[0], &sets[1]].map(String::as_str).concat();
    let catalogue = read(&shuffled, true).unwrap();
    assert_eq!(catalogue.feeds.len(), 1);
    let notices: Vec<_> = catalogue.faults.iter().map(ToString::to_string).collect();
    assert_eq!(
        notices,
        [
            "sets.tle:2: 3 element sets of HIST, of 2018-01-20T12:00:00.000Z to 2018-01-30T12:00:00.000Z; at each instant the one of the nearest epoch is used"
        ]
    );
    assert!(catalogue.faults[0].is_notice());
    for (way, feed) in [
        (
            "catalogue",
            catalogue.into_one(Path::new("sets.tle"), None).unwrap(),
        ),
        ("one", from_text(&shuffled, None).unwrap()),
        ("by name", from_text(&shuffled, Some("hist")).unwrap()),
        ("by number", from_text(&shuffled, Some("25544")).unwrap()),
    ] {
        // Days from the first epoch, and the set that is the nearest: half-way the later one.
        for (days, nearest) in [
            (-20.0, 0),
            (0.0, 0),
            (1.99, 0),
            (2.0, 1),
            (4.0, 1),
            (6.99, 1),
            (7.0, 2),
            (10.0, 2),
            (39.0, 2),
        ] {
            let at = alone[0].epoch() + Duration::from_seconds(days * 86_400.0);
            let wanted = alone[nearest].state_at(at).unwrap();
            assert_eq!(feed.state_at(at).unwrap(), wanted, "{way} {days}");
        }
        assert_eq!(
            feed.validity(),
            (alone[0].validity().0, alone[2].validity().1)
        );
        assert_eq!((feed.epoch(), feed.gaps()), (alone[2].epoch(), Vec::new()));
    }
}

#[test]
fn sets_far_apart_leave_a_gap() {
    let (early, late) = (
        set("001.50000000", " 39.5332"),
        set("101.50000000", " 80.0000"),
    );
    let feed = from_text(&format!("{early}{late}"), None).unwrap();
    let (a, b) = (
        from_text(&early, None).unwrap(),
        from_text(&late, None).unwrap(),
    );
    assert_eq!(feed.gaps(), [(a.validity().1, b.validity().0)]);
    let between = a.epoch() + Duration::from_seconds(40.0 * 86_400.0);
    assert!(matches!(
        feed.state_at(between),
        Err(OrbitError::OutsideValidity { .. })
    ));
}

#[test]
fn a_wrong_set_of_a_history_costs_itself_alone() {
    let [first, second, third] = three();
    let wrong = second.replace("9018", "901x").replacen("  999", "  99x", 1);
    let catalogue = read(&[first, wrong, third].concat(), false).unwrap();
    assert!(catalogue.faults.iter().any(|fault| !fault.is_notice()));
    assert!(!catalogue.is_open_which_is_meant());
    let other = set("024.50000000", "x0.0000").replace("HIST", "OTHER");
    let catalogue = read(&[three()[0].clone(), other].concat(), false).unwrap();
    assert!(catalogue.is_open_which_is_meant());
}

#[test]
fn a_set_that_comes_twice_is_one() {
    let [first, ..] = three();
    let twice = read(&format!("{first}{first}"), true).unwrap();
    assert_eq!((twice.feeds.len(), twice.faults.len()), (1, 0));
    assert!(from_text(&format!("{first}{first}"), None).is_ok());
    // Of two sets of one epoch the later one is used.
    let corrected = set("020.50000000", "100.0000");
    let read = read(&format!("{first}{corrected}"), true).unwrap();
    assert_eq!(read.feeds[0].elements().mean_anomaly_deg, 100.0);
    // One that has been renamed.
    let renamed = set("024.50000000", " 80.0000").replace("HIST", "NEW");
    let one = self::read(&format!("{first}{renamed}"), true).unwrap();
    assert_eq!((one.feeds.len(), one.feeds[0].name()), (1, "NEW"));
    // Another satellite of that number, as objects without one have: both are there.
    let other = first.replace("HIST", "OTHER").replace("98067A", "98067B");
    let lines: Vec<_> = other
        .lines()
        .map(|line| {
            if line.starts_with("1 ") {
                crate::with_checksum(line)
            } else {
                line.to_owned()
            }
        })
        .collect();
    let both = self::read(&format!("{first}{}\n", lines.join("\n")), true).unwrap();
    let names: Vec<_> = both.feeds.iter().map(Feed::name).collect();
    assert_eq!(names, ["HIST", "OTHER"]);
}

#[test]
fn a_satellite_that_has_decayed_stays_decayed() {
    let lines = [
        "1 91001U 26001A   26100.50000000  .05000000  10000-4  50000-1 0  9990",
        "2 91001  97.5000 100.0000 0012000  90.0000  10.0000 15.95000000  1009",
    ];
    let feed = from_text(
        &format!("FALLING\n{}\n", lines.map(crate::with_checksum).join("\n")),
        None,
    )
    .unwrap();
    let end = feed.validity().1;
    for days in [0.01, 0.5, 1.0, 3.0, 5.0, 10.0, 29.0, 31.0, 100.0, 1000.0] {
        let after = end + Duration::from_seconds(days * 86_400.0);
        assert!(feed.state_at(after).is_err(), "{days}");
        let before = feed.validity().0 - Duration::from_seconds(days * 86_400.0);
        assert!(feed.state_at(before).is_err(), "-{days}");
    }
    // All states are near the Earth.
    for hour in -40..40 {
        let at = feed.epoch() + Duration::from_seconds(f64::from(hour) * 3600.0);
        if let Ok(state) = feed.state_at(at) {
            assert!(state.position_m.length() < 8e6, "{hour}");
        }
    }
}

#[test]
fn a_wanted_record_that_is_wrong_is_named() {
    let [good, ..] = three();
    let [one, two] = ISS;
    let wanted = one.replacen("25544", "91003", 1);
    let second = edited(two, 3, "91003");
    let first = edited(one, 3, "91003");
    for (record, line) in [
        (format!("WANTED\n{wanted}\n{second}\n"), 5),
        (
            format!(
                "WANTED\n{first}\n{}\n",
                second.replace("51.6424", "51.6425")
            ),
            6,
        ),
        (format!("WANTED\n{first}\n"), 5),
        (format!("WANTED\n{first}\n{two}\n"), 6),
        (
            format!("WANTED\n{first}\n{}\n", edited(&second, 9, "251.6424")),
            6,
        ),
    ] {
        for text in [format!("{good}{record}"), format!("{good}{record}{good}")] {
            for name in ["wanted", "91003"] {
                let catalogue = read(&text, false).unwrap();
                let error = catalogue
                    .into_one(Path::new("sets.tle"), Some(name))
                    .unwrap_err();
                let says = error.to_string();
                assert!(says.starts_with(&format!("sets.tle:{line}")), "{says}");
                assert!(
                    says.ends_with(&format!("{name:?} has no other record in the file")),
                    "{says}"
                );
            }
        }
        // With another record, that one is flown.
        let both = format!("{good}{record}WANTED\n{first}\n{second}\n");
        assert!(
            read(&both, false)
                .unwrap()
                .into_one(Path::new("sets.tle"), Some("WANTED"))
                .is_ok()
        );
    }
    let unknown = read(&good, false)
        .unwrap()
        .into_one(Path::new("sets.tle"), Some("WANTED"));
    assert!(matches!(unknown, Err(OrbitError::UnknownName { .. })));
}

const MEMBERS: &str = r#""OBJECT_ID":"1998-067A","EPOCH":"2018-01-20T12:00:00","MEAN_MOTION":15.54,"ECCENTRICITY":0.001,"INCLINATION":51.6,"RA_OF_ASC_NODE":10,"ARG_OF_PERICENTER":20,"MEAN_ANOMALY":30,"BSTAR":0.00002"#;

#[test]
fn a_wanted_message_that_is_wrong_is_named() {
    let object = |name: &str, number: u32| {
        format!("{{\"OBJECT_NAME\":\"{name}\",\"NORAD_CAT_ID\":{number},{MEMBERS}}}")
    };
    let text = format!(
        "[{},\n{}]",
        object("GOOD", 1),
        object("BAD", 2).replace(":15.54", ":\"fast\"")
    );
    for name in ["bad", "2"] {
        let error = read(&text, false)
            .unwrap()
            .into_one(Path::new("sets.tle"), Some(name));
        let says = error.unwrap_err().to_string();
        assert!(
            says.starts_with("sets.tle:2:") && says.contains("MEAN_MOTION"),
            "{says}"
        );
    }
    let csv = "OBJECT_NAME,NORAD_CAT_ID,EPOCH,MEAN_MOTION,ECCENTRICITY,INCLINATION,RA_OF_ASC_NODE,ARG_OF_PERICENTER,MEAN_ANOMALY,BSTAR\n\
        GOOD,1,2018-01-20T12:00:00,15.5,0.001,51.6,10,20,30,0.00002\nBAD,2,2018-01-20T12:00:00,15.5,0.001,51.6,10\n";
    let error = read(csv, false)
        .unwrap()
        .into_one(Path::new("sets.tle"), Some("BAD"));
    let says = error.unwrap_err().to_string();
    assert!(
        says.starts_with("sets.tle:3:") && says.contains("7 fields"),
        "{says}"
    );
}

#[test]
fn without_a_name_unnamed_satellites_are_listed() {
    let [one, two] = ISS;
    let text = format!(
        "{one}\n{two}\n{}\n{}\n",
        edited(one, 3, "91003"),
        edited(two, 3, "91003")
    );
    let error = from_text(&text, None).unwrap_err().to_string();
    assert_eq!(
        error,
        "sets.tle: 2 element sets: 25544 (25544, line 1), 91003 (91003, line 3); name one of these numbers"
    );
}

#[test]
fn the_fault_that_ends_the_work_is_the_one_that_is_named() {
    // The file is not ended by a line feed, which does no harm; its only record is wrong.
    let csv = "OBJECT_NAME,EPOCH,MEAN_MOTION,ECCENTRICITY,INCLINATION,RA_OF_ASC_NODE,ARG_OF_PERICENTER,MEAN_ANOMALY,BSTAR\n\
        BAD,2018-01-20T12:00:00,15.5,7,51.6,10,20,30,0.00002";
    let error = read(csv, false).unwrap_err().to_string();
    assert!(error.contains("ECCENTRICITY is \"7\""), "{error}");
}

#[test]
fn epochs_of_messages_are_read_in_every_form() {
    let epoch = |text: &str| {
        let object = format!(
            "{{\"OBJECT_NAME\":\"A\",{}}}",
            MEMBERS.replace("2018-01-20T12:00:00", text)
        );
        from_text(&object, None).map(|feed| feed.epoch())
    };
    let wanted = epoch("2018-01-20T12:00:00").unwrap();
    for text in [
        "2018-01-20 12:00:00",
        "2018-01-20T13:30:00+01:30",
        "2018-01-20T09:00:00.000-03:00",
        "2018-020T12:00:00Z",
    ] {
        assert_eq!(epoch(text).unwrap(), wanted, "{text}");
    }
    let error = epoch("20 January 2018").unwrap_err().to_string();
    assert!(
        error.contains("EPOCH: \"20 January 2018\" is not a date"),
        "{error}"
    );
}

const XML: &str = "<ndm><omm id=\"CCSDS_OMM_VERS\" version=\"2.0\"><body><segment><metadata><OBJECT_NAME>SATÉLITE</OBJECT_NAME><OBJECT_ID>2026-001A</OBJECT_ID><CENTER_NAME>EARTH</CENTER_NAME><REF_FRAME>TEME</REF_FRAME><TIME_SYSTEM>UTC</TIME_SYSTEM><MEAN_ELEMENT_THEORY>SGP4</MEAN_ELEMENT_THEORY></metadata><data><meanElements><EPOCH>2026-04-10T12:00:00</EPOCH><MEAN_MOTION>15.5</MEAN_MOTION><ECCENTRICITY>.001</ECCENTRICITY><INCLINATION>51.6</INCLINATION><RA_OF_ASC_NODE>100</RA_OF_ASC_NODE><ARG_OF_PERICENTER>90</ARG_OF_PERICENTER><MEAN_ANOMALY>10</MEAN_ANOMALY></meanElements><tleParameters><NORAD_CAT_ID>91007</NORAD_CAT_ID><BSTAR>.00002</BSTAR></tleParameters></data></segment></body></omm></ndm>";

#[test]
fn files_say_in_which_encoding_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xml");
    let declared =
        |encoding: &str| format!("<?xml version=\"1.0\" encoding=\"{encoding}\"?>\n{XML}");
    let latin1: Vec<u8> = declared("ISO-8859-1")
        .chars()
        .map(|c| u8::try_from(c).unwrap())
        .collect();
    let utf16: Vec<u8> = declared("UTF-16")
        .encode_utf16()
        .flat_map(u16::to_be_bytes)
        .collect();
    let marked: Vec<u8> = format!("\u{feff}{XML}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for bytes in [latin1, utf16, marked, declared("UTF-8").into_bytes()] {
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(
            Catalogue::from_file(&path, true).unwrap().feeds[0].name(),
            "SATÉLITE"
        );
        assert_eq!(TleFeed::from_file(&path, None).unwrap().name(), "SATÉLITE");
    }
    std::fs::write(&path, declared("KOI8-R")).unwrap();
    let error = Catalogue::from_file(&path, false).unwrap_err().to_string();
    assert!(error.contains("its encoding is \"KOI8-R\""), "{error}");
}

#[test]
fn lines_may_end_in_carriage_returns() {
    let [good, ..] = three();
    let feed = from_text(&good.replace('\n', "\r"), None).unwrap();
    assert_eq!((feed.name(), feed.line()), ("HIST", 2));
}
