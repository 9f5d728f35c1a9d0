//! Loader threads, and the state that they share with the renderer.
//!
//! The renderer only tries the mutex. If a low-priority thread was suspended inside, the frame continues and retries later.

use crate::elevation::tiles::HeldTile;
use crate::elevation::{HeightTileError, HeightTileKey, HeightTileLayout, HeightTileSource};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use terrella_files::loaders::{LoadQueue, Loaders};

/// Maximum loaded tiles that wait to be accepted; threads pause meanwhile.
const MOST_WAITING: usize = 32;

/// Result of a load.
pub(super) type Loaded = (HeightTileKey, Result<HeldTile, HeightTileError>);

pub(super) struct HeightLoader {
    reads: Arc<HeightReads>,
    threads: Loaders,
}

struct HeightReads {
    source: Arc<dyn HeightTileSource>,
    layout: HeightTileLayout,
    queue: LoadQueue<Work>,
    /// Whether each thread's load was cancelled.
    cancelled: Vec<AtomicBool>,
}

#[derive(Default)]
struct Work {
    /// The most urgent last.
    queue: Vec<HeightTileKey>,
    /// The tile that each thread is loading.
    loading: Vec<Option<HeightTileKey>>,
    finished: Vec<Loaded>,
}

impl HeightLoader {
    /// Starts the threads. If the system cannot start one, the others do its work.
    pub fn new(source: Arc<dyn HeightTileSource>, threads: usize) -> Self {
        let work = Work {
            loading: vec![None; threads],
            ..Work::default()
        };
        let reads = Arc::new(HeightReads {
            layout: source.layout(),
            source,
            queue: LoadQueue::new(work),
            cancelled: (0..threads).map(|_| AtomicBool::new(false)).collect(),
        });
        let own = Arc::clone(&reads);
        let threads = Loaders::start("heights", threads, move |worker| {
            own.work_until_stopped(worker);
        });
        Self { reads, threads }
    }

    /// Takes loaded tiles if the list is unlocked. Never waits.
    pub fn collect(&self) -> Vec<Loaded> {
        let work = self.reads.queue.try_lock();
        work.map_or_else(Vec::new, |mut work| {
            if !work.finished.is_empty() {
                self.reads.queue.wake();
            }
            std::mem::take(&mut work.finished)
        })
    }

    /// Sets the tiles to load, the most urgent first; loads that are not among them are cancelled. Never waits: returns
    /// false if the list is locked.
    pub fn hand_over(&self, queue: &[HeightTileKey]) -> bool {
        let Some(mut work) = self.reads.queue.try_lock() else {
            return false;
        };
        let Work {
            queue: todo,
            loading,
            finished,
            ..
        } = &mut *work;
        for (cancelled, key) in self.reads.cancelled.iter().zip(&*loading) {
            let is_wanted = key.is_none_or(|key| queue.contains(&key));
            cancelled.store(!is_wanted, Ordering::Relaxed);
        }
        let is_under_way = |key: &HeightTileKey| {
            loading.contains(&Some(*key)) || finished.iter().any(|(done, _)| done == key)
        };
        todo.clear();
        todo.extend(queue.iter().rev().filter(|key| !is_under_way(key)));
        if !todo.is_empty() {
            self.reads.queue.wake();
        }
        true
    }

    /// Whether nothing is loading or waiting to be taken.
    pub fn is_idle(&self) -> bool {
        let work = self.reads.queue.lock();
        work.finished.is_empty()
            && work.queue.is_empty()
            && work.loading.iter().all(Option::is_none)
    }

    /// Waits until a load has ended, at most for the timeout.
    pub fn wait(&self, timeout: Duration) {
        if self.threads.is_empty() {
            return;
        }
        let work = self.reads.queue.lock();
        let nothing = |work: &mut Work| work.finished.is_empty();
        drop(self.reads.queue.wait(work, timeout, nothing));
    }
}

impl Drop for HeightLoader {
    fn drop(&mut self) {
        self.reads.queue.stop(&mut self.threads);
    }
}

impl HeightReads {
    fn work_until_stopped(&self, worker: usize) {
        while let Some(key) = self.queue.take(|work| self.next(work, worker)) {
            let result = self.load(key, worker);
            self.queue.end(|work| {
                work.loading[worker] = None;
                work.finished.push((key, result));
            });
        }
    }

    fn next(&self, work: &mut Work, worker: usize) -> Option<HeightTileKey> {
        if work.finished.len() >= MOST_WAITING {
            return None;
        }
        let key = work.queue.pop()?;
        work.loading[worker] = Some(key);
        self.cancelled[worker].store(false, Ordering::Relaxed);
        Some(key)
    }

    fn load(&self, key: HeightTileKey, worker: usize) -> Result<HeldTile, HeightTileError> {
        let is_cancelled =
            || self.queue.is_stopped() || self.cancelled[worker].load(Ordering::Relaxed);
        // A source that panics may be in an inconsistent state; each result is validated.
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
