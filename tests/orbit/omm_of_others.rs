//! Mean elements as servers and spreadsheets write them: wrapped in an object, an object a line, with semicolons or tabs; and tables
//! that are none.

use std::path::Path;
use terrella_frames::Duration;
use terrella_orbit::{Catalogue, Ephemerides, Feed, FileFormat, OrbitError, Sgp4Feed};

/// Two satellites, of which the second has no name in `NUMBERED`.
const KEYS: [&str; 10] = [
    "OBJECT_NAME",
    "NORAD_CAT_ID",
    "EPOCH",
    "MEAN_MOTION",
    "ECCENTRICITY",
    "INCLINATION",
    "RA_OF_ASC_NODE",
    "ARG_OF_PERICENTER",
    "MEAN_ANOMALY",
    "BSTAR",
];
const ISS: [&str; 10] = [
    "ISS (ZARYA)",
    "25544",
    "2018-01-20T21:33:14.841216",
    "15.5419008",
    "0.0003646",
    "51.6424",
    "32.9776",
    "28.7227",
    "39.5332",
    "0.00003855",
];
const DEB: [&str; 10] = [
    "COSMOS; DEB, A",
    "799500001",
    "2018-01-20T12:00:00",
    "14.2",
    "0.01",
    "98.6",
    "10",
    "20",
    "30",
    "0.0001",
];

fn read(text: &str) -> Result<Catalogue, OrbitError> {
    Catalogue::from_text(text, Path::new("sats.txt"), true)
}

fn object(values: [&str; 10], between: &str) -> String {
    let members: Vec<_> = KEYS
        .iter()
        .zip(values)
        .map(|(key, value)| match value.parse::<f64>() {
            Ok(_) => format!("\"{key}\":{value}"),
            Err(_) => format!("\"{key}\":\"{value}\""),
        })
        .collect();
    format!("{{{}}}", members.join(between))
}

fn table(separator: &str, rows: &[[&str; 10]]) -> String {
    let field = |value: &str| match value.contains([';', ',', '\t']) {
        true => format!("\"{value}\""),
        false => value.to_owned(),
    };
    let line = |values: &[&str; 10]| values.map(field).join(separator) + "\r\n";
    std::iter::once(&KEYS).chain(rows).map(line).collect()
}

/// That both satellites are there and fly as those of the plain array do.
fn assert_both(text: &str) {
    let plain = read(&format!("[{},{}]", object(ISS, ","), object(DEB, ","))).unwrap();
    let read = read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(FileFormat::of_text(text), Some(FileFormat::Omm), "{text}");
    assert_eq!(read.feeds.len(), 2, "{text}");
    assert!(read.faults.is_empty(), "{:?}", read.faults);
    for (feed, wanted) in read.feeds.iter().zip(&plain.feeds) {
        assert_eq!(feed.elements(), wanted.elements(), "{text}");
        let later = wanted.epoch() + Duration::from_seconds(5000.0);
        let (state, wanted) = (
            feed.state_at(later).unwrap(),
            wanted.state_at(later).unwrap(),
        );
        assert_eq!(state.position_m, wanted.position_m);
    }
}

#[test]
fn semicolons_and_tabs_are_read() {
    for separator in [",", ";", "\t"] {
        assert_both(&table(separator, &[ISS, DEB]));
    }
    // Empty fields at the end of a row are fields.
    let rows = table("\t", &[ISS, DEB]).replace("\r\n", "\t\r\n");
    assert_both(&rows.replacen("BSTAR\t", "BSTAR\tDECAY_DATE", 1));
    // Numbers with commas, as spreadsheets of some languages write them.
    let text = table(";", &[ISS]).replace("15.5419008", "15,5419008");
    let error = read(&text).unwrap_err().to_string();
    assert!(
        error.starts_with("sats.txt:2:") && error.contains("MEAN_MOTION is \"15,5419008\""),
        "{error}"
    );
}

#[test]
fn an_object_may_stand_on_each_line() {
    assert_both(&format!("{}\n{}\n", object(ISS, ","), object(DEB, ",")));
    // As `jq` prints them.
    assert_both(&format!(
        "{}\n{}",
        object(ISS, ",\n  "),
        object(DEB, ",\n  ")
    ));
}

#[test]
fn a_bad_line_costs_its_own_object() {
    let bad = object(ISS, ",").replace(':', "");
    let text = format!("{}\n{bad}\n{}\n", object(ISS, ","), object(DEB, ","));
    let error = read(&text).unwrap_err().to_string();
    assert!(error.starts_with("sats.txt:2:15: not JSON"), "{error}");
    let lenient = Catalogue::from_text(&text, Path::new("sats.txt"), false).unwrap();
    assert_eq!(lenient.feeds.len(), 2);
    assert_eq!(lenient.faults.len(), 1, "{:?}", lenient.faults);
}

#[test]
fn a_list_is_found_within_an_object() {
    let list = format!("[{},\n{}]", object(ISS, ","), object(DEB, ","));
    for (before, behind) in [
        ("{\"results\": ", "}"),
        (
            "{\"count\": 2, \"next\": null, \"data\": ",
            ", \"took\": [1, 2]}",
        ),
        ("{\"response\": {\"status\": \"ok\", \"satellites\": ", "}}"),
        ("{\"warnings\": [{\"text\": \"old\"}], \"results\": ", "}"),
    ] {
        assert_both(&format!("{before}{list}{behind}"));
    }
    for (text, place, says) in [
        (
            "{\"count\": 0}".to_owned(),
            "1:1",
            "the object without MEAN_MOTION; expected the elements of a satellite, or under any name a list",
        ),
        (
            format!("{{\"a\": {list},\n\"b\": {list}}}"),
            "3:6",
            "expected one list of satellites",
        ),
        (
            format!("{{\"results\": {}", object(ISS, ",")),
            "1:",
            "not JSON: EOF while parsing",
        ),
    ] {
        let error = read(&text).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("sats.txt:{place}")) && error.contains(says),
            "{error}\n{text}"
        );
    }
    // Deeper than anybody wraps.
    let deep = "{\"a\":".repeat(50_000) + &list + &"}".repeat(50_000);
    assert!(read(&deep).is_err());
}

#[test]
fn satellites_without_names_are_called_by_their_numbers() {
    let text = table(",", &[ISS]).replace("OBJECT_NAME", "COMMON_NAME");
    let catalogue = read(&text).unwrap();
    assert_eq!(catalogue.feeds[0].elements().name, "25544");
    let number = "NORAD_CAT_ID";
    let error = read(&text.replace(number, "CATALOG"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("the header has no column OBJECT_NAME;"),
        "{error}"
    );
}

#[test]
fn tables_of_other_columns_say_what_they_lack() {
    let ephemerides = |text: &str| {
        let read = Ephemerides::from_text(text, Path::new("sats.txt"), false);
        read.map(drop).unwrap_err().to_string()
    };
    let catalogue = |text: &str| read(text).map(drop).unwrap_err().to_string();
    let one = |text: &str| {
        let read = Sgp4Feed::from_text(text, Path::new("sats.txt"), None);
        read.map(drop).unwrap_err().to_string()
    };
    let states = "time;x_km;y_km;z\n0;7000;0;0\n";
    let error = ephemerides(states);
    assert!(
        error.starts_with("sats.txt:1:1: the header has no columns epoch_utc, z_km; "),
        "{error}"
    );
    for error in [catalogue(states), one(states)] {
        assert!(
            error.contains("has no columns OBJECT_NAME, EPOCH, MEAN_MOTION, ECCENTRICITY,"),
            "{error}"
        );
    }
    let lower = table("\t", &[ISS]).to_lowercase();
    let error = catalogue(&lower);
    assert!(error.contains("has no columns OBJECT_NAME, EPOCH,") && error.contains("in capitals"));
    let members = object(ISS, ",").to_lowercase();
    assert_eq!(FileFormat::of_text(&members), Some(FileFormat::Omm));
    assert!(catalogue(&members).contains("the object without MEAN_MOTION"));
    // Two-line elements whose blanks have become tabs are no table of columns.
    let tle = crate::ISS.join("\n").replace(' ', "\t");
    assert!(
        !catalogue(&tle).contains("has no columns"),
        "{}",
        catalogue(&tle)
    );
    let bars = ephemerides(&states.replace(';', "|"));
    assert!(
        bars.contains("between commas, semicolons or tabs"),
        "{bars}"
    );
    let less = table(",", &[ISS])
        .replace("BSTAR", "DRAG")
        .replace("EPOCH", "DATE");
    assert!(catalogue(&less).contains("the header has no columns EPOCH, BSTAR;"));
    // What one reader has no use for is another's.
    for text in [table(";", &[ISS]), object(ISS, ",")] {
        assert!(!ephemerides(&text).is_empty());
    }
    assert!(ephemerides(&table(";", &[ISS])).contains("a file of mean elements has no ephemeris"));
    let oem = "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2020-01-01T00:00:00\n";
    for text in [oem, "# frame = TEME\nepoch_utc,x_km,y_km,z_km\n"] {
        for error in [catalogue(text), one(text)] {
            assert!(
                error.contains("an ephemeris has no mean elements"),
                "{error}"
            );
        }
    }
}
