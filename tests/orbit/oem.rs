//! Orbit ephemeris messages in KVN and XML.

use crate::utc;
use glam::DVec3;
use std::fmt::Write;
use std::path::Path;
use terrella_frames::{Duration, Epoch, TimeScale, ccsds_time};
use terrella_orbit::interpolated::{
    EphemerisSegment, InterpolatedStates, Interpolation, KeplerOrbit, StateSample,
};
use terrella_orbit::{Ephemerides, EphemerisFeed, Feed, Frame, Header, OrbitError, write_oem};

pub(crate) fn epoch(t_s: f64) -> Epoch {
    utc("2016-12-31T23:50:00Z") + Duration::from_seconds(t_s)
}

/// Metadata of a segment, in the order of the standard; an empty value leaves the line out.
pub(crate) struct Meta<'m> {
    keys: Vec<(&'m str, String)>,
    scale: TimeScale,
}

pub(crate) fn meta(scale: TimeScale, from_s: f64, to_s: f64) -> Meta<'static> {
    Meta {
        keys: vec![
            ("OBJECT_NAME", "TEST SAT".into()),
            ("OBJECT_ID", "2016-001A".into()),
            ("CENTER_NAME", "EARTH".into()),
            ("REF_FRAME", "EME2000".into()),
            ("TIME_SYSTEM", scale.name().into()),
            ("START_TIME", ccsds_time(epoch(from_s), scale)),
            ("USEABLE_START_TIME", String::new()),
            ("USEABLE_STOP_TIME", String::new()),
            ("STOP_TIME", ccsds_time(epoch(to_s), scale)),
            ("INTERPOLATION", "HERMITE".into()),
            ("INTERPOLATION_DEGREE", "7".into()),
        ],
        scale,
    }
}

impl<'m> Meta<'m> {
    pub(crate) fn with(mut self, key: &'m str, value: &str) -> Self {
        self.keys.retain_mut(|(name, old)| {
            if *name == key {
                *old = value.to_owned();
            }
            true
        });
        self
    }

    pub(crate) fn kvn(&self) -> String {
        let lines = self.keys.iter().filter(|(_, value)| !value.is_empty());
        let lines: String = lines
            .map(|(key, value)| format!("{key} = {value}\n"))
            .collect();
        format!("META_START\n{lines}META_STOP\n")
    }

    fn xml(&self) -> String {
        let lines = self.keys.iter().filter(|(_, value)| !value.is_empty());
        let lines: String = lines
            .map(|(key, value)| format!("<{key}>{value}</{key}>\n"))
            .collect();
        format!("<metadata>\n{lines}</metadata>\n")
    }
}

fn state_km(t_s: f64) -> [f64; 6] {
    let (r, v) = KeplerOrbit::LOW.state(t_s);
    [r.x, r.y, r.z, v.x, v.y, v.z].map(|m| m / 1e3)
}

pub(crate) fn rows(times_s: &[f64], scale: TimeScale) -> String {
    let mut text = String::new();
    for &t in times_s {
        let numbers = state_km(t).map(|n| n.to_string()).join("  ");
        let _ = writeln!(text, "{} {numbers}", ccsds_time(epoch(t), scale));
    }
    text
}

pub(crate) fn every_minute(from: u32, to: u32) -> Vec<f64> {
    (from..=to).map(|k| f64::from(k) * 60.0).collect()
}

pub(crate) const HEADER: &str =
    "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2017-01-01T00:00:00\nORIGINATOR = NOBODY\n\n";

pub(crate) fn kvn(meta: &Meta<'_>, times_s: &[f64]) -> String {
    format!(
        "{HEADER}{}COMMENT states follow\n{}",
        meta.kvn(),
        rows(times_s, meta.scale)
    )
}

pub(crate) fn xml(meta: &Meta<'_>, times_s: &[f64]) -> String {
    let mut states = String::new();
    for &t in times_s {
        let date = ccsds_time(epoch(t), meta.scale);
        let _ = writeln!(states, "<stateVector><EPOCH>{date}</EPOCH>");
        let names = ["X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT"];
        for (name, value) in names.iter().zip(state_km(t)) {
            let unit = if name.len() == 1 { "km" } else { "km/s" };
            let _ = write!(states, "<{name} units=\"{unit}\">{value}</{name}>");
        }
        states += "<X_DDOT>0</X_DDOT></stateVector>\n";
    }
    format!(
        "<oem version=\"2.0\"><header/><body><segment>\n{}<data>\n{states}</data></segment></body></oem>",
        meta.xml()
    )
}

pub(crate) fn read(text: &str) -> Result<Ephemerides, OrbitError> {
    Ephemerides::from_text(text, Path::new("sat.oem"), true)
}

pub(crate) fn one(text: &str) -> EphemerisFeed {
    let mut feeds = read(text).unwrap_or_else(|e| panic!("{e}\n{text}")).feeds;
    assert_eq!(feeds.len(), 1);
    feeds.remove(0)
}

#[test]
fn both_forms_give_the_orbit_in_all_time_systems() {
    let times = every_minute(0, 30);
    for scale in TimeScale::ALL {
        let meta = meta(scale, 0.0, 1800.0);
        for text in [kvn(&meta, &times), xml(&meta, &times)] {
            let feed = one(&text);
            assert_eq!(
                (feed.name(), feed.object_id()),
                ("TEST SAT", Some("2016-001A"))
            );
            assert_eq!(feed.validity(), (epoch(0.0), epoch(1800.0)));
            assert_eq!(
                feed.segments()[0].samples.interpolation(),
                Interpolation::Hermite { degree: 7 }
            );
            for k in 0..=1800 {
                let t = f64::from(k);
                let state = feed.state_at(epoch(t)).unwrap();
                let (r, v) = KeplerOrbit::LOW.state(t);
                assert_eq!(state.frame, Frame::Eme2000);
                assert!(state.position_m.distance(r) < 0.02, "{t}");
                assert!(state.velocity_m_s.distance(v) < 1e-3, "{t}");
            }
        }
    }
}

/// The same digits in four time systems: in 2016 UTC was 36 s behind TAI, GPS 19 s, and TT 32.184 s ahead of it.
#[test]
fn time_systems_are_those_of_the_world() {
    let text = kvn(&meta(TimeScale::Utc, 0.0, 540.0), &every_minute(0, 9));
    for (name, begins) in [
        ("UTC", "2016-12-31T23:50:00Z"),
        ("GPS", "2016-12-31T23:49:43Z"),
        ("TAI", "2016-12-31T23:49:24Z"),
        ("TT", "2016-12-31T23:48:51.816Z"),
    ] {
        let feed = one(&text.replace("TIME_SYSTEM = UTC", &format!("TIME_SYSTEM = {name}")));
        assert_eq!(feed.validity().0, utc(begins), "{name}");
    }
}

#[test]
fn frames_are_known_by_all_their_names() {
    for (name, frame) in [
        ("ICRF", Some(Frame::Gcrf)),
        ("ICRF3", Some(Frame::Gcrf)),
        ("GCRF", Some(Frame::Gcrf)),
        ("EME2000", Some(Frame::Eme2000)),
        ("TEME", Some(Frame::Teme)),
        ("ITRF", Some(Frame::Itrf)),
        ("ITRF2000", Some(Frame::Itrf)),
        ("ITRF-97", Some(Frame::Itrf)),
        ("itrf1993", Some(Frame::Itrf)),
        ("ICRS", Some(Frame::Gcrf)),
        ("GTOD", Some(Frame::Pef)),
        ("TDR", Some(Frame::Pef)),
        ("GRC", Some(Frame::Itrf)),
        // Turned when they are read.
        ("TOD", Some(Frame::Gcrf)),
        ("MOD", Some(Frame::Gcrf)),
        ("ITRFX", None),
        ("RTN", None),
        ("MCI", None),
    ] {
        let meta = meta(TimeScale::Utc, 0.0, 600.0).with("REF_FRAME", name);
        for text in [
            kvn(&meta, &every_minute(0, 10)),
            xml(&meta, &every_minute(0, 10)),
        ] {
            match (read(&text), frame) {
                (Ok(read), Some(frame)) => {
                    assert_eq!(read.feeds[0].segments()[0].samples.frame(), frame)
                }
                (Err(error), None) => assert!(
                    error.to_string().contains("known frames are ICRF"),
                    "{error}"
                ),
                (read, _) => panic!("{name}: {read:?}"),
            }
        }
    }
}

/// An engine fires at 600 s: the segments meet there, and neither uses the other's states.
#[test]
fn nothing_is_interpolated_across_segments() {
    let first = meta(TimeScale::Utc, 0.0, 600.0);
    let second = meta(TimeScale::Utc, 600.0, 1200.0);
    // On its way five seconds earlier than it should be.
    let pushed: String = every_minute(10, 20)
        .iter()
        .map(|&t| {
            let numbers = state_km(t + 5.0).map(|n| n.to_string()).join(" ");
            format!("{} {numbers}\n", ccsds_time(epoch(t), TimeScale::Utc))
        })
        .collect();
    let text = kvn(&first, &every_minute(0, 10)) + &second.kvn() + &pushed;
    let both = one(&text);
    let alone = one(&kvn(&first, &every_minute(0, 10)));
    let other = one(&format!("{HEADER}{}{pushed}", second.kvn()));
    for k in 0..=1200 {
        let t = epoch(f64::from(k));
        let expected = if k < 600 {
            alone.state_at(t)
        } else {
            other.state_at(t)
        };
        assert_eq!(both.state_at(t).unwrap(), expected.unwrap(), "{k}");
    }
    // Where they meet, the later one applies; a nanosecond before, the earlier one.
    let before = epoch(600.0) - Duration::from_total_nanoseconds(1);
    let jump =
        both.state_at(before).unwrap().position_m - both.state_at(epoch(600.0)).unwrap().position_m;
    assert!(jump.length() > 1e3, "{jump}");
}

#[test]
fn usable_intervals_and_gaps() {
    let first = meta(TimeScale::Utc, 0.0, 600.0)
        .with("USEABLE_START_TIME", "2016-12-31T23:52:00")
        .with("USEABLE_STOP_TIME", "2016-12-31T23:58:00");
    let second = meta(TimeScale::Utc, 900.0, 1500.0);
    let text = kvn(&first, &every_minute(0, 10))
        + &second.kvn()
        + &rows(&every_minute(15, 25), TimeScale::Utc);
    let feed = one(&text);
    assert_eq!(feed.validity(), (epoch(120.0), epoch(1500.0)));
    for (t, known) in [
        (0.0, false),
        (119.9, false),
        (120.0, true),
        (480.0, true),
        (480.1, false),
        (899.0, false),
        (900.0, true),
        (1500.0, true),
        (1501.0, false),
    ] {
        assert_eq!(feed.state_at(epoch(t)).is_ok(), known, "{t}");
    }
    assert_eq!(
        feed.state_at(epoch(700.0)).unwrap_err().to_string(),
        "TEST SAT is not known at 2017-01-01T00:01:39.000Z: its ephemeris has states until 2016-12-31T23:58:00.000Z and again from 2017-01-01T00:04:59.000Z; change the date or take an ephemeris of that time"
    );
    // Inside the usable interval the states outside it still serve.
    let whole = one(&kvn(
        &meta(TimeScale::Utc, 0.0, 600.0),
        &every_minute(0, 10),
    ));
    assert_eq!(
        feed.state_at(epoch(130.0)).unwrap(),
        whole.state_at(epoch(130.0)).unwrap()
    );
}

#[test]
fn interpolations_are_those_that_are_named() {
    let times = every_minute(0, 30);
    for (name, degree, interpolation, most_m) in [
        ("LINEAR", "1", Interpolation::Linear, 4e3),
        ("LINEAR", "", Interpolation::Linear, 4e3),
        ("LAGRANGE", "5", Interpolation::Lagrange { degree: 5 }, 0.05),
        (
            "lagrange",
            "10",
            Interpolation::Lagrange { degree: 10 },
            1e-5,
        ),
        ("HERMITE", "3", Interpolation::Hermite { degree: 3 }, 1.0),
        ("HERMITE", "27", Interpolation::Hermite { degree: 27 }, 1e-6),
        ("", "", Interpolation::WITH_VELOCITIES, 1e-6),
    ] {
        let meta = meta(TimeScale::Utc, 0.0, 1800.0)
            .with("INTERPOLATION", name)
            .with("INTERPOLATION_DEGREE", degree);
        let feed = one(&kvn(&meta, &times));
        assert_eq!(feed.segments()[0].samples.interpolation(), interpolation);
        let mut worst = 0.0_f64;
        for k in 600..1200 {
            let t = f64::from(k) + 0.5;
            worst = worst.max(
                feed.state_at(epoch(t))
                    .unwrap()
                    .position_m
                    .distance(KeplerOrbit::LOW.state(t).0),
            );
        }
        println!("{name} {degree}: {worst:.1e} m");
        assert!(
            worst < most_m && worst > most_m * 1e-4,
            "{name} {degree}: {worst}"
        );
    }
}

pub(crate) const COVARIANCE: &str = "COVARIANCE_START
EPOCH = 2016-12-31T23:50:00
COV_REF_FRAME = RTN
4.0e-4
1e-5 0.0
1e-5 1e-5 5.0e-4
0 0 0 1e-9
0 0 0 0 1e-9
0 0 0 0 0 1e-9

COMMENT an hour on
EPOCH = 2017-01-01T00:49:59
4.0e-2
0 4e-2
0 0 1e-2
0 0 0 1e-9
0 0 0 0 1e-9
0 0 0 0 0 1e-9
COVARIANCE_STOP
";

#[test]
fn covariances_are_error_estimates() {
    let text = kvn(&meta(TimeScale::Utc, 0.0, 600.0), &every_minute(0, 10));
    let feed = one(&(text.clone() + COVARIANCE));
    // √(4e-4 + 0 + 5e-4) km = 30 m, √0.09 km = 300 m, an hour between them.
    for (t, metres) in [(0.0, 30.0), (360.0, 57.0), (600.0, 75.0)] {
        let error = feed.error_m(epoch(t)).unwrap();
        assert!((error - metres).abs() < 1e-9, "{t}: {error}");
    }
    assert_eq!(feed.error_m(epoch(601.0)), None);
    assert_eq!(one(&text).error_m(epoch(0.0)), None);
    let block = "<covarianceMatrix><EPOCH>2016-12-31T23:50:00</EPOCH><CX_X units=\"km**2\">9e-4</CX_X>\
                 <CY_X>1</CY_X><CY_Y>0</CY_Y><CZ_Z>0</CZ_Z></covarianceMatrix></data>";
    let text =
        xml(&meta(TimeScale::Utc, 0.0, 600.0), &every_minute(0, 10)).replace("</data>", block);
    assert!((one(&text).error_m(epoch(300.0)).unwrap() - 30.0).abs() < 1e-9);
}

#[test]
fn what_is_written_reads_back_to_the_last_digit() {
    let segment = |from: u32, frame, interpolation| {
        let samples: Vec<_> = (from..from + 40)
            .map(|k| {
                let t = f64::from(k) * 61.234_567_891;
                let (position_m, velocity) = KeplerOrbit::MOLNIYA.state(t);
                // The third axis has numbers of all magnitudes.
                let z = DVec3::Z * (f64::from(k) * 0.7).sin() * 10_f64.powi(k as i32 % 17 - 9);
                StateSample {
                    epoch: epoch(t),
                    position_m: position_m + z,
                    velocity_m_s: Some(velocity - z),
                }
            })
            .collect();
        let mut segment = EphemerisSegment::whole(
            InterpolatedStates::new(frame, &samples, interpolation).unwrap(),
        );
        segment.usable.0 += Duration::from_total_nanoseconds(123_456_789);
        segment
    };
    let segments = vec![
        segment(0, Frame::Teme, Interpolation::Hermite { degree: 9 }),
        segment(50, Frame::Itrf, Interpolation::Lagrange { degree: 10 }),
        segment(100, Frame::Gcrf, Interpolation::Linear),
        segment(150, Frame::Eme2000, Interpolation::Linear),
        segment(200, Frame::Pef, Interpolation::Linear),
    ];
    let feed = EphemerisFeed::new("SAT [1]".into(), Some("2016-001A".into()), segments).unwrap();
    let header = Header {
        originator: "TERRELLA".into(),
        created: epoch(0.0),
    };
    let text = write_oem(&feed, &header);
    let read = one(&text);
    assert_eq!(
        (read.name(), read.object_id()),
        (feed.name(), feed.object_id())
    );
    for (a, b) in feed.segments().iter().zip(read.segments()) {
        assert_eq!(a.usable, b.usable);
        assert_eq!(a.samples.frame(), b.samples.frame());
        assert_eq!(a.samples.interpolation(), b.samples.interpolation());
        assert!(a.samples.samples().eq(b.samples.samples()));
    }
    assert_eq!(write_oem(&read, &header), text);
    // With covariances: the sum is preserved.
    let with = one(&(kvn(&meta(TimeScale::Utc, 0.0, 600.0), &every_minute(0, 10)) + COVARIANCE));
    let again = one(&write_oem(&with, &header));
    let (a, b) = (
        with.error_m(epoch(77.0)).unwrap(),
        again.error_m(epoch(77.0)).unwrap(),
    );
    assert!((a - b).abs() < 1e-9);
}
