//! SP3, the orbits of navigation satellites and of others in orbit with them: versions a to d (igs.org/formats-and-standards, Hilla
//! 2010 and 2016).

use super::Frame;
use super::entry::{RecordError, RecordFault, TextPosition, printable, scaled_number};
use super::found::{Each, Found};
use super::interpolated::{Interpolation, StateSample};
use super::runs::{MAX_RUNS, Motion, Run};
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;
use terrella_files::excerpt;
use terrella_frames::{Duration, Epoch, TimeScale, epoch_from_ccsds};

/// Most states of a file.
const MAX_STATES: usize = 2_000_000;
/// Eleven positions: within millimetres of orbits of navigation satellites a quarter of an hour apart.
const POSITIONS: Interpolation = Interpolation::Lagrange { degree: 10 };

/// Whether a text is in this format: `#`, the version, `P` or `V`, and a year.
pub(super) fn is_sp3(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default().as_bytes();
    matches!(first, [b'#', version, b'P' | b'V', year @ ..]
        if version.is_ascii_lowercase()
            && year.get(..4).is_some_and(|year| year.iter().all(u8::is_ascii_digit)))
}

/// Calls `each` for every satellite.
pub(super) fn each_object(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), RecordError> {
    let mut reader = Reader {
        origin,
        frame: Frame::Itrf,
        scale: Scale::GPS,
        is_headed: false,
        epoch: None,
        epochs: 0,
        states: 0,
        satellites: Vec::new(),
        by_id: HashMap::new(),
    };
    let mut is_ended = false;
    let mut last = 1;
    for (index, line) in text.lines().enumerate() {
        let place = TextPosition {
            line: index + 1,
            column: 1,
        };
        last = place.line;
        if line.starts_with("EOF") {
            is_ended = true;
            break;
        }
        reader.line(line, place, each)?;
    }
    if !is_ended {
        let what = "EOF at its end".to_owned();
        let cut = super::CutOff::Unclosed { what };
        let place = TextPosition {
            line: last,
            column: 1,
        };
        each(Found::BadState(
            place.error(origin, RecordFault::CutOff(cut)),
        ))?;
    }
    reader.finish(each)
}

/// A scale of time, and how far what it shows is behind it, seconds.
#[derive(Clone, Copy)]
struct Scale {
    scale: TimeScale,
    behind_s: i64,
}

impl Scale {
    const GPS: Self = Self {
        scale: TimeScale::Gps,
        behind_s: 0,
    };

    fn from_name(name: &str) -> Option<Self> {
        let of = |scale| Self { scale, behind_s: 0 };
        Some(match name {
            // Those of Galileo, QZSS and NavIC keep the seconds of GPS.
            "GPS" | "GAL" | "QZS" | "IRN" | "ccc" | "" => Self::GPS,
            // BeiDou began 14 leap seconds later.
            "BDT" | "BDS" => Self {
                behind_s: 14,
                ..Self::GPS
            },
            "TAI" => of(TimeScale::Tai),
            "UTC" | "GLO" => of(TimeScale::Utc),
            _ => return None,
        })
    }
}

struct Satellite {
    id: String,
    line: usize,
    runs: Vec<Run>,
    /// Which epoch its last position is of, counted from 1.
    last_epoch: usize,
    has_velocities: bool,
}

struct Reader<'o> {
    origin: &'o Path,
    frame: Frame,
    scale: Scale,
    is_headed: bool,
    epoch: Option<Epoch>,
    epochs: usize,
    states: usize,
    satellites: Vec<Satellite>,
    by_id: HashMap<String, usize>,
}

/// Callback for a satellite, the three numbers of its line, their position, and whether it has fired an engine.
type UseColumns<'o> =
    fn(&mut Reader<'o>, &str, [&str; 3], TextPosition, bool) -> Result<(), RecordError>;

impl<'o> Reader<'o> {
    fn line(
        &mut self,
        line: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        let mut marks = line.chars();
        match (marks.next(), marks.next()) {
            (Some('#'), Some('#')) => Ok(()),
            (Some('#'), version) => self.version(version, line, place),
            (Some('%'), Some('c')) if !self.is_headed => self.time_system(line, place),
            (Some('*'), _) => self.epoch(line, place, each),
            (Some('P'), _) => self.with_columns(line, place, each, Self::position),
            (Some('V'), _) => self.with_columns(line, place, each, Self::velocity),
            // Satellites, accuracies, numbers, comments, and how numbers hang together.
            (Some('+' | '%' | '/' | 'E') | None, _) => Ok(()),
            _ => {
                let expected = "a line of SP3: #, +, %, /*, *, P, V or EOF";
                Err(self.unexpected(line, place, expected))
            }
        }
    }

    fn unexpected(&self, text: &str, place: TextPosition, expected: &'static str) -> RecordError {
        let text = excerpt(text);
        place.error(self.origin, RecordFault::Unexpected { text, expected })
    }

    /// The first line has the frame in columns 47 to 51.
    fn version(
        &mut self,
        version: Option<char>,
        line: &str,
        place: TextPosition,
    ) -> Result<(), RecordError> {
        let name = line.get(46..51).unwrap_or_default().trim();
        match version {
            Some('a'..='d') => {
                self.frame = frame(name).ok_or_else(|| {
                    let fault = RecordFault::Unsupported {
                        key: "the frame".to_owned(),
                        text: excerpt(name),
                        remedy: "known inertial ones are GCRF, ICRF, EME00, EME2K, J2000 and TEME; all others are Earth-fixed",
                    };
                    place.error(self.origin, fault)
                })?;
                Ok(())
            }
            other => Err(place.error(
                self.origin,
                RecordFault::Unsupported {
                    key: "the version".to_owned(),
                    text: other.map(String::from).unwrap_or_default(),
                    remedy: "versions a to d are read",
                },
            )),
        }
    }

    /// The first line `%c` has the time system in columns 10 to 12.
    fn time_system(&mut self, line: &str, place: TextPosition) -> Result<(), RecordError> {
        self.is_headed = true;
        let name = line.get(9..12).unwrap_or_default().trim();
        self.scale = Scale::from_name(name).ok_or_else(|| {
            let fault = RecordFault::Unsupported {
                key: "the time system".to_owned(),
                text: excerpt(name),
                remedy: "known ones are GPS, GAL, QZS, IRN, BDT, GLO, UTC and TAI",
            };
            place.error(self.origin, fault)
        })?;
        Ok(())
    }

    /// `*  2001  8  8  0  0  0.00000000`. Positions behind a wrong one are left out with it.
    fn epoch(
        &mut self,
        line: &str,
        place: TextPosition,
        each: &mut Each<'_>,
    ) -> Result<(), RecordError> {
        self.epochs += 1;
        self.epoch = None;
        let fields: Vec<_> = line
            .get(1..)
            .unwrap_or_default()
            .split_whitespace()
            .collect();
        let [year, month, day, hour, minute, second] = fields.as_slice() else {
            let expected = "* with year, month, day, hour, minute and second";
            return each(Found::BadState(self.unexpected(line, place, expected)));
        };
        let (whole, decimals) = second.split_once('.').unwrap_or((second, "0"));
        let text =
            format!("{year}-{month:0>2}-{day:0>2}T{hour:0>2}:{minute:0>2}:{whole:0>2}.{decimals}");
        match epoch_from_ccsds(&text, self.scale.scale) {
            Ok(epoch) => {
                let behind = i128::from(self.scale.behind_s) * 1_000_000_000;
                self.epoch = Some(epoch + Duration::from_total_nanoseconds(behind));
                Ok(())
            }
            Err(cause) => {
                let key = "the epoch".to_owned();
                let fault = RecordFault::Time { key, cause };
                each(Found::BadState(place.error(self.origin, fault)))
            }
        }
    }

    /// The satellite and the three numbers of a line, of which a wrong one costs its state alone.
    fn with_columns(
        &mut self,
        line: &str,
        place: TextPosition,
        each: &mut Each<'_>,
        use_it: UseColumns<'o>,
    ) -> Result<(), RecordError> {
        if self.epochs == 0 {
            let expected = "a line with * and the epoch before it";
            return Err(self.unexpected(line, place, expected));
        }
        if self.epoch.is_none() {
            return Ok(());
        }
        self.states += 1;
        if self.states > MAX_STATES {
            let (what, limit) = ("states", MAX_STATES);
            return Err(place.error(self.origin, RecordFault::TooMany { what, limit }));
        }
        let columns = [line.get(4..18), line.get(18..32), line.get(32..46)];
        let (Some(id), [Some(x), Some(y), Some(z)]) = (line.get(1..4), columns) else {
            let expected = "three coordinates in the columns 5 to 46";
            return each(Found::BadState(self.unexpected(line, place, expected)));
        };
        let is_moved = line.get(78..79) == Some("M");
        match use_it(self, id, [x, y, z], place, is_moved) {
            Err(error) if matches!(*error.fault, RecordFault::TooMany { .. }) => Err(error),
            Err(error) => each(Found::BadStateOf(identifier(id), error)),
            Ok(()) => Ok(()),
        }
    }

    fn numbers(
        &self,
        columns: [&str; 3],
        power: i32,
        place: TextPosition,
    ) -> Result<DVec3, RecordError> {
        let mut numbers = [0.0; 3];
        for ((slot, text), key) in numbers.iter_mut().zip(columns).zip(["x", "y", "z"]) {
            *slot = scaled_number(text, power).ok_or_else(|| {
                let fault = RecordFault::Field {
                    key: key.to_owned(),
                    text: excerpt(text.trim()),
                    expected: "a number",
                };
                place.error(self.origin, fault)
            })?;
        }
        Ok(DVec3::from(numbers))
    }

    /// In kilometres; zeros mean no position. A run ends where the satellite has none, and at a manoeuvre.
    fn position(
        &mut self,
        id: &str,
        columns: [&str; 3],
        place: TextPosition,
        is_moved: bool,
    ) -> Result<(), RecordError> {
        let position_m = self.numbers(columns, 3, place)?;
        let (Some(epoch), false) = (self.epoch, position_m == DVec3::ZERO) else {
            return Ok(());
        };
        let id = identifier(id);
        let at = *self.by_id.entry(id.clone()).or_insert_with(|| {
            self.satellites.push(Satellite {
                id,
                line: place.line,
                runs: Vec::new(),
                last_epoch: 0,
                has_velocities: false,
            });
            self.satellites.len() - 1
        });
        let Some(satellite) = self.satellites.get_mut(at) else {
            return Ok(());
        };
        let is_next = satellite.last_epoch + 1 >= self.epochs && !is_moved;
        satellite.last_epoch = self.epochs;
        if !is_next || satellite.runs.is_empty() {
            if satellite.runs.len() >= MAX_RUNS {
                let (what, limit) = ("gaps", MAX_RUNS);
                return Err(place.error(self.origin, RecordFault::TooMany { what, limit }));
            }
            satellite.runs.push(Run::default());
        }
        if let Some(run) = satellite.runs.last_mut() {
            run.lines.push(place.line);
            run.samples.push(StateSample {
                epoch,
                position_m,
                velocity_m_s: None,
            });
        }
        Ok(())
    }

    /// Decimetres a second, of the position before it.
    fn velocity(
        &mut self,
        id: &str,
        columns: [&str; 3],
        place: TextPosition,
        _: bool,
    ) -> Result<(), RecordError> {
        let velocity_m_s = self.numbers(columns, -1, place)?;
        let id = identifier(id);
        let satellite = self
            .by_id
            .get(&id)
            .and_then(|&at| self.satellites.get_mut(at));
        let Some(satellite) = satellite.filter(|one| one.last_epoch == self.epochs) else {
            return Ok(());
        };
        let sample = satellite
            .runs
            .last_mut()
            .and_then(|run| run.samples.last_mut());
        if let Some(sample) = sample.filter(|_| velocity_m_s != DVec3::ZERO) {
            sample.velocity_m_s = Some(velocity_m_s);
            satellite.has_velocities = true;
        }
        Ok(())
    }

    fn finish(self, each: &mut Each<'_>) -> Result<(), RecordError> {
        for satellite in self.satellites {
            let mut samples = satellite.runs.iter().flat_map(|run| &run.samples);
            let has_all = samples.all(|sample| sample.velocity_m_s.is_some());
            let motion = Motion {
                name: satellite.id.clone(),
                frame: self.frame,
                interpolation: match satellite.has_velocities && has_all {
                    true => Interpolation::WITH_VELOCITIES,
                    false => POSITIONS,
                },
                origin: self.origin,
                place: TextPosition {
                    line: satellite.line,
                    column: 1,
                },
            };
            let object = motion.feed(satellite.runs, each);
            each(Found::of(vec![satellite.id], object))?;
        }
        Ok(())
    }
}

/// The frame of this name: those that are not known as inertial are realisations of ITRF. `None` for inertial ones that are not read.
fn frame(name: &str) -> Option<Frame> {
    match name.to_ascii_uppercase().as_str() {
        "GCRF" | "GCRS" | "ICRF" | "ICRS" => Some(Frame::Gcrf),
        "EME00" | "EME2K" | "J2000" => Some(Frame::Eme2000),
        "TEME" => Some(Frame::Teme),
        "ECI" | "INERT" | "TOD" | "MOD" => None,
        _ => Some(Frame::Itrf),
    }
}

/// In version a satellites are those of GPS, by number.
fn identifier(written: &str) -> String {
    match written.trim().parse::<u32>() {
        Ok(number) => format!("G{number:02}"),
        Err(_) => printable(&written.trim().replace(' ', "0")),
    }
}
