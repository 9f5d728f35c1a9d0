//! Who loads tiles, decoder threads or the host, and their shared state with the frame.
//!
//! The frame only tries to lock the mutex: if a low-priority thread was suspended while it held the lock, the frame continues and tries again the
//! next time.

use super::TileLoading;
use super::cache::{LoadError, LoadId, TileCache, check};
use super::pools::usable;
use crate::tile::{LayerLayout, Tile, TileError, TileFormat, TileKey, TileShape, TileSource};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use terrella_files::clock::Instant;
use terrella_files::loaders::{LoadQueue, Loaders};

pub(super) struct Loader {
    reads: Arc<TileReads>,
    threads: Loaders,
    /// Value at the last access under the mutex.
    reserved_bytes: u64,
    /// Lists that change places with the shared ones, so that nothing is allocated under the mutex.
    started: Vec<(TileKey, LoadId)>,
    finished: Vec<(TileKey, Result<Tile, LoadError>)>,
}

pub(super) struct TileReads {
    source: Arc<dyn TileSource>,
    layers: Vec<LayerLayout>,
    limit_bytes: u64,
    queue: LoadQueue<Work>,
    /// For each thread or load of the host the number of the load that it must cancel; 0 is none.
    cancelled: Vec<AtomicU64>,
}

#[derive(Default)]
struct Work {
    /// Tiles to load, the most urgent first; those before `next` are taken.
    queue: Vec<TileKey>,
    next: usize,
    /// Taken since the frame last looked.
    started: Vec<(TileKey, LoadId)>,
    finished: Vec<(TileKey, Result<Tile, LoadError>)>,
    /// Tiles that are done with, to be freed by a thread: giving back much memory takes time.
    retired: Vec<Tile>,
    /// Memory of all tiles from the time when a thread takes them to the time when they are freed, bytes.
    reserved_bytes: u64,
    /// Number of loads taken so far.
    loads: u64,
    /// Places among `cancelled` for loads of the host, without those under way.
    idle: Vec<usize>,
}

/// Next action of a thread.
enum Next {
    Free(Tile),
    /// A tile, and the number of its load.
    Load(TileKey, u64),
}

impl Loader {
    /// Starts the threads, if threads load.
    pub fn new(source: Arc<dyn TileSource>, limit_bytes: u64, loading: TileLoading) -> Self {
        let (threads, at_once) = match loading {
            TileLoading::Threads(threads) => {
                (threads.unwrap_or_else(usual_threads).clamp(1, 16), 0)
            }
            TileLoading::Host(at_once) => (0, at_once.max(1)),
        };
        let layers = usable(source.layers()).into_iter().cloned().collect();
        let reads = Arc::new(TileReads {
            source,
            layers,
            limit_bytes,
            queue: LoadQueue::new(Work {
                idle: (0..at_once).rev().collect(),
                ..Work::default()
            }),
            cancelled: (0..threads + at_once).map(|_| AtomicU64::new(0)).collect(),
        });
        let own = Arc::clone(&reads);
        let threads = Loaders::start("tiles", threads, move |worker| {
            own.work_until_stopped(worker);
        });
        Self {
            reads,
            threads,
            reserved_bytes: 0,
            started: Vec::new(),
            finished: Vec::new(),
        }
    }

    /// The shared state, for loads of the host.
    pub fn reads(&self) -> &Arc<TileReads> {
        &self.reads
    }

    /// Bytes of tiles under way or waiting, when last looked.
    pub fn reserved_bytes(&self) -> u64 {
        self.reserved_bytes
    }

    /// Reports to the cache which loads were taken and which have ended. Never waits.
    pub fn collect(
        &mut self,
        cache: &mut TileCache,
        now: Instant,
        report_error: impl FnMut(TileKey, LoadError),
    ) {
        let reads = Arc::clone(&self.reads);
        if let Some(mut work) = reads.queue.try_lock() {
            self.exchange(&mut work);
        }
        self.report(cache, now, report_error);
    }

    /// Passes the new queue and the tiles to be freed to the threads, and cancels loads that are no longer requested. Never waits.
    pub fn hand_over(&mut self, cache: &mut TileCache) {
        for load in cache.pending_loads() {
            let LoadId { worker, number } = load.id;
            let number = if load.cancel { number } else { 0 };
            self.reads.cancelled[worker].store(number, Ordering::Relaxed);
        }
        if let Some(mut work) = self.reads.queue.try_lock() {
            self.reads.hand_over(&mut work, cache);
        }
    }

    /// Waits until a load ends or the time is over; whether one has ended.
    pub fn wait(
        &mut self,
        cache: &mut TileCache,
        timeout: Duration,
        now: Instant,
        report_error: impl FnMut(TileKey, LoadError),
    ) -> bool {
        let reads = Arc::clone(&self.reads);
        let mut work = reads.queue.lock();
        reads.hand_over(&mut work, cache);
        let nothing = |work: &mut Work| work.finished.is_empty();
        let mut work = reads.queue.wait(work, timeout, nothing);
        let has_ended = !work.finished.is_empty();
        self.exchange(&mut work);
        drop(work);
        self.report(cache, now, report_error);
        has_ended
    }

    fn exchange(&mut self, work: &mut Work) {
        self.reserved_bytes = work.reserved_bytes;
        std::mem::swap(&mut self.started, &mut work.started);
        std::mem::swap(&mut self.finished, &mut work.finished);
    }

    fn report(
        &mut self,
        cache: &mut TileCache,
        now: Instant,
        mut report_error: impl FnMut(TileKey, LoadError),
    ) {
        for (key, id) in self.started.drain(..) {
            cache.begin(key, id);
        }
        for (key, result) in self.finished.drain(..) {
            if let Some(error) = cache.finish(key, now, result) {
                report_error(key, error);
            }
        }
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.reads.queue.stop(&mut self.threads);
    }
}

impl TileReads {
    fn hand_over(&self, work: &mut Work, cache: &mut TileCache) {
        let retired = cache.retired();
        let has_retired = retired.len() > 0;
        work.retired.extend(retired);
        let Work { queue, started, .. } = work;
        queue.clear();
        // The cache has not yet been notified of tiles that were taken since.
        let is_taken = |key: &TileKey| started.iter().any(|(taken, _)| taken == key);
        queue.extend(cache.queue().iter().filter(|key| !is_taken(key)));
        work.next = 0;
        if has_retired || !work.queue.is_empty() {
            self.queue.wake();
        }
    }

    /// Format and shape that a tile must have.
    fn expected(&self, key: TileKey) -> Option<(TileFormat, TileShape)> {
        let layer = self.layers.iter().find(|layer| layer.layer == key.layer)?;
        let level = layer.levels.get(usize::from(key.level))?;
        Some((layer.format, level.shape))
    }

    fn bytes(&self, key: TileKey) -> u64 {
        let expected = self.expected(key);
        expected.map_or(0, |(format, shape)| shape.bytes(format) as u64)
    }

    fn work_until_stopped(&self, worker: usize) {
        while let Some(next) = self.queue.take(|work| self.next(work, worker)) {
            match next {
                Next::Free(tile) => {
                    let bytes = tile.texels.len() as u64;
                    drop(tile);
                    self.queue.lock().reserved_bytes -= bytes;
                }
                Next::Load(key, number) => {
                    let result = self.load(key, LoadId { worker, number });
                    self.queue.end(|work| self.finish(work, key, result));
                }
            }
        }
    }

    fn finish(&self, work: &mut Work, key: TileKey, result: Result<Tile, LoadError>) {
        if result.is_err() {
            work.reserved_bytes -= self.bytes(key);
        }
        work.finished.push((key, result));
    }

    /// Begins a load of the host: the most urgent one.
    pub fn begin(&self) -> Option<(TileKey, LoadId)> {
        let work = &mut *self.queue.lock();
        loop {
            let worker = *work.idle.last()?;
            match self.next(work, worker)? {
                Next::Free(tile) => work.reserved_bytes -= tile.texels.len() as u64,
                Next::Load(key, number) => {
                    work.idle.pop();
                    return Some((key, LoadId { worker, number }));
                }
            }
        }
    }

    /// Ends a load of the host.
    pub fn end(&self, key: TileKey, id: LoadId, result: Result<Tile, TileError>) {
        let result = self.checked(key, result);
        self.queue.end(|work| {
            work.idle.push(id.worker);
            self.finish(work, key, result);
        });
    }

    pub fn is_cancelled(&self, id: LoadId) -> bool {
        let cancelled = &self.cancelled[id.worker];
        self.queue.is_stopped() || cancelled.load(Ordering::Relaxed) == id.number
    }

    fn next(&self, work: &mut Work, worker: usize) -> Option<Next> {
        if let Some(tile) = work.retired.pop() {
            return Some(Next::Free(tile));
        }
        let key = work.queue.get(work.next).copied()?;
        let bytes = self.bytes(key);
        let reserved = work.reserved_bytes;
        if reserved > 0 && reserved.saturating_add(bytes) > self.limit_bytes {
            return None;
        }
        work.next += 1;
        work.loads += 1;
        work.reserved_bytes += bytes;
        let number = work.loads;
        work.started.push((key, LoadId { worker, number }));
        Some(Next::Load(key, number))
    }

    fn load(&self, key: TileKey, id: LoadId) -> Result<Tile, LoadError> {
        let is_cancelled = || self.is_cancelled(id);
        // A source that panics half-way may be left in disorder; what it gives is checked each time.
        let read = catch_unwind(AssertUnwindSafe(|| self.source.read(key, &is_cancelled)));
        match read {
            Ok(read) => self.checked(key, read),
            Err(panic) => Err(LoadError::Panicked(panic_text(panic.as_ref()))),
        }
    }

    fn checked(&self, key: TileKey, read: Result<Tile, TileError>) -> Result<Tile, LoadError> {
        let tile = read?;
        match self.expected(key) {
            Some((format, shape)) => check(tile, format, shape),
            None => Ok(tile),
        }
    }
}

/// Decoder threads by default.
fn usual_threads() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if cores <= 2 { 1 } else { (cores / 2).min(4) }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "without a message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{TileRequest, plan_pools};
    use crate::tile::{BlockSet, LevelLayout, MapLayer};
    use std::sync::atomic::AtomicBool;

    /// Waits in each read until it may go on.
    struct Gate(Vec<LayerLayout>, AtomicBool);

    impl TileSource for Gate {
        fn layers(&self) -> &[LayerLayout] {
            &self.0
        }

        fn read(&self, key: TileKey, _: &dyn Fn() -> bool) -> Result<Tile, TileError> {
            while !self.1.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
            }
            Err(TileError::Absent(key))
        }
    }

    #[test]
    fn a_tile_taken_since_the_last_look_is_not_queued_again() {
        let level = |pixels| {
            LevelLayout::of_blocks(TileShape::new(pixels).expect("in range"), BlockSet::ALL)
        };
        let layers = vec![LayerLayout {
            layer: MapLayer::Day,
            format: TileFormat::R8Unorm,
            levels: vec![level(24), level(16)],
        }];
        let mut cache = TileCache::new(&layers, plan_pools(&layers, u64::MAX), u64::MAX);
        let source = Arc::new(Gate(layers, AtomicBool::new(false)));
        let mut loader = Loader::new(
            Arc::clone(&source) as Arc<dyn TileSource>,
            u64::MAX,
            TileLoading::Threads(Some(1)),
        );
        let key = |block| TileKey {
            layer: MapLayer::Day,
            level: 0,
            block,
            part: 0,
        };
        let requests = [1, 2].map(|block| TileRequest {
            key: key(block),
            drawn: true,
        });
        cache.allocate(Instant::now(), &requests, 0);
        let reads = Arc::clone(&loader.reads);
        reads.hand_over(&mut reads.queue.lock(), &mut cache);
        while reads.queue.lock().started.is_empty() {
            std::thread::sleep(Duration::from_millis(1));
        }
        // The frame has not looked, and hands over what it still believes to be queued.
        assert_eq!(cache.queue(), [key(1), key(2)]);
        reads.hand_over(&mut reads.queue.lock(), &mut cache);
        assert_eq!(reads.queue.lock().queue, [key(2)]);
        loader.collect(&mut cache, Instant::now(), |_, _| {});
        assert_eq!(cache.queue(), [key(2)]);
        source.1.store(true, Ordering::Relaxed);
    }
}
