//! The time line along the bottom of the window: its state and labels.
//!
//! | file | content |
//! |---|---|
//! | `ticks.rs` | marks at round times |
//! | `bar.rs` | drawing, and pointer interaction |
//! | `fields.rs` | text fields for a date and a place |
//! | `entry.rs` | dates and places from text |
//! | `zoom.rs` | the visible part of the span |
//! | `light.rs` | night below the satellite, and the Earth's shadow |
//! | `pass_search.rs` | passes and light, on a separate thread |

mod bar;
mod entry;
mod fields;
mod light;
mod pass_search;
mod ticks;
mod zoom;

pub use bar::show;
pub use pass_search::{PassQuery, PassResult, PassSearch};

use super::clock::Clock;
use super::flight::Flight;
use super::place_names::shipped_names;
use super::place_text::place_text;
use crate::scene::CameraMode;
use hifitime::{TimeScale, Unit};
use light::LightBands;
use pass_search::{PassSite, Upcoming};
use std::sync::Arc;
use terrella::frames::{Duration, Epoch, Geodetic, rfc3339};
use terrella::tracks::NamedPlace;
use terrella_orbit::{Feed, Pass};
use zoom::Zoom;

/// Minimum elevation of a pass where nothing else is said, degrees.
const DEFAULT_MIN_ELEVATION_DEG: f64 = 10.0;
/// How far ahead the next pass is looked for, days.
const NEXT_PASS_SEARCH_DAYS: f64 = 60.0;
/// Shortest span around the present in real time, seconds.
const REAL_TIME_SPAN_S: f64 = 5400.0;
/// Fraction of the span before now at which real time scrolls it.
const REAL_TIME_MAX_FRACTION: f64 = 0.75;
/// Fraction of a span before the pass that it is moved to.
const PASS_LEAD_FRACTION: f64 = 0.05;

/// Least time in which a pass that was looked for is played, seconds.
const PASS_PLAYBACK_S: f64 = 20.0;

/// The satellite that cameras fly with, and when it is known.
#[derive(Clone, Copy, Debug)]
pub struct Coverage<'f> {
    /// The satellite.
    pub name: &'f str,
    /// The first instant at which it is known.
    pub first: Epoch,
    pub last: Epoch,
}

impl<'f> Coverage<'f> {
    pub fn of(feed: &'f dyn Feed) -> Self {
        let (first, last) = feed.validity();
        Self {
            name: feed.name(),
            first,
            last,
        }
    }

    fn contains(&self, epoch: Epoch) -> bool {
        (self.first..=self.last).contains(&epoch)
    }
}

/// State of the time line besides the clock.
#[derive(Clone, Debug)]
pub struct TimeLine {
    /// Whether it is shown, where there is a panel.
    pub shown: bool,
    /// The place that passes are over.
    pub place: Option<Geodetic>,
    /// Cities that can be chosen by name, the most important first.
    pub cities: Arc<[NamedPlace]>,
    /// Minimum elevation of a pass over it, degrees.
    pub min_elevation_deg: f64,
    /// Whether only visible passes are shown.
    pub visible_only: bool,
    /// Passes of the span.
    pub passes: Vec<Pass>,
    /// Night and shadow in the span.
    pub light: LightBands,
    zoom: Option<Zoom>,
    /// Whether the clock follows the real clock.
    real_time: bool,
    /// Query of the current passes.
    asked: Option<(PassSite, (Epoch, Epoch))>,
    /// The span that the present light was searched for.
    asked_light: Option<(Epoch, Epoch)>,
    has_satellite: bool,
}

impl TimeLine {
    /// The initial state from the scene: passes are over its first ground station, else over the place of its geodetic camera, if it has one.
    pub fn new(flight: &Flight) -> Self {
        let scene = flight.scene();
        let camera = &scene.camera;
        let is_given = |key| scene.line("camera", key).is_some();
        let has_place =
            camera.mode == CameraMode::Geodetic || is_given("lat_deg") || is_given("lon_deg");
        let of_camera =
            has_place.then(|| Geodetic::from_degrees(camera.lat_deg, camera.lon_deg, 0.0));
        let station = scene.stations.first();
        let place = station.map(|one| one.place).or(of_camera);
        Self {
            shown: true,
            place: place.filter(|_| flight.feed().is_some()),
            cities: shipped_names().into(),
            min_elevation_deg: station
                .map_or(DEFAULT_MIN_ELEVATION_DEG, |one| one.min_elevation_deg),
            visible_only: false,
            passes: Vec::new(),
            light: LightBands::default(),
            zoom: None,
            real_time: false,
            asked: None,
            asked_light: None,
            has_satellite: flight.feed().is_some(),
        }
    }

    /// Whether the clock follows the real clock.
    pub fn is_real_time(&self) -> bool {
        self.real_time
    }

    /// Stops following the real clock, after the user has set the clock.
    pub fn leave_real_time(&mut self) {
        self.real_time = false;
    }

    /// Begins to follow the real clock, which reads `now`. `coverage` is the satellite's, if
    /// there is one. Answers the message to show, also where it cannot.
    pub fn begin_real_time(
        &mut self,
        clock: &mut Clock,
        now: Epoch,
        coverage: Option<Coverage<'_>>,
    ) -> String {
        let now = now.to_time_scale(TimeScale::TAI);
        if let Some(outside) = coverage.filter(|coverage| !coverage.contains(now)) {
            return format!(
                "no real time: {} is known from {} to {}, and it is {}; take elements of today",
                outside.name,
                seconds(outside.first),
                seconds(outside.last),
                seconds(now)
            );
        }
        self.real_time = true;
        clock.set_real_time();
        clock.set_paused(false);
        center_span_on(clock, now, coverage);
        format!("real time: it is {}", seconds(now))
    }

    /// Sets the clock to the present, `now`, where it is followed. Answers the message to show if it cannot be any further.
    pub fn follow(
        &mut self,
        clock: &mut Clock,
        now: Epoch,
        coverage: Option<Coverage<'_>>,
    ) -> Option<String> {
        let now = now.to_time_scale(TimeScale::TAI);
        if let Some(outside) = coverage.filter(|coverage| !coverage.contains(now)) {
            self.real_time = false;
            clock.set_paused(true);
            return Some(format!(
                "real time ends: {} is known from {} to {}",
                outside.name,
                seconds(outside.first),
                seconds(outside.last)
            ));
        }
        let (first, last) = clock.span();
        let elapsed_fraction = (now - first).to_seconds() / (last - first).to_seconds();
        if !(0.0..=REAL_TIME_MAX_FRACTION).contains(&elapsed_fraction) {
            center_span_on(clock, now, coverage);
        }
        clock.seek_to(now);
        None
    }

    /// Sets the clock to a date. A span that does not hold it is moved, as long as it is. Answers the message to show if the
    /// satellite is not known then.
    pub fn go_to(
        &mut self,
        clock: &mut Clock,
        to: Epoch,
        coverage: Option<Coverage<'_>>,
    ) -> Option<String> {
        let to = to.to_time_scale(TimeScale::TAI);
        if let Some(outside) = coverage.filter(|coverage| !coverage.contains(to)) {
            return Some(format!(
                "{} is known from {} to {}, and not at {}",
                outside.name,
                seconds(outside.first),
                seconds(outside.last),
                seconds(to)
            ));
        }
        let (first, last) = clock.span();
        if !(first..=last).contains(&to) {
            let half = (last - first) * 0.5;
            let (mut first, mut last) = (to - half, to + half);
            if let Some(coverage) = coverage {
                (first, last) = (first.max(coverage.first), last.min(coverage.last));
            }
            clock.set_span(first, last);
        }
        clock.seek_to(to);
        None
    }

    /// The part of the span that is shown, 0…1.
    pub fn part(&self, clock: &Clock) -> (f64, f64) {
        Zoom::part(self.zoom, clock.span())
    }

    /// Zooms by `factor` about a fraction of the span, and shifts by the fraction `by` of the visible part.
    pub fn zoom(&mut self, clock: &Clock, at: f64, factor: f64, by: f64) {
        self.zoom = Zoom::changed(self.zoom, clock.span(), at, factor, by);
    }

    /// Moves what is shown so that the clock's instant is in it.
    pub fn show_now(&mut self, clock: &Clock) {
        self.zoom = Zoom::showing(self.zoom, clock.span(), clock.progress());
    }

    /// The query for night and shadow in the span, if that is another than last time.
    pub fn light_query(&mut self, clock: &Clock) -> Option<PassQuery> {
        let span = clock.span();
        if !self.shown || !self.has_satellite || self.asked_light == Some(span) {
            return None;
        }
        self.asked_light = Some(span);
        self.light = LightBands::default();
        Some(PassQuery::Light(span))
    }

    /// Computes night and shadow in the span synchronously.
    #[cfg(test)]
    pub fn find_light(&mut self, flight: &Flight, clock: &Clock) {
        self.light = LightBands::of(flight, clock.span(), &|| true).unwrap_or_default();
    }

    fn site(&self) -> Option<PassSite> {
        self.place.map(|place| PassSite {
            place,
            min_elevation_rad: self.min_elevation_deg.to_radians(),
            is_visible: self.visible_only,
        })
    }

    /// The query for the passes of the span, if that or the place is another than last time.
    pub fn passes_query(&mut self, clock: &Clock) -> Option<PassQuery> {
        let wanted = self.site().map(|site| (site, clock.span()));
        if !self.shown || wanted == self.asked {
            return None;
        }
        self.asked = wanted;
        // Those of before are of another place, or drawn at another one.
        self.passes.clear();
        wanted.map(|(site, span)| PassQuery::InSpan(site, span))
    }

    /// The query for the next pass after the clock's instant.
    ///
    /// # Errors
    /// The message to show where there is no place or no satellite.
    pub fn next_pass_query(
        &self,
        clock: &Clock,
        coverage: Option<Coverage<'_>>,
    ) -> Result<PassQuery, String> {
        let Some(coverage) = coverage else {
            return Err("the scene has no satellite, so none passes".into());
        };
        let Some(site) = self.site() else {
            return Err(
                "over which place? Type its latitude and longitude, or click on the ground".into(),
            );
        };
        let now = clock.now();
        let until = coverage
            .last
            .min(now + Duration::from_days(NEXT_PASS_SEARCH_DAYS));
        Ok(PassQuery::Next(site, (now, until)))
    }

    /// Takes what a search has found. Answers the message to show.
    pub fn receive(
        &mut self,
        clock: &mut Clock,
        found: PassResult,
        coverage: Option<Coverage<'_>>,
    ) -> Option<String> {
        let next = match found {
            PassResult::InSpan(passes) => {
                self.passes = passes;
                return None;
            }
            PassResult::Light(light) => {
                self.light = light;
                return None;
            }
            PassResult::Next(next) => next,
        };
        let coverage = coverage?;
        let name = coverage.name;
        let place = self
            .place
            .map(|at| place_text(at.lat_rad, at.lon_rad))
            .unwrap_or_default();
        let min_elevation_deg = self.min_elevation_deg;
        Some(match next {
            Upcoming::Pass(pass) => {
                self.real_time = false;
                let (first, last) = clock.span();
                if pass.begin < first || pass.end > last {
                    let length = last - first;
                    let begin = (pass.begin - length * PASS_LEAD_FRACTION).max(coverage.first);
                    clock.set_span(begin, (begin + length).min(coverage.last));
                }
                clock.seek_to(pass.begin);
                play_pass(clock, &pass);
                format!("{}. Space plays it", pass_text(name, &place, &pass))
            }
            Upcoming::AlwaysAbove => {
                format!("{name} always stands more than {min_elevation_deg}° above {place}")
            }
            Upcoming::NoneFound => {
                let until = coverage
                    .last
                    .min(clock.now() + Duration::from_days(NEXT_PASS_SEARCH_DAYS));
                let what = match self.visible_only {
                    true => "is not visible",
                    false => "does not rise",
                };
                format!(
                    "{name} {what} {min_elevation_deg}° above {place} until {}",
                    seconds(until)
                )
            }
            Upcoming::Failed(message) => message,
        })
    }
}

/// Has the clock stand at the beginning of a pass, and play it alone, slowly enough to be watched.
fn play_pass(clock: &mut Clock, pass: &Pass) {
    let (first, _) = clock.span();
    let part = |epoch: Epoch| (epoch - first).to_seconds() / clock.duration_s();
    let (from, to) = (part(pass.begin), part(pass.end));
    clock.clear_range();
    clock.set_range_start(from);
    clock.set_range_end(to);
    let length_s = (pass.end - pass.begin).to_seconds();
    let slowest = (length_s / PASS_PLAYBACK_S).floor().max(1.0);
    if clock.speed().abs() > slowest {
        clock.set_rate(slowest);
    }
    clock.set_paused(true);
}

/// Centres a span of the same length on a time, within the satellite's validity.
fn center_span_on(clock: &mut Clock, now: Epoch, coverage: Option<Coverage<'_>>) {
    let half = clock.duration_s().max(REAL_TIME_SPAN_S) * 0.5 * Unit::Second;
    let (mut first, mut last) = (now - half, now + half);
    if let Some(coverage) = coverage {
        (first, last) = (first.max(coverage.first), last.min(coverage.last));
    }
    clock.set_span(first, last);
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
#[path = "timeline/tests.rs"]
mod tests;
