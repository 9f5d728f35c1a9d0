//! Files that are not what they should be: one clear message with file, line and cause, and never a panic.

use crate::{ISS, edited, from_text, utc, with_checksum};
use proptest::prelude::*;
use std::io::Write;
use std::path::Path;
use terrella_frames::Duration;
use terrella_orbit::{Feed, OrbitError, TleFeed};

const GOES: [&str; 2] = [
    "1 41866U 16071A   18019.87773469 -.00000245  00000-0  00000-0 0  9992",
    "2 41866   0.0069 115.0916 0001074 269.6956 335.2025  1.00271237  4322",
];

fn message(text: &str, name: Option<&str>) -> String {
    from_text(text, name)
        .map(|feed| feed.name().to_owned())
        .expect_err(text)
        .to_string()
}

/// Asserts that the message is about this place and contains this text.
fn rejected(text: &str, place: &str, says: &str) {
    let message = message(text, None);
    assert!(
        message.starts_with(&format!("sets.tle{place}: ")),
        "{place}: {message}"
    );
    assert!(message.contains(says), "{says}: {message}");
}

#[test]
fn every_layout_of_a_good_file_is_read() {
    let [one, two] = ISS;
    for text in [
        format!("{one}\n{two}"),
        format!("{one}\r\n{two}\r\n"),
        format!("{one}   \n{two}\t \n"),
        format!("\u{feff}# comment\n\n{one}\n# between\n\n{two}\n\n"),
    ] {
        assert_eq!(from_text(&text, None).unwrap().name(), "25544", "{text:?}");
    }
    for text in [
        format!("ISS (ZARYA)             \n{one}\n{two}\n"),
        format!("0 ISS (ZARYA)\r\n{one}\r\n{two}\r\n"),
    ] {
        for name in [None, Some("iss (Zarya) "), Some("25544"), Some("025544")] {
            assert_eq!(
                from_text(&text, name).unwrap().name(),
                "ISS (ZARYA)",
                "{text:?}"
            );
        }
    }
}

#[test]
fn one_of_several_is_chosen_by_name_or_number() {
    let text = format!(
        "ISS (ZARYA)\n{}\nGOES 16\n{}\n",
        ISS.join("\n"),
        GOES.join("\n")
    );
    assert_eq!(
        from_text(&text, Some("goes 16"))
            .unwrap()
            .catalogue_number(),
        41866
    );
    assert_eq!(
        from_text(&text, Some("25544")).unwrap().name(),
        "ISS (ZARYA)"
    );

    let several = message(&text, None);
    assert_eq!(
        several,
        "sets.tle: 2 element sets: ISS (ZARYA) (25544, line 2), GOES 16 (41866, line 5); name the satellite or give its catalogue number"
    );
    let unknown = message(&text, Some("GOES 17"));
    assert_eq!(
        unknown,
        "sets.tle: no satellite \"GOES 17\" among its 2; the nearest name is \"GOES 16\""
    );
    assert!(message(&text, Some("2554")).contains("nearest name is \"ISS (ZARYA)\""));
    assert!(message(&text, Some("")).contains("no satellite \"\""));
    let long = message(&text, Some(&"x".repeat(1 << 20)));
    assert!(long.len() < 400, "{}", long.len());

    // The same set twice is one.
    let twice = format!("{text}{text}");
    let one = from_text(&twice, Some("GOES 16")).unwrap();
    assert_eq!(one.catalogue_number(), 41866);
    let debris = format!("DEB\n{}\nDEB\n{}\n", ISS.join("\n"), GOES.join("\n"));
    assert!(message(&debris, Some("deb")).ends_with("give the catalogue number instead"));
}

#[test]
fn alpha_5_numbers_are_read() {
    for (written, number) in [
        ("A0000", 100_000),
        ("J2931", 182_931),
        ("Z9999", 339_999),
        ("    5", 5),
    ] {
        let text = [edited(ISS[0], 3, written), edited(ISS[1], 3, written)].join("\n");
        let feed = from_text(&text, None).unwrap();
        assert_eq!(feed.catalogue_number(), number);
        assert!(from_text(&text, Some(&number.to_string())).is_ok());
    }
    for written in ["I0000", "O0000", "a0000", "A000 ", "1 234", "+1234"] {
        let text = [edited(ISS[0], 3, written), edited(ISS[1], 3, written)].join("\n");
        rejected(&text, ":1:3", "catalogue number");
    }
}

#[test]
fn corrupt_lines_are_named() {
    let [one, two] = ISS;
    let name = "ISS (ZARYA)";
    // Bad checksum, on either line, and none at all.
    rejected(
        &format!(
            "{name}\n{one}\n{}4",
            &two[..68].replace("51.6424", "51.6425")
        ),
        ":3:69",
        "bad checksum: that of the line is 5 and it ends in '4'",
    );
    rejected(
        &format!("{}3\n{two}", &one[..68]),
        ":1:69",
        "bad checksum: that of the line is 2 and it ends in '3'",
    );
    rejected(&format!("{}!\n{two}", &one[..68]), ":1:69", "ends in '!'");
    // Short and long lines.
    rejected(
        &format!("{name}\n{one}\n{}", &two[..60]),
        ":3",
        "short line: 60 characters where an element line has 69",
    );
    rejected(
        &format!("# c\n\n{}\n{two}", &one[..68]),
        ":3",
        "short line: 68 characters",
    );
    rejected(&format!("1 \n{two}"), ":1", "short line: 1 characters");
    rejected(
        &format!("{one}\n{two}     0.00      4320.0"),
        ":2:70",
        "long line: 90 characters",
    );
    // Mixed satellites.
    rejected(
        &format!("{name}\n{one}\n{}", GOES[1]),
        ":3:3",
        "mixed satellites: line 1 (line 2 of the file) is of 25544, line 2 of 41866",
    );
    // Lines that miss their partner.
    rejected(
        &format!("{one}\n{one}\n{two}"),
        ":1",
        "not followed by its line 2",
    );
    rejected(
        &format!("{one}\n{name}\n{two}"),
        ":1",
        "not followed by its line 2",
    );
    rejected(&format!("# c\n{one}\n"), ":2", "not followed by its line 2");
    rejected(&format!("{two}\n{one}"), ":1", "has no line 1 before it");
    rejected(
        &format!("{one}\n{two}\n{two}"),
        ":3",
        "has no line 1 before it",
    );
    rejected(
        &format!("{name}\n{name}\n{one}\n{two}"),
        ":1",
        "neither an element line nor a name",
    );
    rejected(
        &format!("{one}\n{two}\n{name}"),
        ":3",
        "neither an element line nor a name",
    );
    rejected("hello\n", ":1", "begin a comment with #");
    rejected("<!DOCTYPE html>\n<html>\n", ":1:1", "as web pages have");
    // Columns that have moved, and line numbers that do not exist.
    rejected(&format!(" {one}\n {two}"), ":1", "begins with a blank");
    rejected(
        &format!("{}\n{two}", with_checksum(&one.replacen('1', "3", 1))),
        ":1",
        "line number '3'",
    );
    rejected(
        &format!("{}\n{two}", edited(one, 9, "198067A ")),
        ":1:9",
        "between two fields",
    );
    // Characters that no element line has.
    rejected(
        &format!("{}\n{two}", one.replacen("0  9992", "0\u{a0} 9992", 1)),
        ":1:64",
        "is not allowed here",
    );
    rejected(
        &format!(
            "{}\n{two}",
            one.replacen(' ', "\t", 1).replacen('\t', " \t", 1)
        ),
        ":1:3",
        "'\\t' is not allowed here",
    );
    rejected(
        &format!("{name}\u{0}\n{one}\n{two}"),
        ":1:12",
        "a name is printable text",
    );
    rejected(
        &format!("{}\n{one}\n{two}", "é".repeat(200)),
        ":1",
        "200 characters; names have at most 128",
    );
    // A corrupt line of another satellite.
    let other = format!(
        "{name}\n{one}\n{two}\nGOES 16\n{}\n{}",
        GOES[0],
        &GOES[1][..50]
    );
    assert!(
        message(&other, Some(name)).starts_with("sets.tle:6: short line"),
        "{}",
        message(&other, Some(name))
    );
}

#[test]
fn fields_are_named_with_their_column() {
    let [one, two] = ISS;
    for (column, characters, says) in [
        (19, "x8", "epoch year is \"x8\""),
        (21, "000.89808844", "epoch day"),
        (21, "366.89808844", "epoch day is \"366.89808844\""),
        (21, "020,89808844", "epoch day"),
        (21, "0 0.89808844", "epoch day"),
        (21, "4294967297.5", "epoch day"),
        (
            34,
            "       nan",
            "first derivative is \"       nan\"; expected a decimal number",
        ),
        (34, " 2.078e-05", "first derivative"),
        (34, "          ", "first derivative"),
        (45, " 0000 -0", "second derivative"),
        (54, " 3855a-4", "drag term B*"),
        (54, " 385504-", "drag term B*"),
        (63, "4", "ephemeris type is \"4\"; expected 0"),
        (65, "-999", "element set number"),
    ] {
        rejected(
            &format!("{}\n{two}", edited(one, column, characters)),
            &format!(":1:{column}"),
            says,
        );
    }
    for (column, characters, says) in [
        (
            9,
            "     inf",
            "inclination is \"     inf\"; expected degrees from 0 to 180",
        ),
        (9, "180.0001", "inclination"),
        (9, " -1.6424", "inclination"),
        (18, "360.0001", "right ascension of the ascending node"),
        (
            27,
            " 003646",
            "eccentricity is \" 003646\"; expected seven digits",
        ),
        (27, "0.03646", "eccentricity"),
        (35, " 2 .7227", "argument of perigee"),
        (44, "- 9.5332", "mean anomaly"),
        (
            53,
            " 0.00000000",
            "mean motion is \" 0.00000000\"; expected revolutions per day above 0",
        ),
        (53, "-5.54190080", "above 0"),
        (53, "15.54.90080", "mean motion"),
        (64, "-9561", "revolution number"),
    ] {
        rejected(
            &format!("{one}\n{}", edited(two, column, characters)),
            &format!(":2:{column}"),
            says,
        );
    }
}

#[test]
fn elements_that_cannot_fly_are_rejected_with_sgp4s_cause() {
    let [one, two] = ISS;
    // 18 revolutions a day: below the ground from the start.
    let error = message(
        &format!("LOW\n{one}\n{}", edited(two, 53, "18.00000000")),
        None,
    );
    assert!(
        error.starts_with("sets.tle:2: LOW has decayed by 2018-01-20T21:33:14.841Z: SGP4 puts it "),
        "{error}"
    );
    // A set that decays within its reach flies until then.
    let text = format!(
        "LOW\n{}\n{}",
        edited(one, 54, " 50000-1"),
        edited(two, 53, "16.40000000")
    );
    let low = from_text(&text, None).unwrap();
    let error = (0..30)
        .find_map(|day| {
            low.state_at(low.epoch() + Duration::from_days(f64::from(day)))
                .err()
        })
        .unwrap();
    let text = error.to_string();
    assert!(
        matches!(error, OrbitError::Decayed { .. } | OrbitError::Sgp4 { .. }),
        "{text}"
    );
    assert!(
        text.starts_with("sets.tle:2: ") && text.contains("LOW") && text.contains("2018-0"),
        "{text}"
    );
    // A date that the elements do not reach.
    let iss = from_text(&ISS.join("\n"), None).unwrap();
    let error = iss
        .state_at(utc("2026-01-01T00:00:00Z"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("2017-12-21T21:33:14.841Z to 2018-02-19T21:33:14.841Z"),
        "{error}"
    );
}

#[test]
fn files_that_are_no_element_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::File::create(&path)
            .unwrap()
            .write_all(bytes)
            .unwrap();
        path
    };
    let error = |path: &Path| {
        let error = TleFeed::from_file(path, None)
            .map(|f| f.name().to_owned())
            .unwrap_err();
        assert!(
            error.to_string().starts_with(&path.display().to_string()),
            "{error}"
        );
        error
    };
    let contains = |path: &Path, says: &str| {
        let text = error(path).to_string();
        assert!(text.contains(says), "{text}");
    };
    contains(&write("empty.tle", b""), "contains no element set");
    contains(
        &write("comments.tle", b"# nothing\n\n\r\n"),
        "contains no element set",
    );
    contains(
        &write("binary.tle", &[0x7f, b'E', b'L', b'F', 2, 1, 1, 0, 0, 0]),
        "is not allowed here",
    );
    contains(
        &write("picture.tle", b"name\n\n\x89PNG\r\n"),
        ":3: not text in UTF-8",
    );
    contains(&write("latin1.tle", b"S\xe3o\n"), ":1: not text in UTF-8");
    assert!(matches!(
        error(&folder.path().join("missing.tle")),
        OrbitError::Read { .. }
    ));
    assert!(matches!(error(folder.path()), OrbitError::Read { .. }));

    // Known to be too large from its metadata: no byte of it is read.
    let huge = folder.path().join("huge.tle");
    std::fs::File::create(&huge)
        .unwrap()
        .set_len(TleFeed::MAX_FILE_BYTES + 1)
        .unwrap();
    contains(&huge, "larger than 16 MiB");
    // At the limit it is read, and found to be no text.
    std::fs::File::options()
        .write(true)
        .open(&huge)
        .unwrap()
        .set_len(TleFeed::MAX_FILE_BYTES)
        .unwrap();
    contains(&huge, ":1:1: '\\0' is not allowed here");
    // A device that claims to be empty.
    #[cfg(unix)]
    contains(Path::new("/dev/zero"), "it is a device, not a file");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>(), name in proptest::option::of(any::<String>())) {
        let _ = from_text(&text, name.as_deref());
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = from_text(&String::from_utf8_lossy(&bytes), None);
    }

    #[test]
    fn no_mutation_makes_it_panic(edits in proptest::collection::vec((0usize..152, any::<char>()), 1..4)) {
        let mut text: Vec<char> = format!("ISS (ZARYA)\n{}\n{}", ISS[0], ISS[1]).chars().collect();
        for (at, c) in edits {
            if let Some(place) = text.get_mut(at) {
                *place = c;
            }
        }
        let _ = from_text(&text.iter().collect::<String>(), None);
    }

    /// With a checksum that fits, so that the fields and SGP4 itself are reached.
    #[test]
    fn no_field_makes_it_or_sgp4_panic(
        edits in proptest::collection::vec((0usize..2, 2usize..68, "[ 0-9.+-]"), 1..6),
        days in -30.0..30.0_f64,
    ) {
        let mut lines = ISS.map(str::to_owned);
        for (line, at, c) in edits {
            lines[line].replace_range(at..=at, &c);
        }
        let text = lines.map(|line| with_checksum(&line)).join("\n");
        if let Ok(feed) = from_text(&text, None) {
            for elapsed in [days, -days, 30.0, -30.0] {
                if let Ok(state) = feed.state_at(feed.epoch() + Duration::from_days(elapsed)) {
                    prop_assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
                    prop_assert!(state.position_m.length() >= 6.378e6);
                }
            }
        }
    }
}
