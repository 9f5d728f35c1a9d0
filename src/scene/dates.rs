//! The scene's span of time, and whether an orbit answers for all of it.

use super::error::{Place, SceneError};
use super::{Scene, Time};
use crate::frames::{Epoch, rfc3339};
use hifitime::Unit;

impl Time {
    /// UTC instant at which playback ends: before `start` where the speed is negative.
    pub fn end(&self) -> Epoch {
        self.start + self.duration_s.copysign(self.speed) * Unit::Second
    }

    /// duration_s · frame_rate_hz / |speed|, before it is made a whole number.
    pub(super) fn frames_exact(&self) -> f64 {
        self.duration_s * self.frame_rate_hz / self.speed.abs()
    }

    /// Frames of one playback, at least one.
    pub fn frame_count(&self) -> u64 {
        // At most `limits::MAX_FRAMES` by the scene's checks; `as` saturates for a hand-made value.
        self.frames_exact().round().max(1.0) as u64
    }
}

impl Scene {
    /// Refuses a scene of which any part lies outside `validity`, the first and last epoch that its orbit
    /// answers for ([`crate::orbit::Feed::validity`]).
    pub fn check_dates(&self, validity: (Epoch, Epoch)) -> Result<(), SceneError> {
        let (first, last) = validity;
        let inside = |epoch: Epoch| first <= epoch && epoch <= last;
        let reach = format!("the orbit answers from {} to {}", utc(first), utc(last));
        let (start, end) = (self.time.start, self.time.end());
        if !inside(start) {
            let is_file = self.orbits.iter().any(|orbit| orbit.source.is_file());
            let or = match is_file || self.orbits.is_empty() {
                true => ", or name newer elements with file in [orbit]",
                false => "",
            };
            let remedy = format!("{reach}; choose a start in that time{or}");
            return Err(self.refuse_time("start", utc(start), remedy));
        }
        if !inside(end) {
            let room_s = if self.time.speed > 0.0 {
                (last - start).to_seconds()
            } else {
                (start - first).to_seconds()
            };
            let remedy = format!(
                "the flight from {} would end at {}, but {reach}; make it at most {} seconds or choose another start",
                utc(start),
                utc(end),
                room_s.floor()
            );
            return Err(self.refuse_time("duration_s", self.time.duration_s.to_string(), remedy));
        }
        Ok(())
    }

    fn refuse_time(&self, key: &str, value: String, remedy: String) -> SceneError {
        let line = self.line("time", key);
        SceneError::Value {
            place: Box::new(Place {
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

/// An instant as a scene would write it: RFC 3339, without decimals of the second where they are all 0.
pub(super) fn utc(epoch: Epoch) -> String {
    let text = rfc3339(epoch);
    match text.strip_suffix(".000Z") {
        Some(whole) => format!("{whole}Z"),
        None => text,
    }
}
