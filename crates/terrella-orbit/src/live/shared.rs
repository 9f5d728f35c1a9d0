//! State shared by the reading threads and the player that draws.

use super::super::pushed::{Insertion, PlaybackClock, StateBuffer};
use super::super::pushed::{Packet, PacketFault, PacketKind};
use super::lockstep::{Lockstep, Outcome};
use super::options::{LiveOptions, Pacing};
use super::reply::Reply;
use super::split::Received;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use terrella_files::printable;

/// Counters of received packets and their results, since the feed was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PacketCounters {
    /// States that were taken.
    pub taken: u64,
    /// Of these, states that came after a later one.
    pub late: u64,
    /// Packets that were no packets, and anything else between packets.
    pub bad: u64,
    /// States of an instant that was known already.
    pub duplicates: u64,
    /// States older than all that are kept.
    pub too_late: u64,
    /// States far from all others in time, not taken.
    pub apart: u64,
    /// How often the simulator jumped to another time or began again.
    pub restarts: u64,
    /// Packets missing in the simulator's count, now.
    pub lost: u64,
    /// Packets beyond the rate, dropped; in lockstep a stream is held back instead.
    pub over_rate: u64,
    /// Connections that were accepted.
    pub connections: u64,
    /// Connections that were rejected or closed to make place.
    pub rejected: u64,
    /// Frames that a simulator waited for.
    pub frames: u64,
    /// Of these, frames that were drawn.
    pub drawn: u64,
    /// Of these, frames that were not drawn in time.
    pub timed_out: u64,
}

/// States and the clock of their arrival; locked for microseconds, never during a wait.
#[derive(Debug)]
pub struct FeedState {
    pub buffer: StateBuffer,
    pub clock: PlaybackClock,
    pub counters: PacketCounters,
    pub last_came: Option<Instant>,
    pub last_fault: Option<String>,
    last_seq: Option<u64>,
}

/// State that the threads share.
#[derive(Debug)]
pub struct SharedFeed {
    pub options: LiveOptions,
    /// Arrivals are counted from here.
    pub opened: Instant,
    inner: Mutex<FeedState>,
    pub lockstep: Lockstep,
    pub name: OnceLock<String>,
    stop: AtomicBool,
    has_ended: AtomicBool,
    /// Packets whose replies have not been sent yet.
    unanswered: AtomicUsize,
}

/// Time for which closing a feed waits until pending frames have their replies.
const LAST_ANSWERS: Duration = Duration::from_millis(200);

impl SharedFeed {
    pub fn new(options: LiveOptions) -> Self {
        let inner = FeedState {
            buffer: StateBuffer::new(options.gap_s),
            clock: PlaybackClock::new(options.rate),
            counters: PacketCounters::default(),
            last_came: None,
            last_fault: None,
            last_seq: None,
        };
        Self {
            options,
            opened: Instant::now(),
            inner: Mutex::new(inner),
            lockstep: Lockstep::default(),
            name: OnceLock::new(),
            stop: AtomicBool::new(false),
            has_ended: AtomicBool::new(false),
            unanswered: AtomicUsize::new(0),
        }
    }

    pub fn lock(&self) -> MutexGuard<'_, FeedState> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// Whether the input stream has ended.
    pub fn has_ended(&self) -> bool {
        self.has_ended.load(Ordering::Acquire)
    }

    /// The stream that is read has ended.
    pub fn end(&self) {
        self.has_ended.store(true, Ordering::Release);
    }

    /// Ends all threads; those with a pending reply last.
    pub fn close(&self) {
        self.lockstep.close();
        let begun = Instant::now();
        while self.unanswered.load(Ordering::Acquire) > 0 && begun.elapsed() < LAST_ANSWERS {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.stop.store(true, Ordering::Release);
    }

    /// Processes a part of a stream and sends its reply; in lockstep it waits until the frame is drawn. Returns `false` if the reply could not be
    /// sent.
    pub fn take(&self, received: Received, send: impl FnOnce(Vec<u8>) -> bool) -> bool {
        self.unanswered.fetch_add(1, Ordering::AcqRel);
        let reply = match received.packet {
            Ok(packet) => self.take_packet(packet),
            Err(fault) => self.take_fault(&fault),
        };
        let is_sent = reply.is_none_or(|reply| send(reply.to_wire(received.format)));
        self.unanswered.fetch_sub(1, Ordering::AcqRel);
        is_sent
    }

    fn take_fault(&self, fault: &PacketFault) -> Option<Reply> {
        let reason = fault.to_string();
        let mut inner = self.lock();
        inner.counters.bad += 1;
        inner.last_fault = Some(printable(&reason));
        drop(inner);
        // A simulator may wait for a reply.
        let is_waited_for = self.options.pacing == Pacing::Lockstep;
        is_waited_for.then_some(Reply::Error { seq: None, reason })
    }

    fn take_packet(&self, packet: Packet) -> Option<Reply> {
        if let Some(name) = packet.name {
            // The first one stays: the player shows it by reference.
            let _ = self.name.set(name);
        }
        let (state, seq) = (packet.state, packet.seq);
        if packet.kind == PacketKind::State {
            self.take_state(state, seq);
            return None;
        }
        let seq = seq?;
        if self.options.pacing == Pacing::Broadcast {
            let reason = "nobody waits here: the feed was opened in broadcast mode; send states, or open it in lockstep";
            let mut inner = self.lock();
            inner.counters.bad += 1;
            inner.last_fault = Some(printable(reason));
            return Some(Reply::Error {
                seq: Some(seq),
                reason: reason.to_owned(),
            });
        }
        let timeout = self.options.frame_timeout;
        let outcome = self.lockstep.ask(seq, state, timeout, || {
            let mut inner = self.lock();
            inner.buffer.take_frame(state);
            inner.counters.taken += 1;
            inner.last_came = Some(Instant::now());
        });
        let mut inner = self.lock();
        inner.counters.frames += 1;
        let reason = match outcome {
            Outcome::Drawn => {
                inner.counters.drawn += 1;
                return Some(Reply::Drawn { seq });
            }
            Outcome::Rejected(reason) => reason,
            Outcome::TimedOut => {
                inner.counters.timed_out += 1;
                format!("not drawn within {} s", timeout.as_secs_f64())
            }
            Outcome::Busy => "too many frames wait already; wait for their answers".to_owned(),
            Outcome::Closed => "the feed is closed".to_owned(),
        };
        let seq = Some(seq);
        Some(Reply::Error { seq, reason })
    }

    fn take_state(&self, state: super::super::OrbitState, seq: Option<u64>) {
        let now = Instant::now();
        let mut inner = self.lock();
        let taken = inner.buffer.take(state);
        let inner = &mut *inner;
        let counters = &mut inner.counters;
        match taken {
            Insertion::Newest => {}
            Insertion::Late => counters.late += 1,
            Insertion::Duplicate => counters.duplicates += 1,
            Insertion::TooLate => counters.too_late += 1,
            Insertion::Apart => counters.apart += 1,
            Insertion::Restart => {
                counters.restarts += 1;
                inner.last_seq = None;
            }
        }
        let since_opening = now.saturating_duration_since(self.opened);
        if !inner.clock.follow(taken, state.epoch, since_opening) {
            return;
        }
        counters.taken += 1;
        inner.last_came = Some(now);
        let Some(seq) = seq else { return };
        match inner.last_seq {
            Some(last) if seq > last => {
                counters.lost = counters.lost.saturating_add(seq - last - 1)
            }
            // One that was counted as lost.
            Some(_) if taken == Insertion::Late => counters.lost = counters.lost.saturating_sub(1),
            _ => {}
        }
        if taken != Insertion::Late {
            inner.last_seq = Some(seq);
        }
    }
}

/// Limits the rate of packets: how many may still come in this second.
#[derive(Debug)]
pub struct RateLimiter {
    per_s: f64,
    left: f64,
    at: Instant,
}

impl RateLimiter {
    pub fn new(per_s: u32) -> Self {
        Self {
            per_s: f64::from(per_s),
            left: f64::from(per_s),
            at: Instant::now(),
        }
    }

    /// Adds tokens for the elapsed time.
    pub fn refill(&mut self, now: Instant) {
        let passed_s = now.saturating_duration_since(self.at).as_secs_f64();
        self.at = now;
        self.left = (self.left + passed_s * self.per_s).min(self.per_s);
    }

    /// Whether one more packet is allowed.
    pub fn has_one(&mut self, now: Instant) -> bool {
        self.refill(now);
        let has_one = self.left >= 1.0;
        if has_one {
            self.left -= 1.0;
        }
        has_one
    }

    /// How long until the next may come; at most 20 ms, so that a thread that waits still sees that the feed ends.
    pub fn pause(&self) -> Duration {
        Duration::from_secs_f64(((1.0 - self.left) / self.per_s).clamp(0.0, 0.02))
    }
}
