//! The time line along the bottom of the window: its state, and what it says.
//!
//! | file | what |
//! |---|---|
//! | `ticks.rs` | marks at round times |
//! | `bar.rs` | what is drawn, and what the pointer does on it |
//! | `finder.rs` | passes, on a thread of their own |

mod bar;
mod finder;
mod ticks;

pub use bar::{HEIGHT, show};
pub use finder::{Answer, Finder, Order};

use super::clock::Clock;
use super::flight::Flight;
use super::place_text::place_text;
use crate::frames::{Duration, Epoch, Geodetic, rfc3339};
use crate::orbit::Pass;
use crate::scene::CameraMode;
use finder::{Lookout, Next};
use hifitime::{TimeScale, Unit};

/// How high a satellite must stand for a pass where nothing else is said, degrees.
const LEAST_ELEVATION_DEG: f64 = 10.0;
/// How far ahead the next pass is looked for, days.
const REACH_DAYS: f64 = 60.0;
/// Shortest span around the present in real time, seconds.
const REAL_TIME_SPAN_S: f64 = 5400.0;
/// How much of the span may lie behind before real time moves it on.
const REAL_TIME_PART: f64 = 0.75;
/// How much of a span that is moved to a pass lies before it.
const BEFORE_PASS: f64 = 0.05;

/// The name of the satellite that cameras fly with, and the first and last instant at which it is known.
pub type Known<'f> = (&'f str, (Epoch, Epoch));

/// What the time line knows beside the clock.
#[derive(Clone, Debug)]
pub struct TimeLine {
    /// Whether it is shown, where there is a panel.
    pub shown: bool,
    /// The place that passes are over.
    pub place: Option<Geodetic>,
    /// How high the satellite must stand there, degrees.
    pub least_elevation_deg: f64,
    /// Passes of the span.
    pub passes: Vec<Pass>,
    /// Whether the clock follows the one on the wall.
    real_time: bool,
    /// What the passes were asked for.
    asked: Option<(Lookout, (Epoch, Epoch))>,
}

impl TimeLine {
    /// As the scene has it: its passes are over the place of its geodetic camera, where it has one.
    pub fn new(flight: &Flight) -> Self {
        let scene = flight.scene();
        let camera = &scene.camera;
        let is_given = |key| scene.line("camera", key).is_some();
        let has_place =
            camera.mode == CameraMode::Geodetic || is_given("lat_deg") || is_given("lon_deg");
        Self {
            shown: true,
            place: (has_place && flight.feed().is_some())
                .then(|| Geodetic::from_degrees(camera.lat_deg, camera.lon_deg, 0.0)),
            least_elevation_deg: LEAST_ELEVATION_DEG,
            passes: Vec::new(),
            real_time: false,
            asked: None,
        }
    }

    /// Whether the clock follows the one on the wall.
    pub fn is_real_time(&self) -> bool {
        self.real_time
    }

    /// The user has set the clock: it follows no more.
    pub fn leave_real_time(&mut self) {
        self.real_time = false;
    }

    /// Begins to follow the clock on the wall, which reads `now`. `known` is the satellite's name and when it is known, if
    /// there is one. Answers what to tell, also where that is why not.
    pub fn begin_real_time(
        &mut self,
        clock: &mut Clock,
        now: Epoch,
        known: Option<Known<'_>>,
    ) -> String {
        let now = now.to_time_scale(TimeScale::TAI);
        if let Some((name, (first, last))) = known.filter(|(_, (a, b))| now < *a || now > *b) {
            return format!(
                "no real time: {name} is known from {} to {}, and it is {}; take elements of today",
                seconds(first),
                seconds(last),
                seconds(now)
            );
        }
        self.real_time = true;
        clock.set_real_time();
        clock.set_paused(false);
        surround(clock, now, known.map(|(_, span)| span));
        format!("real time: it is {}", seconds(now))
    }

    /// Sets the clock to the present, `now`, where it is followed. Answers what to tell, if it cannot be any further.
    pub fn follow(
        &mut self,
        clock: &mut Clock,
        now: Epoch,
        known: Option<Known<'_>>,
    ) -> Option<String> {
        let now = now.to_time_scale(TimeScale::TAI);
        if let Some((name, (first, last))) = known.filter(|(_, (a, b))| now < *a || now > *b) {
            self.real_time = false;
            clock.set_paused(true);
            return Some(format!(
                "real time ends: {name} is known from {} to {}",
                seconds(first),
                seconds(last)
            ));
        }
        let (first, last) = clock.span();
        let part = (now - first).to_seconds() / (last - first).to_seconds();
        if !(0.0..=REAL_TIME_PART).contains(&part) {
            surround(clock, now, known.map(|(_, span)| span));
        }
        clock.seek_to(now);
        None
    }

    fn lookout(&self) -> Option<Lookout> {
        self.place.map(|place| Lookout {
            place,
            least_elevation_rad: self.least_elevation_deg.to_radians(),
        })
    }

    /// Asks for the passes of the span, if that or the place is another than last time.
    pub fn wanted_marks(&mut self, clock: &Clock) -> Option<Order> {
        let wanted = self.lookout().map(|lookout| (lookout, clock.span()));
        if !self.shown || wanted == self.asked {
            return None;
        }
        self.asked = wanted;
        // Those of before are of another place, or drawn at another one.
        self.passes.clear();
        wanted.map(|(lookout, span)| Order::Marks(lookout, span))
    }

    /// What to ask for the next pass after the clock's instant.
    ///
    /// # Errors
    /// What to tell where there is no place or no satellite.
    pub fn next_order(&self, clock: &Clock, known: Option<Known<'_>>) -> Result<Order, String> {
        let Some((_, (_, last))) = known else {
            return Err("the scene has no satellite, so none passes".into());
        };
        let Some(lookout) = self.lookout() else {
            return Err("over which place? Write latitude and longitude into the time line".into());
        };
        let now = clock.now();
        let until = last.min(now + Duration::from_days(REACH_DAYS));
        Ok(Order::Next(lookout, (now, until)))
    }

    /// Takes what was found. Answers what to tell.
    pub fn take(
        &mut self,
        clock: &mut Clock,
        answer: Answer,
        known: Option<Known<'_>>,
    ) -> Option<String> {
        let next = match answer {
            Answer::Marks(passes) => {
                self.passes = passes;
                return None;
            }
            Answer::Next(next) => next,
        };
        let (name, validity) = known?;
        let place = self
            .place
            .map(|at| place_text(at.lat_rad, at.lon_rad))
            .unwrap_or_default();
        let least_deg = self.least_elevation_deg;
        Some(match next {
            Next::Pass(pass) => {
                self.real_time = false;
                let (first, last) = clock.span();
                if pass.begin < first || pass.end > last {
                    let length = last - first;
                    let begin = (pass.begin - length * BEFORE_PASS).max(validity.0);
                    clock.set_span(begin, (begin + length).min(validity.1));
                }
                clock.seek_to(pass.begin);
                pass_text(name, &place, &pass)
            }
            Next::Always => {
                format!("{name} always stands more than {least_deg}° above {place}")
            }
            Next::Never => {
                let until = validity
                    .1
                    .min(clock.now() + Duration::from_days(REACH_DAYS));
                format!(
                    "{name} does not rise {least_deg}° above {place} until {}",
                    seconds(until)
                )
            }
            Next::Refused(words) => words,
        })
    }
}

/// A span as long as the present one around an instant, as far as a satellite is known.
fn surround(clock: &mut Clock, now: Epoch, known: Option<(Epoch, Epoch)>) {
    let half = clock.duration_s().max(REAL_TIME_SPAN_S) * 0.5 * Unit::Second;
    let (first, last) = known.unwrap_or((now - half, now + half));
    clock.set_span((now - half).max(first), (now + half).min(last));
    clock.seek_to(now);
}

/// Without decimals of the second.
fn seconds(epoch: Epoch) -> String {
    let text = rfc3339(epoch);
    match text.split_once('.') {
        Some((whole, _)) => format!("{whole}Z"),
        None => text,
    }
}

fn pass_text(name: &str, place: &str, pass: &Pass) -> String {
    let day_and_time = seconds(pass.begin);
    let time = |epoch| {
        let text = seconds(epoch);
        text.split_once('T')
            .map_or(text.clone(), |(_, time)| time.to_owned())
    };
    format!(
        "{name} over {place}: {day_and_time} to {}, {:.0}° high at {}",
        time(pass.end),
        pass.elevation_rad.to_degrees(),
        time(pass.highest)
    )
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
