//! Loader threads, and what they share with who draws.
//!
//! One mutex guards lists of keys and loaded tiles; nobody reads or decodes under it. Who draws only tries it: where a thread of low
//! priority was put to sleep inside, the frame goes on and comes back the next time.

use crate::elevation::tiles::HeldTile;
use crate::elevation::{HeightTileError, HeightTileKey, HeightTileLayout, HeightTileSource};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Loaded tiles that may wait to be taken in; threads rest meanwhile.
const MOST_WAITING: usize = 32;

/// How long a dropped loader waits for its threads. One that is stuck in a read is left to itself then.
const JOIN_TIMEOUT: Duration = Duration::from_secs(2);

/// A tile as a thread has left it.
pub(super) type Loaded = (HeightTileKey, Result<HeldTile, HeightTileError>);

pub(super) struct HeightLoader {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared {
    source: Arc<dyn HeightTileSource>,
    layout: HeightTileLayout,
    work: Mutex<Work>,
    /// There may be something to do for a thread.
    to_do: Condvar,
    /// A load or a thread has ended.
    ended: Condvar,
    stop: AtomicBool,
    /// Each thread's load is not wanted any more.
    cancelled: Vec<AtomicBool>,
}

#[derive(Default)]
struct Work {
    /// The most lacking last.
    queue: Vec<HeightTileKey>,
    /// What each thread loads.
    loading: Vec<Option<HeightTileKey>>,
    finished: Vec<Loaded>,
    threads: usize,
}

impl HeightLoader {
    /// Starts the threads. One that the system refuses is done without.
    pub fn new(source: Arc<dyn HeightTileSource>, threads: usize) -> Self {
        let work = Work {
            loading: vec![None; threads],
            ..Work::default()
        };
        let shared = Arc::new(Shared {
            layout: source.layout(),
            source,
            work: Mutex::new(work),
            to_do: Condvar::new(),
            ended: Condvar::new(),
            stop: AtomicBool::new(false),
            cancelled: (0..threads).map(|_| AtomicBool::new(false)).collect(),
        });
        let start = |worker: usize| {
            let own = Arc::clone(&shared);
            shared.lock().threads += 1;
            let thread = thread::Builder::new().name(format!("terrella heights {worker}"));
            let thread = thread.spawn(move || own.work_until_stopped(worker));
            if let Err(error) = &thread {
                shared.lock().threads -= 1;
                tracing::warn!("a thread for heights could not be started: {error}");
            }
            thread.ok()
        };
        let threads = (0..threads).filter_map(start).collect();
        Self { shared, threads }
    }

    /// Takes what has been loaded, if the list is free just now. Never waits.
    pub fn collect(&self) -> Vec<Loaded> {
        let work = self.shared.try_lock();
        work.map_or_else(Vec::new, |mut work| {
            if !work.finished.is_empty() {
                self.shared.to_do.notify_all();
            }
            std::mem::take(&mut work.finished)
        })
    }

    /// Hands over what shall be loaded, most lacking first; loads that are not among it are given up. Never waits: false
    /// where the list is not free just now.
    pub fn hand_over(&self, queue: &[HeightTileKey]) -> bool {
        let Some(mut work) = self.shared.try_lock() else {
            return false;
        };
        let Work {
            queue: todo,
            loading,
            finished,
            ..
        } = &mut *work;
        for (cancelled, key) in self.shared.cancelled.iter().zip(&*loading) {
            let is_wanted = key.is_none_or(|key| queue.contains(&key));
            cancelled.store(!is_wanted, Ordering::Relaxed);
        }
        let is_under_way = |key: &HeightTileKey| {
            loading.contains(&Some(*key)) || finished.iter().any(|(done, _)| done == key)
        };
        todo.clear();
        todo.extend(queue.iter().rev().filter(|key| !is_under_way(key)));
        if !todo.is_empty() {
            self.shared.to_do.notify_all();
        }
        true
    }

    /// Whether nothing is being loaded, or waits to be taken.
    pub fn is_idle(&self) -> bool {
        let work = self.shared.lock();
        work.finished.is_empty()
            && work.queue.is_empty()
            && work.loading.iter().all(Option::is_none)
    }

    /// Waits until a load has ended, or for so long.
    pub fn wait(&self, timeout: Duration) {
        let work = self.shared.lock();
        let nothing = |work: &mut Work| work.finished.is_empty() && work.threads > 0;
        let waited = self.shared.ended.wait_timeout_while(work, timeout, nothing);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }
}

impl Drop for HeightLoader {
    fn drop(&mut self) {
        let shared = &self.shared;
        shared.stop.store(true, Ordering::Relaxed);
        let work = shared.lock();
        shared.to_do.notify_all();
        let waited = shared
            .ended
            .wait_timeout_while(work, JOIN_TIMEOUT, |work| work.threads > 0);
        let left = waited.unwrap_or_else(PoisonError::into_inner).0.threads;
        if left > 0 {
            tracing::warn!("{left} threads for heights are stuck in a read and are left behind");
            return;
        }
        for thread in self.threads.drain(..) {
            // A thread catches what its source panics with: nothing is lost by not asking.
            let _ = thread.join();
        }
    }
}

impl Shared {
    /// The work. Nothing panics under the mutex, so that a poisoned one is as good.
    fn lock(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn try_lock(&self) -> Option<MutexGuard<'_, Work>> {
        match self.work.try_lock() {
            Ok(work) => Some(work),
            Err(TryLockError::Poisoned(work)) => Some(work.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    fn work_until_stopped(&self, worker: usize) {
        lower_priority();
        while let Some(key) = self.take(worker) {
            let result = self.load(key, worker);
            let mut work = self.lock();
            work.loading[worker] = None;
            work.finished.push((key, result));
            self.ended.notify_all();
        }
        self.lock().threads -= 1;
        self.ended.notify_all();
    }

    /// Waits for a tile to load; `None` when it is time to stop.
    fn take(&self, worker: usize) -> Option<HeightTileKey> {
        let mut work = self.lock();
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return None;
            }
            let may_load = work.finished.len() < MOST_WAITING;
            if let Some(key) = may_load.then(|| work.queue.pop()).flatten() {
                work.loading[worker] = Some(key);
                self.cancelled[worker].store(false, Ordering::Relaxed);
                return Some(key);
            }
            let waited = self.to_do.wait(work);
            work = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn load(&self, key: HeightTileKey, worker: usize) -> Result<HeldTile, HeightTileError> {
        let is_cancelled =
            || self.stop.load(Ordering::Relaxed) || self.cancelled[worker].load(Ordering::Relaxed);
        // A source that panics half-way may be left in disorder; what it gives is checked each time.
        let read = catch_unwind(AssertUnwindSafe(|| self.source.read(key, &is_cancelled)));
        let samples = read.unwrap_or_else(|_| {
            Err(HeightTileError::Unsound {
                key,
                what: "reading it failed in a way that is a fault of the program".into(),
            })
        })?;
        HeldTile::new(key, &self.layout, samples)
    }
}

/// Where loader threads stand between the lowest priority, 0, and the highest, 99: on Linux a niceness of about 10.
#[cfg(feature = "packs")]
fn lower_priority() {
    use thread_priority::{ThreadPriority, ThreadPriorityValue};
    const PRIORITY: u8 = 25;
    if let Ok(priority) = ThreadPriorityValue::try_from(PRIORITY) {
        // Some systems do not let a program choose: then the frame and the threads share as equals.
        let _ = ThreadPriority::Crossplatform(priority).set_for_current();
    }
}

/// Without packs the crate that sets priorities is not there: the threads are as any others.
#[cfg(not(feature = "packs"))]
fn lower_priority() {}
