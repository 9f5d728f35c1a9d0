//! Detects the format of an orbit file from its text or name.

use super::file::first_text;
use super::text::{kvn, unmarked, with_line_feeds};
use super::{FileFormat, OrbitError, ephemeris_csv, omm, sp3, stk};
use std::path::Path;

/// Shortest line of two-line elements: 69 columns, of which the checksum and blanks at the end may be missing.
const TLE_LINE: usize = 60;

impl FileFormat {
    /// The format of a text from its beginning; `None` if it is not an orbit file. The first tens of kilobytes are enough.
    pub fn of_text(text: &str) -> Option<Self> {
        let text = with_line_feeds(unmarked(text));
        let text = text.trim_start();
        if sp3::is_sp3(text) {
            return Some(Self::Sp3);
        }
        if stk::is_stk(text) {
            return Some(Self::Stk);
        }
        match text.as_bytes().first()? {
            b'<' => of_xml(text),
            b'[' | b'{' => of_json(text),
            _ => of_lines(text),
        }
    }

    /// As [`Self::of_text`], of the bytes that a file begins with: it may be compressed by gzip, or in UTF-16.
    pub fn of_bytes(head: &[u8]) -> Option<Self> {
        Self::of_text(&first_text(head))
    }

    /// Whether a file starts as a CCSDS message without a reader, such as an OCM or a CDM. [`Ephemerides`](crate::Ephemerides) describes the
    /// remedy.
    pub fn is_unread_message(head: &[u8]) -> bool {
        let text = first_text(head);
        let text = with_line_feeds(&text);
        Self::of_text(&text).is_none() && message_of_another_kind(&text).is_some()
    }

    /// The format of a file name's extension, without its dot and in any case. Generic extensions (`txt`, `xml`, `json`) give none.
    pub fn of_ending(ending: &str) -> Option<Self> {
        Some(match ending.to_lowercase().as_str() {
            "tle" | "2le" | "3le" => Self::Tle,
            "omm" => Self::Omm,
            "oem" => Self::Oem,
            "opm" => Self::Opm,
            "czml" => Self::Czml,
            "csv" => Self::Csv,
            "sp3" => Self::Sp3,
            "e" => Self::Stk,
            _ => return None,
        })
    }
}

/// A CCSDS message that has neither mean elements nor an ephemeris.
pub(super) struct OtherMessage {
    key: &'static str,
    element: &'static str,
    kind: &'static str,
    remedy: &'static str,
}

const OTHER_MESSAGES: [OtherMessage; 8] = [
    OtherMessage {
        key: VERSIONS[2],
        element: "<opm",
        kind: "an orbit parameter message (OPM)",
        remedy: "has neither mean elements nor an ephemeris; a scene reads it with source = \"opm\"",
    },
    OtherMessage {
        key: "CCSDS_OCM_VERS",
        element: "<ocm",
        kind: "an orbit comprehensive message (OCM)",
        remedy: "is not read; export its trajectory as an OEM, or its state as an OPM",
    },
    OtherMessage {
        key: "CCSDS_AEM_VERS",
        element: "<aem",
        kind: "an attitude ephemeris message (AEM)",
        remedy: "has no orbit in it; export an OEM",
    },
    OtherMessage {
        key: "CCSDS_CDM_VERS",
        element: "<cdm",
        kind: "a conjunction data message (CDM)",
        remedy: "has states of one instant alone; export an OEM or OPM of the object",
    },
    OtherMessage {
        key: "CCSDS_TDM_VERS",
        element: "<tdm",
        kind: "a tracking data message (TDM)",
        remedy: "has measurements and no orbit; export an OEM",
    },
    OtherMessage {
        key: "CCSDS_RDM_VERS",
        element: "<rdm",
        kind: "a re-entry data message (RDM)",
        remedy: "has a prediction of the re-entry and no orbit; export an OEM",
    },
    OtherMessage {
        key: "CCSDS_APM_VERS",
        element: "<apm",
        kind: "an attitude parameter message (APM)",
        remedy: "has no orbit in it; export an OEM",
    },
    OtherMessage {
        key: "CCSDS_ACM_VERS",
        element: "<acm",
        kind: "an attitude comprehensive message (ACM)",
        remedy: "has no orbit in it; export an OEM",
    },
];

impl OtherMessage {
    /// The error that it is not of the requested kind.
    pub fn error(&self, origin: &Path) -> OrbitError {
        OrbitError::NotRead {
            path: origin.to_owned(),
            kind: self.kind,
            remedy: self.remedy,
        }
    }
}

/// The kind of a CCSDS message without mean elements and ephemeris, from its first key or its elements.
pub(super) fn message_of_another_kind(text: &str) -> Option<&'static OtherMessage> {
    let start = unmarked(text).trim_start();
    let mut kinds = OTHER_MESSAGES.iter();
    if !start.starts_with('<') {
        let first_key = match kvn::lines(start).next() {
            Some(kvn::KvnLine::Entry(entry)) => entry.key,
            _ => return None,
        };
        return kinds.find(|other| first_key == other.key);
    }
    let head: String = start.chars().take(HEAD_CHARS).collect();
    // An <ndm> may contain such messages beside the requested ones.
    let is_other = !["<oem", "<omm"].iter().any(|wanted| head.contains(wanted));
    kinds.find(|other| is_other && (head.contains(other.element) || head.contains(other.key)))
}

/// How far into a message in XML its kind is looked for, characters.
const HEAD_CHARS: usize = 4096;

/// The format of the first of these words in a text.
fn first_of(text: &str, words: &[(&str, FileFormat)]) -> Option<FileFormat> {
    let found = words.iter().filter_map(|(word, format)| {
        let at = text.find(word)?;
        Some((at, *format))
    });
    found.min_by_key(|(at, _)| *at).map(|(_, format)| format)
}

fn of_xml(text: &str) -> Option<FileFormat> {
    use FileFormat::{Oem, Omm, Opm};
    // Messages may be inside an <ndm>, and tags may have prefixes.
    first_of(
        text,
        &[
            (VERSIONS[0], Omm),
            (VERSIONS[1], Oem),
            (VERSIONS[2], Opm),
            ("<omm", Omm),
            ("<oem", Oem),
            ("<opm", Opm),
            ("MEAN_MOTION>", Omm),
            ("stateVector>", Oem),
        ],
    )
}

fn of_json(text: &str) -> Option<FileFormat> {
    // A table of TOML begins so too, but no value follows.
    let inner = text.trim_start_matches(['[', '{']).trim_start();
    if !inner.starts_with(['"', '{']) {
        return None;
    }
    use FileFormat::{Czml, Omm};
    first_of(
        text,
        &[
            ("\"MEAN_MOTION\"", Omm),
            ("\"mean_motion\"", Omm),
            ("\"SEMI_MAJOR_AXIS\"", Omm),
            ("\"OBJECT_NAME\"", Omm),
            ("\"OBJECT_ID\"", Omm),
            ("\"document\"", Czml),
            ("\"position\"", Czml),
        ],
    )
}

/// First keys of messages in KVN.
const VERSIONS: [&str; 3] = ["CCSDS_OMM_VERS", "CCSDS_OEM_VERS", "CCSDS_OPM_VERS"];

fn of_lines(text: &str) -> Option<FileFormat> {
    match kvn::lines(text).next() {
        Some(kvn::KvnLine::Entry(entry)) if entry.key == VERSIONS[0] => {
            return Some(FileFormat::Omm);
        }
        Some(kvn::KvnLine::Entry(entry)) if entry.key == VERSIONS[1] => {
            return Some(FileFormat::Oem);
        }
        Some(kvn::KvnLine::Entry(entry)) if entry.key == VERSIONS[2] => {
            return Some(FileFormat::Opm);
        }
        _ => {}
    }
    if omm::has_element_columns(text) {
        return Some(FileFormat::Omm);
    }
    if ephemeris_csv::is_table(text) {
        return Some(FileFormat::Csv);
    }
    has_elements(text).then_some(FileFormat::Tle)
}

/// Whether two consecutive lines are those of an element set.
pub(super) fn has_elements(text: &str) -> bool {
    let is = |line: &str, number: &str| line.starts_with(number) && line.len() >= TLE_LINE;
    let mut lines = text.lines().map(str::trim);
    let mut before = lines.next().unwrap_or_default();
    lines.any(|line| {
        let is_pair = is(before, "1 ") && is(line, "2 ");
        before = line;
        is_pair
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_come_with_the_program_are_recognised() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits");
        let mut seen = 0;
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let text = std::fs::read_to_string(&path).expect("text");
            let ending = path.extension().expect("an ending").to_string_lossy();
            let promised = FileFormat::of_ending(&ending);
            assert!(promised.is_some(), "{}", path.display());
            assert_eq!(FileFormat::of_text(&text), promised, "{}", path.display());
            seen += 1;
        }
        assert!(seen >= 5, "{seen}");
    }

    #[test]
    fn all_forms_are_distinguished_from_one_another_and_from_scenes() {
        use FileFormat::{Csv, Czml, Oem, Omm, Opm, Sp3, Stk, Tle};
        let set = "1 25544U 98067A   26329.50000000  .00016717  00000-0  10270-3 0  9993\n2 25544  51.6400 208.9163 0006703  69.9862  25.2906 15.50000000    13\n";
        let cases: &[(&str, Option<FileFormat>)] = &[
            (set, Some(Tle)),
            (
                &format!(
                    "\u{feff}# by hand\r\n\r\nISS\r\n{}",
                    set.replace('\n', "\r\n")
                ),
                Some(Tle),
            ),
            ("CCSDS_OMM_VERS = 2.0\n", Some(Omm)),
            ("COMMENT x\nCCSDS_OEM_VERS = 2.0\n", Some(Oem)),
            ("CCSDS_OEM_VERS = 2.0\n", Some(Oem)),
            (
                "<?xml version=\"1.0\"?>\n<ndm><omm id=\"CCSDS_OMM_VERS\">",
                Some(Omm),
            ),
            ("<ndm:oem id=\"CCSDS_OEM_VERS\">", Some(Oem)),
            ("COMMENT x\nCCSDS_OPM_VERS = 2.0\n", Some(Opm)),
            (
                "<?xml version=\"1.0\"?>\n<ndm><opm id=\"CCSDS_OPM_VERS\"><stateVector>",
                Some(Opm),
            ),
            ("<html><body>", None),
            (
                "[{\"OBJECT_NAME\":\"ISS\",\"MEAN_MOTION\":15.5}]",
                Some(Omm),
            ),
            ("[\n {\"id\":\"document\",\"version\":\"1.0\"}]", Some(Czml)),
            ("{\"name\":\"x\"}", None),
            ("OBJECT_NAME,OBJECT_ID,EPOCH,MEAN_MOTION\n", Some(Omm)),
            ("OBJECT_NAME\tEPOCH\tMEAN_MOTION\n", Some(Omm)),
            ("NORAD_CAT_ID;EPOCH;INCLINATION\n", Some(Omm)),
            ("OBJECT_ID,EPOCH,epoch_utc,x_km,y_km,z_km\n", Some(Csv)),
            ("epoch_utc;x_km;y_km;z_km\n", Some(Csv)),
            ("{\"data\": [{\"OBJECT_NAME\":\"ISS\"}]}", Some(Omm)),
            ("# frame = ITRF\nepoch_utc,x_km,y_km,z_km\n", Some(Csv)),
            ("a,b,c\n1,2,3\n", None),
            ("[time]\nstart = \"now\"\n", None),
            ("[[orbit]]\nfile = \"a.tle\"\n", None),
            ("[ camera ]\n", None),
            (
                "#dP2020  6 24  0  0  0.00000000      96 ORBIT IGS14\n",
                Some(Sp3),
            ),
            ("#c comment\n", None),
            ("stk.v.11.0\nBEGIN Ephemeris\n", Some(Stk)),
            ("CREATION\rCCSDS_OEM_VERS = 2.0\r", None),
            ("COMMENT x\rCCSDS_OEM_VERS = 2.0\r", Some(Oem)),
            ("", None),
            ("1 apple\n2 pears\n", None),
        ];
        for (text, wanted) in cases {
            assert_eq!(FileFormat::of_text(text), *wanted, "{text}");
        }
        assert_eq!(FileFormat::of_ending("TLE"), Some(Tle));
        assert_eq!(FileFormat::of_ending("txt"), None);
    }
}
