//! Orbit parameter messages in KVN and XML.

use std::path::Path;
use terrella_orbit::ParameterMessages;

/// Reads any text. An accepted message must have a finite state, and its manoeuvres in order.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let origin = Path::new("fuzz.opm");
    if let Err(error) = ParameterMessages::from_text(text, origin, true) {
        assert!(!error.to_string().is_empty());
    }
    let Ok(read) = ParameterMessages::from_text(text, origin, false) else {
        return;
    };
    assert!(!read.messages.is_empty());
    for message in &read.messages {
        let state = &message.state;
        assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
        let ignitions = message.maneuvers.iter().map(|maneuver| maneuver.ignition);
        assert!(ignitions.is_sorted());
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    const KEYS: [(&str, &str); 30] = [
        ("OBJECT_NAME", "SAT"),
        ("OBJECT_ID", "2018-001A"),
        ("CENTER_NAME", "EARTH"),
        ("REF_FRAME", "EME2000"),
        ("TIME_SYSTEM", "UTC"),
        ("EPOCH", "2018-01-01T00:00:00"),
        ("X", "6778.137"),
        ("Y", "0"),
        ("Z", "0.5"),
        ("X_DOT", "0"),
        ("Y_DOT", "4.7"),
        ("Z_DOT", "6.05"),
        ("SEMI_MAJOR_AXIS", "6778.137"),
        ("ECCENTRICITY", "0.001"),
        ("INCLINATION", "52.2"),
        ("RA_OF_ASC_NODE", "0"),
        ("ARG_OF_PERICENTER", "0"),
        ("TRUE_ANOMALY", "0"),
        ("GM", "398600.4415"),
        ("MASS", "1913"),
        ("DRAG_AREA", "10"),
        ("DRAG_COEFF", "2.3"),
        ("CX_X", "1e-4"),
        ("MAN_EPOCH_IGNITION", "2018-01-01T01:00:00"),
        ("MAN_DURATION", "60.5"),
        ("MAN_DELTA_MASS", "-1"),
        ("MAN_REF_FRAME", "RTN"),
        ("MAN_DV_1", "0.001"),
        ("MAN_DV_2", "-2e-3"),
        ("MAN_DV_3", "0"),
    ];
    let kvn = KEYS
        .map(|(key, value)| format!("{key} = {value}\n"))
        .concat();
    let kvn = format!("CCSDS_OPM_VERS = 2.0\nCREATION_DATE = 2018-01-01T00:00:00\n{kvn}");
    let xml = KEYS
        .map(|(key, value)| format!("<{key}>{value}</{key}>\n"))
        .concat();
    let xml = format!("<opm id=\"CCSDS_OPM_VERS\"><body>{xml}</body></opm>");
    [kvn, xml].map(String::into_bytes).into()
}
