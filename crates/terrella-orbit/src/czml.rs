//! CZML: the positions of its objects (github.com/AnalyticalGraphicsInc/czml-writer, CZML Structure and CZML Guide).
//!
//! Packets with the same identifier describe one object; later ones add to earlier ones or replace them, as in Cesium.

mod position;
mod sampled;
mod settings;
mod spans;

use super::Frame;
use super::entry::{RecordError, RecordFault, printable};
use super::found::{Each, Found};
use super::interpolated::{EphemerisFeed, InterpolatedStates};
use super::iso8601::{earliest, latest};
use super::text::json::{Document, Object};
use position::{Given, Value, each_given, intervals};
use sampled::{Sampled, at_rest};
use serde_json::value::RawValue;
use settings::Settings;
use spans::{Known, MAX_INTERVALS, Span, Taken, in_order, joined, segments, within};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use terrella_files::excerpt;

/// Most packets of a document.
const MAX_PACKETS: usize = 1_000_000;

/// Calls `each` for every object that moves.
pub(super) fn each_object(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), RecordError> {
    let document = Document::new(text, origin);
    let mut objects = Objects::default();
    let read = document.each_object::<RecordError>(MAX_PACKETS, "packets", &mut |value| {
        objects.packet(&document, value, each)
    });
    // An error that ends the text is one more fault if other objects are valid.
    read.or_else(|error| each(Found::corrupt(error)))?;
    objects.finish(&document, each)
}

/// The objects read so far, in the order of their first packets.
#[derive(Default)]
struct Objects<'t> {
    all: Vec<Thing<'t>>,
    by_id: HashMap<String, usize>,
}

/// An object.
struct Thing<'t> {
    id: Option<String>,
    name: Option<String>,
    /// Its first packet.
    packet: &'t RawValue,
    availability: Option<Vec<Span>>,
    /// Later ones over earlier ones.
    pieces: Vec<Piece<'t>>,
    /// Its last position property.
    position: Option<&'t RawValue>,
    /// Frame and settings that packets without a value have given for the values to come.
    to_come: (Option<Frame>, Settings),
    /// A fault has been reported: it is not flown.
    is_faulty: bool,
}

/// A value that applies in an interval, or at all times.
struct Piece<'t> {
    interval: Option<Span>,
    place: &'t RawValue,
    motion: Motion<'t>,
}

enum Motion<'t> {
    /// Nothing is known of it.
    None,
    Still(Frame, glam::DVec3),
    Sampled(Sampled<'t>),
    /// As another object, by identifier.
    As(String),
}

impl<'t> Objects<'t> {
    fn packet(
        &mut self,
        document: &Document<'t>,
        value: &'t RawValue,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let packet = match document.object(value, "a packet, which is an object") {
            Ok(packet) => packet,
            Err(error) => return each(Found::corrupt(error)),
        };
        let text = |key| {
            let entry = document.entry(key, packet.get(key)?)?;
            Some(entry.value.into_owned())
        };
        let id = text("id").filter(|id| !id.is_empty());
        let known = id.as_ref().and_then(|id| self.by_id.get(id)).copied();
        if packet.get("delete").is_some_and(|v| v.get() == "true") {
            // An object of that identifier that follows is another one.
            if let (Some(id), Some(thing)) = (&id, known.and_then(|at| self.all.get_mut(at))) {
                self.by_id.remove(id);
                thing.pieces.clear();
                thing.id = None;
            }
            return Ok(());
        }
        let at = known.unwrap_or(self.all.len());
        if known.is_none() {
            if let Some(id) = &id {
                self.by_id.insert(id.clone(), at);
            }
            self.all.push(Thing::new(id, value));
        }
        let Some(thing) = self.all.get_mut(at) else {
            return Ok(());
        };
        if let Some(name) = text("name").filter(|name| !name.is_empty()) {
            thing.name = Some(printable(&name));
        }
        match thing.add(document, &packet, each) {
            Err(error) if !thing.is_faulty => {
                thing.is_faulty = true;
                each(Found::Corrupt(thing.names(), error))
            }
            _ => Ok(()),
        }
    }

    /// Hands the objects on.
    fn finish(self, document: &Document<'t>, each: &mut Each<'_>) -> Result<(), RecordError> {
        let mut timelines = Timelines {
            document,
            objects: &self,
            known: Vec::new(),
        };
        timelines.known.resize_with(self.all.len(), || Work::Open);
        for (at, thing) in self.all.iter().enumerate() {
            if thing.is_faulty || !thing.moves() {
                continue;
            }
            let object = match timelines.known(at, each) {
                Ok(known) => thing.feed(document, known),
                Err(error) => Err(error),
            };
            match object {
                Ok(Some(feed)) => each(match thing.has_samples() {
                    true => Found::Object(feed),
                    false => Found::Follower(feed),
                })?,
                Ok(None) => {}
                Err(error) => each(Found::Corrupt(thing.names(), error))?,
            }
        }
        Ok(())
    }
}

impl<'t> Thing<'t> {
    fn new(id: Option<String>, packet: &'t RawValue) -> Self {
        Self {
            id,
            name: None,
            packet,
            availability: None,
            pieces: Vec::new(),
            position: None,
            to_come: Default::default(),
            is_faulty: false,
        }
    }

    /// Its identifier and name, as far as it has them.
    fn names(&self) -> Vec<String> {
        let id = self.id.as_deref().map(printable);
        id.into_iter().chain(self.name.clone()).collect()
    }

    /// Whether it moves.
    fn moves(&self) -> bool {
        let mut motions = self.pieces.iter().map(|piece| &piece.motion);
        motions.any(|motion| matches!(motion, Motion::Sampled(_) | Motion::As(_)))
    }

    /// Whether it has its own samples.
    fn has_samples(&self) -> bool {
        let mut motions = self.pieces.iter().map(|piece| &piece.motion);
        motions.any(|motion| matches!(motion, Motion::Sampled(_)))
    }

    /// Applies a packet.
    fn add(
        &mut self,
        document: &Document<'t>,
        packet: &Object<'t>,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        if let Some(value) = packet.get("availability") {
            self.availability = Some(joined(intervals(document, value)?));
        }
        let Some(position) = packet.get("position") else {
            return Ok(());
        };
        self.position = Some(position);
        each_given(document, position, each, &mut |given, each| {
            self.add_position(document, given, each)
        })
    }

    fn add_position(
        &mut self,
        document: &Document<'t>,
        given: Given<'t>,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let Some(value) = given.value else {
            return self.reinterpret(document, &given, each);
        };
        let same = match given.interval {
            None => self.pieces.last_mut().filter(|p| p.interval.is_none()),
            some => self.pieces.iter_mut().rfind(|p| p.interval == some),
        };
        let motion = match value {
            Value::Deleted => Motion::None,
            Value::Constant(position_m) => {
                let frame = given.frame.or(self.to_come.0);
                Motion::Still(frame.unwrap_or(Frame::Itrf), position_m)
            }
            Value::Reference(id) => Motion::As(id),
            Value::Samples {
                samples,
                with_velocity,
                numbers,
            } => {
                let (frame_to_come, mut settings) = self.to_come;
                settings.update(&given.settings);
                let mut frame = given.frame.or(frame_to_come).unwrap_or(Frame::Itrf);
                if let Some(Piece {
                    motion: Motion::Sampled(earlier),
                    ..
                }) = same
                {
                    earlier.settings.update(&given.settings);
                    frame = given.frame.unwrap_or(earlier.frame);
                    if frame == earlier.frame && with_velocity == earlier.with_velocity {
                        return earlier.add(document, samples, numbers);
                    }
                    settings = earlier.settings;
                    let fault = RecordFault::NotFollowed {
                        key: "position",
                        text: "an earlier packet's samples".to_owned(),
                        why: "those of this packet are in another frame, or with velocities where they were without, and take their place",
                    };
                    each(Found::BadState(document.error(numbers, fault)))?;
                }
                Motion::Sampled(Sampled::new(
                    frame,
                    with_velocity,
                    settings,
                    samples,
                    numbers,
                ))
            }
        };
        let piece = Piece {
            interval: given.interval,
            place: given.place,
            motion,
        };
        if given.interval.is_none() {
            // A value for all times replaces everything before.
            self.pieces.clear();
        }
        if self.pieces.len() >= MAX_INTERVALS {
            let (what, limit) = ("intervals", MAX_INTERVALS);
            return Err(document.error(given.place, RecordFault::TooMany { what, limit }));
        }
        self.pieces.push(piece);
        Ok(())
    }

    /// Applies a property without a value: it changes the interpretation of the existing values, and of those to come.
    fn reinterpret(
        &mut self,
        document: &Document<'t>,
        given: &Given<'t>,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let meant =
            |piece: &&mut Piece<'t>| given.interval.is_none() || piece.interval == given.interval;
        let mut is_used = given.interval.is_none();
        for piece in self.pieces.iter_mut().filter(meant) {
            is_used = true;
            match &mut piece.motion {
                Motion::Sampled(sampled) => {
                    sampled.settings.update(&given.settings);
                    sampled.frame = given.frame.unwrap_or(sampled.frame);
                }
                Motion::Still(frame, _) => *frame = given.frame.unwrap_or(*frame),
                Motion::None | Motion::As(_) => {}
            }
        }
        if given.interval.is_none() {
            self.to_come.0 = given.frame.or(self.to_come.0);
            self.to_come.1.update(&given.settings);
        }
        if is_used {
            return Ok(());
        }
        let fault = RecordFault::NotFollowed {
            key: "position",
            text: "an interval without a value".to_owned(),
            why: "no packet before it gives a value for this interval",
        };
        each(Found::BadState(document.error(given.place, fault)))
    }

    /// The feed of its known positions; `None` if it is fixed.
    fn feed(
        &self,
        document: &Document<'t>,
        known: &[Known],
    ) -> Result<Option<EphemerisFeed>, RecordError> {
        let place = self.position.unwrap_or(self.packet);
        let within_availability = match &self.availability {
            None => known.to_vec(),
            Some(availability) => {
                let mut cut = Vec::new();
                for known in known {
                    cut.extend(within(known.span, availability).map(|span| Known {
                        span,
                        samples: known.samples.clone(),
                    }));
                    check_count(document, place, cut.len())?;
                }
                cut
            }
        };
        if within_availability.is_empty() {
            if !self.has_samples() {
                // It follows a fixed object.
                return Ok(None);
            }
            let fault = RecordFault::Unexpected {
                text: "an interval without samples".to_owned(),
                expected: "samples within the interval or the availability",
            };
            return Err(document.error(place, fault));
        }
        let id = self.id.as_deref().map(printable);
        let name = self.name.clone().or_else(|| id.clone());
        let segments = segments(in_order(within_availability));
        match EphemerisFeed::new(name.unwrap_or_default(), None, segments) {
            Ok(feed) => {
                let feed = feed.at_line(document.place(self.packet).line);
                Ok(Some(match id {
                    Some(id) => feed.with_id(id),
                    None => feed,
                }))
            }
            Err(error) => Err(document.error(place, RecordFault::Segments(error))),
        }
    }
}

fn check_count(document: &Document<'_>, place: &RawValue, count: usize) -> Result<(), RecordError> {
    let (what, limit) = ("intervals", MAX_INTERVALS);
    match count > limit {
        true => Err(document.error(place, RecordFault::TooMany { what, limit })),
        false => Ok(()),
    }
}

/// When objects are known, availability aside.
struct Timelines<'o, 't> {
    document: &'o Document<'t>,
    objects: &'o Objects<'t>,
    known: Vec<Work>,
}

/// How far the work on an object is.
enum Work {
    Open,
    Begun,
    Failed,
    Done(Vec<Known>),
}

impl<'t> Timelines<'_, 't> {
    /// When an object is known, in order of time.
    fn known(&mut self, at: usize, each: &mut Each<'_>) -> Result<&[Known], RecordError> {
        if matches!(self.known.get(at), Some(Work::Open))
            && let Some(thing) = self.objects.all.get(at)
        {
            if let Some(work) = self.known.get_mut(at) {
                *work = Work::Begun;
            }
            let known = self.work(thing, each);
            if let Some(work) = self.known.get_mut(at) {
                *work = match known {
                    Ok(known) => Work::Done(known),
                    Err(error) => {
                        *work = Work::Failed;
                        return Err(error);
                    }
                };
            }
        }
        match self.known.get(at) {
            Some(Work::Done(known)) => Ok(known),
            _ => Ok(&[]),
        }
    }

    fn work(&mut self, thing: &Thing<'t>, each: &mut Each<'_>) -> Result<Vec<Known>, RecordError> {
        let mut taken = Taken::default();
        let mut all = Vec::new();
        for piece in thing.pieces.iter().rev() {
            let interval = piece.interval.unwrap_or((earliest(), latest()));
            let left = taken.take(interval);
            let sources = match &piece.motion {
                Motion::None => Vec::new(),
                Motion::Still(frame, position_m) => {
                    self.still(thing, piece, *frame, *position_m)?
                }
                Motion::Sampled(sampled) => {
                    let ends = ends(piece.interval, thing.availability.as_deref());
                    let pieces = sampled.pieces(self.document, ends, each)?;
                    let whole = |samples: Arc<InterpolatedStates>| {
                        let span = samples.reach();
                        Known { samples, span }
                    };
                    pieces.into_iter().map(whole).collect()
                }
                Motion::As(id) => self.followed(piece, id, each)?,
            };
            for source in sources {
                all.extend(within(source.span, &left).map(|span| Known {
                    span,
                    samples: source.samples.clone(),
                }));
                check_count(self.document, piece.place, all.len())?;
            }
        }
        Ok(in_order(all))
    }

    /// A fixed point for the duration of its interval or of the availability.
    fn still(
        &self,
        thing: &Thing<'t>,
        piece: &Piece<'t>,
        frame: Frame,
        position_m: glam::DVec3,
    ) -> Result<Vec<Known>, RecordError> {
        let (Some(from), Some(to)) = ends(piece.interval, thing.availability.as_deref()) else {
            return Ok(Vec::new());
        };
        let samples = at_rest(frame, position_m, (from, to)).map_err(|error| {
            self.document
                .error(piece.place, RecordFault::Samples(error))
        })?;
        let span = (from, to);
        Ok(vec![Known { samples, span }])
    }

    /// Known positions of the object that a piece refers to.
    fn followed(
        &mut self,
        piece: &Piece<'t>,
        id: &str,
        each: &mut Each<'_>,
    ) -> Result<Vec<Known>, RecordError> {
        let reject = |remedy| {
            let fault = RecordFault::Unsupported {
                key: "reference".to_owned(),
                text: excerpt(id),
                remedy,
            };
            Err(self.document.error(piece.place, fault))
        };
        let Some(at) = self.objects.by_id.get(id).copied() else {
            return reject("no object has this id");
        };
        let is_faulty = self
            .objects
            .all
            .get(at)
            .is_some_and(|other| other.is_faulty);
        if is_faulty || matches!(self.known.get(at), Some(Work::Failed)) {
            return reject("the object of this id cannot be read");
        }
        if matches!(self.known.get(at), Some(Work::Begun)) {
            return reject("objects refer to one another in a circle; give one of them samples");
        }
        Ok(self.known(at, each)?.to_vec())
    }
}

/// The ends of an interval and of an availability, where they are not open.
fn ends(interval: Option<Span>, availability: Option<&[Span]>) -> sampled::Ends {
    let interval = interval.unwrap_or((earliest(), latest()));
    let first = availability.and_then(|a| a.first());
    let last = availability.and_then(|a| a.last());
    let from = first.map_or(interval.0, |span| span.0.max(interval.0));
    let to = last.map_or(interval.1, |span| span.1.min(interval.1));
    (
        Some(from).filter(|from| *from > earliest()),
        Some(to).filter(|to| *to < latest()),
    )
}
