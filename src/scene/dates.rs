//! Whether an orbit answers for all of a scene's time.

use super::Scene;
use super::error::{KeyLocation, SceneError};
use super::time::utc;
use crate::frames::Epoch;

impl Scene {
    /// Refuses a scene of which any part lies outside `validity`, the first and last epoch that its orbit
    /// answers for ([`crate::orbit::Feed::validity`]).
    pub fn check_dates(&self, validity: (Epoch, Epoch)) -> Result<(), SceneError> {
        let (first, last) = validity;
        let inside = |epoch: Epoch| first <= epoch && epoch <= last;
        let validity_text = format!("the orbit answers from {} to {}", utc(first), utc(last));
        let (start, end) = (self.time.start, self.time.end());
        if !inside(start) {
            let is_file = self.orbits.iter().any(|orbit| orbit.source.is_file());
            let or = match is_file || self.orbits.is_empty() {
                true => ", or name newer elements with file in [orbit]",
                false => "",
            };
            let remedy = format!("{validity_text}; choose a start in that time{or}");
            return Err(self.refuse_time("start", utc(start), remedy));
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
            return Err(self.refuse_time("duration_s", self.time.duration_s.to_string(), remedy));
        }
        Ok(())
    }

    fn refuse_time(&self, key: &str, value: String, remedy: String) -> SceneError {
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
