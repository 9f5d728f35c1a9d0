//! Threads that load tiles in the background, and locks for their shared state.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long threads are waited for at the end. One that is stuck in a read is left to itself then.
const JOIN_TIMEOUT: Duration = Duration::from_secs(2);

/// Locks a mutex under which no code panics, so that poisoning can be ignored.
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

/// State shared by loader threads and the renderer. One mutex guards lists of keys and loaded tiles: no tile is read, decoded or freed under it.
pub struct LoadQueue<W> {
    work: Mutex<W>,
    /// Signals that a thread may have work.
    to_do: Condvar,
    ended: Condvar,
    is_stopped: AtomicBool,
}

impl<W> LoadQueue<W> {
    /// A queue that holds this work.
    pub fn new(work: W) -> Self {
        Self {
            work: Mutex::new(work),
            to_do: Condvar::new(),
            ended: Condvar::new(),
            is_stopped: AtomicBool::new(false),
        }
    }

    /// The work; waits until the mutex is free.
    pub fn lock(&self) -> MutexGuard<'_, W> {
        lock(&self.work)
    }

    /// The work, if the mutex is free just now.
    pub fn try_lock(&self) -> Option<MutexGuard<'_, W>> {
        try_lock(&self.work)
    }

    /// Wakes the threads: there may be something to do.
    pub fn wake(&self) {
        self.to_do.notify_all();
    }

    /// Whether the threads must stop.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// For a thread: waits until `next` finds work; `None` when it must stop.
    pub fn take<T>(&self, mut next: impl FnMut(&mut W) -> Option<T>) -> Option<T> {
        let mut work = self.lock();
        while !self.is_stopped() {
            let found = next(&mut work);
            if found.is_some() {
                return found;
            }
            let waited = self.to_do.wait(work);
            work = waited.unwrap_or_else(PoisonError::into_inner);
        }
        None
    }

    /// For a thread: records that a load has ended.
    pub fn end(&self, note: impl FnOnce(&mut W)) {
        note(&mut self.lock());
        self.ended.notify_all();
    }

    /// Waits while loads end and `is_waiting` holds, or for so long.
    pub fn wait<'a>(
        &self,
        work: MutexGuard<'a, W>,
        timeout: Duration,
        is_waiting: impl FnMut(&mut W) -> bool,
    ) -> MutexGuard<'a, W> {
        let waited = self.ended.wait_timeout_while(work, timeout, is_waiting);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Stops the threads and waits for them.
    pub fn stop(&self, threads: &mut Loaders) {
        self.is_stopped.store(true, Ordering::Relaxed);
        // Under the lock, so that no thread misses it between its look and its sleep.
        let work = self.lock();
        self.wake();
        drop(work);
        threads.join();
    }
}

/// Threads of low priority that work until their queue is stopped.
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
    /// Starts threads, each with its number; `what` they load names them. Where the system cannot start one, the others do its work.
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
                #[cfg(not(target_family = "wasm"))]
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

    /// Whether the system provided no thread.
    pub fn is_empty(&self) -> bool {
        self.threads.is_empty()
    }

    /// Waits for threads that were requested to stop, and detaches those that do not.
    pub fn join(&mut self) {
        // A web page has none, and no clock to wait by.
        if self.is_empty() {
            return;
        }
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
#[cfg(not(target_family = "wasm"))]
fn lower_priority() {
    use thread_priority::{ThreadPriority, ThreadPriorityValue};
    const PRIORITY: u8 = 25;
    if let Ok(priority) = ThreadPriorityValue::try_from(PRIORITY) {
        // Some systems do not allow it: then the frame and the threads have equal priority.
        let _ = ThreadPriority::Crossplatform(priority).set_for_current();
    }
}
