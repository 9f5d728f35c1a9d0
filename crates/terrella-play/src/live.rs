//! Scenes whose time a simulator controls: the time of an image, replies to simulators, and status in the window.

use super::camera::HeadTurn;
use super::error::PlayError;
use super::flight::{Flight, Moment, ViewRequest};
use super::keys::Action;
use super::live_status::LiveStatus;
use crate::scene::CameraMode;
use std::time::{Duration, Instant};
use terrella::frames::Epoch;
use terrella_orbit::basilisk::{Meeting, Simulation, StepPace, StepRequest};
use terrella_orbit::live::{FrameRequest, LiveFeed, Pacing, PacketCounters};
use terrella_orbit::{Feed, Freshness};

/// How often a window without a picture to draw polls for a simulator's next frame.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(4);
/// Interval at which a paused window checks the age of its states.
const AGE_CHECK_INTERVAL: Duration = Duration::from_millis(250);

/// The window's time where a simulator gives it.
pub(super) struct LivePlay<'f> {
    flight: &'f Flight,
    feed: &'f LiveFeed,
    /// A frame that a simulator waits for and that is not drawn yet.
    request: Option<FrameRequest>,
    /// The last picture in which the satellite was where its simulator said.
    last: Option<Moment>,
    /// The instant at which the user stopped the picture.
    held: Option<Epoch>,
    /// Why the last requested image could not be drawn.
    fault: Option<String>,
    age_checked: Instant,
}

impl<'f> LivePlay<'f> {
    /// `None` for scenes that have their own time.
    pub fn of(flight: &'f Flight) -> Option<Self> {
        Some(Self {
            flight,
            feed: flight.live_clock()?,
            request: None,
            last: None,
            held: None,
            fault: None,
            age_checked: Instant::now(),
        })
    }

    fn is_lockstep(&self) -> bool {
        self.feed.options().pacing == Pacing::Lockstep
    }

    /// Whether a new image is due. If the window is hidden, pending requests are rejected.
    pub fn is_due(&mut self, is_hidden: bool, is_paused: bool) -> bool {
        if !self.is_lockstep() && !is_paused {
            return !is_hidden;
        }
        if is_hidden {
            let waiting = self.request.take().into_iter();
            for request in waiting.chain(std::iter::from_fn(|| self.feed.next_request())) {
                self.feed
                    .reject(&request, "the window is hidden, nothing is drawn");
            }
            return false;
        }
        self.request = self.request.or_else(|| self.feed.next_request());
        let is_time = self.age_checked.elapsed() > AGE_CHECK_INTERVAL;
        if is_time {
            self.age_checked = Instant::now();
        }
        self.request.is_some() || is_time
    }

    /// Time for which the window may sleep before the next check; `None` draws continuously.
    pub fn pause(&self, is_paused: bool) -> Option<Duration> {
        match (self.is_lockstep(), is_paused) {
            (true, _) => Some(POLL_INTERVAL),
            (false, true) => Some(AGE_CHECK_INTERVAL),
            (false, false) => None,
        }
    }

    /// Simulated seconds per second, if time runs uniformly.
    pub fn rate(&self) -> Option<f64> {
        (!self.is_lockstep()).then_some(self.feed.options().rate)
    }

    /// The picture of now. There always is one: of the last instant that the satellite is known at, and before there is
    /// any, of the Earth without it.
    pub fn moment(&mut self, view: &ViewRequest, is_paused: bool) -> Moment {
        let epoch = match (self.is_lockstep(), is_paused) {
            (true, _) => self.request.map(|request| request.state.epoch),
            (false, true) => self.held.or_else(|| self.feed.playback_epoch()),
            (false, false) => self.feed.playback_epoch(),
        };
        self.held = epoch.filter(|_| is_paused);
        let asked = epoch.map(|epoch| self.flight.view_at(epoch, view));
        let drawn = match asked {
            Some(Ok(moment)) => {
                self.fault = None;
                self.last = Some(moment);
                return moment;
            }
            Some(Err(error)) => {
                self.reject(&error);
                self.fault = Some(error.to_string());
                self.last.map(|last| last.epoch)
            }
            // In lockstep the previous frame stays on screen.
            None => self.last.map(|last| last.epoch),
        };
        // The same instant, as the user looks at it now.
        let again = drawn.map(|epoch| self.flight.view_at(epoch, view));
        match (again, self.last) {
            (Some(Ok(moment)), _) => moment,
            // Its states are forgotten: a simulator that began again.
            (_, Some(last)) => last,
            (_, None) => {
                let epoch = epoch.unwrap_or(self.flight.scene().time.start);
                self.flight.without_satellite(epoch, view)
            }
        }
    }

    /// The picture is on its way to the screen.
    pub fn drawn(&mut self) {
        self.age_checked = Instant::now();
        if let Some(request) = self.request.take() {
            self.feed.acknowledge(&request);
        }
    }

    fn reject(&mut self, error: &PlayError) {
        if let Some(request) = self.request.take() {
            self.feed.reject(&request, &error.to_string());
        }
    }

    /// The message for an action that only the simulator can perform; `None` for other actions.
    pub fn denial(&self, action: Action) -> Option<String> {
        let what = match action {
            Action::Pause if self.is_lockstep() => "stopped",
            Action::Faster | Action::Slower | Action::Rate(_) => "made faster or slower",
            Action::Reverse => "turned round",
            Action::Seek(_)
            | Action::Skip(_)
            | Action::Step(_)
            | Action::GoTo(_)
            | Action::NextPass => "moved",
            Action::Loop | Action::RangeStart(_) | Action::RangeEnd(_) | Action::RangeAll => {
                "played in parts"
            }
            Action::RealTime | Action::SceneSpan | Action::TimeLine => "set by another clock",
            _ => return None,
        };
        let listens_on = self.feed.listens_on();
        Some(format!(
            "time comes from the simulator on {listens_on} and cannot be {what} here; do it there"
        ))
    }

    /// The state of the simulators, for the panel.
    pub fn status(&self, is_paused: bool) -> LiveStatus {
        let feeds = || self.flight.satellites().iter().filter_map(|one| one.live());
        let several = feeds().nth(1).is_some();
        let rows = feeds().flat_map(|feed| rows(feed, several)).collect();
        let pace = match self.is_lockstep() {
            true => "in lockstep".to_owned(),
            false if is_paused => "live, held here".to_owned(),
            false => format!("{} × real time, live", self.feed.options().rate),
        };
        LiveStatus {
            name: self.followed_name(),
            pace,
            rows,
            notice: self.notice(),
        }
    }

    fn followed_name(&self) -> String {
        let followed = self.flight.feed();
        followed.map_or_else(String::new, |feed| feed.name().to_owned())
    }

    fn notice(&self) -> Option<String> {
        let listens_on = self.feed.listens_on();
        let (what, came) = match self.is_lockstep() {
            true => ("frames", "frame was asked for"),
            false => ("states", "state came"),
        };
        match self.feed.freshness() {
            Freshness::Waiting => Some(format!("waiting for {what} on {listens_on}")),
            Freshness::Stale { age_s } => Some(format!("stale: the last {came} {age_s:.1} s ago")),
            _ => self.fault.clone(),
        }
    }
}

/// The panel's lines about one feed.
fn rows(feed: &LiveFeed, is_named: bool) -> Vec<(&'static str, String)> {
    let counters = feed.counters();
    let age = match (feed.freshness(), feed.age()) {
        (Freshness::Stale { age_s }, _) => format!("STALE, {age_s:.1} s old"),
        (_, Some(age)) => format!("live, {:.1} s old", age.as_secs_f64()),
        (_, None) => "nothing has come yet".to_owned(),
    };
    let listens_on = feed.listens_on();
    let source = match is_named {
        true => format!("{}, {listens_on}", feed.name()),
        false => listens_on.to_string(),
    };
    let mut rows = vec![("source", source), ("states", age)];
    rows.push(("packets", packets_text(&counters)));
    if feed.options().pacing == Pacing::Lockstep {
        let late = match counters.timed_out {
            0 => String::new(),
            late => format!(", {late} too late"),
        };
        rows.push(("frames", format!("{} drawn{late}", counters.drawn)));
    }
    rows
}

/// Numbers of packets received, and of bad and dropped ones if there are any.
fn packets_text(counters: &PacketCounters) -> String {
    let dropped = [
        (counters.bad, "bad"),
        (counters.over_rate, "over the rate"),
        (counters.duplicates, "doubled"),
        (counters.too_late + counters.apart, "out of time"),
    ];
    let dropped = dropped.iter().filter(|(count, _)| *count > 0);
    let dropped: Vec<_> = dropped
        .map(|(count, why)| format!("{count} {why}"))
        .collect();
    let lost = match counters.lost {
        0 => String::new(),
        lost => format!("; {lost} never came"),
    };
    match dropped.is_empty() {
        true => format!("{} taken, none dropped{lost}", counters.taken),
        false => format!(
            "{} taken; dropped: {}{lost}",
            counters.taken,
            dropped.join(", ")
        ),
    }
}

impl Flight {
    /// The feed whose simulator controls the time of all images: the one in lockstep, else the followed satellite's, else the first. `None` if the
    /// scene has its own time.
    pub fn live_clock(&self) -> Option<&LiveFeed> {
        let live = || self.satellites().iter().filter_map(|one| one.live());
        let waits = live().find(|feed| feed.options().pacing == Pacing::Lockstep);
        let followed = || self.satellites().get(self.followed())?.live();
        waits.or_else(followed).or_else(|| live().next())
    }

    /// Rejects a scene whose time a simulator controls, for operations that need their own time.
    ///
    /// # Errors
    /// Names the operation and the remedy.
    pub fn reject_live(&self, work: &'static str, remedy: &'static str) -> Result<(), PlayError> {
        let simulation = self.simulation().map(|one| one.endpoint().to_string());
        let feed = || Some(self.live_clock()?.listens_on().to_string());
        match simulation.or_else(feed) {
            None => Ok(()),
            Some(listens_on) => Err(PlayError::Live {
                scene: self.scene().path.clone(),
                listens_on,
                work,
                remedy,
            }),
        }
    }

    /// Whether a simulator controls the time of all images.
    pub fn is_timed_by_simulator(&self) -> bool {
        self.simulation().is_some() || self.live_clock().is_some()
    }

    /// The view where the satellite is not known: above the place of a geodetic camera, by default the whole disc.
    pub(super) fn without_satellite(&self, epoch: Epoch, view: &ViewRequest) -> Moment {
        let request = ViewRequest {
            mode: CameraMode::Geodetic,
            ..*view
        };
        self.moment(epoch, &request, self.ground_pose(), None)
    }

    /// Waits for the next image of a simulator: in lockstep the next requested one; in broadcast the current one, once there is a state. At most
    /// for the scene's timeout.
    ///
    /// # Errors
    /// If nothing arrives, or the satellite has no state at the time; a pending request is then rejected.
    pub(super) fn await_moment(
        &self,
        aspect: f64,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<(Moment, Option<AwaitedFrame<'_>>), PlayError> {
        if let Some(simulation) = self.simulation() {
            return self.await_step(simulation, aspect, is_cancelled);
        }
        let feed = self.live_clock().ok_or(PlayError::NoSatellite)?;
        let (epoch, asked) = match self.wait_for_input(feed, is_cancelled) {
            Some(LiveInput::Frame(request)) => (
                request.state.epoch,
                Some(AwaitedFrame::Frame { feed, request }),
            ),
            Some(LiveInput::Time(epoch)) => (epoch, None),
            None => {
                return Err(PlayError::Silent {
                    listens_on: feed.listens_on().to_string(),
                    when: match feed.has_ended() {
                        true => "before its end".to_owned(),
                        false => format!("within {} s", self.scene().output.wait_s),
                    },
                });
            }
        };
        match self.at(epoch, aspect) {
            Ok(moment) => Ok((moment, asked)),
            Err(error) => {
                if let Some(asked) = asked {
                    asked.reject(&error.to_string());
                }
                Err(error)
            }
        }
    }

    /// Waits for a simulation's next step, which is pending until it is drawn; in subscriber mode for the latest one.
    fn await_step<'f>(
        &self,
        simulation: &'f Simulation,
        aspect: f64,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<(Moment, Option<AwaitedFrame<'f>>), PlayError> {
        simulation.set_pace(StepPace::Drawn);
        let publishes = matches!(simulation.options().meeting, Meeting::Subscribe(_));
        let (wait, begun) = (self.scene().output.wait(), Instant::now());
        let request = ViewRequest {
            mode: self.scene().camera.mode,
            look: HeadTurn::default(),
            aspect,
        };
        loop {
            if publishes && let Some(latest) = simulation.latest() {
                return Ok((self.simulated(&latest, &request)?, None));
            }
            if let Some(step) = simulation.next_step(POLL_INTERVAL) {
                let moment = self.simulated(&step.snapshot, &request)?;
                return Ok((moment, Some(AwaitedFrame::Step(step))));
            }
            if publishes {
                std::thread::sleep(POLL_INTERVAL);
            }
            let counters = simulation.counters();
            let has_left = counters.steps > 0 && counters.connected == 0;
            let has_ended = has_left || simulation.is_over();
            if is_cancelled() || has_ended || begun.elapsed() >= wait {
                return Err(PlayError::Silent {
                    listens_on: simulation.endpoint().to_string(),
                    when: match has_ended {
                        true => "before its end".to_owned(),
                        false => format!("within {} s", self.scene().output.wait_s),
                    },
                });
            }
        }
    }

    /// The next input; `None` if nothing arrives in time, or ever.
    fn wait_for_input(
        &self,
        feed: &LiveFeed,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Option<LiveInput> {
        let wait = self.scene().output.wait();
        let begun = Instant::now();
        loop {
            match feed.options().pacing {
                Pacing::Lockstep => {
                    if let Some(request) = feed.wait_request(POLL_INTERVAL) {
                        return Some(LiveInput::Frame(request));
                    }
                }
                Pacing::Broadcast => {
                    if let Some(epoch) = feed.playback_epoch() {
                        return Some(LiveInput::Time(epoch));
                    }
                    std::thread::sleep(POLL_INTERVAL);
                }
            }
            // A stream ends after replies to all its requests.
            if is_cancelled() || feed.has_ended() || begun.elapsed() >= wait {
                return None;
            }
        }
    }
}

/// Input of a simulator that sets an image's time.
enum LiveInput {
    /// It waits for this picture.
    Frame(FrameRequest),
    Time(Epoch),
}

/// A picture that a simulator waits for.
pub(super) enum AwaitedFrame<'f> {
    /// A frame request with a satellite's state.
    Frame {
        feed: &'f LiveFeed,
        request: FrameRequest,
    },
    /// A step of a simulation.
    Step(StepRequest<'f>),
}

impl AwaitedFrame<'_> {
    /// Reports that it is drawn. Returns `false` if no one waits for it any more.
    pub fn drawn(&self) -> bool {
        match self {
            Self::Frame { feed, request } => feed.acknowledge(request),
            Self::Step(step) => step.drawn(),
        }
    }

    /// Reports that there is no image.
    pub fn reject(&self, reason: &str) {
        match self {
            Self::Frame { feed, request } => {
                feed.reject(request, reason);
            }
            // A simulation is not notified and continues; the reason is for the user.
            Self::Step(step) => {
                step.drawn();
            }
        }
    }
}

#[cfg(test)]
#[path = "live_tests.rs"]
mod tests;
