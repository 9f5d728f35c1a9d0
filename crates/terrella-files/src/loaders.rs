//! Threads that load tiles beside the frame, and locks for what they share with it.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long threads are waited for at the end. One that is stuck in a read is left to itself then.
const JOIN_TIMEOUT: Duration = Duration::from_secs(2);

/// Locks what nobody panics under, so that a poisoned mutex is as good.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The same, if it is free just now: a frame does not wait for a thread of low priority that was put to sleep inside.
pub fn try_lock<T>(mutex: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    match mutex.try_lock() {
        Ok(held) => Some(held),
        Err(TryLockError::Poisoned(held)) => Some(held.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}

/// Threads of low priority that work until they are told to stop.
pub struct Loaders {
    what: &'static str,
    running: Arc<Running>,
    threads: Vec<JoinHandle<()>>,
}

#[derive(Default)]
struct Running {
    count: Mutex<usize>,
    ended: Condvar,
}

impl Loaders {
    /// Starts threads, each with its number; `what` they load names them. One that the system refuses is done without.
    pub fn start(
        what: &'static str,
        count: usize,
        work: impl Fn(usize) + Clone + Send + 'static,
    ) -> Self {
        let running = Arc::new(Running::default());
        let start = |worker: usize| {
            let (work, own) = (work.clone(), Arc::clone(&running));
            *lock(&running.count) += 1;
            let thread = thread::Builder::new().name(format!("terrella {what} {worker}"));
            let thread = thread.spawn(move || {
                lower_priority();
                work(worker);
                own.leave();
            });
            if let Err(error) = &thread {
                running.leave();
                tracing::warn!("a thread that loads {what} could not be started: {error}");
            }
            thread.ok()
        };
        let threads = (0..count).filter_map(start).collect();
        Self {
            what,
            running,
            threads,
        }
    }

    /// Whether the system gave no thread.
    pub fn is_empty(&self) -> bool {
        self.threads.is_empty()
    }

    /// Waits for threads that have been told to stop, and leaves those behind that do not.
    pub fn join(&mut self) {
        let count = lock(&self.running.count);
        let waited = self
            .running
            .ended
            .wait_timeout_while(count, JOIN_TIMEOUT, |count| *count > 0);
        let left = *waited.unwrap_or_else(PoisonError::into_inner).0;
        if left > 0 {
            tracing::warn!(
                "{left} threads that load {} are stuck in a read and are left behind",
                self.what
            );
            return;
        }
        for thread in self.threads.drain(..) {
            // A thread catches what its source panics with: nothing is lost by not asking.
            let _ = thread.join();
        }
    }
}

impl Running {
    fn leave(&self) {
        *lock(&self.count) -= 1;
        self.ended.notify_all();
    }
}

/// Between the lowest priority, 0, and the highest, 99: on Linux a niceness of about 10.
fn lower_priority() {
    use thread_priority::{ThreadPriority, ThreadPriorityValue};
    const PRIORITY: u8 = 25;
    if let Ok(priority) = ThreadPriorityValue::try_from(PRIORITY) {
        // Some systems do not let a program choose: then the frame and the threads share as equals.
        let _ = ThreadPriority::Crossplatform(priority).set_for_current();
    }
}
