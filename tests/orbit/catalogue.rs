//! Files of many two-line sets.

use crate::{ISS, edited};
use std::fmt::Write;
use std::path::Path;
use terrella_frames::Duration;
use terrella_orbit::{Catalogue, Feed, LineFault, OrbitError, OrbitFiles};

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
    let corrupt = two.replace("51.6424", "51.6425");
    // The file, the number of valid sets, and the reported lines.
    let cases: [(String, usize, &[&str]); 9] = [
        (
            format!("A\n{one}\n{corrupt}\n{}", named("B")),
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
fn a_file_without_a_good_set_is_rejected() {
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

/// Thirty thousand satellites in 5 MB, of which two hundred are taken.
#[test]
fn a_file_is_read_once_however_many_are_taken_from_it() {
    let mut csv = String::from(
        "OBJECT_NAME,OBJECT_ID,EPOCH,MEAN_MOTION,ECCENTRICITY,INCLINATION,RA_OF_ASC_NODE,ARG_OF_PERICENTER,MEAN_ANOMALY,EPHEMERIS_TYPE,NORAD_CAT_ID,ELEMENT_SET_NO,REV_AT_EPOCH,BSTAR\n",
    );
    for k in 0..30_000 {
        let _ = writeln!(
            csv,
            "SAT {k},2020-001A,2026-04-10T12:00:00.000000,15.{k:05},.0010000,51.6000,{}.5,90.0000,10.0000,0,{},999,1,.20000E-4",
            k % 360,
            k + 1
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("all.csv");
    std::fs::write(&path, &csv).unwrap();
    let mut files = OrbitFiles::default();
    let start = std::time::Instant::now();
    let first = files.catalogue(&path, false).unwrap();
    let reading = start.elapsed();
    assert!(first.is_new);
    // Gone: what has been read is used.
    std::fs::remove_file(&path).unwrap();
    let start = std::time::Instant::now();
    for k in (0..30_000).step_by(150) {
        let file = files.catalogue(&path, false).unwrap();
        assert!(!file.is_new);
        for name in [format!("sat {k}"), (k + 1).to_string()] {
            let feed = file.content.one(&path, Some(&name)).unwrap();
            assert_eq!(feed.catalogue_number(), k + 1);
        }
    }
    let taking = start.elapsed();
    println!("reading {reading:?}, taking 400 {taking:?}");
    assert!(taking < reading, "{taking:?} {reading:?}");
    assert!(files.catalogue(&path, true).is_err());
    // Names that are not one satellite's are looked into.
    let error = first.content.one(&path, Some("SAT")).unwrap_err();
    assert!(matches!(error, OrbitError::UnknownName { .. }));
    assert!(matches!(
        first.content.one(&path, None),
        Err(OrbitError::Ambiguous { .. })
    ));
}

#[test]
fn ephemerides_are_read_once_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.csv");
    let row =
        |name: &str, minute: u32| format!("{name},2026-04-10T12:0{minute}:00Z,7000,{minute},0\n");
    let rows: String = ["A", "B"]
        .iter()
        .flat_map(|name| (0..4).map(|m| row(name, m)))
        .collect();
    std::fs::write(
        &path,
        format!("# frame = GCRF\nname,epoch_utc,x_km,y_km,z_km\n{rows}"),
    )
    .unwrap();
    let mut files = OrbitFiles::default();
    assert!(files.ephemerides(&path, true).unwrap().is_new);
    std::fs::remove_file(&path).unwrap();
    for name in ["A", "B"] {
        let file = files.ephemerides(&path, true).unwrap();
        assert_eq!(file.content.one(&path, Some(name)).unwrap().name(), name);
        assert!(!file.is_new);
    }
}

/// So many sets as a catalogue publishes them in CSV, 147 and more bytes each.
fn table_of(count: usize) -> String {
    let mut text = "OBJECT_NAME,OBJECT_ID,EPOCH,MEAN_MOTION,ECCENTRICITY,INCLINATION,RA_OF_ASC_NODE,ARG_OF_PERICENTER,MEAN_ANOMALY,\
        EPHEMERIS_TYPE,CLASSIFICATION_TYPE,NORAD_CAT_ID,ELEMENT_SET_NO,REV_AT_EPOCH,BSTAR,MEAN_MOTION_DOT,MEAN_MOTION_DDOT\n"
        .to_owned();
    for k in 0..count {
        let x = k as f64;
        let _ = writeln!(
            text,
            "SATELLITE NUMBER {k:06},{}-{:03}AAA,2026-11-{:02}T{:02}:{:02}:13.841216,{:.8},{:.7},{:.4},{:.4},{:.4},{:.4},0,U,{},999,{k},{:.13},{:.10},0",
            1990 + k % 36,
            1 + k % 200,
            1 + k % 20,
            k % 24,
            k % 60,
            11.5 + x * 0.618 % 4.0,
            0.0001 + x * 0.000_137 % 0.01,
            20.0 + x * 0.9 % 79.0,
            x * 0.7 % 360.0,
            x * 3.1 % 360.0,
            x * 1.3 % 360.0,
            k + 1,
            1e-5 + x * 1e-9,
            1e-6,
        );
    }
    text
}

/// The figures of `docs/orbits.md`. Run in a release build on a quiet machine, alone.
#[test]
#[ignore = "prints times"]
fn print_catalogue_times() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, count| {
        let path = folder.path().join(name);
        let text = table_of(count);
        std::fs::write(&path, &text).unwrap();
        (path, text.len() as f64 / 1e6)
    };
    let (path, megabytes) = put("all.csv", 30_000);
    let mut opened = Vec::new();
    let mut moved = Vec::new();
    for _ in 0..5 {
        let start = std::time::Instant::now();
        let catalogue = Catalogue::from_file(&path, false).unwrap();
        opened.push(start.elapsed());
        assert_eq!(catalogue.feeds.len(), 30_000);
        let epoch = catalogue.feeds[0].epoch();
        for frame in 0..20 {
            let epoch = epoch + Duration::from_seconds(f64::from(frame) / 60.0);
            let start = std::time::Instant::now();
            let states = catalogue.feeds.iter().map(|feed| feed.state_at(epoch));
            let known = states.filter(|state| std::hint::black_box(state).is_ok());
            assert!(known.count() > 29_000);
            moved.push(start.elapsed());
        }
    }
    let median = |times: &mut Vec<std::time::Duration>| {
        times.sort();
        times[times.len() / 2].as_secs_f64()
    };
    println!(
        "30 000 sets of {megabytes:.1} MB: opened in {:.2} s, a frame of all in {:.1} ms",
        median(&mut opened),
        1e3 * median(&mut moved)
    );
    let (path, megabytes) = put("large.csv", 112_000);
    let mut taken = Vec::new();
    for _ in 0..5 {
        let start = std::time::Instant::now();
        let mut files = OrbitFiles::default();
        for n in 0..100 {
            let file = files.catalogue(&path, false).unwrap();
            let name = format!("SATELLITE NUMBER {:06}", n * 907);
            let feed = file.content.one(&path, Some(&name)).unwrap();
            assert_eq!(feed.catalogue_number(), n * 907 + 1);
        }
        taken.push(start.elapsed());
    }
    println!(
        "100 satellites of a file of {megabytes:.1} MB taken in {:.2} s",
        median(&mut taken)
    );
}
