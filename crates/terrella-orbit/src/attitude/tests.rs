//! Attitudes against the matrix of the standard, and files that are wrong.

use super::*;
use glam::DVec3;
use terrella_frames::{Duration, utc_from_rfc3339};

fn at(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap()
}

fn read(text: &str) -> Result<AttitudeHistory, RecordError> {
    AttitudeHistory::of_text(text, Path::new("a.aem"))
}

/// A message of one segment; `meta` replaces lines of its metadata by their keys.
fn aem(version: &str, meta: &[(&str, &str)], rows: &[&str]) -> String {
    let mut lines = vec![
        ("OBJECT_NAME", "SAT"),
        ("REF_FRAME_A", "EME2000"),
        ("REF_FRAME_B", "SC_BODY_1"),
        ("TIME_SYSTEM", "UTC"),
        ("START_TIME", "2018-01-15T12:00:00"),
        ("STOP_TIME", "2018-01-15T12:10:00"),
        ("ATTITUDE_TYPE", "QUATERNION"),
    ];
    for (key, value) in meta {
        match lines.iter_mut().find(|(known, _)| known == key) {
            Some(line) => line.1 = value,
            None => lines.push((key, value)),
        }
    }
    let lines = lines.iter().filter(|(_, value)| !value.is_empty());
    let lines: String = lines.map(|(k, v)| format!("{k} = {v}\n")).collect();
    let rows = rows.join("\n");
    format!(
        "CCSDS_AEM_VERS = {version}\nCREATION_DATE = 2018-01-01T00:00:00\nORIGINATOR = X\nCOMMENT a = b\nMETA_START\n{lines}META_STOP\nDATA_START\n{rows}\nDATA_STOP\n"
    )
}

/// An odd attitude, as Q1, Q2, Q3, QC.
const Q: [f64; 4] = [
    0.18257418583505536,
    -0.3651483716701107,
    0.5477225575051661,
    0.7302967433402214,
];

fn row(time: &str, q: [f64; 4]) -> String {
    let [a, b, c, d] = q;
    format!("2018-01-15T{time} {a} {b} {c} {d}")
}

/// The attitude matrix of CCSDS 504.0-B-1, annex on conventions: v_B = M v_A.
fn coordinates_in_b([q1, q2, q3, qc]: [f64; 4], v: DVec3) -> DVec3 {
    let m = [
        [
            q1 * q1 - q2 * q2 - q3 * q3 + qc * qc,
            2.0 * (q1 * q2 + q3 * qc),
            2.0 * (q1 * q3 - q2 * qc),
        ],
        [
            2.0 * (q1 * q2 - q3 * qc),
            -q1 * q1 + q2 * q2 - q3 * q3 + qc * qc,
            2.0 * (q2 * q3 + q1 * qc),
        ],
        [
            2.0 * (q1 * q3 + q2 * qc),
            2.0 * (q2 * q3 - q1 * qc),
            -q1 * q1 - q2 * q2 + q3 * q3 + qc * qc,
        ],
    ];
    DVec3::from_array(m.map(|row| row[0] * v.x + row[1] * v.y + row[2] * v.z))
}

/// The same message in XML with one attitude; `values` are the elements after its epoch.
fn xml(meta: &[(&str, &str)], values: &str) -> String {
    let kvn = aem("2.0", meta, &[]);
    let meta = kvn.lines().skip(5).take_while(|line| *line != "META_STOP");
    let meta: String = meta
        .map(|line| {
            let (key, value) = line.split_once(" = ").unwrap();
            format!("<{key}>{value}</{key}>\n")
        })
        .collect();
    format!(
        "<aem id=\"CCSDS_AEM_VERS\" version=\"2.0\"><body><segment>\n\n<metadata>\n{meta}</metadata>\n<data><attitudeState><x><EPOCH>2018-01-15T12:00:00</EPOCH>{values}</x></attitudeState></data>\n</segment></body></aem>\n"
    )
}

/// v_B = R₃ R₂ R₁ v_A with the elementary rotations of frames (CCSDS 500.0-G, 3.3).
fn turned(sequence: &str, angles_deg: [f64; 3], v: DVec3) -> DVec3 {
    let axes = sequence.chars().zip(angles_deg);
    axes.fold(v, |v, (axis, deg)| {
        let (s, c) = deg.to_radians().sin_cos();
        match axis {
            'X' => DVec3::new(v.x, c * v.y + s * v.z, c * v.z - s * v.y),
            'Y' => DVec3::new(c * v.x - s * v.z, v.y, s * v.x + c * v.z),
            _ => DVec3::new(c * v.x + s * v.y, c * v.y - s * v.x, v.z),
        }
    })
}

#[test]
fn euler_angles_and_xml_are_those_of_the_standard() {
    let v = DVec3::new(0.3, -0.7, 0.2);
    let epoch = at("2018-01-15T12:00:00Z");
    let body_of = |text: &str| {
        let read = read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let (_, frame_from_body) = read.frame_from_body(epoch).unwrap();
        frame_from_body.inverse() * v
    };
    let angles = [25.0, -70.0, 310.0];
    let named = "<ANGLE_1 units=\"deg\">25</ANGLE_1><ANGLE_2>-70</ANGLE_2><ANGLE_3>310</ANGLE_3>";
    for (letters, numbers) in [
        ("ZYX", "321"),
        ("XYZ", "123"),
        ("ZXZ", "313"),
        ("YZY", "232"),
    ] {
        let expected = turned(letters, angles, v);
        let row = "2018-01-15T12:00:00 25 -70 310";
        let with_rates = format!("{row} 0.1 0.2 0.3");
        for (kind, row) in [("EULER_ANGLE", row), ("EULER_ANGLE/RATE", &with_rates)] {
            let meta = [
                ("ATTITUDE_TYPE", kind),
                ("EULER_ROT_SEQ", numbers),
                ("ATTITUDE_DIR", "A2B"),
            ];
            assert!((body_of(&aem("1.0", &meta, &[row])) - expected).length() < 1e-14);
        }
        let meta = [("ATTITUDE_TYPE", "EULER_ANGLE"), ("EULER_ROT_SEQ", letters)];
        assert!((body_of(&xml(&meta, named)) - expected).length() < 1e-14);
    }
    let [q1, q2, q3, qc] = Q;
    let named =
        format!("<quaternion><QC>{qc}</QC><Q1>{q1}</Q1><Q2>{q2}</Q2><Q3>{q3}</Q3></quaternion>");
    let quaternion = [("QUATERNION_TYPE", "FIRST")];
    let in_body = coordinates_in_b(Q, v);
    assert!((body_of(&xml(&quaternion, &named)) - in_body).length() < 1e-15);
}

#[test]
fn quaternions_are_those_of_the_standard() {
    let v = DVec3::new(0.3, -0.7, 0.2);
    let epoch = at("2018-01-15T12:00:00Z");
    let body_of = |text: &str| {
        let (frame, frame_from_body) = read(text).unwrap().frame_from_body(epoch).unwrap();
        assert_eq!(frame, Frame::Eme2000);
        frame_from_body.inverse() * v
    };
    let rows = [row("12:00:00", Q)];
    let last = [rows[0].as_str()];
    let in_body = coordinates_in_b(Q, v);
    assert!((body_of(&aem("2.0", &[], &last)) - in_body).length() < 1e-15);
    let [q1, q2, q3, qc] = Q;
    let first = row("12:00:00", [qc, q1, q2, q3]);
    let first = aem(
        "1.0",
        &[("ATTITUDE_DIR", "A2B"), ("QUATERNION_TYPE", "FIRST")],
        &[&first],
    );
    assert!((body_of(&first) - in_body).length() < 1e-15);
    // From the body to the frame: the matrix maps the body coordinates to v.
    let swapped = [("REF_FRAME_A", "SC_BODY_1"), ("REF_FRAME_B", "EME2000")];
    let from_body = body_of(&aem("2.0", &swapped, &last));
    assert!((coordinates_in_b(Q, from_body) - v).length() < 1e-15);
    let backwards = [("ATTITUDE_DIR", "B2A"), ("QUATERNION_TYPE", "LAST")];
    let from_body = body_of(&aem("1.0", &backwards, &last));
    assert!((coordinates_in_b(Q, from_body) - v).length() < 1e-15);
    // The table's own convention is the same rotation.
    let table = format!(
        "# frame = EME2000\nqw,qx,epoch_utc,qy,qz\n{qc},{q1},2018-01-15T12:00:00Z,{q2},{q3}\n"
    );
    assert!((body_of(&table) - in_body).length() < 1e-15);
}

#[test]
fn between_samples_it_turns_evenly_and_the_shorter_way() {
    let half = |degrees: f64| (0.5 * degrees.to_radians()).sin_cos();
    let about_z = |degrees: f64, sign: f64| {
        let (sin, cos) = half(degrees);
        [0.0, 0.0, sign * sin, sign * cos]
    };
    // The second is the same attitude with the other sign.
    let rows = [
        row("12:00:00", about_z(10.0, 1.0)),
        row("12:01:00", about_z(70.0, -1.0)),
    ];
    let history = read(&aem("2.0", &[], &[&rows[0], &rows[1]])).unwrap();
    for (seconds, degrees) in [(0.0, 10.0), (15.0, 25.0), (45.0, 55.0), (60.0, 70.0)] {
        let epoch = at("2018-01-15T12:00:00Z") + Duration::from_seconds(seconds);
        let (_, q) = history.frame_from_body(epoch).unwrap();
        let x = q * DVec3::X;
        let got = x.y.atan2(x.x).to_degrees();
        assert!((got - degrees).abs() < 1e-9, "{seconds}: {got}");
    }
    let (_, q) = history.frame_from_body(at("2018-01-15T12:00:30Z")).unwrap();
    let itrf = history
        .itrf_from_body(at("2018-01-15T12:00:30Z"), &Orientation::default())
        .unwrap();
    let frame = Frame::Eme2000.itrf_from(at("2018-01-15T12:00:30Z"), &Orientation::default());
    assert!((itrf * DVec3::Y - frame * (q * DVec3::Y)).length() < 1e-14);
}

#[test]
fn outside_of_its_time_and_in_gaps_an_error_says_so() {
    let first = aem(
        "2.0",
        &[("USEABLE_START_TIME", "2018-01-15T12:00:30")],
        &[&row("12:00:00", Q), &row("12:01:00", Q)],
    );
    let second = aem("2.0", &[], &[&row("12:05:00", Q), &row("12:06:00", Q)]);
    let (_, second) = second.split_once("COMMENT a = b\n").unwrap();
    let history = read(&format!("{first}{second}")).unwrap();
    assert_eq!(
        history.validity(),
        (at("2018-01-15T12:00:30Z"), at("2018-01-15T12:06:00Z"))
    );
    let said = |time: &str| history.frame_from_body(at(time)).unwrap_err().to_string();
    assert_eq!(
        said("2018-01-15T12:00:10Z"),
        "a.aem: the attitude is not known at 2018-01-15T12:00:10.000Z; the file has it from 2018-01-15T12:00:30.000Z to 2018-01-15T12:06:00.000Z: take a time within, or a file that reaches there"
    );
    assert_eq!(
        said("2018-01-15T12:03:00Z"),
        "a.aem: the attitude is not known at 2018-01-15T12:03:00.000Z; the file has none between 2018-01-15T12:01:00.000Z and 2018-01-15T12:05:00.000Z: take a time outside of that gap"
    );
    let span = |from: &str, to: &str| history.check_span(at(from), at(to));
    assert!(span("2018-01-15T12:00:30Z", "2018-01-15T12:01:00Z").is_ok());
    assert!(matches!(
        span("2018-01-15T12:00:40Z", "2018-01-15T12:05:30Z"),
        Err(AttitudeError::Gap { .. })
    ));
    assert!(matches!(
        span("2018-01-15T12:05:30Z", "2018-01-15T12:07:00Z"),
        Err(AttitudeError::Outside { .. })
    ));
}

#[test]
fn wrong_files_are_errors_by_line_and_column() {
    let good = row("12:00:00", Q);
    let with = |meta: &[(&str, &str)]| aem("2.0", meta, &[&good]);
    let cases = [
        (
            with(&[("REF_FRAME_A", "LVLH")]),
            "a.aem:7:15: REF_FRAME_A = \"LVLH\" cannot be used: known frames",
        ),
        (
            with(&[("REF_FRAME_B", "STARTRACKER_1")]),
            "must be a spacecraft body frame",
        ),
        (
            with(&[("ATTITUDE_TYPE", "SPIN")]),
            "attitudes are read as QUATERNION and EULER_ANGLE",
        ),
        (
            with(&[("ATTITUDE_TYPE", "EULER_ANGLE")]),
            "without EULER_ROT_SEQ",
        ),
        (
            with(&[("ATTITUDE_TYPE", "EULER_ANGLE"), ("EULER_ROT_SEQ", "ZZX")]),
            "no two neighbours are the same",
        ),
        (
            with(&[("ATTITUDE_TYPE", "EULER_ANGLE"), ("EULER_ROT_SEQ", "ZYX")]),
            "expected an epoch and three angles",
        ),
        (with(&[("TIME_SYSTEM", "MET")]), "known time systems"),
        (with(&[("OBJECT_NAME", "")]), "without OBJECT_NAME"),
        (
            with(&[("USEABLE_START_TIME", "2018-01-15T13:00:00")]),
            "within its useable time",
        ),
        (
            aem("1.0", &[("QUATERNION_TYPE", "LAST")], &[&good]),
            "without ATTITUDE_DIR",
        ),
        (
            aem(
                "1.0",
                &[("ATTITUDE_DIR", "A2C"), ("QUATERNION_TYPE", "LAST")],
                &[&good],
            ),
            "expected A2B or B2A",
        ),
        (aem("3.0", &[], &[&good]), "versions 1 and 2"),
        (
            aem("2.0", &[], &["2018-01-15T12:00:00 1 2 3"]),
            "expected an epoch and four numbers",
        ),
        (
            aem("2.0", &[], &["2018-01-15T12:00:00 0 0 0 nan"]),
            "the attitude is \"nan\"",
        ),
        (
            aem("2.0", &[], &["2018-01-15T12:00:00 0 0 0 0"]),
            "the length of the quaternion is \"0.0000\"",
        ),
        (
            aem("2.0", &[], &["2018-01-15T12:00:00 0 0 0 1e308"]),
            "the length of the quaternion is",
        ),
        (aem("2.0", &[], &["never 0 0 0 1"]), "the epoch"),
        (
            aem("2.0", &[], &[&good, &good]),
            "one after that of the row before",
        ),
        (aem("2.0", &[], &[]), "without attitudes"),
        (
            aem("2.0", &[], &[&good]).replace("DATA_STOP\n", ""),
            "without DATA_STOP; the file is truncated",
        ),
        ("<aem/>".to_owned(), "without segment; it has no attitudes"),
        (
            xml(&[("OBJECT_NAME", "")], "<Q1>0</Q1>"),
            "a.aem:3:1: the metadata",
        ),
        (xml(&[], "<Q1>0</Q1>"), "the attitude without Q2"),
        (xml(&[], "<Q1>x</Q1>"), "a.aem:12:"),
        ("CCSDS_AEM_VERS = 2.0\n".to_owned(), "without META_START"),
        (String::new(), "the file without attitudes"),
        (
            "# frame = GCRF\nepoch_utc,qx,qy,qz\n".to_owned(),
            "expected the columns epoch_utc",
        ),
        (
            "epoch_utc,qx,qy,qz,qw\n2018-01-15T12:00:00Z,0,0,0,1\n".to_owned(),
            "without frame; write \"# frame = GCRF\"",
        ),
        (
            "# frame = MARS\nepoch_utc,qx,qy,qz,qw\n2018-01-15T12:00:00Z,0,0,0,1\n".to_owned(),
            "a.aem:1:11: frame = \"MARS\"",
        ),
        (
            "# frame = GCRF\nepoch_utc,qx,qy,qz,qw\n2018-01-15T12:00:00Z,0,0,x,1\n".to_owned(),
            "a.aem:3:26: qz is \"x\"",
        ),
        (
            "# frame = GCRF\nepoch_utc,qx,qy,qz,qw\n1,2\n".to_owned(),
            "2 fields",
        ),
    ];
    for (text, said) in cases {
        let error = read(&text).expect_err(said).to_string();
        assert!(
            error.starts_with("a.aem:") && error.contains(said),
            "{said}: {error}"
        );
    }
    // Nothing that is cut off or changed panics.
    let whole = aem(
        "1.0",
        &[("ATTITUDE_DIR", "A2B"), ("QUATERNION_TYPE", "LAST")],
        &[&good],
    );
    for end in 0..whole.len() {
        let _ = read(&whole[..end]);
        let mut bytes = whole.clone().into_bytes();
        bytes[end] = b'\n';
        let _ = read(&String::from_utf8_lossy(&bytes));
    }
}
