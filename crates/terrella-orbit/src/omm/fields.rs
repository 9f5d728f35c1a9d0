//! Checks the entries of one satellite and converts them to elements.

use super::super::entry::{Entry, Fields, RecordError, RecordFault, TextPosition, printable};
use super::super::iso8601;
use super::super::tle_fields::catalogue_number;
use crate::MeanElements;
use std::path::Path;

/// Keys that are read, and the units they may state. All others are skipped, including `USER_DEFINED_…`.
const KEYS: [(&str, &str); 21] = [
    ("OBJECT_NAME", ""),
    ("OBJECT_ID", ""),
    ("CENTER_NAME", ""),
    ("REF_FRAME", ""),
    ("TIME_SYSTEM", ""),
    ("MEAN_ELEMENT_THEORY", ""),
    ("EPOCH", ""),
    ("MEAN_MOTION", "rev/day"),
    ("SEMI_MAJOR_AXIS", "km"),
    ("ECCENTRICITY", ""),
    ("INCLINATION", "deg"),
    ("RA_OF_ASC_NODE", "deg"),
    ("ARG_OF_PERICENTER", "deg"),
    ("MEAN_ANOMALY", "deg"),
    ("EPHEMERIS_TYPE", ""),
    ("NORAD_CAT_ID", ""),
    ("ELEMENT_SET_NO", ""),
    ("REV_AT_EPOCH", ""),
    ("BSTAR", "1/ER"),
    ("MEAN_MOTION_DOT", "rev/day**2"),
    ("MEAN_MOTION_DDOT", "rev/day**3"),
];

/// Origin of a record.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum OmmSource {
    /// A message of CCSDS 502.0: frame, time system, centre and theory are required.
    Message,
    /// JSON or CSV of a catalogue, which may omit them. The defaults are those of catalogues: TEME, UTC, the Earth
    /// and SGP4.
    Catalogue,
}

/// Entries read for one satellite.
pub struct ElementEntries(Fields);

impl ElementEntries {
    /// Empty; `what` is its name in errors, `place` its start.
    pub fn new(what: &'static str, place: TextPosition) -> Self {
        Self(Fields::new(what, place, &KEYS))
    }

    pub fn place(&self) -> TextPosition {
        self.0.place()
    }

    /// The keys that name the satellite.
    pub const NAMES: [&str; 3] = ["OBJECT_NAME", "NORAD_CAT_ID", "OBJECT_ID"];

    /// Names of the satellite, as far as read.
    pub fn names(&self) -> Vec<String> {
        let entries = Self::NAMES.iter().filter_map(|key| self.0.get(key));
        entries.map(|entry| entry.value.to_string()).collect()
    }

    /// Adds an entry if it is one of the elements.
    pub fn add(&mut self, entry: Entry<'_>, origin: &Path) -> Result<(), RecordError> {
        self.0.add(entry, origin)
    }

    /// Rejects a value outside `accepted`; in a message, also rejects a missing value.
    fn check(
        &self,
        key: &'static str,
        accepted: &[&str],
        remedy: &'static str,
        source: OmmSource,
        origin: &Path,
    ) -> Result<(), RecordError> {
        match self.0.get(key) {
            Some(entry) if accepted.iter().any(|a| entry.value.eq_ignore_ascii_case(a)) => Ok(()),
            Some(entry) => Err(entry.unsupported(origin, remedy)),
            None if source == OmmSource::Catalogue => Ok(()),
            None => self.0.must(key, "", origin).map(|_| ()),
        }
    }

    /// The elements, if complete and made for SGP4.
    pub fn elements(&self, origin: &Path, source: OmmSource) -> Result<MeanElements, RecordError> {
        self.check_meaning(origin, source)?;
        let number = |key, range, expected| {
            let remedy = match key {
                "MEAN_MOTION" => "; SGP4 needs it, SEMI_MAJOR_AXIS does not do",
                "BSTAR" => "; SGP4 needs it",
                _ => "",
            };
            self.0
                .must(key, remedy, origin)?
                .number(origin, range, expected)
        };
        let angle = |key| number(key, -360.0..=360.0, "degrees from -360 to 360");
        let rate = |key| match self.0.get(key) {
            Some(entry) => entry.number(origin, -1e6..=1e6, "a number"),
            None => Ok(0.0),
        };
        let count = |key| match self.0.get(key) {
            Some(entry) => whole(&entry.value)
                .ok_or_else(|| entry.wrong(origin, "a whole number of at most 18 digits")),
            None => Ok(0),
        };
        let name = match (self.0.get("OBJECT_NAME"), self.0.get("NORAD_CAT_ID")) {
            // Lists of many catalogues have only numbers.
            (None, Some(_)) if source == OmmSource::Catalogue => "",
            _ => self.0.must("OBJECT_NAME", "", origin)?.value.trim(),
        };
        let catalogue_number = match self.0.get("NORAD_CAT_ID") {
            Some(entry) => catalogue_number(integer(&entry.value)).ok_or_else(|| {
                entry.wrong(origin, "a whole number, or a letter and four digits")
            })?,
            None => 0,
        };
        let date = self.0.must("EPOCH", "", origin)?;
        let epoch = iso8601::epoch(&date.value).map_err(|cause| {
            let key = "EPOCH".to_owned();
            date.place.error(origin, RecordFault::Time { key, cause })
        })?;
        let object_id = self.0.get("OBJECT_ID").map(|entry| entry.value.trim());
        Ok(MeanElements {
            name: match name {
                "" => catalogue_number.to_string(),
                name => printable(name),
            },
            object_id: object_id
                .filter(|id| !id.is_empty() && !id.eq_ignore_ascii_case("UNKNOWN"))
                .map(printable),
            catalogue_number,
            epoch,
            mean_motion_rev_day: number(
                "MEAN_MOTION",
                f64::MIN_POSITIVE..=1e3,
                "revolutions per day above 0",
            )?,
            eccentricity: number(
                "ECCENTRICITY",
                0.0..=1.0 - f64::EPSILON,
                "a number from 0 to below 1",
            )?,
            inclination_deg: number("INCLINATION", 0.0..=180.0, "degrees from 0 to 180")?,
            raan_deg: angle("RA_OF_ASC_NODE")?,
            arg_perigee_deg: angle("ARG_OF_PERICENTER")?,
            mean_anomaly_deg: angle("MEAN_ANOMALY")?,
            drag_term_per_er: number("BSTAR", -1e6..=1e6, "a number")?,
            mean_motion_dot: rate("MEAN_MOTION_DOT")?,
            mean_motion_ddot: rate("MEAN_MOTION_DDOT")?,
            element_set_number: count("ELEMENT_SET_NO")?,
            revolution_number: count("REV_AT_EPOCH")?,
        })
    }

    /// Rejects elements that SGP4 would propagate incorrectly.
    fn check_meaning(&self, origin: &Path, source: OmmSource) -> Result<(), RecordError> {
        for (key, accepted, remedy) in [
            (
                "MEAN_ELEMENT_THEORY",
                ["SGP4", "SGP/SGP4"],
                "these elements are made for another theory, which SGP4 would fly wrongly; take a message with SGP4",
            ),
            (
                "REF_FRAME",
                ["TEME", "TEMEOFDATE"],
                "SGP4's elements are in TEME; take a message in that frame",
            ),
            (
                "TIME_SYSTEM",
                ["UTC", "UTC"],
                "SGP4's epochs are UTC; take a message in that time system",
            ),
            (
                "CENTER_NAME",
                ["EARTH", "EARTH"],
                "only orbits about the Earth are flown",
            ),
        ] {
            self.check(key, &accepted, remedy, source, origin)?;
        }
        match self.0.get("EPHEMERIS_TYPE") {
            // 0 in distributed sets; 2 or 3 (SGP4, SDP4) in old ones; 4 is SGP4-XP.
            Some(entry) if !matches!(whole(&entry.value), Some(0 | 2 | 3)) => {
                Err(entry.unsupported(origin, "only sets made for SGP4 (0) can be flown with it"))
            }
            _ => Ok(()),
        }
    }
}

/// Without a fraction of zeros, with which some programs write whole numbers: `91002.0`.
fn integer(text: &str) -> &str {
    let text = text.trim();
    match text.split_once('.') {
        Some((whole, "0" | "00" | "")) => whole,
        _ => text,
    }
}

/// Digits only, at most 18.
fn whole(text: &str) -> Option<u64> {
    let text = integer(text);
    let is_plain = text.len() <= 18 && text.bytes().all(|c| c.is_ascii_digit());
    is_plain.then(|| text.parse().ok()).flatten()
}
