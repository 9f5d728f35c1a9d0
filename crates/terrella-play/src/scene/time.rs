//! `[time]`: the start of the flight and its playback.

use super::error::SceneError;
use super::field::{Field, PathKind, range_text};
use super::keys::{DEFAULT_START, MAX_FRAMES, RawTime, YEARS};
use super::record::quoted;
use super::text::SceneText;
use hifitime::Unit;
use std::path::PathBuf;
use terrella::frames::{Duration, Epoch, rfc3339, utc_from_text, utc_now};
use toml::Spanned;

/// `[time]`: the start of the flight and its playback.
#[derive(Clone, Debug, PartialEq)]
pub struct Time {
    /// UTC instant of the first frame. Where [`Self::start_from`] is [`StartSource::Default`] it is not final before the
    /// satellites are opened: one of them may have a time of its own ([`Scene::begin_at`](super::Scene::begin_at)).
    pub start: Epoch,
    /// Where `start` is from.
    pub start_from: StartSource,
    /// Simulated seconds that are played, > 0.
    pub duration_s: f64,
    /// Simulated seconds per second of playback; negative plays backwards, never 0.
    pub speed: f64,
    /// Frames per second of playback.
    pub frame_rate_hz: f64,
    /// Table of the Earth's orientation by date; `None` takes UT1 as UTC and leaves polar motion out.
    pub orientation: Option<PathBuf>,
    /// Times between start and end that playback leaves out, ascending: the satellite that cameras fly with is not known in them. Empty
    /// before the satellites are opened.
    pub left_out: Vec<(Epoch, Epoch)>,
}

/// Source of a scene's first instant.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum StartSource {
    /// The scene gives it.
    Given,
    /// The scene says "now": the system's clock when it was read.
    Clock,
    /// The caller gives it instead of the scene ([`Scene::begin`](super::Scene::begin)).
    Caller,
    /// The scene does not give it, and no opened satellite has its own time.
    #[default]
    Default,
    /// The scene does not give it, but a satellite has its own time; the text describes it.
    Satellite(String),
}

impl Time {
    /// UTC instant at which playback ends: before `start` for a negative speed.
    pub fn end(&self) -> Epoch {
        self.start + self.duration_s.copysign(self.speed) * Unit::Second
    }

    /// The first played instant, and the one `length` later or the last.
    pub fn span(&self, length: Option<Duration>) -> (Epoch, Epoch) {
        let first = self.start.min(self.end());
        let last = self.start.max(self.end());
        (first, length.map_or(last, |length| first + length))
    }

    /// (duration_s − skipped time) · frame_rate_hz / |speed|, before rounding.
    pub(super) fn frames_exact(&self) -> f64 {
        let left_out = self.left_out.iter().map(|(from, to)| *to - *from);
        let left_out_s: f64 = left_out.map(|time| time.to_seconds()).sum();
        (self.duration_s - left_out_s) * self.frame_rate_hz / self.speed.abs()
    }

    /// The instant after this many simulated seconds of playback; before the start for a negative speed.
    pub(crate) fn epoch_after(&self, played_s: f64) -> Epoch {
        let mut epoch = self.start + played_s * Unit::Second;
        if self.speed < 0.0 {
            for (from, to) in self.left_out.iter().rev() {
                epoch = if epoch < *to {
                    epoch - (*to - *from)
                } else {
                    epoch
                };
            }
        } else {
            for (from, to) in &self.left_out {
                epoch = if epoch > *from {
                    epoch + (*to - *from)
                } else {
                    epoch
                };
            }
        }
        epoch
    }

    /// The number of the frame nearest to an instant. It wraps if that is before the first, or beyond 2³².
    pub fn nearest_frame(&self, epoch: Epoch) -> u32 {
        let frame_s = self.speed / self.frame_rate_hz;
        let mut after = epoch - self.start;
        for (from, to) in &self.left_out {
            // The part between the start and the instant.
            let (first, last) = (self.start.min(epoch), self.start.max(epoch));
            let length = (*to).min(last) - (*from).max(first);
            if length > Duration::ZERO {
                after = if epoch > self.start {
                    after - length
                } else {
                    after + length
                };
            }
        }
        (after.to_unit(Unit::Second) / frame_s).round() as i64 as u32
    }

    /// The year of its start or end that is outside the range of scenes.
    pub(super) fn bad_year(&self) -> Option<i32> {
        let years = [self.start, self.end()].map(|epoch| epoch.to_gregorian_utc().0);
        years.into_iter().find(|year| !YEARS.contains(year))
    }

    /// Frames of one playback, at least one.
    pub fn frame_count(&self) -> u64 {
        // At most [`MAX_FRAMES`] by the scene's checks; `as` saturates for manually created values.
        self.frames_exact().round().max(1.0) as u64
    }
}

impl SceneText<'_> {
    /// Checks `[time]`.
    pub(super) fn time(&self, time: &RawTime) -> Result<Time, SceneError> {
        let start_field = time.start();
        let default_start =
            utc_from_text(DEFAULT_START).map_err(|error| self.reject(&start_field, error))?;
        let (start, start_from) = match start_field.given.map(Spanned::get_ref) {
            None => (default_start, StartSource::Default),
            Some(value) if is_now(value) => (
                utc_now().map_err(|error| self.reject(&start_field, error))?,
                StartSource::Clock,
            ),
            Some(_) => (
                self.instant(&start_field, default_start)?,
                StartSource::Given,
            ),
        };
        start_field.note(quoted(&utc(start)));
        let (duration, speed_field) = (time.duration_s(), time.speed());
        let most_s = *duration.rule.range.end();
        let duration_s = self.number(&duration, |_, _| {
            format!("must be more than 0 and at most {most_s} seconds")
        })?;
        let speed = self.number(&speed_field, |_, range| {
            format!("must be from {range} simulated seconds per second")
        })?;
        if speed == 0.0 {
            return Err(self.reject(
                &speed_field,
                "a scene at speed 0 would never end; give 1 for real time, a negative speed to play backwards",
            ));
        }
        let frame_rate_hz = self.number(&time.frame_rate_hz(), |_, range| {
            format!("must be from {range} frames per second")
        })?;
        let time = Time {
            start,
            start_from,
            duration_s,
            speed,
            frame_rate_hz,
            orientation: self.path(
                &time.orientation(),
                PathKind::File,
                "UT1 is taken as UTC and polar motion as none",
            )?,
            left_out: Vec::new(),
        };
        if time.frames_exact() > MAX_FRAMES {
            let advice = format!(
                "duration_s {duration_s} × frame_rate_hz {frame_rate_hz} / speed {} makes more than {MAX_FRAMES} frames; \
                 shorten the duration, lower the frame rate or raise the speed",
                speed.abs()
            );
            // With the default duration only slow motion reaches this, so the reported field is a given one.
            let guilty = if speed.abs() < 1.0 {
                &speed_field
            } else {
                &duration
            };
            return Err(self.reject(guilty, advice));
        }
        if let Some(year) = time.bad_year() {
            let advice = year_advice(year);
            return Err(match duration.is_given() {
                true => self.reject(&duration, advice),
                false => self.reject(&start_field, advice),
            });
        }
        Ok(time)
    }

    /// Reads a UTC instant, given as a string or as a TOML date-time.
    pub(super) fn instant(
        &self,
        field: &Field<'_, toml::Value>,
        default: Epoch,
    ) -> Result<Epoch, SceneError> {
        const ADVICE: &str = "write UTC like \"2018-01-15T12:00:00Z\"";
        let text = match field.given.map(Spanned::get_ref) {
            None => return Ok(default),
            Some(toml::Value::String(text)) => text.clone(),
            Some(toml::Value::Datetime(when)) => {
                if when.date.is_none() {
                    return Err(self.reject(field, format!("must have a date; {ADVICE}")));
                }
                when.to_string()
            }
            Some(_) => {
                return Err(self.reject(
                    field,
                    format!("must be a date, with or without a time of day; {ADVICE}"),
                ));
            }
        };
        utc_from_text(&text).map_err(|error| self.reject(field, error))
    }
}

fn is_now(value: &toml::Value) -> bool {
    value.as_str() == Some("now")
}

pub(super) fn year_advice(year: i32) -> String {
    format!(
        "the flight would reach the year {year}; it must stay in the years {}",
        range_text(&YEARS)
    )
}

/// An instant in scene syntax: RFC 3339, without fractional seconds if they are 0.
pub(super) fn utc(epoch: Epoch) -> String {
    let text = rfc3339(epoch);
    match text.strip_suffix(".000Z") {
        Some(whole) => format!("{whole}Z"),
        None => text,
    }
}
