//! AEM in XML.

use super::super::super::entry::{
    Fields, Keys, RecordError, RecordFault, TextPosition, scaled_number,
};
use super::super::super::text::xml::{XmlItem, walk};
use super::super::Segment;
use super::{
    Form, IN_ORDER, META_KEYS, Meaning, is_in_order, meaning, one_object, sample, unexpected,
};
use glam::DQuat;
use std::path::Path;
use terrella_frames::Epoch;

const STATE_KEYS: &Keys = &[
    ("EPOCH", ""),
    ("Q1", ""),
    ("Q2", ""),
    ("Q3", ""),
    ("QC", ""),
    ("ANGLE_1", "deg"),
    ("ANGLE_2", "deg"),
    ("ANGLE_3", "deg"),
];

/// Numbers are named in XML: keys required only by version 1 are not needed.
const VERSION: u32 = 2;

pub fn segments(text: &str, origin: &Path) -> Result<Vec<Segment>, RecordError> {
    let mut message = Message {
        origin,
        segments: Vec::new(),
        object: None,
        block: Block::None,
        data: None,
    };
    walk::<RecordError>(text, origin, &mut |item| message.item(item))?;
    if message.segments.is_empty() {
        let fault = RecordFault::Missing {
            what: "the message",
            key: "segment",
            remedy: "; it has no attitudes",
        };
        return Err(TextPosition { line: 1, column: 1 }.error(origin, fault));
    }
    Ok(message.segments)
}

/// The enclosing element of values.
enum Block {
    None,
    Metadata(Fields),
    State(Fields),
}

struct Message<'o> {
    origin: &'o Path,
    segments: Vec<Segment>,
    object: Option<String>,
    block: Block,
    /// The segment that has begun.
    data: Option<(Meaning, Vec<(Epoch, DQuat)>)>,
}

impl Message<'_> {
    fn item(&mut self, item: XmlItem<'_>) -> Result<(), RecordError> {
        let origin = self.origin;
        match item {
            XmlItem::Open(name, line) => {
                let place = TextPosition { line, column: 1 };
                match name {
                    "metadata" => {
                        let fields = Fields::new("the metadata", place, META_KEYS);
                        self.block = Block::Metadata(fields);
                    }
                    // Within it are elements of the kind of attitude, whose names differ between the versions.
                    "attitudeState" => {
                        let fields = Fields::new("the attitude", place, STATE_KEYS);
                        self.block = Block::State(fields);
                    }
                    _ => {}
                }
                Ok(())
            }
            XmlItem::Value(entry) => match &mut self.block {
                Block::Metadata(fields) | Block::State(fields) => fields.add(entry, origin),
                Block::None => Ok(()),
            },
            XmlItem::Close("metadata") => {
                if let Block::Metadata(fields) = std::mem::replace(&mut self.block, Block::None) {
                    one_object(&fields, &mut self.object, origin)?;
                    let meaning = meaning(&fields, VERSION, origin)?;
                    self.data = Some((meaning, Vec::new()));
                }
                Ok(())
            }
            XmlItem::Close("attitudeState") => {
                if let Block::State(fields) = std::mem::replace(&mut self.block, Block::None) {
                    self.state(&fields)?;
                }
                Ok(())
            }
            XmlItem::Close("segment") => {
                let Some((meaning, samples)) = self.data.take() else {
                    return Ok(());
                };
                let Meaning {
                    frame,
                    useable,
                    place,
                    ..
                } = meaning;
                let segment = Segment::new(frame, samples, useable, place, origin)?;
                if !is_in_order(&self.segments, &segment) {
                    return Err(unexpected("segment", place, IN_ORDER, origin));
                }
                self.segments.push(segment);
                Ok(())
            }
            XmlItem::Close(_) => Ok(()),
        }
    }

    fn state(&mut self, fields: &Fields) -> Result<(), RecordError> {
        let (origin, place) = (self.origin, fields.place());
        let Some((meaning, samples)) = &mut self.data else {
            return Err(unexpected(
                "attitudeState",
                place,
                "metadata before it",
                origin,
            ));
        };
        let epoch = meaning
            .system
            .epoch(fields.must("EPOCH", "", origin)?, origin)?;
        let number = |key| {
            let entry = fields.must(key, "", origin)?;
            scaled_number(&entry.value, 0).ok_or_else(|| entry.wrong(origin, "a number"))
        };
        let numbers = match &mut meaning.form {
            // By name, whatever order the metadata give.
            Form::Quaternion { is_scalar_first } => {
                *is_scalar_first = false;
                [number("Q1")?, number("Q2")?, number("Q3")?, number("QC")?]
            }
            Form::Euler(_) => [
                number("ANGLE_1")?,
                number("ANGLE_2")?,
                number("ANGLE_3")?,
                0.0,
            ],
        };
        sample(epoch, numbers, meaning, place, samples, origin)
    }
}
