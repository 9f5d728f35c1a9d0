//! Whether an orbit covers a scene's whole time span, and the fallback if the scene does not require it.

use super::Scene;
use super::choices::{FrameName, OrbitSource};
use super::error::{KeyLocation, SceneError};
use super::field::written;
use super::orbit::{InitialState, Motion, Orbit, OrbitParameters};
use super::orbit_check::set_elements;
use super::record::{number_text, quoted};
use super::time::{StartSource, utc, year_advice};
use terrella::frames::Epoch;
use terrella_orbit::Frame;
use terrella_orbit::kepler::KeplerElements;

/// Name of the satellite used when the built-in elements are out of range.
const STAND_IN: &str = "ISS stand-in";

/// Why an orbit's validity ends, apart from the end of its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The satellite hits the ground at this place.
    Impact(String),
    /// SGP4 fails beyond: the satellite has decayed.
    Decay,
    /// An ephemeris has a gap.
    Gap,
}

fn validity_text(validity: (Epoch, Epoch), ending: Option<&Ending>) -> String {
    let (first, last) = (utc(validity.0), utc(validity.1));
    match ending {
        Some(Ending::Impact(place)) => {
            format!("the satellite meets the ground at {last}, {place}; it is known from {first}")
        }
        Some(Ending::Decay) => {
            format!("SGP4 has an orbit for the satellite from {first} to {last} and none beyond")
        }
        Some(Ending::Gap) => {
            format!("the ephemeris has a gap; it is known without one from {first} to {last}")
        }
        None => format!("the orbit answers from {first} to {last}"),
    }
}

impl Scene {
    /// Rejects a scene that extends beyond `validity`. This is the first and last epoch that its orbit covers without a gap
    /// ([`terrella_orbit::Feed::validity`], [`terrella_orbit::Feed::gaps`]). `ending` is the known reason why that time ends.
    pub fn check_dates(
        &self,
        validity: (Epoch, Epoch),
        ending: Option<&Ending>,
    ) -> Result<(), SceneError> {
        let (first, last) = validity;
        let inside = |epoch: Epoch| first <= epoch && epoch <= last;
        let validity_text = validity_text(validity, ending);
        let (start, end) = (self.time.start, self.time.end());
        if !inside(start) {
            let is_file = self.orbits.iter().any(|orbit| orbit.source.is_file());
            let or = match is_file || self.orbits.is_empty() {
                true => ", or name newer elements with file in [orbit]",
                false => "",
            };
            let remedy = format!("{validity_text}; choose a start in that time{or}");
            return Err(self.reject_time("start", utc(start), remedy));
        }
        if !inside(end) {
            let room_s = if self.time.speed > 0.0 {
                (last - start).to_seconds()
            } else {
                (start - first).to_seconds()
            };
            let remedy = format!(
                "the flight from {} would end at {}, but {validity_text}; make it at most {} seconds or choose another start",
                utc(start),
                utc(end),
                room_s.floor()
            );
            return Err(self.reject_time("duration_s", self.time.duration_s.to_string(), remedy));
        }
        Ok(())
    }

    /// Skips the gaps of the followed satellite in playback.
    pub fn leave_out(&mut self, gaps: &[(Epoch, Epoch)]) {
        let (first, last) = (self.time.start, self.time.end());
        let (first, last) = (first.min(last), first.max(last));
        let within = |(from, to): &&(Epoch, Epoch)| first <= *from && *to <= last;
        self.time.left_out = gaps.iter().filter(within).copied().collect();
    }

    /// Shortens a default duration to the orbit's validity, with a notice.
    pub fn shorten(&mut self, validity: (Epoch, Epoch), ending: Option<&Ending>) {
        let (start, end) = (self.time.start, self.time.end());
        let inside = |epoch: Epoch| validity.0 <= epoch && epoch <= validity.1;
        if self.line("time", "duration_s").is_some() || !inside(start) || inside(end) {
            return;
        }
        let room = match self.time.speed > 0.0 {
            true => validity.1 - start,
            false => start - validity.0,
        };
        // Rounded down to milliseconds, so that it ends inside.
        let room_s = (room.to_seconds() * 1e3).floor() / 1e3;
        if room_s > 0.0 {
            self.notices.push(format!(
                "[time] duration_s is shortened from its default, {}, to {room_s}: {}",
                self.time.duration_s,
                validity_text(validity, ending)
            ));
            self.time.duration_s = room_s;
            self.set("time", "duration_s", Ok(number_text(room_s)));
        }
    }

    /// Adds a notice about keyframes of the camera after the end of the film.
    pub fn note_late_keyframes(&mut self) {
        let length_s = self.time.duration_s;
        let direction = 1.0_f64.copysign(self.time.speed);
        let keys = self.camera.keys.iter().zip(1..);
        let late = keys.filter(|(key, _)| key.time_s * direction > length_s);
        let late: Vec<(f64, u32)> = late.map(|(key, number)| (key.time_s, number)).collect();
        let Some((time_s, number)) = late.first() else {
            return;
        };
        let more = match late.len() {
            1 => String::new(),
            count => format!(" (and {} more)", count - 1),
        };
        self.notices.push(format!(
            "[camera.keys] keyframe {number}, time_s = {}{more}: after the end of the film, duration_s = {}; set an earlier time_s, or a longer duration_s in [time]",
            number_text(*time_s),
            number_text(length_s)
        ));
    }

    /// Starts a scene without a given start at a satellite's own time; `from` describes that time. Motions without an epoch
    /// start with it. A scene with a given start is unchanged.
    ///
    /// # Errors
    /// A time outside the range of scenes.
    pub fn begin_at(&mut self, start: Epoch, from: String) -> Result<(), SceneError> {
        match self.time.start_from {
            StartSource::Default => self.move_start(start, StartSource::Satellite(from)),
            _ => Ok(()),
        }
    }

    /// Starts the scene at this instant, regardless of its own start. Motions without an epoch start with it.
    ///
    /// # Errors
    /// A time outside the range of scenes.
    pub fn begin(&mut self, start: Epoch) -> Result<(), SceneError> {
        self.move_start(start, StartSource::Caller)
    }

    fn move_start(&mut self, start: Epoch, from: StartSource) -> Result<(), SceneError> {
        self.time.start = start;
        self.time.start_from = from;
        self.set("time", "start", quoted(&utc(start)));
        for index in 0..self.orbits.len() {
            let table = self.orbit_table(index);
            if let Some(orbit) = self.orbits.get_mut(index)
                && let Some(motion) = &mut orbit.motion
                && let Some(record) = self.orbit_records.get_mut(table)
                && record.line("epoch").is_none()
            {
                motion.start_mut().epoch = start;
                record.set("epoch", quoted(&utc(start)));
            }
        }
        match self.time.bad_year() {
            Some(year) => Err(self.reject_time("start", utc(start), year_advice(year))),
            None => Ok(()),
        }
    }

    /// Replaces the built-in satellite at this index by a conic from the scene's start on, with a notice. Its own
    /// elements, `elements`, are valid only for `validity`.
    pub fn stand_in(&mut self, orbit: usize, elements: KeplerElements, validity: (Epoch, Epoch)) {
        let start = self.time.start;
        let table = self.orbit_table(orbit);
        let Some((slot, record)) = self
            .orbits
            .get_mut(orbit)
            .zip(self.orbit_records.get_mut(table))
        else {
            return;
        };
        for (key, text) in [
            ("source", quoted(&written(&OrbitSource::Kepler))),
            ("name", quoted(STAND_IN)),
            ("epoch", quoted(&utc(start))),
            ("frame", quoted(&written(&FrameName::Teme))),
            ("j2", Ok(true.to_string())),
        ] {
            record.set(key, text);
        }
        set_elements(record, &elements);
        *slot = Orbit {
            source: OrbitSource::Kepler,
            name: Some(STAND_IN.to_owned()),
            motion: Some(Motion::Kepler {
                start: InitialState {
                    epoch: start,
                    frame: Frame::Teme,
                    parameters: OrbitParameters::Elements(elements),
                },
                j2: true,
            }),
            ..slot.clone()
        };
        self.notices.push(format!(
            "{STAND_IN} is not where the International Space Station is at {}: the station's built-in elements are valid from {} to {}, so an orbit of its size and inclination is flown; for the station itself name elements of that time with file in [orbit]",
            utc(start),
            utc(validity.0),
            utc(validity.1)
        ));
    }

    fn reject_time(&self, key: &str, value: String, remedy: String) -> SceneError {
        let line = self.line("time", key);
        SceneError::Value {
            place: Box::new(KeyLocation {
                path: self.path.clone(),
                line,
                table: "time".to_owned(),
                key: key.to_owned(),
            }),
            value: if line.is_some() {
                value
            } else {
                format!("{value} (default)")
            },
            remedy,
        }
    }
}
