//! The position property of a packet.

use super::super::entry::{RecordError, RecordFault, number};
use super::super::found::{Each, Found};
use super::super::interpolated::StateSample;
use super::super::iso8601;
use super::super::text::json::{Document, Object};
use super::sampled::{MAX_NUMBERS, Sample};
use super::settings::{Settings, unsupported};
use super::spans::{MAX_INTERVALS, Span};
use crate::Frame;
use glam::DVec3;
use serde_json::value::RawValue;
use std::f64::consts::FRAC_PI_2;
use terrella_files::excerpt;
use terrella_frames::{Duration, Ellipsoid, Epoch, Geodetic};

/// A position, or one interval of it.
pub struct Given<'t> {
    pub place: &'t RawValue,
    pub interval: Option<Span>,
    pub frame: Option<Frame>,
    pub settings: Settings,
    pub value: Option<Value<'t>>,
}

/// A value of the position.
pub enum Value<'t> {
    /// Deletes earlier values.
    Deleted,
    /// A fixed position.
    Constant(DVec3),
    Samples {
        samples: Vec<Sample<'t>>,
        with_velocity: bool,
        /// The array.
        numbers: &'t RawValue,
    },
    /// The position of another object, given by its identifier; an empty one is the object itself.
    Reference(String),
}

/// Calls `use_it` for every interval of a position; samples that cannot be read go to `each`.
pub fn each_given<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
    each: &mut Each<'_>,
    use_it: &mut dyn FnMut(Given<'t>, &mut Each<'_>) -> Result<(), RecordError>,
) -> Result<(), RecordError> {
    let mut one = |value| {
        let given = given(document, value, each)?;
        use_it(given, each)
    };
    match value.get().starts_with('[') {
        true => document.each_member(value.get(), MAX_INTERVALS, "intervals", &mut one),
        false => one(value),
    }
}

fn given<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
    each: &mut Each<'_>,
) -> Result<Given<'t>, RecordError> {
    let object = document.object(value, "an object or an array of them")?;
    let interval = match object.get("interval") {
        Some(value) => Some(interval(document, value)?),
        None => None,
    };
    let is_deleted = object.get("delete").is_some_and(|v| v.get() == "true");
    let reference = object.get("reference");
    let coordinates = COORDINATES
        .iter()
        .find_map(|c| Some((c, object.get(c.key)?)));
    let mut frame = frame(document, &object)?;
    let value_given = match (is_deleted, reference, coordinates) {
        (true, ..) => Some(Value::Deleted),
        (_, Some(value), _) => Some(Value::Reference(referenced(document, value)?)),
        (_, None, Some((coordinates, numbers))) => {
            if coordinates.axes != Axes::Metres && frame.is_some_and(|f| f != Frame::Itrf) {
                let remedy = "places on the Earth are FIXED; leave referenceFrame out";
                return Err(unsupported(document, coordinates.key, numbers, remedy));
            }
            if coordinates.axes != Axes::Metres {
                frame = Some(Frame::Itrf);
            }
            Some(coordinates.read(document, &object, numbers, each)?)
        }
        (_, None, None) => None,
    };
    Ok(Given {
        place: value,
        interval,
        frame,
        settings: Settings::of(document, &object)?,
        value: value_given,
    })
}

/// Key of an array of coordinates.
struct Coordinates {
    key: &'static str,
    with_velocity: bool,
    axes: Axes,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Axes {
    /// Metres along three axes.
    Metres,
    /// Longitude and latitude in units of so many radians, and metres above the ellipsoid WGS84.
    Geodetic(Unit),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Unit {
    Degrees,
    Radians,
}

const COORDINATES: [Coordinates; 4] = [
    Coordinates {
        key: "cartesianVelocity",
        with_velocity: true,
        axes: Axes::Metres,
    },
    Coordinates {
        key: "cartesian",
        with_velocity: false,
        axes: Axes::Metres,
    },
    Coordinates {
        key: "cartographicRadians",
        with_velocity: false,
        axes: Axes::Geodetic(Unit::Radians),
    },
    Coordinates {
        key: "cartographicDegrees",
        with_velocity: false,
        axes: Axes::Geodetic(Unit::Degrees),
    },
];

impl Coordinates {
    fn read<'t>(
        &self,
        document: &Document<'t>,
        object: &Object<'t>,
        numbers: &'t RawValue,
        each: &mut Each<'_>,
    ) -> Result<Value<'t>, RecordError> {
        let point = if self.with_velocity { 6 } else { 3 };
        if commas(numbers) < point {
            return self.constant(document, numbers, point);
        }
        let key = "epoch";
        let epoch = match object.get(key) {
            Some(value) => Some(date(document, key, value)?),
            None => None,
        };
        Ok(Value::Samples {
            samples: self.samples(document, numbers, epoch, each)?,
            with_velocity: self.with_velocity,
            numbers,
        })
    }

    fn constant<'t>(
        &self,
        document: &Document<'t>,
        array: &'t RawValue,
        count: usize,
    ) -> Result<Value<'t>, RecordError> {
        let mut read = Vec::with_capacity(count);
        let mut one = |value: &'t RawValue| {
            let number = number(value.get());
            let number = number.filter(|number| self.is_possible(read.len(), *number));
            let wrong = || document.wrong("a coordinate", value, self.expected());
            read.push(number.ok_or_else(wrong)?);
            Ok(())
        };
        document.each_member::<RecordError>(array.get(), count, "coordinates", &mut one)?;
        match read.as_slice() {
            [x, y, z] | [x, y, z, _, _, _] => Ok(Value::Constant(self.position_m([*x, *y, *z]))),
            _ => {
                let expected = "coordinates of a point, or groups of a time and coordinates";
                let text = excerpt(array.get());
                Err(document.error(array, RecordFault::Unexpected { text, expected }))
            }
        }
    }

    fn position_m(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        let radians = |angle: f64| match self.axes {
            Axes::Geodetic(Unit::Degrees) => angle.to_radians(),
            _ => angle,
        };
        match self.axes {
            Axes::Metres => DVec3::new(x, y, z),
            Axes::Geodetic(_) => Ellipsoid::WGS84.itrf_from_geodetic(Geodetic {
                lon_rad: radians(x),
                lat_rad: radians(y),
                height_m: z,
            }),
        }
    }

    /// `[t, x, y, z, …]` or `[t, x, y, z, vx, vy, vz, …]`, t in seconds since `epoch` or as a date. A group with an invalid element goes to `each`.
    /// If the number of elements does not fit, the grouping is unknown.
    fn samples<'t>(
        &self,
        document: &Document<'t>,
        array: &'t RawValue,
        epoch: Option<Epoch>,
        each: &mut Each<'_>,
    ) -> Result<Vec<Sample<'t>>, RecordError> {
        let width = if self.with_velocity { 7 } else { 4 };
        let mut samples = Vec::new();
        let mut row = [0.0; 6];
        let mut at: Option<(Epoch, &'t RawValue)> = None;
        // The error of the group.
        let mut bad: Option<RecordError> = None;
        let mut count = 0;
        let mut one = |value: &'t RawValue| {
            let column = count % width;
            count += 1;
            let read = match column {
                0 => time(document, value, epoch).map(|epoch| at = Some((epoch, value))),
                _ => match (number(value.get()), row.get_mut(column - 1)) {
                    (Some(number), Some(slot)) if self.is_possible(column - 1, number) => {
                        *slot = number;
                        Ok(())
                    }
                    _ => Err(document.wrong("a coordinate", value, self.expected())),
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
            samples.push(Sample {
                state: StateSample {
                    epoch,
                    position_m: self.position_m([x, y, z]),
                    velocity_m_s: self.with_velocity.then_some(DVec3::new(vx, vy, vz)),
                },
                place,
            });
            Ok(())
        };
        document.each_member(array.get(), MAX_NUMBERS, "numbers", &mut one)?;
        match count % width {
            0 => Ok(samples),
            _ => {
                let expected = match self.with_velocity {
                    true => "groups of seven: time, position and velocity",
                    false => "groups of four: time and position",
                };
                let text = format!("{count} numbers");
                Err(document.error(array, RecordFault::Unexpected { text, expected }))
            }
        }
    }

    /// Whether a coordinate may have this value. Latitudes that may not are mostly longitudes, in the wrong order.
    fn is_possible(&self, coordinate: usize, number: f64) -> bool {
        match (self.axes, coordinate) {
            (Axes::Geodetic(Unit::Degrees), 1) => number.abs() <= 90.0,
            // The nearest number to π/2 may have been rounded up when it was written.
            (Axes::Geodetic(Unit::Radians), 1) => number.abs() <= FRAC_PI_2 + 1e-6,
            _ => true,
        }
    }

    fn expected(&self) -> &'static str {
        match self.axes {
            Axes::Metres => "a number of metres",
            Axes::Geodetic(_) => {
                "a number: longitude, then latitude of at most 90° either way, then height in metres"
            }
        }
    }
}

/// Commas in a value's text: as many as a point has coordinates are more than one point.
fn commas(value: &RawValue) -> usize {
    value.get().bytes().filter(|&b| b == b',').count()
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
    iso8601::epoch(&text).map_err(|cause| {
        let key = key.to_owned();
        document.error(value, RecordFault::Time { key, cause })
    })
}

/// `begin/end`.
fn interval<'t>(document: &Document<'t>, value: &'t RawValue) -> Result<Span, RecordError> {
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
        iso8601::bound(text).map_err(|cause| {
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
pub fn intervals<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
) -> Result<Vec<Span>, RecordError> {
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

fn frame<'t>(document: &Document<'t>, object: &Object<'t>) -> Result<Option<Frame>, RecordError> {
    let key = "referenceFrame";
    let Some(value) = object.get(key) else {
        return Ok(None);
    };
    match document.entry(key, value).map(|e| e.value).as_deref() {
        Some("INERTIAL") => Ok(Some(Frame::Gcrf)),
        Some("FIXED") => Ok(Some(Frame::Itrf)),
        _ => {
            let remedy = "known frames are INERTIAL and FIXED";
            Err(unsupported(document, key, value, remedy))
        }
    }
}

/// The identifier in `id#property`, in which `\` escapes a `#` or a `\` of the identifier.
fn referenced<'t>(document: &Document<'t>, value: &'t RawValue) -> Result<String, RecordError> {
    let key = "reference";
    let entry = document.entry(key, value);
    let text = entry.map(|e| e.value.into_owned()).unwrap_or_default();
    let mut id = String::new();
    let mut characters = text.chars();
    let remedy = "only positions of other objects are followed: write id#position";
    while let Some(character) = characters.next() {
        match character {
            '\\' => id.extend(characters.next()),
            '#' if characters.as_str() == "position" => return Ok(id),
            '#' => return Err(unsupported(document, key, value, remedy)),
            other => id.push(other),
        }
    }
    Err(unsupported(document, key, value, remedy))
}
