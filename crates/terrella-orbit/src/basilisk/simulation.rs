//! A running simulation, as seen by the player.

use super::endpoint::{Endpoint, Listener};
use super::feeds::{CraftFeed, PlaceFeed};
use super::message::Camera;
use super::options::{Meeting, SimulationError, SimulationOptions};
use super::shared::{Counters, SharedSimulation, StepPace};
use super::world::{Roster, Snapshot};
use super::{server, subscriber};
use glam::DVec3;
use std::sync::{Arc, OnceLock};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;
use terrella_frames::Epoch;

/// A connection to a simulation: it replies, stores the state, and returns what the simulation waits for.
///
/// Dropping it replies to all pending requests, closes each connection right after a reply (or after a second without a request), and ends its
/// threads.
#[derive(Debug)]
pub struct Simulation {
    shared: Arc<SharedSimulation>,
    endpoint: Endpoint,
    thread: Option<JoinHandle<()>>,
}

/// A step that its simulator waits for. Dropping it lets the simulator continue.
#[derive(Debug)]
pub struct StepRequest<'s> {
    /// Snapshot to draw.
    pub snapshot: Arc<Snapshot>,
    shared: &'s SharedSimulation,
    ticket: u64,
}

/// A picture that a simulator waits for. Dropping it replies with an empty one.
#[derive(Debug)]
pub struct PictureRequest<'s> {
    /// Snapshot to draw.
    pub snapshot: Arc<Snapshot>,
    /// Camera of the image.
    pub camera: Camera,
    shared: &'s SharedSimulation,
    ticket: u64,
}

impl StepRequest<'_> {
    /// Reports that it is drawn. Returns `false` if no one waits for it any more.
    pub fn drawn(&self) -> bool {
        self.shared.answer(self.ticket, Vec::new())
    }
}

impl Drop for StepRequest<'_> {
    fn drop(&mut self) {
        self.drawn();
    }
}

impl PictureRequest<'_> {
    /// Passes the file of the image. Returns `false` if no one waits for it any more.
    pub fn answer(&self, file: Vec<u8>) -> bool {
        self.shared.answer(self.ticket, file)
    }
}

impl Drop for PictureRequest<'_> {
    fn drop(&mut self) {
        self.answer(Vec::new());
    }
}

/// Somebody who draws pictures, from its making to its end, whichever that is.
#[derive(Debug)]
pub struct Painter<'s> {
    shared: &'s SharedSimulation,
}

impl Painter<'_> {
    /// Image requests get replies in time from now on.
    pub fn is_ready(&self) {
        self.shared.painter_is_ready();
    }
}

impl Drop for Painter<'_> {
    fn drop(&mut self) {
        self.shared.painter_leaves();
    }
}

impl Simulation {
    /// Connects to a simulation. `start` is the epoch of simulated time 0 if the simulation does not send it.
    ///
    /// # Errors
    /// Invalid settings, or a port that is in use.
    pub fn open(options: SimulationOptions, start: Epoch) -> Result<Self, SimulationError> {
        options.check()?;
        let endpoint = options.meeting.endpoint().clone();
        let listens = matches!(options.meeting, Meeting::Listen(_));
        let shared = Arc::new(SharedSimulation::new(options, start));
        let its = Arc::clone(&shared);
        let thread = Builder::new().name("terrella-basilisk-listen".to_owned());
        let (endpoint, thread) = match listens {
            true => {
                let bind = |source| SimulationError::Bind {
                    endpoint: endpoint.clone(),
                    source,
                };
                let listener = Listener::bind(&endpoint).map_err(bind)?;
                let bound = listener.endpoint().map_err(bind)?;
                (bound, thread.spawn(move || server::listen(&listener, &its)))
            }
            false => {
                let its_endpoint = endpoint.clone();
                let body = move || subscriber::follow(&its_endpoint, &its);
                (endpoint, thread.spawn(body))
            }
        };
        let thread = thread.map_err(|source| SimulationError::Thread { source })?;
        Ok(Self {
            shared,
            endpoint,
            thread: Some(thread),
        })
    }

    /// A simulation without a connection: for showing a scene without using its port.
    ///
    /// # Errors
    /// Invalid settings.
    pub fn unconnected(options: SimulationOptions, start: Epoch) -> Result<Self, SimulationError> {
        options.check()?;
        Ok(Self {
            endpoint: options.meeting.endpoint().clone(),
            shared: Arc::new(SharedSimulation::new(options, start)),
            thread: None,
        })
    }

    /// How it was set up.
    pub fn options(&self) -> &SimulationOptions {
        &self.shared.options
    }

    /// Where it is met, with the port that was found for port 0.
    pub fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Sets whether simulators wait until their steps are drawn. By default they do.
    pub fn set_pace(&self, pace: StepPace) {
        self.shared.set_pace(pace);
    }

    /// The newest instant.
    pub fn latest(&self) -> Option<Arc<Snapshot>> {
        self.shared.latest()
    }

    /// How many instants have come; changes with each.
    pub fn serial(&self) -> u64 {
        self.shared.serial()
    }

    /// Waits until more instants have come than `than`, at most so long.
    pub fn wait_beyond(&self, than: u64, wait: Duration) -> Option<Arc<Snapshot>> {
        self.shared.wait_beyond(than, wait)
    }

    /// The next step that a simulator waits for with [`StepPace::Drawn`]; waits for one, at most so long.
    pub fn next_step(&self, wait: Duration) -> Option<StepRequest<'_>> {
        let (ticket, snapshot, _) = self.shared.next(false, wait)?;
        Some(StepRequest {
            snapshot,
            shared: &self.shared,
            ticket,
        })
    }

    /// Announces that somebody will draw pictures: from now on they are waited for.
    pub fn painter(&self) -> Painter<'_> {
        self.shared.painter_opens();
        Painter {
            shared: &self.shared,
        }
    }

    /// The next picture that a simulator waits for; waits for one, at most so long.
    pub fn next_picture(&self, wait: Duration) -> Option<PictureRequest<'_>> {
        let (ticket, snapshot, camera) = self.shared.next(true, wait)?;
        Some(PictureRequest {
            snapshot,
            camera: camera?,
            shared: &self.shared,
            ticket,
        })
    }

    /// Records a pressed key. If the script of the drawn simulation listens to it (`keyboardLiveInput`), the script receives it with its next
    /// request, and this returns the character as the script spells it.
    pub fn press(&self, key: char) -> Option<char> {
        self.shared.press(key)
    }

    /// The characters whose keys that script listens to.
    pub fn heard_keys(&self) -> String {
        self.shared.heard_keys()
    }

    /// How long ago the last step came; `None` before the first.
    pub fn age(&self) -> Option<Duration> {
        self.shared.age()
    }

    /// Counters of received messages and their results.
    pub fn counters(&self) -> Counters {
        self.shared.counters()
    }

    /// Notes for the user about the simulation, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        self.shared.notes()
    }

    /// Tells a user something about the simulation, once.
    pub fn tell(&self, note: String) {
        self.shared.tell(&[note]);
    }

    /// Replies to every pending request and closes all connections, from any thread: for a program that is interrupted while it is busy.
    pub fn stopper(&self) -> impl Fn() + Send + 'static {
        let shared = Arc::clone(&self.shared);
        move || shared.stop()
    }

    /// Whether its threads have been stopped.
    pub fn is_stopped(&self) -> bool {
        self.shared.is_stopped()
    }

    /// Whether the simulation has requested its viewer to close.
    pub fn is_over(&self) -> bool {
        self.shared.is_over()
    }

    /// Spacecraft and places, and a number that changes when they do.
    pub fn roster(&self) -> (Arc<Roster>, u64) {
        self.shared.roster()
    }

    /// The motion of a spacecraft; `None` for the first one.
    pub fn craft_feed(&self, craft: Option<&str>) -> CraftFeed {
        CraftFeed {
            shared: Arc::clone(&self.shared),
            craft: craft.map(str::to_owned),
            name: OnceLock::new(),
        }
    }

    /// A place on the ground at `position_itrf_m`, metres, as a feed.
    pub fn place_feed(&self, name: Arc<str>, position_itrf_m: DVec3) -> PlaceFeed {
        PlaceFeed {
            shared: Arc::clone(&self.shared),
            name,
            position_itrf_m,
        }
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        self.shared.stop();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so itself.
            let _ = thread.join();
        }
    }
}
