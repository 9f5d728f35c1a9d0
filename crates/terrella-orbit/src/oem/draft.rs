//! A message while it is read: what KVN and XML have in common.

use super::super::cut::CutOff;
use super::super::entry::{Entry, Fields, RecordError, RecordFault, TextPosition, printable};
use super::super::found::{Each, Found};
use super::super::interpolated::{
    EphemerisFeed, EphemerisSegment, InterpolatedStates, Interpolation, InterpolationError,
    StateSample, doubts, sift,
};
use super::metadata::{Axes, META_KEYS, TimeSystem, axes_and_time, interpolation};
use glam::DVec3;
use std::path::Path;
use terrella_frames::{Epoch, rfc3339};

/// Most states of a message.
const MAX_STATES: usize = 2_000_000;
/// Instants that are written to a millisecond may differ by as much, seconds.
const STOP_TOLERANCE_S: f64 = 0.002;
/// Most segments of a message.
const MAX_SEGMENTS: usize = 100_000;

/// An empty set of a segment's metadata.
pub fn metadata(place: TextPosition) -> Fields {
    Fields::new("the metadata", place, META_KEYS)
}

/// A message, segment after segment.
pub struct Draft<'o> {
    origin: &'o Path,
    /// Position of its first character.
    place: TextPosition,
    /// Name and identifier of the object.
    object: Option<(String, String)>,
    segments: Vec<EphemerisSegment>,
    segment_places: Vec<TextPosition>,
    states: usize,
    open: Option<OpenSegment>,
}

struct OpenSegment {
    place: TextPosition,
    axes: Axes,
    system: TimeSystem,
    usable: (Epoch, Epoch),
    stop: Epoch,
    interpolation: Option<Interpolation>,
    samples: Vec<StateSample>,
    /// Lines of the samples.
    lines: Vec<usize>,
    sigma_m: Vec<(Epoch, f64)>,
}

impl<'o> Draft<'o> {
    pub fn new(origin: &'o Path, place: TextPosition) -> Self {
        Self {
            origin,
            place,
            object: None,
            segments: Vec::new(),
            segment_places: Vec::new(),
            states: 0,
            open: None,
        }
    }

    /// Name and identifier of the object, as far as known.
    pub fn names(&self) -> Vec<String> {
        let names = self.object.iter().flat_map(|(name, id)| [name, id]);
        names.cloned().collect()
    }

    /// Position of the message's first character.
    pub fn place(&self) -> TextPosition {
        self.place
    }

    /// The time system of the open segment; an error where no metadata have been.
    pub fn system(&self, place: TextPosition) -> Result<TimeSystem, RecordError> {
        self.open.as_ref().map(|s| s.system).ok_or_else(|| {
            let fault = RecordFault::Missing {
                what: "a state",
                key: "metadata before it",
                remedy: "; begin the segment with META_START",
            };
            place.error(self.origin, fault)
        })
    }

    /// Begins a segment with its metadata.
    pub fn begin(&mut self, meta: &Fields, each: &mut Each<'_>) -> Result<(), RecordError> {
        self.finish_segment(each)?;
        let origin = self.origin;
        if self.segments.len() >= MAX_SEGMENTS {
            let (what, limit) = ("segments", MAX_SEGMENTS);
            return Err(meta
                .place()
                .error(origin, RecordFault::TooMany { what, limit }));
        }
        let must = |key| meta.must(key, "", origin);
        self.check_object(must("OBJECT_NAME")?, must("OBJECT_ID")?)?;
        let (axes, system) = axes_and_time(meta, origin)?;
        let (start, stop) = (
            system.epoch(must("START_TIME")?, origin)?,
            system.epoch(must("STOP_TIME")?, origin)?,
        );
        let date = |key, otherwise| match meta.get(key) {
            Some(entry) => system.epoch(entry, origin),
            None => Ok(otherwise),
        };
        self.open = Some(OpenSegment {
            place: meta.place(),
            axes,
            system,
            usable: (
                date("USEABLE_START_TIME", start)?,
                date("USEABLE_STOP_TIME", stop)?,
            ),
            stop,
            interpolation: interpolation(meta, origin)?,
            samples: Vec::new(),
            lines: Vec::new(),
            sigma_m: Vec::new(),
        });
        Ok(())
    }

    /// A message is of one object.
    fn check_object(&mut self, name: &Entry<'_>, id: &Entry<'_>) -> Result<(), RecordError> {
        match &self.object {
            Some((_, first)) if *first != id.value => Err(id.unsupported(
                self.origin,
                "a message tells of one object; write one for each",
            )),
            Some(_) => Ok(()),
            None => {
                self.object = Some((printable(&name.value), printable(&id.value)));
                Ok(())
            }
        }
    }

    /// Adds a state to the open segment.
    pub fn state(
        &mut self,
        place: TextPosition,
        epoch: Epoch,
        position_m: DVec3,
        velocity_m_s: DVec3,
    ) -> Result<(), RecordError> {
        self.system(place)?;
        self.states += 1;
        if self.states > MAX_STATES {
            let (what, limit) = ("states", MAX_STATES);
            return Err(place.error(self.origin, RecordFault::TooMany { what, limit }));
        }
        if let Some(open) = &mut self.open {
            let turn = open.axes.turn(epoch);
            let turned = |vector| turn.map_or(vector, |turn| turn * vector);
            open.samples.push(StateSample {
                epoch,
                position_m: turned(position_m),
                velocity_m_s: Some(turned(velocity_m_s)),
            });
            open.lines.push(place.line);
        }
        Ok(())
    }

    /// Adds the variances of a covariance matrix's position, km². Their sum is the same in all axes.
    pub fn covariance(
        &mut self,
        place: TextPosition,
        epoch: Epoch,
        variances_km2: [f64; 3],
    ) -> Result<(), RecordError> {
        self.system(place)?;
        let variance_km2: f64 = variances_km2.iter().sum();
        let wrong = |key: &str, text: String, expected| {
            let key = key.to_owned();
            place.error(
                self.origin,
                RecordFault::Field {
                    key,
                    text,
                    expected,
                },
            )
        };
        if !(variances_km2.iter().all(|v| *v >= 0.0) && variance_km2 < 1e20) {
            let text = format!("{variances_km2:?}");
            return Err(wrong(
                "the diagonal of the covariance",
                text,
                "squares of km, none below 0",
            ));
        }
        if let Some(open) = &mut self.open {
            if open
                .sigma_m
                .last()
                .is_some_and(|(before, _)| *before >= epoch)
            {
                let text = terrella_frames::rfc3339(epoch);
                return Err(wrong(
                    "the covariance's EPOCH",
                    text,
                    "a later one than the one before it",
                ));
            }
            open.sigma_m.push((epoch, variance_km2.sqrt() * 1e3));
        }
        Ok(())
    }

    fn finish_segment(&mut self, each: &mut Each<'_>) -> Result<(), RecordError> {
        let Some(open) = self.open.take() else {
            return Ok(());
        };
        let interpolation = open.interpolation.unwrap_or(Interpolation::WITH_VELOCITIES);
        let at_its_line = |error: InterpolationError| {
            let line = error.index().and_then(|i| open.lines.get(i));
            let place = line.map_or(open.place, |&line| TextPosition { line, column: 1 });
            place.error(self.origin, RecordFault::Samples(error))
        };
        let samples = sift(&open.samples, |error| {
            each(Found::BadState(at_its_line(error)))
        })?;
        let line_of = |sample: Option<&StateSample>| {
            let at = open.samples.iter().rposition(|one| Some(one) == sample);
            let line = at.and_then(|at| open.lines.get(at));
            line.map_or(open.place, |&line| TextPosition { line, column: 1 })
        };
        if let Some(last) = samples.last()
            && (open.stop - last.epoch).to_seconds() > STOP_TOLERANCE_S
        {
            let cut = CutOff::Stop {
                last: rfc3339(last.epoch),
                key: "STOP_TIME",
                stop: rfc3339(open.stop),
            };
            let place = line_of(Some(last));
            each(Found::BadState(
                place.error(self.origin, RecordFault::CutOff(cut)),
            ))?;
        }
        for doubt in doubts(open.axes.frame(), &samples) {
            let place = line_of(samples.get(doubt.index()));
            each(Found::BadState(
                place.error(self.origin, RecordFault::Doubt(doubt)),
            ))?;
        }
        let samples = InterpolatedStates::new(open.axes.frame(), &samples, interpolation)
            .map_err(|error| open.place.error(self.origin, RecordFault::Samples(error)))?;
        let mut segment = EphemerisSegment::whole(samples);
        segment.usable = open.usable;
        segment.sigma_m = open.sigma_m;
        self.segments.push(segment);
        self.segment_places.push(open.place);
        Ok(())
    }

    /// Ends the message: the object's feed.
    pub fn finish(mut self, each: &mut Each<'_>) -> Result<EphemerisFeed, RecordError> {
        self.finish_segment(each)?;
        let (name, id) = self.object.take().unwrap_or_default();
        // A file may have them in any order.
        let mut parts: Vec<_> = std::iter::zip(self.segments, self.segment_places).collect();
        parts.sort_by_key(|(segment, _)| segment.usable.0);
        let (segments, places): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
        let name = match name.is_empty() {
            true => id.clone(),
            false => name,
        };
        let id = (!id.is_empty() && !id.eq_ignore_ascii_case("UNKNOWN")).then_some(id);
        match EphemerisFeed::new(name, id, segments) {
            Ok(feed) => Ok(feed.at_line(self.place.line)),
            Err(error) => {
                let place = places.get(error.index());
                let place = place.copied().unwrap_or(self.place);
                Err(place.error(self.origin, RecordFault::Segments(error)))
            }
        }
    }
}
