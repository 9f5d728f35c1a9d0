//! Attitude ephemeris messages: the quaternions and Euler angles of 504.0-B-1 (2008) and 504.0-B-2 (2024).

mod xml;

use super::super::Frame;
use super::super::entry::{
    Entry, Fields, Keys, RecordError, RecordFault, TextPosition, scaled_number,
};
use super::super::oem::TimeSystem;
use super::super::text::kvn::{KvnLine, lines};
use super::super::text::offset;
use super::{Segment, push};
use glam::{DQuat, DVec3, DVec4};
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
    ("EULER_ROT_SEQ", ""),
];

/// Versions that are read.
const VERSIONS: &str = "versions 1 and 2 are read";

/// Whether a text is an AEM, in KVN or in XML.
pub fn is_aem(text: &str) -> bool {
    let begin = text.trim_start();
    begin.starts_with('<')
        || match lines(begin).next() {
            Some(KvnLine::Entry(entry)) => entry.key == VERSION,
            _ => false,
        }
}

/// Meaning of a segment's rows, from its metadata.
struct Meaning {
    frame: Frame,
    /// Whether the quaternion is the rotation from the frame to the body; otherwise from the body to the frame.
    is_to_body: bool,
    system: TimeSystem,
    form: Form,
    /// Numbers of a row behind its epoch.
    columns: usize,
    useable: (Option<Epoch>, Option<Epoch>),
    place: TextPosition,
}

/// The first numbers of a row.
#[derive(Clone, Copy)]
enum Form {
    Quaternion {
        is_scalar_first: bool,
    },
    /// Angles in degrees about these axes, each of the frame that the rotations before it have made.
    Euler([DVec3; 3]),
}

impl Form {
    /// How many numbers it takes.
    fn numbers(self) -> usize {
        match self {
            Self::Quaternion { .. } => 4,
            Self::Euler(_) => 3,
        }
    }

    /// As a quaternion of the standard: vector, then scalar.
    fn quaternion(self, mut numbers: [f64; 4]) -> [f64; 4] {
        match self {
            Self::Quaternion { is_scalar_first } => {
                if is_scalar_first {
                    numbers.rotate_left(1);
                }
                numbers
            }
            Self::Euler(axes) => {
                let [first, second, third, _] = numbers;
                let turns = axes.into_iter().zip([first, second, third]);
                let turns = turns.map(|(axis, deg)| {
                    // Whole turns first: degrees keep their digits.
                    DQuat::from_axis_angle(axis, (deg % 360.0).to_radians())
                });
                turns
                    .fold(DQuat::IDENTITY, |all, turn| all * turn)
                    .to_array()
            }
        }
    }
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
        return xml::segments(text, origin);
    }
    let mut segments: Vec<Segment> = Vec::new();
    let mut object: Option<String> = None;
    let mut version = 0;
    let mut block = Block::Header;
    for line in lines(text) {
        block = match (line, block) {
            (KvnLine::Entry(entry), Block::Header) => {
                if entry.key == VERSION {
                    version = version_of(&entry.value)
                        .ok_or_else(|| entry.unsupported(origin, VERSIONS))?;
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
                    one_object(&meta, &mut object, origin)?;
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
                    if !is_in_order(&segments, &segment) {
                        return Err(unexpected(text, place, IN_ORDER, origin));
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

/// Requirement for segments.
const IN_ORDER: &str = "segments in order of time";

fn is_in_order(segments: &[Segment], next: &Segment) -> bool {
    segments.last().is_none_or(|last| last.first <= next.first)
}

fn version_of(text: &str) -> Option<u32> {
    match text.split('.').next() {
        Some("1") => Some(1),
        Some("2") => Some(2),
        _ => None,
    }
}

/// Rejects a segment of another object than the first.
fn one_object(
    meta: &Fields,
    object: &mut Option<String>,
    origin: &Path,
) -> Result<(), RecordError> {
    let name = meta.must("OBJECT_NAME", "", origin)?;
    match object {
        Some(first) if *first != *name.value => {
            let remedy = "the file begins with another object; give each object a file of its own";
            Err(name.unsupported(origin, remedy))
        }
        _ => {
            *object = Some(name.value.clone().into_owned());
            Ok(())
        }
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
    let either = |key, is_needed: bool, first: &str, second: &str, expected| match meta.get(key) {
        Some(entry) if entry.value.eq_ignore_ascii_case(first) => Ok(true),
        Some(entry) if entry.value.eq_ignore_ascii_case(second) => Ok(false),
        Some(entry) => Err(entry.wrong(origin, expected)),
        None if version == 1 && is_needed => {
            Err(meta.must(key, "", origin).err().unwrap_or_else(|| {
                let fault = RecordFault::Missing {
                    what: "the metadata",
                    key,
                    remedy: "",
                };
                meta.place().error(origin, fault)
            }))
        }
        None => Ok(true),
    };
    let is_from_a = either("ATTITUDE_DIR", true, "A2B", "B2A", "A2B or B2A")?;
    let kind = must("ATTITUDE_TYPE")?;
    let kind_name = kind.value.to_ascii_uppercase().replace(' ', "_");
    let is_euler = kind_name.starts_with("EULER_ANGLE");
    let is_scalar_last = either(
        "QUATERNION_TYPE",
        !is_euler,
        "LAST",
        "FIRST",
        "FIRST or LAST",
    )?;
    let form = match is_euler {
        false => Form::Quaternion {
            is_scalar_first: !is_scalar_last,
        },
        true => {
            let sequence = must("EULER_ROT_SEQ")?;
            let axes = euler_axes(&sequence.value);
            let expected = "three axes of which no two neighbours are the same: ZYX, or 321";
            Form::Euler(axes.ok_or_else(|| sequence.wrong(origin, expected))?)
        }
    };
    let columns = match kind_name.as_str() {
        "QUATERNION" => 4,
        "QUATERNION/DERIVATIVE" => 8,
        "QUATERNION/RATE" | "QUATERNION/ANGVEL" => 7,
        "EULER_ANGLE" => 3,
        "EULER_ANGLE/RATE" | "EULER_ANGLE/DERIVATIVE" | "EULER_ANGLE/ANGVEL" => 6,
        _ => {
            let remedy = "attitudes are read as QUATERNION and EULER_ANGLE, each alone or with /RATE, /DERIVATIVE or /ANGVEL; write one of these";
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
        form,
        columns,
        useable: (epoch("USEABLE_START_TIME")?, epoch("USEABLE_STOP_TIME")?),
        place: meta.place(),
    })
}

/// The axes of a sequence of rotations, by letters or numbers.
fn euler_axes(sequence: &str) -> Option<[DVec3; 3]> {
    let axes = sequence.trim().chars().map(|axis| match axis {
        'X' | 'x' | '1' => Some(DVec3::X),
        'Y' | 'y' | '2' => Some(DVec3::Y),
        'Z' | 'z' | '3' => Some(DVec3::Z),
        _ => None,
    });
    let axes: Option<Vec<_>> = axes.collect();
    let axes = <[DVec3; 3]>::try_from(axes?).ok()?;
    (axes[0] != axes[1] && axes[1] != axes[2]).then_some(axes)
}

/// An epoch and an attitude, and perhaps rates, which are not used.
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
        let expected = match (meaning.form, meaning.columns) {
            (Form::Euler(_), 3) => "an epoch and three angles",
            (Form::Euler(_), _) => "an epoch, three angles and three rates",
            (_, 4) => "an epoch and four numbers",
            (_, 7) => "an epoch, four numbers of the quaternion and three rates",
            _ => "an epoch, four numbers of the quaternion and four derivatives",
        };
        return Err(unexpected(text, place, expected, origin));
    };
    let mut numbers = [0.0; 4];
    for (slot, word) in numbers.iter_mut().zip(&values[..meaning.form.numbers()]) {
        *slot = scaled_number(word, 0).ok_or_else(|| {
            let fault = RecordFault::Field {
                key: "the attitude".to_owned(),
                text: excerpt(word),
                expected: "numbers",
            };
            let column = place.column + offset(text, word);
            let line = place.line;
            TextPosition { line, column }.error(origin, fault)
        })?;
    }
    let date = Entry {
        key: Cow::Borrowed("the epoch"),
        value: Cow::Borrowed(date),
        unit: None,
        place,
    };
    let epoch = meaning.system.epoch(&date, origin)?;
    sample(epoch, numbers, meaning, place, samples, origin)
}

/// Adds an attitude by the numbers of its form.
fn sample(
    epoch: Epoch,
    numbers: [f64; 4],
    meaning: &Meaning,
    place: TextPosition,
    samples: &mut Vec<(Epoch, DQuat)>,
    origin: &Path,
) -> Result<(), RecordError> {
    let mut quaternion = meaning.form.quaternion(numbers);
    // The standard rotates frames: the coordinates in Y of a vector given in X are M v with the attitude matrix M of the quaternion.
    // glam rotates vectors, and its matrix of the same quaternion is Mᵀ: it takes coordinates in Y to those in X.
    if !meaning.is_to_body {
        let [x, y, z, w] = quaternion;
        quaternion = [-x, -y, -z, w];
    }
    push(samples, epoch, DVec4::from_array(quaternion), place, origin)
}
