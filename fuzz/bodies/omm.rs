//! Elements in all forms: two-line lists, OMM in KVN, XML, JSON and CSV.

use std::path::Path;
use terrella_orbit::{Catalogue, Feed, Header, write_omm};

/// Reads any text; what is found good must propagate or say why not, and come back from what is written of it.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let origin = Path::new("fuzz.omm");
    let strict = Catalogue::from_text(text, origin, true);
    let lenient = Catalogue::from_text(text, origin, false);
    match (&strict, &lenient) {
        (Ok(strict), Ok(lenient)) => assert_eq!(strict.feeds.len(), lenient.feeds.len()),
        (Err(error), _) => assert!(!error.to_string().is_empty()),
        (Ok(_), Err(error)) => panic!("good when strict, and {error}"),
    }
    let Ok(catalogue) = lenient else { return };
    let elements: Vec<_> = catalogue
        .feeds
        .iter()
        .map(|f| f.elements().clone())
        .collect();
    let header = Header {
        originator: "FUZZ".to_owned(),
        created: catalogue.feeds[0].epoch(),
    };
    let again = Catalogue::from_text(&write_omm(&elements, &header), origin, true);
    let again = again.expect("what is written is read").feeds;
    assert_eq!(again.len(), elements.len());
    for (feed, written) in again.iter().zip(&elements) {
        let read = feed.elements();
        assert_eq!(read.epoch, written.epoch);
        assert_eq!(read.mean_motion_rev_day, written.mean_motion_rev_day);
        assert_eq!(read.drag_term_per_er, written.drag_term_per_er);
        let (first, last) = feed.validity();
        for epoch in [first, feed.epoch(), last] {
            if let Ok(state) = feed.state_at(epoch) {
                assert!(state.position_m.is_finite());
            }
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    const KEYS: [(&str, &str); 15] = [
        ("OBJECT_NAME", "ISS (ZARYA)"),
        ("OBJECT_ID", "1998-067A"),
        ("EPOCH", "2018-01-20T21:33:14.841216"),
        ("MEAN_MOTION", "15.5419008"),
        ("ECCENTRICITY", "0.0003646"),
        ("INCLINATION", "51.6424"),
        ("RA_OF_ASC_NODE", "32.9776"),
        ("ARG_OF_PERICENTER", "28.7227"),
        ("MEAN_ANOMALY", "39.5332"),
        ("EPHEMERIS_TYPE", "0"),
        ("NORAD_CAT_ID", "25544"),
        ("ELEMENT_SET_NO", "999"),
        ("BSTAR", "3.855e-5"),
        ("MEAN_MOTION_DOT", "2.078e-5"),
        ("MEAN_MOTION_DDOT", "0"),
    ];
    const MEANING: [(&str, &str); 4] = [
        ("CENTER_NAME", "EARTH"),
        ("REF_FRAME", "TEME"),
        ("TIME_SYSTEM", "UTC"),
        ("MEAN_ELEMENT_THEORY", "SGP4"),
    ];
    let all = || MEANING.iter().chain(&KEYS);
    let kvn: String = all()
        .map(|(key, value)| format!("{key} = {value}\n"))
        .collect();
    let kvn = format!("CCSDS_OMM_VERS = 2.0\nCOMMENT seed\n{kvn}");
    let xml: String = all()
        .map(|(key, value)| format!("<{key}>{value}</{key}>\n"))
        .collect();
    let xml = format!("<ndm><omm><body><segment><data>\n{xml}</data></segment></body></omm></ndm>");
    let json: Vec<_> = KEYS
        .iter()
        .map(|(key, value)| match value.parse::<f64>() {
            Ok(_) => format!("\"{key}\":{value}"),
            Err(_) => format!("\"{key}\":\"{value}\""),
        })
        .collect();
    let json = format!("[{{{}}}]", json.join(",\n"));
    let (names, values): (Vec<_>, Vec<_>) = KEYS.iter().copied().unzip();
    let csv = format!(
        "{}\n\"{}\n",
        names.join(","),
        values.join(",").replacen(',', "\",", 1)
    );
    let twice = format!("{kvn}\n{}", kvn.replace("25544", "799500001"));
    let object = json.trim_matches(['[', ']']).replace('\n', "");
    let lines = format!("{object}\n{}\n", object.replace("25544", "799500001"));
    let wrapped = format!("{{\"count\":1,\"results\":{json}}}");
    let tabs = format!("{}\n{}\n", names.join("\t"), values.join("\t"));
    [kvn, xml, json, csv, twice, lines, wrapped, tabs]
        .map(String::into_bytes)
        .into()
}
