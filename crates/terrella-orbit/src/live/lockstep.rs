//! Frames that a simulator waits for: handed to the player, answered when they are drawn.

use super::super::OrbitState;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How many frames may wait at the same time; each connection waits for one.
pub const MAX_WAITING: usize = 8;

/// A picture that a simulator waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRequest {
    /// The simulator's number of it.
    pub seq: u64,
    /// State to draw: the feed returns it at its epoch, bit for bit.
    pub state: OrbitState,
    /// Tells requests of equal numbers apart.
    ticket: u64,
}

/// How a frame ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    Drawn,
    /// The player rejected it, with a reason.
    Rejected(String),
    /// Nobody drew it in time.
    TimedOut,
    /// Too many wait already.
    Busy,
    /// The feed ends.
    Closed,
}

#[derive(Debug)]
struct Waiting {
    request: FrameRequest,
    is_taken: bool,
    outcome: Option<Outcome>,
}

#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<Waiting>,
    next_ticket: u64,
    is_closed: bool,
}

/// The frames that are waited for.
#[derive(Debug, Default)]
pub struct Lockstep {
    queue: Mutex<Queue>,
    changed: Condvar,
}

impl Lockstep {
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a frame to the others and waits until it is drawn; `before` runs once its place is sure.
    pub fn ask(
        &self,
        seq: u64,
        state: OrbitState,
        timeout: Duration,
        before: impl FnOnce(),
    ) -> Outcome {
        let deadline = Instant::now() + timeout;
        let mut queue = self.lock();
        if queue.is_closed {
            return Outcome::Closed;
        }
        if queue.waiting.len() >= MAX_WAITING {
            return Outcome::Busy;
        }
        before();
        let ticket = queue.next_ticket;
        queue.next_ticket += 1;
        queue.waiting.push_back(Waiting {
            request: FrameRequest { seq, state, ticket },
            is_taken: false,
            outcome: None,
        });
        self.changed.notify_all();
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let at = queue
                .waiting
                .iter()
                .position(|w| w.request.ticket == ticket);
            let waiting = at.and_then(|at| queue.waiting.get_mut(at));
            let outcome = match waiting {
                Some(waiting) => waiting.outcome.take(),
                None => Some(Outcome::Closed),
            };
            let outcome = match (outcome, queue.is_closed) {
                (Some(outcome), _) => outcome,
                (None, true) => Outcome::Closed,
                (None, false) if left.is_zero() => Outcome::TimedOut,
                (None, false) => {
                    let woken = self.changed.wait_timeout(queue, left);
                    queue = woken.unwrap_or_else(PoisonError::into_inner).0;
                    continue;
                }
            };
            if let Some(at) = at {
                queue.waiting.remove(at);
            }
            return outcome;
        }
    }

    /// The frame that has waited longest and was not handed out yet.
    pub fn next(&self) -> Option<FrameRequest> {
        let mut queue = self.lock();
        let waiting = queue.waiting.iter_mut().find(|w| !w.is_taken)?;
        waiting.is_taken = true;
        Some(waiting.request)
    }

    /// The same; waits for one.
    pub fn wait(&self, timeout: Duration) -> Option<FrameRequest> {
        let deadline = Instant::now() + timeout;
        loop {
            if let Some(request) = self.next() {
                return Some(request);
            }
            let queue = self.lock();
            let left = deadline.saturating_duration_since(Instant::now());
            if queue.is_closed || left.is_zero() {
                return None;
            }
            if queue.waiting.iter().all(|w| w.is_taken) {
                drop(self.changed.wait_timeout(queue, left));
            }
        }
    }

    /// Ends a frame; `false` where it has ended already.
    pub fn end(&self, request: &FrameRequest, outcome: Outcome) -> bool {
        let mut queue = self.lock();
        let mut waiting = queue.waiting.iter_mut();
        let is_it = |w: &&mut Waiting| w.request.ticket == request.ticket && w.outcome.is_none();
        let Some(waiting) = waiting.find(is_it) else {
            return false;
        };
        waiting.outcome = Some(outcome);
        self.changed.notify_all();
        true
    }

    /// Ends all waits, and allows no new ones.
    pub fn close(&self) {
        self.lock().is_closed = true;
        self.changed.notify_all();
    }
}
