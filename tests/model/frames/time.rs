//! Dates in UTC, leap seconds included.

use super::utc;
use proptest::prelude::*;
use terrella::frames::{Duration, Epoch, TimeError, rfc3339, utc_from_rfc3339, utc_from_text};

#[test]
fn dates_are_read_and_written() {
    for (text, written) in [
        ("2018-01-15T12:00:00Z", "2018-01-15T12:00:00.000Z"),
        ("2018-01-15t12:00:00.1234z", "2018-01-15T12:00:00.123Z"),
        ("2018-01-15T12:00:00.9996Z", "2018-01-15T12:00:01.000Z"),
        ("2018-01-15T01:15:00+01:30", "2018-01-14T23:45:00.000Z"),
        ("2017-12-31T23:45:00-00:30", "2018-01-01T00:15:00.000Z"),
        ("2016-02-29T00:00:00-00:00", "2016-02-29T00:00:00.000Z"),
        ("1900-01-01T00:00:00Z", "1900-01-01T00:00:00.000Z"),
        ("1957-10-04T19:28:34Z", "1957-10-04T19:28:34.000Z"),
        ("1971-12-31T23:59:59Z", "1971-12-31T23:59:59.000Z"),
        ("2099-12-31T23:59:59.999999999Z", "2100-01-01T00:00:00.000Z"),
        ("2016-12-31T23:59:60Z", "2016-12-31T23:59:60.000Z"),
        ("2016-12-31T23:59:60.9994Z", "2016-12-31T23:59:60.999Z"),
        ("2016-12-31T23:59:60.9996Z", "2017-01-01T00:00:00.000Z"),
        ("2016-12-31T23:59:59.9996Z", "2016-12-31T23:59:60.000Z"),
        ("2017-01-01T05:29:60+05:30", "2016-12-31T23:59:60.000Z"),
        ("2015-06-30T15:59:60-08:00", "2015-06-30T23:59:60.000Z"),
    ] {
        assert_eq!(rfc3339(utc(text)), written, "{text}");
    }
}

#[test]
fn other_scales_are_written_in_utc() {
    let noon = Epoch::from_gregorian_utc_hms(2018, 1, 15, 12, 0, 0);
    assert_eq!(noon, utc("2018-01-15T12:00:00Z"));
    assert_eq!(rfc3339(noon), "2018-01-15T12:00:00.000Z");
    let gps = noon.to_time_scale(hifitime::TimeScale::GPST);
    assert_eq!(rfc3339(gps), "2018-01-15T12:00:00.000Z");
}

#[test]
fn bad_dates_are_rejected_with_the_reason() {
    for (text, part) in [
        ("", "write it like 2018-01-15T12:00:00Z"),
        ("now", "write it like"),
        ("2018-01-15", "write it like"),
        ("2018-01-15 12:00:00Z", "write it like"),
        ("2018-01-15T12:00:00", "write it like"),
        ("2018-01-15T12:00Z", "write it like"),
        ("2018-01-15T12:00:00.Z", "write it like"),
        ("2018-01-15T12:00:00+0100", "write it like"),
        ("2018-01-15T12:00:00Z ", "write it like"),
        ("+018-01-15T12:00:00Z", "write it like"),
        ("2018-01-15T12:00:0٣Z", "write it like"),
        ("2018-00-15T12:00:00Z", "month 0 is not from 1 to 12"),
        ("2018-13-15T12:00:00Z", "month 13 is not from 1 to 12"),
        ("2018-02-29T12:00:00Z", "day 29 is not from 1 to 28"),
        ("1900-02-29T12:00:00Z", "day 29 is not from 1 to 28"),
        ("2018-04-00T12:00:00Z", "day 0 is not from 1 to 30"),
        ("2018-01-15T24:00:00Z", "hour 24 is not from 0 to 23"),
        ("2018-01-15T12:60:00Z", "minute 60 is not from 0 to 59"),
        ("2018-01-15T12:00:61Z", "second 61 is not from 0 to 60"),
        ("2018-01-15T12:00:00+24:00", "offset hour 24"),
        ("2018-01-15T12:00:00-00:60", "offset minute 60"),
        ("1899-12-31T23:59:59Z", "year 1899 is not from 1900 to 2099"),
        (
            "1900-01-01T00:30:00+01:00",
            "year 1899 is not from 1900 to 2099",
        ),
        ("2100-01-01T00:00:00Z", "year 2100 is not from 1900 to 2099"),
        ("2018-01-15T12:00:60Z", "there was no leap second then"),
        ("2017-12-31T23:59:60Z", "there was no leap second then"),
        ("1971-12-31T23:59:60Z", "there was no leap second then"),
        ("2016-12-31T23:59:60+00:01", "there was no leap second then"),
    ] {
        let error = utc_from_rfc3339(text).expect_err(text).to_string();
        assert!(
            error.contains(part) && error.contains(text),
            "{text}: {error}"
        );
    }
    let long = utc_from_rfc3339(&"9".repeat(1_000_000)).unwrap_err();
    assert!(matches!(long, TimeError::Form { .. }) && long.to_string().len() < 200);
}

#[test]
fn dates_are_read_as_people_write_them() {
    for (text, rfc3339) in [
        ("2018-01-15", "2018-01-15T00:00:00Z"),
        ("2018-01-15Z", "2018-01-15T00:00:00Z"),
        ("2018-01-15 12:30", "2018-01-15T12:30:00Z"),
        ("2018-01-15 12:30Z", "2018-01-15T12:30:00Z"),
        ("2018-01-15T12:30", "2018-01-15T12:30:00Z"),
        ("2018-01-15T12:30Z", "2018-01-15T12:30:00Z"),
        ("2018-01-15 12:30:15", "2018-01-15T12:30:15Z"),
        ("2018-01-15t12:30:15.25z", "2018-01-15T12:30:15.25Z"),
        ("2018-01-15 12:30+01:30", "2018-01-15T11:00:00Z"),
        ("2018-01-15T12:30:00-01:30", "2018-01-15T14:00:00Z"),
        ("2016-12-31 23:59:60", "2016-12-31T23:59:60Z"),
    ] {
        assert_eq!(utc_from_text(text), Ok(utc(rfc3339)), "{text}");
    }
    for text in [
        "",
        "now",
        "2018",
        "2018-01",
        "2018-1-5",
        "15-01-2018",
        "01/02/2018",
        "2018/01/15",
        "20180115",
        "2018-01-15 ",
        " 2018-01-15",
        "2018-01-15 12",
        "2018-01-15 1:30",
        "2018-01-15  12:30",
        "2018-01-15 12:30 Z",
        "2018-01-15 12:30 CET",
        "2018-01-15 12:30 pm",
        "2018-01-15-12:30",
        "2018-01-15+01:00",
        "12:30",
        "2018-01-15 12:3٣",
        "2018-01-1٣",
    ] {
        let error = utc_from_text(text).expect_err(text);
        assert!(matches!(error, TimeError::Form { .. }), "{text}: {error}");
        assert!(error.to_string().contains(text), "{text}: {error}");
    }
    for (text, part) in [
        ("2018-02-30", "day 30 is not from 1 to 28"),
        ("2018-01-15 24:00", "hour 24 is not from 0 to 23"),
        ("2018-01-15 23:59:60", "there was no leap second then"),
    ] {
        let error = utc_from_text(text).expect_err(text).to_string();
        assert!(error.contains(part) && error.contains(text), "{error}");
    }
    let long = utc_from_text(&"9".repeat(1_000_000)).unwrap_err();
    assert!(matches!(long, TimeError::Form { .. }) && long.to_string().len() < 200);
}

#[test]
fn seconds_run_on_through_a_leap_second() {
    let before = utc("2016-12-31T23:59:59Z");
    let texts: Vec<_> = (0..4)
        .map(|s| rfc3339(before + Duration::from_seconds(f64::from(s))))
        .collect();
    assert_eq!(
        texts,
        [
            "2016-12-31T23:59:59.000Z",
            "2016-12-31T23:59:60.000Z",
            "2017-01-01T00:00:00.000Z",
            "2017-01-01T00:00:01.000Z"
        ]
    );
    assert_eq!(
        utc("2017-01-01T00:00:00Z") - before,
        Duration::from_seconds(2.0)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_makes_the_date_reader_panic(text in ".{0,40}") {
        let _ = utc_from_rfc3339(&text);
        let _ = utc_from_text(&text);
    }

    #[test]
    fn no_mutated_date_makes_it_panic(at in 0usize..25, byte in any::<u8>()) {
        let mut text = b"2016-12-31T23:59:60+00:00".to_vec();
        text[at] = byte;
        if let Ok(text) = std::str::from_utf8(&text) {
            let _ = utc_from_rfc3339(text);
            let _ = utc_from_text(text);
        }
    }

    #[test]
    fn milliseconds_survive_writing_and_reading(ms in -2_200_000_000_000_i64..4_000_000_000_000) {
        let epoch = utc("1972-01-01T00:00:00Z") + Duration::from_truncated_nanoseconds(ms * 1_000_000);
        // The ten seconds that pre-1972 UTC leaves over have no separate readings.
        prop_assume!(!(-10_001..0).contains(&ms));
        prop_assert_eq!(utc(&rfc3339(epoch)), epoch);
    }
}
