//! The rule by which a server of simulators keeps connections: the same for live feeds and for Basilisk simulations.
//!
//! A connection counts from its first valid packet on. Of those that count, [`MAX_SIMULATORS`] are kept; if there are more, the one that has been
//! silent longest is dismissed. Connections without a valid packet never displace one that has sent some: [`MAX_SILENT`] of them are kept, the
//! oldest is dismissed first, and each is dismissed after [`FIRST_PACKET_TIME`]. A connection that waits for a reply is never dismissed.
//!
//! Dismissal is a request to the connection's own thread, which replies to everything already received and then closes the connection.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How many connections are kept that have sent a good packet.
pub const MAX_SIMULATORS: usize = 4;
/// How many are kept that have not.
pub const MAX_SILENT: usize = 8;
/// How long a connection may take to its first good packet.
pub const FIRST_PACKET_TIME: Duration = Duration::from_secs(300);
/// How long a dismissed connection may take to complete a packet that it has begun.
pub const GRACE: Duration = Duration::from_secs(1);
/// Limit of running threads, including those of dismissed connections. Further clients wait in the system's queue.
const MAX_THREADS: usize = 24;

/// State of one connection; its thread writes it, the listening thread reads it.
#[derive(Debug)]
pub struct Standing {
    came: Instant,
    /// Milliseconds from `came` to the last valid packet or its reply, at least 1; 0 before the first.
    active_ms: AtomicU64,
    is_waiting: AtomicBool,
    is_dismissed: AtomicBool,
}

impl Default for Standing {
    fn default() -> Self {
        Self {
            came: Instant::now(),
            active_ms: AtomicU64::new(0),
            is_waiting: AtomicBool::new(false),
            is_dismissed: AtomicBool::new(false),
        }
    }
}

impl Standing {
    /// A good packet has come.
    pub fn took_good(&self) {
        let ms = u64::try_from(self.came.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.active_ms.store(ms.max(1), Ordering::Release);
    }

    /// Marks the connection as waiting for a reply until the result is dropped.
    pub fn wait(&self) -> Waiting<'_> {
        self.is_waiting.store(true, Ordering::Release);
        Waiting(self)
    }

    /// Whether the connection must end after replying to everything received.
    pub fn is_dismissed(&self) -> bool {
        self.is_dismissed.load(Ordering::Acquire)
    }

    fn facts(&self) -> Facts {
        let active_ms = self.active_ms.load(Ordering::Acquire);
        let last_active = (active_ms > 0).then(|| self.came + Duration::from_millis(active_ms));
        Facts {
            came: self.came,
            last_active,
            is_waiting: self.is_waiting.load(Ordering::Acquire),
        }
    }
}

/// A pending reply.
#[derive(Debug)]
pub struct Waiting<'s>(&'s Standing);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        // A client that has waited long for a reply does not count as silent.
        if self.0.active_ms.load(Ordering::Acquire) > 0 {
            self.0.took_good();
        }
        self.0.is_waiting.store(false, Ordering::Release);
    }
}

/// Input of the rule.
#[derive(Clone, Copy, Debug)]
struct Facts {
    came: Instant,
    /// When its last good packet came or was answered; `None` before the first.
    last_active: Option<Instant>,
    is_waiting: bool,
}

/// The rule: which of the connections leave, by index.
fn leaving(all: &[Facts], now: Instant) -> Vec<usize> {
    let counted = all.iter().filter(|one| one.last_active.is_some()).count();
    let mut counting: Vec<_> = idle(all, |one| one.last_active).collect();
    counting.sort_unstable();
    counting.truncate(counted.saturating_sub(MAX_SIMULATORS));
    let mut silent: Vec<_> = idle(all, |one| match one.last_active {
        None => Some(one.came),
        Some(_) => None,
    })
    .collect();
    silent.sort_unstable();
    let surplus = silent.len().saturating_sub(MAX_SILENT);
    let late = |(place, &(came, _)): (usize, &(Instant, usize))| {
        place < surplus || now.saturating_duration_since(came) >= FIRST_PACKET_TIME
    };
    let silent = silent.iter().enumerate().filter(|one| late(*one));
    let silent = silent.map(|(_, (_, at))| *at);
    silent.chain(counting.iter().map(|(_, at)| *at)).collect()
}

/// Connections without a pending reply for which `time` is known, with their index.
fn idle(
    all: &[Facts],
    time: impl Fn(&Facts) -> Option<Instant>,
) -> impl Iterator<Item = (Instant, usize)> {
    let idle = all.iter().enumerate().filter(|(_, one)| !one.is_waiting);
    idle.filter_map(move |(at, one)| Some((time(one)?, at)))
}

/// The connections of one server. `C` closes a connection immediately.
#[derive(Debug)]
pub struct Connections<C>(Vec<Connection<C>>);

#[derive(Debug)]
struct Connection<C> {
    standing: Arc<Standing>,
    thread: JoinHandle<()>,
    closer: C,
}

impl<C> Default for Connections<C> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<C> Connections<C> {
    /// Adds a connection whose thread runs.
    pub fn add(&mut self, standing: Arc<Standing>, thread: JoinHandle<()>, closer: C) {
        self.0.push(Connection {
            standing,
            thread,
            closer,
        });
    }

    /// Whether no more may be accepted now.
    pub fn is_full(&self) -> bool {
        self.0.len() >= MAX_THREADS
    }

    /// Removes connections that have ended and dismisses those selected by the rule. Returns the number of dismissed ones.
    pub fn tidy(&mut self) -> usize {
        self.0.retain(|one| !one.thread.is_finished());
        let kept = self.0.iter().filter(|one| !one.standing.is_dismissed());
        let kept: Vec<_> = kept.map(|one| &one.standing).collect();
        let facts: Vec<_> = kept.iter().map(|one| one.facts()).collect();
        let leaving = leaving(&facts, Instant::now());
        for standing in leaving.iter().filter_map(|at| kept.get(*at)) {
            standing.is_dismissed.store(true, Ordering::Release);
        }
        leaving.len()
    }

    /// Ends all connections and waits for their threads.
    pub fn end(self, close: impl Fn(&C)) {
        for one in self.0 {
            close(&one.closer);
            // A thread that panicked has said so itself.
            let _ = one.thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    /// Connections that came a second apart, with when each was active last, seconds after the first came.
    fn connections(start: Instant, active_s: &[Option<u32>], waiting: &[usize]) -> Vec<Facts> {
        let facts = |(at, active_s): (usize, &Option<u32>)| Facts {
            came: start + SECOND * at as u32,
            last_active: active_s.map(|s| start + SECOND * s),
            is_waiting: waiting.contains(&at),
        };
        active_s.iter().enumerate().map(facts).collect()
    }

    #[test]
    fn the_longest_silent_leaves_and_none_that_waits() {
        let start = Instant::now();
        let now = start + SECOND * 20;
        let active = [Some(9), Some(7), Some(8), Some(6), Some(10), Some(11)];
        let leave = |waiting: &[usize]| leaving(&connections(start, &active, waiting), now);
        assert_eq!(leave(&[]), [3, 1]);
        assert_eq!(leave(&[3]), [1, 2]);
        assert_eq!(leave(&[0, 1, 2, 3, 4]), [5]);
        assert_eq!(leave(&[0, 1, 2, 3, 4, 5]), [0; 0]);
        let few = connections(start, &active[..MAX_SIMULATORS], &[]);
        assert_eq!(leaving(&few, now), [0; 0]);
    }

    #[test]
    fn whoever_has_sent_nothing_good_displaces_only_its_like() {
        let start = Instant::now();
        let mut active = vec![Some(1), Some(2), Some(3), Some(4)];
        active.extend([None; MAX_SILENT]);
        let full = connections(start, &active, &[]);
        assert_eq!(leaving(&full, start + SECOND * 20), [0; 0]);
        active.extend([None; 2]);
        let more = connections(start, &active, &[]);
        assert_eq!(leaving(&more, start + SECOND * 20), [4, 5]);
    }

    #[test]
    fn whoever_has_sent_nothing_good_leaves_in_time() {
        let start = Instant::now();
        let all = connections(start, &[None, Some(1), None], &[]);
        assert_eq!(leaving(&all, start + FIRST_PACKET_TIME - SECOND), [0; 0]);
        assert_eq!(leaving(&all, start + FIRST_PACKET_TIME), [0]);
        assert_eq!(leaving(&all, start + FIRST_PACKET_TIME * 2), [0, 2]);
    }

    #[test]
    fn an_answer_that_was_waited_for_counts_as_a_sign_of_life() {
        let standing = Standing::default();
        drop(standing.wait());
        assert_eq!(standing.facts().last_active, None, "nothing good came");
        standing.took_good();
        let asked = standing.facts().last_active;
        let waiting = standing.wait();
        assert!(standing.facts().is_waiting);
        std::thread::sleep(Duration::from_millis(5));
        drop(waiting);
        assert!(standing.facts().last_active > asked && !standing.facts().is_waiting);
    }
}
