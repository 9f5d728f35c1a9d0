//! Loader threads, and what they share with who draws.
//!
//! One mutex guards lists of keys and loaded tiles; nobody reads or decodes under it. Who draws only tries it: where a thread of low
//! priority was put to sleep inside, the frame goes on and comes back the next time.

use crate::elevation::tiles::HeldTile;
use crate::elevation::{HeightTileError, HeightTileKey, HeightTileLayout, HeightTileSource};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;
use terrella_files::loaders::{Loaders, lock, try_lock};

/// Loaded tiles that may wait to be taken in; threads rest meanwhile.
const MOST_WAITING: usize = 32;

/// A tile as a thread has left it.
pub(super) type Loaded = (HeightTileKey, Result<HeldTile, HeightTileError>);

pub(super) struct HeightLoader {
    shared: Arc<Shared>,
    threads: Loaders,
}

struct Shared {
    source: Arc<dyn HeightTileSource>,
    layout: HeightTileLayout,
    work: Mutex<Work>,
    /// There may be something to do for a thread.
    to_do: Condvar,
    /// A load has ended.
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
        let own = Arc::clone(&shared);
        let threads = Loaders::start("heights", threads, move |worker| {
            own.work_until_stopped(worker);
        });
        Self { shared, threads }
    }

    /// Takes what has been loaded, if the list is free just now. Never waits.
    pub fn collect(&self) -> Vec<Loaded> {
        let work = try_lock(&self.shared.work);
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
        let Some(mut work) = try_lock(&self.shared.work) else {
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
        let work = lock(&self.shared.work);
        work.finished.is_empty()
            && work.queue.is_empty()
            && work.loading.iter().all(Option::is_none)
    }

    /// Waits until a load has ended, or for so long.
    pub fn wait(&self, timeout: Duration) {
        if self.threads.is_empty() {
            return;
        }
        let work = lock(&self.shared.work);
        let nothing = |work: &mut Work| work.finished.is_empty();
        let waited = self.shared.ended.wait_timeout_while(work, timeout, nothing);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }
}

impl Drop for HeightLoader {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        // Under the lock, so that no thread misses it between its look and its sleep.
        let work = lock(&self.shared.work);
        self.shared.to_do.notify_all();
        drop(work);
        self.threads.join();
    }
}

impl Shared {
    fn work_until_stopped(&self, worker: usize) {
        while let Some(key) = self.take(worker) {
            let result = self.load(key, worker);
            let mut work = lock(&self.work);
            work.loading[worker] = None;
            work.finished.push((key, result));
            self.ended.notify_all();
        }
    }

    /// Waits for a tile to load; `None` when it is time to stop.
    fn take(&self, worker: usize) -> Option<HeightTileKey> {
        let mut work = lock(&self.work);
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
