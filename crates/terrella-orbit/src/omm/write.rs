//! Writes OMM in KVN.

use super::super::write_ccsds::{Header, one_line, real};
use crate::MeanElements;
use std::fmt::Write;
use terrella_frames::{TimeScale, ccsds_time};

/// Writes elements as OMM (CCSDS 502.0-B-2, KVN), one message per satellite in sequence.
///
/// Every number has enough digits for an exact round trip; dates have all their nanoseconds.
pub fn write_omm(elements: &[MeanElements], header: &Header) -> String {
    let mut text = String::new();
    for one in elements {
        let fields = [
            ("CCSDS_OMM_VERS", "2.0".to_owned()),
            ("CREATION_DATE", header.date()),
            ("ORIGINATOR", header.originator()),
            ("OBJECT_NAME", one_line(&one.name)),
            (
                "OBJECT_ID",
                one_line(one.object_id.as_deref().unwrap_or("UNKNOWN")),
            ),
            ("CENTER_NAME", "EARTH".to_owned()),
            ("REF_FRAME", "TEME".to_owned()),
            ("TIME_SYSTEM", "UTC".to_owned()),
            ("MEAN_ELEMENT_THEORY", "SGP4".to_owned()),
            ("EPOCH", ccsds_time(one.epoch, TimeScale::Utc)),
            ("MEAN_MOTION", real(one.mean_motion_rev_day)),
            ("ECCENTRICITY", real(one.eccentricity)),
            ("INCLINATION", real(one.inclination_deg)),
            ("RA_OF_ASC_NODE", real(one.raan_deg)),
            ("ARG_OF_PERICENTER", real(one.arg_perigee_deg)),
            ("MEAN_ANOMALY", real(one.mean_anomaly_deg)),
            ("EPHEMERIS_TYPE", "0".to_owned()),
            ("CLASSIFICATION_TYPE", "U".to_owned()),
            ("NORAD_CAT_ID", one.catalogue_number.to_string()),
            ("ELEMENT_SET_NO", one.element_set_number.to_string()),
            ("REV_AT_EPOCH", one.revolution_number.to_string()),
            ("BSTAR", real(one.drag_term_per_er)),
            ("MEAN_MOTION_DOT", real(one.mean_motion_dot)),
            ("MEAN_MOTION_DDOT", real(one.mean_motion_ddot)),
        ];
        if !text.is_empty() {
            text.push('\n');
        }
        for (key, value) in fields {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{key} = {value}");
        }
    }
    text
}
