//! CZML: the sampled positions of its packets (github.com/AnalyticalGraphicsInc/czml-writer, CZML guide).

use super::Frame;
use super::entry::{RecordError, RecordFault, number, printable};
use super::found::{Each, Found};
use super::interpolated::{
    EphemerisFeed, EphemerisSegment, InterpolatedStates, Interpolation, InterpolationError,
    StateSample, doubts, sift,
};
use super::text::json::{Document, Object};
use glam::DVec3;
use serde_json::value::RawValue;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use terrella_files::excerpt;
use terrella_frames::{Duration, Epoch, TimeScale, epoch_from_ccsds, utc_from_rfc3339};

/// Most packets of a document.
const MAX_PACKETS: usize = 1_000_000;
/// Most numbers of an object's samples.
const MAX_NUMBERS: usize = 8_000_000;
/// Most intervals of an object's availability or position.
const MAX_INTERVALS: usize = 10_000;

/// Calls `each` for every packet that has a sampled position.
pub(super) fn each_object(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), RecordError> {
    let document = Document::new(text, origin);
    // Identifiers and the lines they are in.
    let mut seen: HashMap<String, usize> = HashMap::new();
    let read =
        document.each_object::<RecordError>(MAX_PACKETS, "packets", &mut |value| match packet(
            &document, value, &mut seen, each,
        ) {
            Ok(Some(feed)) => each(Found::Object(feed)),
            Ok(None) => Ok(()),
            Err(error) => each(Found::Spoilt(error)),
        });
    // What ends a whole text is one more fault where others are good.
    read.or_else(|error| each(Found::Spoilt(error)))
}

/// A packet's object, if it moves.
fn packet<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
    seen: &mut HashMap<String, usize>,
    each: &mut Each<'_>,
) -> Result<Option<EphemerisFeed>, RecordError> {
    let packet = document.object(value, "a packet, which is an object")?;
    let Some(position) = packet.get("position") else {
        return Ok(None);
    };
    let text = |key| {
        let entry = document.entry(key, packet.get(key)?)?;
        Some(printable(&entry.value))
    };
    let id = text("id").unwrap_or_default();
    let place = document.place(value);
    let mut pieces = Vec::new();
    if position.get().starts_with('[') {
        let mut one = |value| {
            pieces.extend(from_position(document, value, each)?);
            Ok(())
        };
        document.each_member(position.get(), MAX_INTERVALS, "intervals", &mut one)?;
    } else {
        pieces.extend(from_position(document, position, each)?);
    }
    if pieces.is_empty() {
        return Ok(None);
    }
    if let Some(first) = seen.insert(id.clone(), place.line) {
        let key = format!("id {:?}", excerpt(&id));
        return Err(document.error(value, RecordFault::Repeated { key, first }));
    }
    let available = match packet.get("availability") {
        Some(value) => intervals(document, value)?,
        None => Vec::new(),
    };
    let segments = segments(pieces, &available).ok_or_else(|| {
        let (what, limit) = ("intervals", MAX_INTERVALS);
        document.error(position, RecordFault::TooMany { what, limit })
    })?;
    if segments.is_empty() {
        let fault = RecordFault::Unexpected {
            text: "an interval without samples".to_owned(),
            expected: "samples within the interval or the availability",
        };
        return Err(document.error(position, fault));
    }
    let name = text("name").filter(|n| !n.is_empty()).unwrap_or(id);
    match EphemerisFeed::new(name, None, segments) {
        Ok(feed) => Ok(Some(feed.at_line(place.line))),
        Err(error) => Err(document.error(position, RecordFault::Segments(error))),
    }
}

/// Samples and the interval in which they hold, if one is said.
type Piece = (InterpolatedStates, Option<(Epoch, Epoch)>);

/// Each piece within each interval of availability, in order of time; `None` if they are too many.
fn segments(pieces: Vec<Piece>, available: &[(Epoch, Epoch)]) -> Option<Vec<EphemerisSegment>> {
    let mut segments = Vec::new();
    for (samples, interval) in pieces {
        let (first, last) = samples.span();
        let (from, to) = interval.unwrap_or((first, last));
        let span = (from.max(first), to.min(last));
        let samples = Arc::new(samples);
        let always = [span];
        let within = match available {
            [] => always.as_slice(),
            several => several,
        };
        for &(from, to) in within {
            let usable = (span.0.max(from), span.1.min(to));
            if usable.0 <= usable.1 {
                if segments.len() >= MAX_INTERVALS {
                    return None;
                }
                segments.push(EphemerisSegment {
                    samples: Arc::clone(&samples),
                    usable,
                    sigma_m: Vec::new(),
                });
            }
        }
    }
    Some(segments)
}

/// The pieces of one position: none if it is a point that stands still or follows another. Samples that are left out go to `each`.
fn from_position<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
    each: &mut Each<'_>,
) -> Result<Vec<Piece>, RecordError> {
    let object = document.object(value, "an object or an array of them")?;
    for key in ["cartographicDegrees", "cartographicRadians"] {
        if let Some(value) = object.get(key).filter(|v| commas(v) > 2) {
            let remedy = "only cartesian samples are read; write cartesian";
            return Err(unsupported(document, key, value, remedy));
        }
    }
    let (numbers, with_velocity) = match (object.get("cartesianVelocity"), object.get("cartesian"))
    {
        (Some(numbers), _) => (numbers, true),
        (None, Some(numbers)) if commas(numbers) > 2 => (numbers, false),
        _ => return Ok(Vec::new()),
    };
    let epoch = match object.get("epoch") {
        Some(value) => Some(date(document, "epoch", value)?),
        None => None,
    };
    let frame = frame(document, &object)?;
    let interpolation = interpolation(document, &object, with_velocity)?;
    let interval = match object.get("interval") {
        Some(value) => Some(interval(document, value)?),
        None => None,
    };
    for key in ["forwardExtrapolationType", "backwardExtrapolationType"] {
        if let Some(value) = object.get(key).filter(|value| value.get() != "\"NONE\"") {
            let fault = RecordFault::NotFollowed {
                key,
                text: excerpt(value.get()),
                why: "the object is known from its first sample to its last one",
            };
            each(Found::BadState(document.error(value, fault)))?;
        }
    }
    let runs = samples(document, numbers, epoch, with_velocity, each)?;
    let mut pieces = Vec::new();
    for run in runs {
        let (run, places): (Vec<_>, Vec<_>) = run.into_iter().unzip();
        let at_its_place = |error: InterpolationError| {
            let place = error.index().and_then(|index| places.get(index));
            document.error(
                place.copied().unwrap_or(numbers),
                RecordFault::Samples(error),
            )
        };
        let kept = sift(&run, |error| each(Found::BadState(at_its_place(error))))?;
        for doubt in doubts(frame, &kept) {
            let sample = kept.get(doubt.index());
            let at = run.iter().position(|one| Some(one) == sample);
            let place = at.and_then(|at| places.get(at)).copied();
            let fault = RecordFault::Doubt(doubt);
            each(Found::BadState(
                document.error(place.unwrap_or(numbers), fault),
            ))?;
        }
        if !kept.is_empty() {
            let sampled = InterpolatedStates::new(frame, &kept, interpolation);
            pieces.push((sampled.map_err(at_its_place)?, interval));
        }
    }
    match pieces.is_empty() {
        true => {
            let fault = RecordFault::Samples(InterpolationError::Empty);
            Err(document.error(numbers, fault))
        }
        false => Ok(pieces),
    }
}

/// Commas in a value's text: more than two are more than one point.
fn commas(value: &RawValue) -> usize {
    value.get().bytes().filter(|&b| b == b',').count()
}

/// A sample, and the value of its time.
type Sampled<'t> = (StateSample, &'t RawValue);

/// `[t, x, y, z, …]` or `[t, x, y, z, vx, vy, vz, …]`, t in seconds since `epoch` or as a date. A group with something else among it
/// goes to `each`; where numbers are too few or too many, nothing says to which group the others belong.
///
/// A time that comes twice begins a new run: so writers say that the motion jumps there, from one element set to the next
/// or by a burn, and a polynomial through both sides would swing.
fn samples<'t>(
    document: &Document<'t>,
    array: &'t RawValue,
    epoch: Option<Epoch>,
    with_velocity: bool,
    each: &mut Each<'_>,
) -> Result<Vec<Vec<Sampled<'t>>>, RecordError> {
    let width = if with_velocity { 7 } else { 4 };
    let mut runs: Vec<Vec<Sampled<'t>>> = vec![Vec::new()];
    let mut row = [0.0; 6];
    let mut at: Option<(Epoch, &'t RawValue)> = None;
    // What is wrong with the group.
    let mut bad: Option<RecordError> = None;
    let mut count = 0;
    let mut one = |value: &'t RawValue| {
        let column = count % width;
        count += 1;
        let read = match column {
            0 => time(document, value, epoch).map(|epoch| at = Some((epoch, value))),
            _ => match (number(value.get()), row.get_mut(column - 1)) {
                (Some(number), Some(slot)) => {
                    *slot = number;
                    Ok(())
                }
                _ => Err(document.wrong("a coordinate", value, "a number of metres")),
            },
        };
        if let Err(error) = read {
            bad.get_or_insert(error);
        }
        if column + 1 != width {
            return Ok(());
        }
        if let Some(error) = bad.take() {
            return each(Found::BadState(error));
        }
        let Some((epoch, place)) = at.take() else {
            return Ok(());
        };
        let [x, y, z, vx, vy, vz] = row;
        let sample = StateSample {
            epoch,
            position_m: DVec3::new(x, y, z),
            velocity_m_s: with_velocity.then_some(DVec3::new(vx, vy, vz)),
        };
        let count = runs.len();
        match runs.last_mut() {
            Some(run) if run.last().is_none_or(|(before, _)| before.epoch != epoch) => {
                run.push((sample, place));
            }
            _ if count >= MAX_INTERVALS => {
                let (what, limit) = ("jumps", MAX_INTERVALS);
                return Err(document.error(value, RecordFault::TooMany { what, limit }));
            }
            _ => runs.push(vec![(sample, place)]),
        }
        Ok(())
    };
    document.each_member(array.get(), MAX_NUMBERS, "numbers", &mut one)?;
    match count % width {
        0 => Ok(runs),
        _ => {
            let expected = match with_velocity {
                true => "groups of seven: time, position and velocity",
                false => "groups of four: time and position",
            };
            let text = format!("{count} numbers");
            Err(document.error(array, RecordFault::Unexpected { text, expected }))
        }
    }
}

/// A sample's time: seconds since the epoch, or a date.
fn time<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
    epoch: Option<Epoch>,
) -> Result<Epoch, RecordError> {
    if value.get().starts_with('"') {
        return date(document, "a sample's time", value);
    }
    let expected = "seconds since the epoch, which the position must have, or a date";
    // Two centuries are more than an ephemeris can hold, and fit nanoseconds.
    match (number(value.get()).filter(|s| s.abs() < 6.4e9), epoch) {
        (Some(seconds), Some(epoch)) => {
            let ns = (seconds * 1e9).round() as i128;
            Ok(epoch + Duration::from_total_nanoseconds(ns))
        }
        _ => Err(document.wrong("a sample's time", value, expected)),
    }
}

fn date<'t>(document: &Document<'t>, key: &str, value: &'t RawValue) -> Result<Epoch, RecordError> {
    let entry = document.entry(key, value);
    let text = entry.map(|e| e.value.into_owned()).unwrap_or_default();
    read_date(text.trim()).map_err(|cause| {
        let key = key.to_owned();
        document.error(value, RecordFault::Time { key, cause })
    })
}

/// CZML's dates are ISO 8601 with a zone; some writers leave it out and mean UTC.
fn read_date(text: &str) -> Result<Epoch, terrella_frames::TimeError> {
    match text.ends_with('Z') || text.contains('+') {
        true => utc_from_rfc3339(text),
        false => epoch_from_ccsds(text, TimeScale::Utc),
    }
}

/// `begin/end`.
fn interval<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
) -> Result<(Epoch, Epoch), RecordError> {
    let entry = document.entry("interval", value);
    let text = entry.map(|e| e.value.into_owned()).unwrap_or_default();
    let wrong = || {
        document.wrong(
            "the interval",
            value,
            "two dates with a slash between them, the earlier first",
        )
    };
    let (begin, end) = text.split_once('/').ok_or_else(wrong)?;
    let read = |text: &str| {
        read_date(text.trim()).map_err(|cause| {
            let key = "the interval".to_owned();
            document.error(value, RecordFault::Time { key, cause })
        })
    };
    let (begin, end) = (read(begin)?, read(end)?);
    match begin <= end {
        true => Ok((begin, end)),
        false => Err(wrong()),
    }
}

/// One interval or an array of them.
fn intervals<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
) -> Result<Vec<(Epoch, Epoch)>, RecordError> {
    if !value.get().starts_with('[') {
        return Ok(vec![interval(document, value)?]);
    }
    let mut intervals = Vec::new();
    let mut each = |value| {
        intervals.push(interval(document, value)?);
        Ok(())
    };
    document.each_member(value.get(), MAX_INTERVALS, "intervals", &mut each)?;
    Ok(intervals)
}

fn frame<'t>(document: &Document<'t>, object: &Object<'t>) -> Result<Frame, RecordError> {
    let key = "referenceFrame";
    let Some(value) = object.get(key) else {
        return Ok(Frame::Itrf);
    };
    match document.entry(key, value).map(|e| e.value).as_deref() {
        Some("INERTIAL") => Ok(Frame::Gcrf),
        Some("FIXED") => Ok(Frame::Itrf),
        _ => Err(unsupported(
            document,
            key,
            value,
            "known frames are INERTIAL and FIXED",
        )),
    }
}

fn interpolation<'t>(
    document: &Document<'t>,
    object: &Object<'t>,
    with_velocity: bool,
) -> Result<Interpolation, RecordError> {
    let key = "interpolationDegree";
    let degree = match object.get(key) {
        Some(value) => value
            .get()
            .parse::<usize>()
            .ok()
            .filter(|n| (1..=Interpolation::MAX_DEGREE).contains(n))
            .ok_or_else(|| document.wrong(key, value, "a whole number from 1 to 31"))?,
        None => 1,
    };
    let key = "interpolationAlgorithm";
    let Some(value) = object.get(key) else {
        return Ok(Interpolation::Linear);
    };
    let name = document.entry(key, value).map(|e| e.value);
    match Interpolation::from_name(name.as_deref().unwrap_or_default(), degree) {
        // Without velocities Hermite's polynomial is Lagrange's.
        Some(Interpolation::Hermite { degree }) if !with_velocity => {
            Ok(Interpolation::Lagrange { degree })
        }
        Some(interpolation) => Ok(interpolation),
        None => Err(unsupported(
            document,
            key,
            value,
            "known algorithms are LINEAR, LAGRANGE and HERMITE",
        )),
    }
}

fn unsupported(
    document: &Document<'_>,
    key: &str,
    value: &RawValue,
    remedy: &'static str,
) -> RecordError {
    let fault = RecordFault::Unsupported {
        key: key.to_owned(),
        text: excerpt(value.get()),
        remedy,
    };
    document.error(value, fault)
}
