//! Ephemeris files of STK, `.e` (help.agi.com, "Ephemeris File Format").

use super::Frame;
use super::entry::{RecordError, RecordFault, TextPosition, number, printable};
use super::found::{Each, Found};
use super::interpolated::{Interpolation, StateSample};
use super::iso8601;
use super::oem::Axes;
use super::runs::{MAX_RUNS, Motion, Run};
use glam::DVec3;
use std::path::Path;
use terrella_files::excerpt;
use terrella_frames::{Duration, Ellipsoid, Epoch, Geodetic, TimeError};

/// Most states of a file.
const MAX_STATES: usize = 2_000_000;
/// Limit of boundaries between segments.
const MAX_BOUNDARIES: usize = MAX_RUNS;

/// Whether a text is in this format: it starts with its version.
pub(super) fn is_stk(text: &str) -> bool {
    let start = text.trim_start().get(..6);
    start.is_some_and(|start| start.eq_ignore_ascii_case("stk.v."))
}

/// Calls `each` for the object.
pub(super) fn each_object(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), RecordError> {
    let mut reader = Reader::new(origin);
    for (index, line) in text.lines().enumerate() {
        // A # starts a comment.
        let line = line.split('#').next().unwrap_or_default().trim();
        let place = TextPosition {
            line: index + 1,
            column: 1,
        };
        if !line.is_empty() {
            reader.line(line, place, each)?;
        }
    }
    let object = reader.finish(each);
    each(Found::of(Vec::new(), object))
}

/// Between which marks the reader is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Block {
    Header,
    Boundaries,
    /// Rows of so many numbers.
    States(usize),
    /// Rows of seconds, latitude, longitude and height.
    Places,
    /// Covariances and others.
    PassedOver,
    Ended,
}

struct Reader<'o> {
    origin: &'o Path,
    block: Block,
    name: Option<String>,
    epoch: Option<Epoch>,
    axes: Axes,
    metres: f64,
    method: Option<(Interpolation, TextPosition)>,
    samples_less_one: Option<usize>,
    states_place: TextPosition,
    boundaries_s: Vec<f64>,
    states: usize,
    last_s: Option<f64>,
    runs: Vec<Run>,
}

impl<'o> Reader<'o> {
    fn new(origin: &'o Path) -> Self {
        Self {
            origin,
            block: Block::Header,
            name: None,
            epoch: None,
            axes: Axes::Of(Frame::Itrf),
            metres: 1.0,
            method: None,
            samples_less_one: None,
            states_place: TextPosition { line: 1, column: 1 },
            boundaries_s: Vec::new(),
            states: 0,
            last_s: None,
            runs: Vec::new(),
        }
    }

    fn line(
        &mut self,
        line: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let (key, value) = line
            .split_once(char::is_whitespace)
            .map_or((line, ""), |(key, value)| (key, value.trim()));
        let (key, what) = (key.to_ascii_lowercase(), value.to_ascii_lowercase());
        match (key.as_str(), self.block) {
            ("end", _) if what == "ephemeris" => self.block = Block::Ended,
            ("end", Block::Boundaries) => {
                self.block = Block::Header;
                self.boundaries_s.sort_by(f64::total_cmp);
            }
            (_, Block::Ended) => {}
            (_, Block::Boundaries) => {
                for word in line.split_whitespace() {
                    let Some(seconds) = number(word) else {
                        return Err(self.unexpected(word, place, "seconds since ScenarioEpoch"));
                    };
                    self.boundaries_s.push(seconds);
                }
                if self.boundaries_s.len() > MAX_BOUNDARIES {
                    let (what, limit) = ("boundaries of segments", MAX_BOUNDARIES);
                    return Err(place.error(self.origin, RecordFault::TooMany { what, limit }));
                }
            }
            (_, Block::Header) => self.header(&key, value, place, each)?,
            (key, Block::States(_) | Block::Places)
                if key.starts_with(|c: char| c.is_ascii_alphabetic()) =>
            {
                self.block = Block::PassedOver;
            }
            (_, Block::States(_) | Block::Places) => {
                let read = match self.block {
                    Block::States(width) => self.state(line, width, place),
                    _ => self.place_of_states(line, place),
                };
                if let Err(error) = read {
                    match &*error.fault {
                        RecordFault::TooMany { .. } => return Err(error),
                        _ => each(Found::BadState(error))?,
                    }
                }
            }
            (_, Block::PassedOver) => {}
        }
        Ok(())
    }

    fn unexpected(&self, text: &str, place: TextPosition, expected: &'static str) -> RecordError {
        let text = excerpt(text);
        place.error(self.origin, RecordFault::Unexpected { text, expected })
    }

    fn unsupported(
        &self,
        key: &str,
        value: &str,
        place: TextPosition,
        remedy: &'static str,
    ) -> RecordError {
        let fault = RecordFault::Unsupported {
            key: key.to_owned(),
            text: excerpt(value),
            remedy,
        };
        place.error(self.origin, fault)
    }

    /// A keyword before the states; those unrelated to the motion are skipped.
    fn header(
        &mut self,
        key: &str,
        value: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        match key {
            "begin" if value.eq_ignore_ascii_case("segmentboundarytimes") => {
                self.block = Block::Boundaries;
            }
            "scenarioepoch" => {
                let epoch = scenario_epoch(value).map_err(|cause| {
                    let key = "ScenarioEpoch".to_owned();
                    place.error(self.origin, RecordFault::Time { key, cause })
                })?;
                self.epoch = Some(epoch);
            }
            "centralbody" if !value.eq_ignore_ascii_case("earth") => {
                let remedy = "only orbits about the Earth are flown";
                return Err(self.unsupported("CentralBody", value, place, remedy));
            }
            "coordinatesystem" => {
                self.axes = match value.to_ascii_lowercase().as_str() {
                    // For the Earth, STK's inertial axes are those of the ICRF.
                    "icrf" | "inertial" => Axes::Of(Frame::Gcrf),
                    "j2000" => Axes::Of(Frame::Eme2000),
                    "fixed" => Axes::Of(Frame::Itrf),
                    "temeofdate" => Axes::Of(Frame::Teme),
                    "trueofdate" => Axes::TrueOfDate,
                    "meanofdate" => Axes::MeanOfDate,
                    _ => {
                        let remedy = "known systems are ICRF, Inertial, J2000, Fixed, TEMEOfDate, TrueOfDate and MeanOfDate";
                        return Err(self.unsupported("CoordinateSystem", value, place, remedy));
                    }
                };
            }
            "coordinatesystemepoch" if self.axes.are_of_date() => {
                let remedy = "axes of a fixed date are not known; only of the state's own";
                return Err(self.unsupported("CoordinateSystemEpoch", value, place, remedy));
            }
            "distanceunit" => {
                self.metres = match value.to_ascii_lowercase().as_str() {
                    "meters" | "meter" | "m" => 1.0,
                    "kilometers" | "kilometer" | "km" => 1e3,
                    "feet" | "foot" | "ft" => 0.3048,
                    "nauticalmiles" | "nauticalmile" | "nm" => 1852.0,
                    _ => {
                        let remedy = "known units are Meters, Kilometers, Feet and NauticalMiles";
                        return Err(self.unsupported("DistanceUnit", value, place, remedy));
                    }
                };
            }
            "interpolationmethod" => self.method(value, place, each)?,
            "interpolationsamplesm1" | "interpolationorder" => {
                let count = value.parse::<usize>().ok();
                let count = count.filter(|n| (1..=Interpolation::MAX_DEGREE).contains(n));
                let Some(count) = count else {
                    let expected = "a whole number from 1 to 31";
                    return Err(self.unexpected(value, place, expected));
                };
                self.samples_less_one = Some(count);
            }
            "timeformat" if !value.trim_matches('"').eq_ignore_ascii_case("epsec") => {
                let remedy = "times are read as seconds since ScenarioEpoch; export them as EpSec";
                return Err(self.unsupported("TimeFormat", value, place, remedy));
            }
            "vehicleid" | "satellitename" | "objectname" => self.name = Some(printable(value)),
            _ if key.starts_with("ephemeris") => {
                self.states_place = place;
                self.block = match key {
                    "ephemeristimepos" => Block::States(4),
                    "ephemeristimeposvel" => Block::States(7),
                    "ephemeristimeposvelacc" => Block::States(10),
                    "ephemerisllatimepos" => Block::Places,
                    _ => {
                        let remedy = "states are read from EphemerisTimePos, EphemerisTimePosVel, EphemerisTimePosVelAcc and EphemerisLLATimePos";
                        return Err(self.unsupported("the format of states", key, place, remedy));
                    }
                };
            }
            _ => {}
        }
        Ok(())
    }

    fn method(
        &mut self,
        value: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let method = match value.to_ascii_lowercase().as_str() {
            "linear" => Interpolation::Linear,
            "hermite" => Interpolation::Hermite { degree: 1 },
            "lagrange" => Interpolation::Lagrange { degree: 1 },
            "lagrangevop" => {
                let fault = RecordFault::NotFollowed {
                    key: "InterpolationMethod",
                    text: excerpt(value),
                    why: "Lagrange is taken instead",
                };
                each(Found::BadState(place.error(self.origin, fault)))?;
                Interpolation::Lagrange { degree: 1 }
            }
            _ => {
                let remedy = "known methods are Linear, Lagrange and Hermite";
                return Err(self.unsupported("InterpolationMethod", value, place, remedy));
            }
        };
        self.method = Some((method, place));
        Ok(())
    }

    /// Seconds, latitude and longitude in degrees, and height above the ellipsoid.
    fn place_of_states(&mut self, line: &str, place: TextPosition) -> Result<(), RecordError> {
        let expected = "seconds, latitude and longitude in degrees, and height";
        let [seconds, lat_deg, lon_deg, height] = self.numbers(line, place, expected)?;
        if !(lat_deg.abs() <= 90.0 && lon_deg.abs() <= 360.0) {
            return Err(self.unexpected(line, place, expected));
        }
        if self.axes != Axes::Of(Frame::Itrf) {
            let remedy = "latitudes and longitudes are Fixed";
            return Err(self.unsupported(
                "CoordinateSystem",
                "of EphemerisLLATimePos",
                place,
                remedy,
            ));
        }
        let geodetic = Geodetic::from_degrees(lat_deg, lon_deg, height * self.metres);
        let position_m = Ellipsoid::WGS84.itrf_from_geodetic(geodetic);
        self.sample(seconds, position_m, None, place)
    }

    /// The numbers of a row, as many as are wanted.
    fn numbers<const N: usize>(
        &self,
        line: &str,
        place: TextPosition,
        expected: &'static str,
    ) -> Result<[f64; N], RecordError> {
        let words = line.split_whitespace().take(N + 1);
        let numbers: Option<Vec<f64>> = words.map(number).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.ok_or_else(|| self.unexpected(line, place, expected))
    }

    /// Seconds, position and velocity.
    fn state(&mut self, line: &str, width: usize, place: TextPosition) -> Result<(), RecordError> {
        let (seconds, position, velocity) = match width {
            4 => {
                let expected = "seconds and three coordinates";
                let [s, x, y, z] = self.numbers(line, place, expected)?;
                (s, DVec3::new(x, y, z), None)
            }
            7 => {
                let expected = "seconds, three coordinates and three of the velocity";
                let [s, x, y, z, vx, vy, vz] = self.numbers(line, place, expected)?;
                (s, DVec3::new(x, y, z), Some(DVec3::new(vx, vy, vz)))
            }
            _ => {
                let expected =
                    "seconds, and three coordinates of the position, velocity and acceleration";
                let [s, x, y, z, vx, vy, vz, _, _, _] = self.numbers(line, place, expected)?;
                (s, DVec3::new(x, y, z), Some(DVec3::new(vx, vy, vz)))
            }
        };
        let velocity_m_s = velocity.map(|velocity| velocity * self.metres);
        self.sample(seconds, position * self.metres, velocity_m_s, place)
    }

    /// A sample in the axes of the file. A time that comes twice, or is a boundary, begins another run.
    fn sample(
        &mut self,
        seconds: f64,
        position_m: DVec3,
        velocity_m_s: Option<DVec3>,
        place: TextPosition,
    ) -> Result<(), RecordError> {
        self.states += 1;
        if self.states > MAX_STATES {
            let (what, limit) = ("states", MAX_STATES);
            return Err(place.error(self.origin, RecordFault::TooMany { what, limit }));
        }
        // Two centuries are more than an ephemeris can hold, and fit nanoseconds.
        let Some(epoch) = self.epoch.filter(|_| seconds.abs() < 6.4e9) else {
            let fault = RecordFault::Missing {
                what: "the ephemeris",
                key: "ScenarioEpoch, or within two centuries of it",
                remedy: "; it says what seconds are counted from",
            };
            return Err(place.error(self.origin, fault));
        };
        let ns = (seconds * 1e9).round() as i128;
        let epoch = epoch + Duration::from_total_nanoseconds(ns);
        let turn = self.axes.turn(epoch);
        let turned = |vector: DVec3| turn.map_or(vector, |turn| turn * vector);
        let sample = StateSample {
            epoch,
            position_m: turned(position_m),
            velocity_m_s: velocity_m_s.map(turned),
        };
        let boundary = self
            .boundaries_s
            .binary_search_by(|known| known.total_cmp(&seconds));
        match (boundary.is_ok(), self.last_s == Some(seconds)) {
            // The next segment starts with this state, unless it is repeated.
            (true, false) => {
                if self.runs.is_empty() {
                    self.begin_run(place)?;
                }
                self.add(sample, place.line);
                self.begin_run(place)?;
            }
            // It has come again: the copy gives way.
            (true, true) => self.runs.last_mut().into_iter().for_each(|run| {
                run.samples.clear();
                run.lines.clear();
            }),
            (false, comes_again) => {
                if comes_again || self.runs.is_empty() {
                    self.begin_run(place)?;
                }
            }
        }
        self.add(sample, place.line);
        self.last_s = Some(seconds);
        Ok(())
    }

    fn begin_run(&mut self, place: TextPosition) -> Result<(), RecordError> {
        if self.runs.len() >= MAX_RUNS {
            let (what, limit) = ("segments", MAX_RUNS);
            return Err(place.error(self.origin, RecordFault::TooMany { what, limit }));
        }
        self.runs.push(Run::default());
        Ok(())
    }

    fn add(&mut self, sample: StateSample, line: usize) {
        if let Some(run) = self.runs.last_mut() {
            run.samples.push(sample);
            run.lines.push(line);
        }
    }

    /// Drops single states that a boundary at an end has copied.
    fn drop_copies(&mut self) {
        let ends_at = |run: Option<&Run>| run.and_then(|run| run.samples.last()).map(|s| s.epoch);
        let begins_at =
            |run: Option<&Run>| run.and_then(|run| run.samples.first()).map(|s| s.epoch);
        let is_one = |run: Option<&Run>| run.is_some_and(|run| run.samples.len() == 1);
        if is_one(self.runs.last())
            && self.runs.len() > 1
            && ends_at(self.runs.get(self.runs.len() - 2)) == begins_at(self.runs.last())
        {
            self.runs.pop();
        }
        if is_one(self.runs.first()) && ends_at(self.runs.first()) == begins_at(self.runs.get(1)) {
            self.runs.remove(0);
        }
    }

    fn finish(mut self, each: &mut Each<'_>) -> Result<super::EphemerisFeed, RecordError> {
        self.drop_copies();
        let has_velocities = self
            .runs
            .iter()
            .flat_map(|run| &run.samples)
            .all(|sample| sample.velocity_m_s.is_some());
        if self.block != Block::Ended {
            let what = "BEGIN Ephemeris".to_owned();
            let fault = RecordFault::CutOff(super::CutOff::Unclosed { what });
            each(Found::BadState(self.states_place.error(self.origin, fault)))?;
        }
        let count = self.samples_less_one;
        let interpolation = match (self.method.map(|(method, _)| method), has_velocities) {
            (Some(Interpolation::Linear), _) => Interpolation::Linear,
            (Some(Interpolation::Hermite { .. }), true) => Interpolation::Hermite {
                degree: (2 * count.unwrap_or(3) + 1).min(Interpolation::MAX_DEGREE),
            },
            (Some(_), _) => Interpolation::Lagrange {
                degree: count.unwrap_or(7),
            },
            (None, true) => Interpolation::WITH_VELOCITIES,
            (None, false) => Interpolation::WITHOUT_VELOCITIES,
        };
        let stem = self.origin.file_stem().unwrap_or_default();
        let motion = Motion {
            name: self
                .name
                .unwrap_or_else(|| printable(&stem.to_string_lossy())),
            frame: self.axes.frame(),
            interpolation,
            origin: self.origin,
            place: self.states_place,
        };
        motion.feed(self.runs, each)
    }
}

/// `1 Jun 2004 12:00:00.000` in UTC, or ISO 8601.
fn scenario_epoch(text: &str) -> Result<Epoch, TimeError> {
    const MONTHS: [&str; 12] = [
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
    ];
    let text = text.trim_matches('"');
    let words: Vec<_> = text.split_whitespace().collect();
    let [day, month, year, time] = words.as_slice() else {
        return iso8601::epoch(text);
    };
    let name = month.to_ascii_lowercase();
    let month = MONTHS.iter().position(|known| name.starts_with(known));
    match month {
        Some(month) => {
            // The hour may have one digit.
            let width = time.find(':').map_or(0, |at| time.len() + 2 - at);
            iso8601::epoch(&format!(
                "{year}-{:02}-{day:0>2}T{time:0>width$}",
                month + 1
            ))
        }
        None => iso8601::epoch(text),
    }
}
