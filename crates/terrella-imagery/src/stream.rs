//! Streaming and residency: which tiles are in memory, and the threads that load them. Independent of the GPU.
//!
//! | file | content |
//! |---|---|
//! | `pools.rs` | the budget of texture memory, split into pools of slots |
//! | `cache/` | requested, loaded, resident and drawn tiles: a state machine without threads or a clock |
//! | `loader.rs` | decoder threads and their shared state with the frame |
//! | `hosted.rs` | loads that the host does itself |
//!
//! # A tile's way
//!
//! ```text
//! requested ─► queued ─► loading ─► decoded ─► in parts into a slot ─► resident ─► evicted
//!                        (thread)   (waits)    (upload budget)         (drawn)
//! ```
//!
//! A slot is taken only when the first part of a decoded tile is written, so that its previous content is drawn until then. A tile that is no
//! longer requested leaves this sequence at any point.
//!
//! # Why nothing waits forever
//!
//! Slots are allocated to requests, and a pool never promises more slots than it has. A tile without a slot can therefore only be blocked by tiles
//! that are not requested and are drawn as stand-ins. A stand-in that is coarser than its block's allocated tile waits for a pool finer than its
//! own, and in the finest pool there is none: the wait ends there, and from there in each coarser pool. A stand-in that is finer than its block's
//! allocated tile is released as soon as its slot is needed. Decoded tiles can fill their memory while the tile that would free a slot is still
//! queued; then the coarser stand-ins of their pools are released too, and tiles that are only expected soon are dropped.
//!
//! In a pool with parts of blocks a block's own tile is requested wherever its parts are, and replaces all that are missing. Any other tile drawn in
//! their place, finer or coarser, is therefore released as soon as its slot is needed.

mod cache;
mod hosted;
mod loader;
mod pools;

pub use super::residency::{
    PartCell, PartTable, PartTables, Pool, ResidentTile, StreamCounters, TileSlot, Upload,
};
pub use cache::{LoadError, LoadId, PendingLoad, TileCache};
pub use hosted::{HostedTiles, TileLoad};
pub use pools::plan_pools;

use super::tile::{MapLayer, TileKey, TileSource};
use loader::Loader;
use std::sync::Arc;
use std::time::Duration;
use terrella_files::clock::Instant;
use terrella_ground::globe::Part;

/// Who loads tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileLoading {
    /// Decoder threads, 1…16; `None` is 1 on a machine of one or two cores, else half of the cores and at most 4.
    Threads(Option<usize>),
    /// The host, so many tiles at once: where there are no threads or tiles come by requests, as in a web page. It takes them from
    /// [`TileStream::take`]; [`TileSource::read`] is not called.
    Host(usize),
}

/// Resources of a [`TileStream`]. Fixed at creation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamOptions {
    /// Texture memory of all pools, bytes. 512 MiB by default.
    pub texture_bytes: u64,
    /// Memory of tiles that are being decoded or wait for upload, bytes; one tile is always allowed. 64 MiB by default. More keeps the threads busy
    /// when many tiles are requested at the same time, less keeps the process small.
    pub decoded_bytes: u64,
    /// By default threads, as many as the machine suggests.
    pub loading: TileLoading,
}

impl Default for StreamOptions {
    fn default() -> Self {
        Self {
            texture_bytes: 512 << 20,
            decoded_bytes: 64 << 20,
            loading: TileLoading::Threads(None),
        }
    }
}

/// A request for a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileRequest {
    /// The tile, at the level that the eye requires.
    pub key: TileKey,
    /// It is in this frame's picture. Otherwise it is expected to be soon.
    pub drawn: bool,
}

/// Tiles of a source, streamed into pools.
///
/// A frame is [`Self::update`], then [`Self::draw`] for each map of each block drawn, then [`Self::upload`], then the submission of all draws and
/// writes. A slot that was drawn is not written in the same frame.
pub struct TileStream {
    cache: TileCache,
    loader: Loader,
    now: Instant,
    warnings: Warnings,
}

impl TileStream {
    /// Plans the pools and starts the decoder threads. Where the system cannot start one, the others do its work.
    pub fn new(source: Arc<dyn TileSource>, options: &StreamOptions) -> Self {
        let pools = plan_pools(source.layers(), options.texture_bytes);
        let cache = TileCache::new(source.layers(), pools, options.decoded_bytes);
        let loader = Loader::new(source, options.decoded_bytes, options.loading);
        Self {
            cache,
            loader,
            now: Instant::now(),
            warnings: Warnings::default(),
        }
    }

    /// With [`TileLoading::Host`]: the most urgent tile for the host to load. `None` if none is requested, if as many as allowed are under way, or if
    /// decoded tiles fill their memory. [`Self::update`] passes on what is requested.
    pub fn take(&self) -> Option<TileLoad> {
        TileLoad::begin(self.loader.reads())
    }

    /// The pools, fixed from the start.
    pub fn pools(&self) -> &[Pool] {
        self.cache.pools()
    }

    /// Begins a frame: what is requested, most urgent first; of several drawn requests for the same map and block the first
    /// counts. Takes finished loads, re-orders the queue and cancels what is no longer requested. Never waits.
    pub fn update(&mut self, now: Instant, requests: &[TileRequest]) {
        self.now = now;
        let warnings = &mut self.warnings;
        let warn = |key, error| warnings.add(now, key, &error);
        self.loader.collect(&mut self.cache, now, warn);
        self.cache
            .allocate(now, requests, self.loader.reserved_bytes());
        self.loader.hand_over(&mut self.cache);
    }

    /// The tile to draw a block of a map with; `None` is the whole coarsest map. Marks the slot as drawn in this frame. A block without a drawn
    /// request in this frame has `None`.
    ///
    /// That is the tile with an allocated slot if it is resident, else the next coarser one, else a finer one whose slot is not needed.
    pub fn draw(&mut self, layer: MapLayer, block: u8) -> Option<ResidentTile> {
        self.cache.draw(layer, block)
    }

    /// Adds a table with the tiles of the parts of a block, where `own` is the result of [`Self::draw`] for it; no table if `own` is not the tile
    /// that parts refine. `wanted` are parts of it in sight, each with the required level, whose parts are at least as large; of nested ones the
    /// last applies. If the allocated level is not resident, a finer part whose slot is not needed is drawn, else a coarser one, else the block's
    /// own tile.
    pub fn draw_parts(
        &mut self,
        layer: MapLayer,
        block: u8,
        own: ResidentTile,
        wanted: &[(Part, u8)],
        tables: &mut PartTables,
    ) {
        self.cache.draw_parts(layer, block, own, wanted, tables);
    }

    /// Gives parts of decoded tiles to `write`, at most `budget` bytes but at least one row unless the budget is 0. A
    /// tile becomes resident with its last part. Returns the bytes written.
    pub fn upload(&mut self, budget: u64, write: &mut dyn FnMut(Upload<'_>)) -> u64 {
        self.cache.upload(budget, write)
    }

    /// Counts of requested, loaded and resident tiles, for statistics.
    pub fn counters(&self) -> StreamCounters {
        self.cache.counters()
    }

    /// Drawn requests of this frame that are not resident at the allocated level, although they could be. For export.
    pub fn missing(&self) -> impl Iterator<Item = TileKey> + '_ {
        self.cache.missing()
    }

    /// Whether there is nothing left to wait for: missing tiles could not be read. For export.
    pub fn is_settled(&self) -> bool {
        self.cache.is_settled()
    }

    /// Blocks until a load ends or the time is over; whether one ended. For export only.
    pub fn wait(&mut self, timeout: Duration) -> bool {
        let (now, warnings) = (self.now, &mut self.warnings);
        let warn = |key, error| warnings.add(now, key, &error);
        self.loader.wait(&mut self.cache, timeout, now, warn)
    }
}

/// Warnings of tiles that cannot be read, at most one a second.
#[derive(Default)]
struct Warnings {
    last: Option<Instant>,
    silent: u64,
}

impl Warnings {
    fn add(&mut self, now: Instant, key: TileKey, error: &LoadError) {
        const PAUSE: Duration = Duration::from_secs(1);
        let is_soon = |last: Instant| now.saturating_duration_since(last) < PAUSE;
        if self.last.is_some_and(is_soon) {
            self.silent += 1;
            return;
        }
        let others = self.silent;
        tracing::warn!(
            "{key} is drawn coarser: {error} ({others} other tiles since the last warning)"
        );
        (self.last, self.silent) = (Some(now), 0);
    }
}
