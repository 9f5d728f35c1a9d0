//! Attitude ephemeris messages in KVN: 504.0-B-1 (2008) and 504.0-B-2 (2024), as far as they hold quaternions.

use super::super::Frame;
use super::super::entry::{
    Entry, Fields, Keys, RecordError, RecordFault, TextPosition, scaled_number,
};
use super::super::oem::TimeSystem;
use super::super::text::kvn::{KvnLine, lines};
use super::super::text::offset;
use super::{Segment, push};
use glam::{DQuat, DVec4};
use std::borrow::Cow;
use std::path::Path;
use terrella_files::excerpt;
use terrella_frames::Epoch;

/// The key that begins a message.
const VERSION: &str = "CCSDS_AEM_VERS";

const META_KEYS: &Keys = &[
    ("OBJECT_NAME", ""),
    ("REF_FRAME_A", ""),
    ("REF_FRAME_B", ""),
    ("ATTITUDE_DIR", ""),
    ("TIME_SYSTEM", ""),
    ("USEABLE_START_TIME", ""),
    ("USEABLE_STOP_TIME", ""),
    ("ATTITUDE_TYPE", ""),
    ("QUATERNION_TYPE", ""),
];

/// Whether a text is an AEM, in KVN or in XML.
pub fn is_aem(text: &str) -> bool {
    let begin = text.trim_start();
    begin.starts_with('<')
        || match lines(begin).next() {
            Some(KvnLine::Entry(entry)) => entry.key == VERSION,
            _ => false,
        }
}

/// What the metadata of a segment say of its rows.
struct Meaning {
    frame: Frame,
    /// Whether the quaternion is of the rotation from the frame to the body; else of that from the body.
    is_to_body: bool,
    system: TimeSystem,
    is_scalar_first: bool,
    /// Numbers of a row behind its epoch.
    columns: usize,
    useable: (Option<Epoch>, Option<Epoch>),
    place: TextPosition,
}

/// Between which marks the reader is.
enum Block {
    Header,
    Metadata(Fields),
    /// Behind the metadata, before the rows.
    Begun(Meaning),
    Data(Meaning, Vec<(Epoch, DQuat)>),
}

pub fn segments(text: &str, origin: &Path) -> Result<Vec<Segment>, RecordError> {
    let start = TextPosition { line: 1, column: 1 };
    if text.trim_start().starts_with('<') {
        let fault = RecordFault::Syntax {
            format: "AEM in KVN",
            cause: "attitude messages in XML are not read; write KVN".to_owned(),
        };
        return Err(start.error(origin, fault));
    }
    let mut segments: Vec<Segment> = Vec::new();
    let mut object: Option<String> = None;
    let mut version = 0;
    let mut block = Block::Header;
    for line in lines(text) {
        block = match (line, block) {
            (KvnLine::Entry(entry), Block::Header) => {
                if entry.key == VERSION {
                    version = match entry.value.split('.').next() {
                        Some("1") => 1,
                        Some("2") => 2,
                        _ => return Err(entry.unsupported(origin, "versions 1 and 2 are read")),
                    };
                }
                Block::Header
            }
            (KvnLine::Entry(entry), Block::Metadata(mut meta)) => {
                meta.add(entry, origin)?;
                Block::Metadata(meta)
            }
            (KvnLine::Entry(entry), Block::Begun(_) | Block::Data(..)) => {
                let place = entry.place;
                return Err(unexpected(
                    &entry.key,
                    place,
                    "DATA_START or rows of attitudes",
                    origin,
                ));
            }
            (KvnLine::Other { text, place }, block) => match (text, block) {
                ("META_START", Block::Header) => {
                    Block::Metadata(Fields::new("the metadata", place, META_KEYS))
                }
                ("META_STOP", Block::Metadata(meta)) => {
                    let name = meta.must("OBJECT_NAME", "", origin)?;
                    match &object {
                        Some(first) if *first != *name.value => {
                            let remedy = "the file begins with another object; give each object a file of its own";
                            return Err(name.unsupported(origin, remedy));
                        }
                        _ => object = Some(name.value.clone().into_owned()),
                    }
                    Block::Begun(meaning(&meta, version, origin)?)
                }
                ("DATA_START", Block::Begun(meaning)) => Block::Data(meaning, Vec::new()),
                ("DATA_STOP", Block::Data(meaning, samples)) => {
                    let segment = Segment::new(
                        meaning.frame,
                        samples,
                        meaning.useable,
                        meaning.place,
                        origin,
                    )?;
                    if segments
                        .last()
                        .is_some_and(|last| last.first > segment.first)
                    {
                        let expected = "segments in order of time";
                        return Err(unexpected(text, place, expected, origin));
                    }
                    segments.push(segment);
                    Block::Header
                }
                (_, Block::Data(meaning, mut samples)) => {
                    row(text, place, &meaning, &mut samples, origin)?;
                    Block::Data(meaning, samples)
                }
                (_, Block::Header) => {
                    return Err(unexpected(text, place, "META_START", origin));
                }
                (_, Block::Metadata(_)) => {
                    return Err(unexpected(text, place, "KEY = value, or META_STOP", origin));
                }
                (_, Block::Begun(_)) => {
                    return Err(unexpected(text, place, "DATA_START", origin));
                }
            },
        };
    }
    let missing = |place: TextPosition, key, remedy| {
        let what = "the message";
        Err(place.error(origin, RecordFault::Missing { what, key, remedy }))
    };
    match block {
        Block::Metadata(meta) => missing(meta.place(), "META_STOP", "; the file is truncated"),
        Block::Begun(meaning) => missing(meaning.place, "DATA_START", "; the file is truncated"),
        Block::Data(meaning, _) => missing(meaning.place, "DATA_STOP", "; the file is truncated"),
        Block::Header if segments.is_empty() => missing(start, "META_START", "; it has no segment"),
        Block::Header => Ok(segments),
    }
}

fn unexpected(
    text: &str,
    place: TextPosition,
    expected: &'static str,
    origin: &Path,
) -> RecordError {
    let text = excerpt(text);
    place.error(origin, RecordFault::Unexpected { text, expected })
}

fn meaning(meta: &Fields, version: u32, origin: &Path) -> Result<Meaning, RecordError> {
    let must = |key| meta.must(key, "", origin);
    let (a, b) = (must("REF_FRAME_A")?, must("REF_FRAME_B")?);
    let is_body = |entry: &Entry<'_>| entry.value.to_ascii_uppercase().starts_with("SC_BODY");
    let (frame, a_is_body) = match (is_body(a), is_body(b)) {
        (false, true) => (a, false),
        (true, false) => (b, true),
        _ => {
            let remedy = "one of REF_FRAME_A and REF_FRAME_B must be a spacecraft body frame, SC_BODY_1 …, and the other one none";
            return Err(b.unsupported(origin, remedy));
        }
    };
    let known = Frame::from_ccsds_name(&frame.value).ok_or_else(|| {
        frame.unsupported(
            origin,
            "known frames are ICRF, GCRF, EME2000, TEME, ITRF… and GTOD",
        )
    })?;
    // Version 2 has neither key: rotations are from A to B, and the scalar comes last.
    let either = |key, first: &str, second: &str, expected| match meta.get(key) {
        Some(entry) if entry.value.eq_ignore_ascii_case(first) => Ok(true),
        Some(entry) if entry.value.eq_ignore_ascii_case(second) => Ok(false),
        Some(entry) => Err(entry.wrong(origin, expected)),
        None if version == 1 => Err(meta.must(key, "", origin).err().unwrap_or_else(|| {
            let fault = RecordFault::Missing {
                what: "the metadata",
                key,
                remedy: "",
            };
            meta.place().error(origin, fault)
        })),
        None => Ok(true),
    };
    let is_from_a = either("ATTITUDE_DIR", "A2B", "B2A", "A2B or B2A")?;
    let is_scalar_last = either("QUATERNION_TYPE", "LAST", "FIRST", "FIRST or LAST")?;
    let kind = must("ATTITUDE_TYPE")?;
    let columns = match kind.value.to_ascii_uppercase().as_str() {
        "QUATERNION" => 4,
        "QUATERNION/DERIVATIVE" => 8,
        "QUATERNION/RATE" | "QUATERNION/ANGVEL" => 7,
        _ => {
            let remedy = "attitudes are read as QUATERNION, QUATERNION/DERIVATIVE, QUATERNION/RATE and QUATERNION/ANGVEL; write one of these";
            return Err(kind.unsupported(origin, remedy));
        }
    };
    let system = TimeSystem::of(must("TIME_SYSTEM")?, origin)?;
    let epoch = |key| match meta.get(key) {
        Some(entry) => system.epoch(entry, origin).map(Some),
        None => Ok(None),
    };
    Ok(Meaning {
        frame: known,
        is_to_body: is_from_a != a_is_body,
        system,
        is_scalar_first: !is_scalar_last,
        columns,
        useable: (epoch("USEABLE_START_TIME")?, epoch("USEABLE_STOP_TIME")?),
        place: meta.place(),
    })
}

/// An epoch and a quaternion, and perhaps rates, which are not used.
fn row(
    text: &str,
    place: TextPosition,
    meaning: &Meaning,
    samples: &mut Vec<(Epoch, DQuat)>,
    origin: &Path,
) -> Result<(), RecordError> {
    let words: Vec<_> = text.split_whitespace().take(10).collect();
    let split = words.split_first();
    let Some((date, values)) = split.filter(|(_, values)| values.len() == meaning.columns) else {
        let expected = match meaning.columns {
            4 => "an epoch and four numbers",
            7 => "an epoch, four numbers of the quaternion and three rates",
            _ => "an epoch, four numbers of the quaternion and four derivatives",
        };
        return Err(unexpected(text, place, expected, origin));
    };
    let mut numbers = [0.0; 4];
    for (slot, word) in numbers.iter_mut().zip(values) {
        *slot = scaled_number(word, 0).ok_or_else(|| {
            let fault = RecordFault::Field {
                key: "the quaternion".to_owned(),
                text: excerpt(word),
                expected: "numbers",
            };
            let column = place.column + offset(text, word);
            let line = place.line;
            TextPosition { line, column }.error(origin, fault)
        })?;
    }
    if meaning.is_scalar_first {
        numbers.rotate_left(1);
    }
    // The standard rotates frames: the coordinates in Y of a vector given in X are M v with the attitude matrix M of the quaternion.
    // glam rotates vectors, and its matrix of the same quaternion is Mᵀ: it takes coordinates in Y to those in X.
    if !meaning.is_to_body {
        let [x, y, z, w] = numbers;
        numbers = [-x, -y, -z, w];
    }
    let date = Entry {
        key: Cow::Borrowed("the epoch"),
        value: Cow::Borrowed(date),
        unit: None,
        place,
    };
    let epoch = meaning.system.epoch(&date, origin)?;
    push(samples, epoch, DVec4::from_array(numbers), place, origin)
}
