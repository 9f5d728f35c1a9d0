//! Ephemerides in all file formats: OEM in KVN and XML, CZML, CSV, SP3, STK.

use std::path::Path;
use terrella_orbit::{Ephemerides, Feed, Header, write_oem};

/// Reads any text. An accepted ephemeris must give finite states within its validity, and the same positions bit for bit after it is written and
/// read again.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let origin = Path::new("fuzz.oem");
    if let Err(error) = Ephemerides::from_text(text, origin, true) {
        assert!(!error.to_string().is_empty());
    }
    let Ok(read) = Ephemerides::from_text(text, origin, false) else {
        return;
    };
    for feed in &read.feeds {
        let (first, last) = feed.validity();
        assert!(first <= last);
        for share in 0..=16 {
            let epoch = first + (last - first) * (f64::from(share) / 16.0);
            if let Ok(state) = feed.state_at(epoch) {
                assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
            }
            if let Some(error_m) = feed.error_m(epoch) {
                assert!(error_m >= 0.0 && error_m.is_finite());
            }
        }
        let header = Header {
            originator: "FUZZ".to_owned(),
            created: first,
        };
        let written = write_oem(feed, &header);
        // Times after 2099 can be computed but not written as dates; names may be empty.
        if let Ok(again) = Ephemerides::from_text(&written, origin, true) {
            for (a, b) in feed.segments().iter().zip(again.feeds[0].segments()) {
                let positions = a.samples.samples().map(|s| (s.epoch, s.position_m));
                assert!(positions.eq(b.samples.samples().map(|s| (s.epoch, s.position_m))));
            }
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    const META: [(&str, &str); 9] = [
        ("OBJECT_NAME", "SAT"),
        ("OBJECT_ID", "2018-001A"),
        ("CENTER_NAME", "EARTH"),
        ("REF_FRAME", "EME2000"),
        ("TIME_SYSTEM", "UTC"),
        ("START_TIME", "2018-01-01T00:00:00"),
        ("STOP_TIME", "2018-01-01T00:05:00"),
        ("INTERPOLATION", "HERMITE"),
        ("INTERPOLATION_DEGREE", "5"),
    ];
    let states: Vec<_> = (0..6)
        .map(|minute| {
            let (sin, cos) = (f64::from(minute) * 0.068).sin_cos();
            let numbers = [
                6778.0 * cos,
                6778.0 * sin,
                0.5,
                -7.66 * sin,
                7.66 * cos,
                0.0,
            ];
            (format!("2018-01-01T00:0{minute}:00"), numbers)
        })
        .collect();
    let joined = |numbers: &[f64], by: &str| {
        let texts: Vec<_> = numbers.iter().map(|n| format!("{n:.4}")).collect();
        texts.join(by)
    };
    let rows = |by: &str| -> String {
        let row =
            |(date, numbers): &(String, [f64; 6])| format!("{date}{by}{}\n", joined(numbers, by));
        states.iter().map(row).collect()
    };
    let meta: String = META
        .iter()
        .map(|(key, value)| format!("{key} = {value}\n"))
        .collect();
    let matrix = "COVARIANCE_START\nEPOCH = 2018-01-01T00:00:00\n1e-4\n0 1e-4\n0 0 1e-4\n0 0 0 1\n0 0 0 0 1\n0 0 0 0 0 1\nCOVARIANCE_STOP\n";
    let kvn = format!(
        "CCSDS_OEM_VERS = 2.0\nMETA_START\n{meta}META_STOP\n{}{matrix}",
        rows(" ")
    );
    let meta: String = META
        .iter()
        .map(|(key, value)| format!("<{key}>{value}</{key}>"))
        .collect();
    let vectors: String = states
        .iter()
        .map(|(date, n)| {
            let values = ["X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT"].iter().zip(n);
            let values: String = values
                .map(|(key, n)| format!("<{key}>{n:.3}</{key}>"))
                .collect();
            format!("<stateVector><EPOCH>{date}</EPOCH>{values}</stateVector>\n")
        })
        .collect();
    let xml = format!(
        "<oem><body><segment><metadata>{meta}</metadata>\n<data>{vectors}</data></segment></body></oem>"
    );
    let samples: Vec<_> = (0..6)
        .map(|k| format!("{},{}", k * 60, joined(&states[k].1[..3], "e3,")))
        .collect();
    let czml = format!(
        "[{{\"id\":\"a\",\"availability\":\"2018-01-01T00:00:00Z/2018-01-01T01:00:00Z\",\"position\":{{\"epoch\":\"2018-01-01T00:00:00Z\",\"interpolationAlgorithm\":\"LAGRANGE\",\n\"interpolationDegree\":5,\"referenceFrame\":\"INERTIAL\",\"cartesian\":[{}]}}}}]",
        samples.join(",\n")
    );
    let csv = format!(
        "# frame = TEME, scale = UTC\nepoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s\n{}",
        rows(",")
    );
    [kvn, xml, czml, csv].map(String::into_bytes).into()
}
