//! State that the threads of a simulation share: its latest snapshot, the history of its spacecraft, and pending requests.

use super::history::History;
use super::keys::ScriptKeys;
use super::message::{Camera, Message};
use super::options::SimulationOptions;
use super::wire::WireFault;
use super::world::{Roster, Snapshot, UpdateFault, World};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use terrella_frames::Epoch;

/// How long the first picture may be waited for while maps are loaded and the renderer is made.
const OPENING_TIME: Duration = Duration::from_secs(120);
/// Limit of images and steps that are pending at the same time: one a connection.
const MAX_WAITING: usize = 8;
/// Upper limit of messages to the user in a run.
const MAX_NOTES: usize = 256;

/// Counters of received messages and their results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps that were taken.
    pub steps: u64,
    /// Messages that could not be read or drawn.
    pub bad: u64,
    /// Pictures that were answered.
    pub pictures: u64,
    /// Image requests that got an empty reply.
    pub no_pictures: u64,
    /// Requests that were not drawn in time.
    pub timed_out: u64,
    /// Simulators that have connected. A connection counts from its first good request on.
    pub connections: u64,
    /// Of these, simulators that are connected now.
    pub connected: u64,
    /// Longest wait of a step for its reply, microseconds.
    pub slowest_step_us: u64,
    /// Total wait of all steps for their replies, microseconds.
    pub steps_us: u64,
    /// Longest time that a picture was waited for, microseconds.
    pub slowest_picture_us: u64,
    /// Time that all pictures were waited for, microseconds.
    pub pictures_us: u64,
}

/// Whether a simulator waits until its steps are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepPace {
    /// It waits until that is known.
    #[default]
    Undecided,
    /// Each step gets its reply immediately; images show the latest one.
    Free,
    /// Each step is answered when it is drawn.
    Drawn,
}

/// Whether images are being drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Painter {
    #[default]
    None,
    Opening,
    Ready,
}

/// Something that a simulator waits for.
#[derive(Debug)]
struct Waiting {
    ticket: u64,
    snapshot: Arc<Snapshot>,
    /// The camera of a picture; `None` for a step.
    camera: Option<Camera>,
    is_taken: bool,
    answer: Option<Vec<u8>>,
}

#[derive(Debug, Default)]
struct Inner {
    latest: Option<Arc<Snapshot>>,
    serial: u64,
    last_came: Option<Instant>,
    /// Which session the histories are of.
    author: u64,
    histories: BTreeMap<Arc<str>, History>,
    roster: Arc<Roster>,
    roster_serial: u64,
    counters: Counters,
    notes: Vec<String>,
    reported: BTreeSet<String>,
    /// The world of the session that spoke last, for one that goes on without saying all again.
    world: Option<World>,
    pace: StepPace,
    painter: Painter,
    waiting: VecDeque<Waiting>,
    next_ticket: u64,
    next_session: u64,
    is_over: bool,
    /// Keys by session.
    keys: BTreeMap<u64, ScriptKeys>,
}

/// State that the threads share.
#[derive(Debug)]
pub struct SharedSimulation {
    pub options: SimulationOptions,
    /// Epoch of simulated time 0 if no message contains it.
    start: Epoch,
    inner: Mutex<Inner>,
    changed: Condvar,
    is_stopped: AtomicBool,
}

/// Why a message gives nothing.
#[derive(Debug, thiserror::Error)]
pub enum BadUpdate {
    #[error("a message of the simulation cannot be read: it {0}")]
    Wire(#[from] WireFault),
    #[error("a message of the simulation cannot be drawn: {0}")]
    Update(#[from] UpdateFault),
}

/// One connection's view of its simulation.
#[derive(Debug)]
pub struct Session {
    number: u64,
    /// Whether it has sent a valid message.
    counts: bool,
    world: Option<World>,
    /// The instant of its last message.
    pub snapshot: Option<Arc<Snapshot>>,
    /// The count of its last message.
    pub frame_number: i64,
}

impl SharedSimulation {
    pub fn new(options: SimulationOptions, start: Epoch) -> Self {
        Self {
            options,
            start,
            inner: Mutex::default(),
            changed: Condvar::new(),
            is_stopped: AtomicBool::new(false),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether all threads must end.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Acquire)
    }

    /// Ends all threads; pending requests get a reply.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Release);
        let _inner = self.lock();
        self.changed.notify_all();
    }

    /// A connection's beginning.
    pub fn session(&self) -> Session {
        let mut inner = self.lock();
        inner.next_session += 1;
        Session {
            number: inner.next_session,
            counts: false,
            world: None,
            snapshot: None,
            frame_number: 0,
        }
    }

    /// Something good has come: from now on the connection counts.
    pub fn enter(&self, session: &mut Session) {
        if !std::mem::replace(&mut session.counts, true) {
            let counters = &mut self.lock().counters;
            counters.connections += 1;
            counters.connected += 1;
        }
    }

    /// A connection's end.
    pub fn leave(&self, session: &mut Session) {
        let mut inner = self.lock();
        let counted = u64::from(session.counts);
        inner.counters.connected = inner.counters.connected.saturating_sub(counted);
        inner.keys.remove(&session.number);
        if session.world.is_some() {
            inner.world = session.world.take();
        }
    }

    /// Processes a message of a session.
    ///
    /// # Errors
    /// An error in the message; it is then not drawn.
    pub fn take(&self, session: &mut Session, bytes: &[u8]) -> Result<Arc<Snapshot>, BadUpdate> {
        let message = Message::read(bytes);
        let taken = message.map_err(BadUpdate::from).and_then(|message| {
            session.frame_number = message.frame_number;
            let ends_viewer = message.ends_viewer;
            let has_epoch = message.epoch.is_some();
            if let Some(keys) = &message.live_keys {
                let mut inner = self.lock();
                inner.keys.entry(session.number).or_default().listen(keys);
            }
            let world = session.world.get_or_insert_with(|| {
                // A simulation that continues with a new viewer does not send its epoch again.
                let before = self.lock().world.clone().filter(|_| !has_epoch);
                before.unwrap_or_else(|| World::new(self.start))
            });
            let taken = world.take(message);
            self.tell(world.notes());
            Ok((taken?, ends_viewer))
        });
        let (snapshot, ends_viewer) = match taken {
            Ok(taken) => taken,
            Err(error) => {
                self.lock().counters.bad += 1;
                self.tell(&[error.to_string()]);
                return Err(error);
            }
        };
        // Before the step becomes visible: a service that ends with its simulators must not see a step without a connection.
        self.enter(session);
        let snapshot = Arc::new(snapshot);
        session.snapshot = Some(Arc::clone(&snapshot));
        self.publish(session.number, &snapshot, ends_viewer);
        Ok(snapshot)
    }

    /// Tells a user, each sentence once.
    pub fn tell(&self, notes: &[String]) {
        let mut inner = self.lock();
        let new: Vec<_> = notes
            .iter()
            .filter(|note| !inner.reported.contains(*note))
            .cloned()
            .collect();
        for note in new {
            if inner.reported.len() < MAX_NOTES {
                tracing::warn!("{note}");
                inner.reported.insert(note.clone());
                inner.notes.push(note);
            }
        }
    }

    fn publish(&self, author: u64, snapshot: &Arc<Snapshot>, ends_viewer: bool) {
        let mut inner = self.lock();
        let inner = &mut *inner;
        if inner.author != author {
            let others = inner.counters.connected > 1 && inner.author != 0;
            inner.author = author;
            inner.histories.clear();
            if others {
                tracing::info!("another simulation is drawn now");
            }
        }
        inner.serial += 1;
        inner.counters.steps += 1;
        inner.last_came = Some(Instant::now());
        inner.is_over |= ends_viewer;
        let most = History::most(snapshot.craft.len());
        if inner.histories.len() > snapshot.craft.len() {
            let is_there = |name: &Arc<str>| snapshot.craft(Some(name)).is_some();
            inner.histories.retain(|name, _| is_there(name));
        }
        for craft in &snapshot.craft {
            let history = inner.histories.entry(Arc::clone(&craft.name)).or_default();
            history.add(snapshot.elapsed_s, craft, most);
        }
        let names = snapshot.craft.iter().map(|craft| &craft.name);
        let is_same =
            inner.roster.craft.iter().eq(names.clone()) && *inner.roster.places == *snapshot.places;
        if !is_same {
            inner.roster = Arc::new(Roster {
                craft: names.cloned().collect(),
                places: Arc::clone(&snapshot.places),
            });
            inner.roster_serial += 1;
        }
        inner.latest = Some(Arc::clone(snapshot));
        self.changed.notify_all();
    }

    /// Waits, for a simulator, until a step is drawn or an image is ready. Returns the bytes of the image, empty if there is none. Ends after the
    /// timeout of the options, or when everything ends.
    pub fn ask(&self, snapshot: &Arc<Snapshot>, camera: Option<Camera>) -> Vec<u8> {
        let begun = Instant::now();
        let is_picture = camera.is_some();
        let mut inner = self.lock();
        let is_settled = |inner: &Inner| match is_picture {
            true => inner.painter != Painter::Opening,
            false => inner.pace != StepPace::Undecided,
        };
        while !is_settled(&inner) && !self.is_stopped() && begun.elapsed() < OPENING_TIME {
            inner = self.pause(inner, OPENING_TIME.saturating_sub(begun.elapsed()));
        }
        let is_drawn = match is_picture {
            true => inner.painter == Painter::Ready,
            false => inner.pace == StepPace::Drawn,
        };
        if !is_drawn || self.is_stopped() || inner.waiting.len() >= MAX_WAITING {
            return Vec::new();
        }
        let ticket = inner.next_ticket;
        inner.next_ticket += 1;
        inner.waiting.push_back(Waiting {
            ticket,
            snapshot: Arc::clone(snapshot),
            camera,
            is_taken: false,
            answer: None,
        });
        self.changed.notify_all();
        let deadline = Instant::now() + self.options.timeout;
        loop {
            let place = inner.waiting.iter().position(|one| one.ticket == ticket);
            let Some(place) = place else {
                return Vec::new();
            };
            let is_answered = inner.waiting.get(place).is_some_and(|w| w.answer.is_some());
            let left = deadline.saturating_duration_since(Instant::now());
            if is_answered || left.is_zero() || self.is_stopped() {
                let ended = inner.waiting.remove(place);
                inner.counters.timed_out += u64::from(!is_answered && left.is_zero());
                return ended.and_then(|ended| ended.answer).unwrap_or_default();
            }
            inner = self.pause(inner, left);
        }
    }

    fn pause<'g>(&self, inner: MutexGuard<'g, Inner>, time: Duration) -> MutexGuard<'g, Inner> {
        let waited = self.changed.wait_timeout(inner, time);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Counts a reply to a step or an image request, and its duration.
    pub fn count(&self, is_picture: bool, has_picture: bool, took: Duration) {
        let us = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        let counters = &mut self.lock().counters;
        match is_picture {
            true => {
                counters.pictures += u64::from(has_picture);
                counters.no_pictures += u64::from(!has_picture);
                counters.pictures_us = counters.pictures_us.saturating_add(us);
                counters.slowest_picture_us = counters.slowest_picture_us.max(us);
            }
            false => {
                counters.steps_us = counters.steps_us.saturating_add(us);
                counters.slowest_step_us = counters.slowest_step_us.max(us);
            }
        }
    }

    /// The next pending step or image that no one has taken; waits for it at most this long.
    pub fn next(
        &self,
        wants_picture: bool,
        wait: Duration,
    ) -> Option<(u64, Arc<Snapshot>, Option<Camera>)> {
        let deadline = Instant::now() + wait;
        let mut inner = self.lock();
        loop {
            let mut waiting = inner.waiting.iter_mut();
            let next = waiting.find(|one| !one.is_taken && one.camera.is_some() == wants_picture);
            if let Some(next) = next {
                next.is_taken = true;
                return Some((next.ticket, Arc::clone(&next.snapshot), next.camera.clone()));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || self.is_stopped() {
                return None;
            }
            inner = self.pause(inner, left);
        }
    }

    /// Replies to a taken request. Returns `false` if no one waits for it any more.
    pub fn answer(&self, ticket: u64, bytes: Vec<u8>) -> bool {
        let mut inner = self.lock();
        let mut waiting = inner.waiting.iter_mut();
        match waiting.find(|one| one.ticket == ticket) {
            Some(one) if one.answer.is_none() => {
                one.answer = Some(bytes);
                self.changed.notify_all();
                true
            }
            _ => false,
        }
    }

    /// Sets who waits for steps from now on.
    pub fn set_pace(&self, pace: StepPace) {
        let mut inner = self.lock();
        inner.pace = pace;
        if pace == StepPace::Free {
            for one in inner.waiting.iter_mut().filter(|one| one.camera.is_none()) {
                one.answer.get_or_insert_default();
            }
        }
        self.changed.notify_all();
    }

    fn set_painter(&self, painter: Painter) {
        let mut inner = self.lock();
        inner.painter = painter;
        if painter == Painter::None {
            for one in inner.waiting.iter_mut().filter(|one| one.camera.is_some()) {
                one.answer.get_or_insert_default();
            }
        }
        self.changed.notify_all();
    }

    /// Somebody will draw pictures soon.
    pub fn painter_opens(&self) {
        self.set_painter(Painter::Opening);
    }

    /// Somebody draws pictures.
    pub fn painter_is_ready(&self) {
        self.set_painter(Painter::Ready);
    }

    /// Nobody draws pictures any more.
    pub fn painter_leaves(&self) {
        self.set_painter(Painter::None);
    }

    /// A key was pressed: as the script of the simulation that is drawn spells it, where it listens to that one.
    pub fn press(&self, key: char) -> Option<char> {
        let mut inner = self.lock();
        let author = inner.author;
        inner.keys.get_mut(&author)?.press(key)
    }

    /// The characters whose keys the script of the simulation that is drawn listens to.
    pub fn heard_keys(&self) -> String {
        let inner = self.lock();
        let keys = inner.keys.get(&inner.author);
        keys.map_or_else(String::new, |keys| keys.heard().to_owned())
    }

    /// Keys pressed for a session since its last request.
    pub fn take_keys(&self, session: &Session) -> String {
        let mut inner = self.lock();
        let keys = inner.keys.get_mut(&session.number);
        keys.map_or_else(String::new, ScriptKeys::take)
    }

    pub fn latest(&self) -> Option<Arc<Snapshot>> {
        self.lock().latest.clone()
    }

    /// How many instants have come; changes with each.
    pub fn serial(&self) -> u64 {
        self.lock().serial
    }

    /// Waits until more instants have come than `than`, at most so long.
    pub fn wait_beyond(&self, than: u64, wait: Duration) -> Option<Arc<Snapshot>> {
        let deadline = Instant::now() + wait;
        let mut inner = self.lock();
        while inner.serial <= than {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || self.is_stopped() {
                return None;
            }
            inner = self.pause(inner, left);
        }
        inner.latest.clone()
    }

    pub fn age(&self) -> Option<Duration> {
        self.lock().last_came.map(|came| came.elapsed())
    }

    pub fn counters(&self) -> Counters {
        self.lock().counters
    }

    pub fn notes(&self) -> Vec<String> {
        self.lock().notes.clone()
    }

    pub fn is_over(&self) -> bool {
        self.lock().is_over
    }

    /// The roster, and a number that changes with it.
    pub fn roster(&self) -> (Arc<Roster>, u64) {
        let inner = self.lock();
        (Arc::clone(&inner.roster), inner.roster_serial)
    }

    /// Calls a function with the latest snapshot and the history of a spacecraft; `None` for the first one.
    pub fn with_history<R>(
        &self,
        craft: Option<&str>,
        read: impl FnOnce(&Snapshot, Option<&History>) -> R,
    ) -> Option<R> {
        let inner = self.lock();
        let latest = inner.latest.as_ref()?;
        let name = latest.craft(craft).map(|craft| &craft.name);
        let history = name.and_then(|name| inner.histories.get(name));
        Some(read(latest, history))
    }
}
