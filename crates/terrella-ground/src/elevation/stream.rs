//! Heights larger than memory: tiles of a source, streamed as they are looked at.
//!
//! | file | what |
//! |---|---|
//! | `cache.rs` | which tiles are asked for, loaded, in memory and given up: a state machine without threads or a clock |
//! | `loader.rs` | threads that read tiles |
//! | `viewer.rs` | where heights are looked at from |
//!
//! What heights are while some tiles are there and others not, `tiles/pyramid.rs` says.
//!
//! # A frame
//!
//! [`StreamedGround::take_over`] takes in tiles that have come: the only moment at which heights change. Who draws then takes
//! [`StreamedGround::now`], which never changes, tells its surface by [`StreamedGround::changes_since`] where heights have changed since
//! the last time, and reads. Reading notes what is not there: a tile is wanted because a height was asked for that would be finer
//! with it. Asked for at a spacing of its own it is always wanted; asked for as the finest that there is, if its coarser
//! stand-in's samples are seen larger than the tolerance of some [`HeightViewer`].
//!
//! # Memory
//!
//! Up to the budget tiles stay. Then a tile is given up for one whose stand-in is seen half as large again as its own would be, so
//! that two tiles never take turns; what finds no room that way stays coarse, and is counted.

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

/// Tiles that a frame takes over in an `Earth`, at most: each has its part of the ground made again.
pub const TILES_PER_FRAME: usize = 4;

/// What a [`StreamedGround`] may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightStreamOptions {
    /// Bytes of heights in memory, the coarsest level's among them. 256 MiB by default. While a frame goes over to new tiles, tables
    /// of some hundred bytes a tile are held twice.
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

/// Why there is no ground of tiles.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StreamedGroundError {
    /// A tile of the coarsest level, which must be there.
    #[error("the coarsest level of elevation data is incomplete: {0}")]
    Tile(#[from] HeightTileError),
    /// The coarsest level as a whole.
    #[error("the coarsest level of heights {0}")]
    Coarsest(#[from] GridError),
}

/// Heights of a source of tiles, under any number of [`HeightGrid`](super::HeightGrid)s. Give it to `GroundOptions`.
///
/// As an [`Elevation`] it uses the tiles in memory at the time of the call; surfaces use [`Self::now`].
pub struct StreamedGround {
    cache: Mutex<HeightCache>,
    loader: HeightLoader,
    viewers: Mutex<Viewers>,
    /// The grids over the tiles of now, and its version.
    now: RwLock<(u64, Arc<Ground>)>,
    /// As [`Self::take_over`] left them.
    counters: Mutex<HeightTileStats>,
}

#[derive(Default)]
struct Viewers {
    all: Vec<Weak<HeightViewer>>,
    looks: Vec<EyePlace>,
    /// As when it was planned last.
    planned: Vec<EyePlace>,
    rested: u32,
    /// The loader has the plan, and nothing has happened since.
    is_planned: bool,
}

/// Calls of [`StreamedGround::take_over`] after which requests are weighed again while tiles are loaded.
const REST: u32 = 4;

impl fmt::Debug for StreamedGround {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StreamedGround")
            .field("counters", &self.counters())
            .finish_non_exhaustive()
    }
}

impl StreamedGround {
    /// Reads the coarsest level, and starts the threads. `over` lies over the tiles as it would over other grids.
    ///
    /// # Errors
    /// A tile of the coarsest level that cannot be read, and more of them than the budget allows.
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

    /// Somebody who looks at the ground: what is asked for as the finest that there is comes as fine as some viewer sees.
    pub fn viewer(&self) -> Arc<HeightViewer> {
        let viewer = Arc::new(HeightViewer::default());
        self.viewers().all.push(Arc::downgrade(&viewer));
        viewer
    }

    /// Takes in at most so many of the tiles that have come, and says what shall be loaded. Call it between frames. Never waits: if
    /// another thread is here, it does nothing.
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
        // While the threads have enough to do, not in each frame.
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

    /// The heights of now and their version: they do not change, whatever comes.
    pub fn now(&self) -> (u64, Arc<Ground>) {
        let now = self.now.read().unwrap_or_else(PoisonError::into_inner);
        (now.0, now.1.clone())
    }

    /// Where heights have changed since a version; `None` where that is too long ago to know: everywhere, perhaps.
    pub fn changes_since(&self, version: u64) -> Option<Vec<HeightChange>> {
        self.cache().changes_since(version)
    }

    /// What the stream was doing at the end of the last [`Self::take_over`].
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
