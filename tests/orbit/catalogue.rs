//! Files of many two-line sets.

use crate::{ISS, edited};
use std::fmt::Write;
use std::path::Path;
use terrella_frames::Duration;
use terrella_orbit::{Catalogue, Feed, LineFault, OrbitError};

fn read(text: &str, is_strict: bool) -> Result<Catalogue, OrbitError> {
    Catalogue::from_text(text, Path::new("sets.tle"), is_strict)
}

/// 700 sets, every second with a name line, of satellites 1, 2, 3 … and, from A0000 on, of six digits.
fn many() -> String {
    let mut text = String::new();
    for k in 0..700 {
        let number = match k {
            0..350 => format!("{:05}", k + 1),
            _ => format!("A{:04}", k),
        };
        if k % 2 == 0 {
            let _ = writeln!(text, "SATELLITE {k}");
        }
        let anomaly = format!("{:8.4}", f64::from(k) * 0.5);
        let lines = [
            edited(ISS[0], 3, &number),
            edited(&edited(ISS[1], 3, &number), 44, &anomaly),
        ];
        let _ = writeln!(text, "{}\r\n{}", lines[0], lines[1]);
    }
    text
}

#[test]
fn all_of_a_file_are_read() {
    for is_strict in [true, false] {
        let catalogue = read(&many(), is_strict).unwrap();
        assert_eq!((catalogue.feeds.len(), catalogue.faults.len()), (700, 0));
        let numbers: Vec<_> = catalogue
            .feeds
            .iter()
            .map(|f| f.catalogue_number())
            .collect();
        assert_eq!((numbers[0], numbers[349], numbers[350]), (1, 350, 100_350));
        assert_eq!(catalogue.feeds[2].name(), "SATELLITE 2");
        assert_eq!(catalogue.feeds[3].name(), "00004");
        let elements = catalogue.feeds[9].elements();
        assert_eq!(elements.mean_anomaly_deg, 4.5);
        assert_eq!(elements.object_id.as_deref(), Some("1998-067A"));
        let origin = Path::new("sets.tle");
        let found = catalogue.into_one(origin, Some("100400")).unwrap();
        assert_eq!(found.name(), "SATELLITE 400");
    }
}

#[test]
fn the_good_are_used_and_the_bad_are_listed() {
    let [one, two] = ISS;
    let named = |name: &str| format!("{name}\n{one}\n{two}\n");
    let spoilt = two.replace("51.6424", "51.6425");
    // What stands in the file, how many are good, and the lines that are named.
    let cases: [(String, usize, &[&str]); 9] = [
        (
            format!("A\n{one}\n{spoilt}\n{}", named("B")),
            1,
            &["3:69: bad checksum"],
        ),
        (
            format!("A\n{}\n{two}\n{}", &one[..60], named("B")),
            1,
            &["2: short line"],
        ),
        (
            format!("A\n{one}\n{}", named("B")),
            1,
            &["2: line 1 of a set is not followed"],
        ),
        (
            format!("A\n{}{}", named("B"), named("C")),
            2,
            &["1: \"A\" is neither"],
        ),
        (
            format!("{one}\n{one}\n{two}\n"),
            1,
            &["1: line 1 of a set is not followed"],
        ),
        (
            format!("{one}\n{}\n{two}\n{}", &one[..50], named("B")),
            1,
            &["1: line 1 of a set is not followed", "2: short line"],
        ),
        (
            format!("{two}\n{}", named("B")),
            1,
            &["1: line 2 of a set has no line 1"],
        ),
        (
            format!(" {one}\n{two}\n{}{one}\n", named("B")),
            1,
            &[
                "1: the element line begins with a blank",
                "6: line 1 of a set is not",
            ],
        ),
        (
            // Whole, and 18 revolutions a day.
            format!(
                "LOW\n{one}\n{}\n{}",
                edited(two, 53, "18.00000000"),
                named("B")
            ),
            1,
            &["2: LOW has decayed"],
        ),
    ];
    for (text, good, says) in cases {
        let catalogue = read(&text, false).unwrap();
        assert_eq!(catalogue.feeds.len(), good, "{text}");
        let faults: Vec<_> = catalogue.faults.iter().map(ToString::to_string).collect();
        assert_eq!(faults.len(), says.len(), "{faults:#?}");
        for (fault, says) in faults.iter().zip(says) {
            assert!(fault.starts_with(&format!("sets.tle:{says}")), "{fault}");
        }
        assert_eq!(read(&text, true).unwrap_err().to_string(), faults[0]);
    }
}

#[test]
fn a_file_without_a_good_set_is_refused() {
    assert!(matches!(
        read("", false),
        Err(OrbitError::NoElements { .. })
    ));
    assert!(matches!(
        read("hello\nworld\n", false),
        Err(OrbitError::Line {
            line: 1,
            fault: LineFault::NameAlone { .. },
            ..
        })
    ));
    // As many faults as lines: a thousand are kept.
    let text = "x\n".repeat(5000) + &ISS.join("\n");
    let catalogue = read(&text, false).unwrap();
    assert_eq!(
        (catalogue.faults.len(), catalogue.faults_left_out),
        (1000, 3999)
    );
    assert_eq!(catalogue.feeds[0].name(), "x");
}

#[test]
fn every_satellite_of_a_list_flies() {
    for feed in read(&many(), true).unwrap().feeds {
        let state = feed
            .state_at(feed.epoch() + Duration::from_days(3.0))
            .unwrap();
        assert!((6.7e6..6.9e6).contains(&state.position_m.length()));
    }
}
