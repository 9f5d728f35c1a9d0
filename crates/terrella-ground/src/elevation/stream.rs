//! Elevation data larger than memory: tiles of a source, streamed on demand.
//!
//! | file | what |
//! |---|---|
//! | `cache.rs` | requests, loads, resident tiles and eviction: a state machine without threads or a clock |
//! | `loader.rs` | threads that read tiles |
//! | `viewer.rs` | eye positions |
//!
//! `tiles/pyramid.rs` defines the heights while only some tiles are in memory.
//!
//! # A frame
//!
//! [`StreamedGround::take_over`] accepts loaded tiles; heights change only at this moment. The renderer then takes
//! [`StreamedGround::now`], an immutable snapshot. It passes the areas of [`StreamedGround::changes_since`] to its surface, and reads
//! heights. Reading records missing tiles: a tile is wanted if a requested height would be finer with it. A request with an explicit
//! spacing always wants the tile. A request for the finest data wants it only if the samples of its coarser stand-in appear larger than
//! some [`HeightViewer`]'s tolerance.
//!
//! # Memory
//!
//! Tiles stay in memory up to the budget. After that a tile is evicted only for one whose stand-in appears half as large again as
//! its own would. Two tiles therefore never alternate. Ground without room stays coarse and is counted.

mod cache;
mod loader;
mod viewer;

#[cfg(test)]
pub(crate) mod test_source;
#[cfg(test)]
mod tests;

pub use viewer::{HeightEye, HeightViewer};

use super::{
    Bounds, Elevation, GridError, Ground, HeightChange, HeightRange, HeightTileError,
    HeightTileKey, HeightTileSource,
};
use crate::height::HeightTileStats;
use cache::HeightCache;
use loader::HeightLoader;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, Weak};
use std::time::Duration;
use terrella_files::loaders::{lock, try_lock};
use viewer::EyePlace;

/// Maximum tiles that a frame accepts in an `Earth`: each causes its part of the ground to be
/// rebuilt.
pub const TILES_PER_FRAME: usize = 4;

/// Resource limits of a [`StreamedGround`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightStreamOptions {
    /// Bytes of heights in memory, including the coarsest level. 256 MiB by default. While a frame switches to new tiles, tables of
    /// some hundred bytes per tile are held twice.
    pub memory_bytes: u64,
    /// Loader threads, 1…16; by default 1 on a machine of one or two cores, else 2.
    pub threads: usize,
}

impl Default for HeightStreamOptions {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            memory_bytes: 256 << 20,
            threads: if cores <= 2 { 1 } else { 2 },
        }
    }
}

/// Why a ground of tiles could not be created.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StreamedGroundError {
    /// A tile of the coarsest level is missing or invalid; that level is required.
    #[error("the coarsest level of elevation data is incomplete: {0}")]
    Tile(#[from] HeightTileError),
    /// The coarsest level as a whole is invalid.
    #[error("the coarsest level of heights {0}")]
    Coarsest(#[from] GridError),
}

/// Heights of a tile source beneath any number of [`HeightGrid`](super::HeightGrid)s. Pass it to `GroundOptions`.
///
/// As an [`Elevation`] it uses the tiles in memory at the time of the call; surfaces use [`Self::now`].
pub struct StreamedGround {
    cache: Mutex<HeightCache>,
    loader: HeightLoader,
    viewers: Mutex<Viewers>,
    /// The grids over the current tiles, and their version.
    now: RwLock<(u64, Arc<Ground>)>,
    /// Counters at the end of the last [`Self::take_over`].
    counters: Mutex<HeightTileStats>,
}

#[derive(Default)]
struct Viewers {
    all: Vec<Weak<HeightViewer>>,
    looks: Vec<EyePlace>,
    /// Eye positions of the last plan.
    planned: Vec<EyePlace>,
    rested: u32,
    /// Whether the loader has the plan and nothing happened since.
    is_planned: bool,
}

/// Number of [`StreamedGround::take_over`] calls between plans while tiles are loading.
const REST: u32 = 4;

impl fmt::Debug for StreamedGround {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StreamedGround")
            .field("counters", &self.counters())
            .finish_non_exhaustive()
    }
}

impl StreamedGround {
    /// Reads the coarsest level, and starts the threads. `over` covers the tiles as it would cover other grids.
    ///
    /// # Errors
    /// An unreadable tile of the coarsest level, or a coarsest level beyond the budget.
    pub fn new(
        source: Arc<dyn HeightTileSource>,
        over: Ground,
        options: &HeightStreamOptions,
    ) -> Result<Self, StreamedGroundError> {
        let cache = HeightCache::new(source.clone(), options.memory_bytes)?;
        let now = Arc::new(over.over_tiles(cache.pyramid().clone()));
        Ok(Self {
            counters: Mutex::new(cache.counters()),
            cache: Mutex::new(cache),
            loader: HeightLoader::new(source, options.threads.clamp(1, 16)),
            viewers: Mutex::default(),
            now: RwLock::new((0, now)),
        })
    }

    /// Registers a viewer. Requests for the finest data load as fine as some viewer can see.
    pub fn viewer(&self) -> Arc<HeightViewer> {
        let viewer = Arc::new(HeightViewer::default());
        self.viewers().all.push(Arc::downgrade(&viewer));
        viewer
    }

    /// Accepts at most `most` loaded tiles, and decides what to load next. Call it between frames. It never waits: if another
    /// thread is inside, it does nothing.
    pub fn take_over(&self, most: usize) {
        let Some(mut cache) = try_lock(&self.cache) else {
            return;
        };
        let mut viewers = self.viewers();
        viewers.all.retain(|viewer| viewer.strong_count() > 0);
        let Viewers {
            all,
            looks,
            planned,
            rested,
            is_planned,
        } = &mut *viewers;
        for (key, result) in self.loader.collect() {
            cache.finish(key, result);
            *is_planned = false;
        }
        looks.clear();
        looks.extend(all.iter().filter_map(|v| v.upgrade()?.looks()));
        let before = cache.version();
        if cache.has_arrivals() {
            cache.take_over(looks, most);
            *is_planned = false;
        }
        let has_changed = cache.version() != before;
        *rested += 1;
        let is_due = !*is_planned || cache.has_wants() || looks != planned;
        // While the threads are busy, not in every frame.
        if is_due && (*rested >= REST || cache.queue().is_empty()) {
            cache.plan(looks);
            *is_planned = self.loader.hand_over(cache.queue());
            planned.clone_from(looks);
            *rested = 0;
        }
        drop(viewers);
        *lock(&self.counters) = cache.counters();
        if has_changed {
            cache.pyramid().wants.forget_taken();
            let mut now = self.now.write().unwrap_or_else(PoisonError::into_inner);
            let tiles = cache.pyramid().clone();
            *now = (cache.version(), Arc::new(now.1.over_tiles(tiles)));
        }
    }

    /// The current heights and their version: an immutable snapshot.
    pub fn now(&self) -> (u64, Arc<Ground>) {
        let now = self.now.read().unwrap_or_else(PoisonError::into_inner);
        (now.0, now.1.clone())
    }

    /// Areas where heights changed since a version; `None` if that is too long ago, which means possibly
    /// everywhere.
    pub fn changes_since(&self, version: u64) -> Option<Vec<HeightChange>> {
        self.cache().changes_since(version)
    }

    /// State of the stream at the end of the last [`Self::take_over`].
    pub fn counters(&self) -> HeightTileStats {
        *lock(&self.counters)
    }

    /// Requested tiles that are missing: loading, over budget, or unreadable.
    pub fn missing(&self) -> Vec<HeightTileKey> {
        self.cache().missing()
    }

    /// Whether all requested heights are final: none will be refined.
    pub fn is_settled(&self) -> bool {
        let cache = self.cache();
        cache.queue().is_empty()
            && !cache.has_arrivals()
            && !cache.has_wants()
            && self.loader.is_idle()
    }

    /// Waits until a tile has arrived, or until the timeout.
    pub fn wait(&self, timeout: Duration) {
        self.loader.wait(timeout);
    }

    fn viewers(&self) -> MutexGuard<'_, Viewers> {
        lock(&self.viewers)
    }

    fn cache(&self) -> MutexGuard<'_, HeightCache> {
        lock(&self.cache)
    }
}

impl Elevation for StreamedGround {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        self.now().1.height_m(lat_rad, lon_rad, spacing_rad)
    }

    fn range_m(&self, bounds: &Bounds) -> HeightRange {
        self.now().1.range_m(bounds)
    }

    fn range_up_to_m(&self, bounds: &Bounds, coarsest_rad: f64) -> HeightRange {
        self.now().1.range_up_to_m(bounds, coarsest_rad)
    }

    fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        self.now().1.finest_spacing_rad(lat_rad, lon_rad)
    }

    fn finest_spacing_in(&self, bounds: &Bounds) -> f64 {
        self.now().1.finest_spacing_in(bounds)
    }

    fn streamed(&self) -> Option<&StreamedGround> {
        Some(self)
    }
}
