//! Residency of tiles: what is requested, loaded, resident and drawn. The state machine of streaming, without threads or a clock.

mod allocate;
mod draw;
mod parts;
mod places;
mod upload;

use super::pools::usable;
use super::{Pool, StreamCounters, TileRequest};
use crate::tile::{
    LayerLayout, LevelLayout, MAP_LAYERS, Tile, TileError, TileFormat, TileKey, TileSet, TileShape,
};
use places::TilePlaces;
use std::time::Duration;
use terrella_files::clock::Instant;
use terrella_ground::globe::BLOCK_COUNT;

/// Why a load gave no tile.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The source said so.
    #[error(transparent)]
    Source(#[from] TileError),
    /// The source returned a tile that contradicts its layout.
    #[error(
        "the source returned {got} instead of {expected}; run `terrella pack verify` and build the pack again"
    )]
    Unexpected {
        /// The expected format and shape.
        expected: String,
        /// The format and shape received.
        got: String,
    },
    /// The source panicked.
    #[error("its reader panicked: {0}; please report this")]
    Panicked(String),
}

/// Identifies a load: the thread that works on it, and a number that no other load has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadId {
    /// The thread.
    pub worker: usize,
    /// The number, from 1.
    pub number: u64,
}

/// A load under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PendingLoad {
    /// The tile.
    pub key: TileKey,
    /// Thread and number of the load.
    pub id: LoadId,
    /// It is requested no longer, as of the last [`TileCache::allocate`].
    pub cancel: bool,
    /// It has not been requested at some time, so that it may end as cancelled.
    was_cancelled: bool,
}

/// State of tiles: requested, loading, resident and drawn.
///
/// The host loads tiles itself: it takes keys from [`Self::queue`], calls [`Self::begin`] for each that it has taken and [`Self::finish`] when it
/// is loaded or has failed. [`super::TileStream`] does it with threads.
pub struct TileCache {
    maps: [MapLevels; MAP_LAYERS],
    places: TilePlaces,
    pools: Vec<Pool>,
    pool_states: Vec<PoolState>,
    tiles: Vec<TileState>,
    allocations: Vec<Allocation>,
    queue: Vec<TileKey>,
    targets: Vec<TileKey>,
    /// Parts that stand in for targets that cannot be read.
    stand_ins: Vec<TileKey>,
    pending_loads: Vec<PendingLoad>,
    pending_uploads: Vec<PendingUpload>,
    retired: Vec<Tile>,
    decoded_limit: u64,
    /// Number of the frame; [`Self::allocate`] begins the next. Never 0, which marks what has not been yet.
    frame: u64,
    /// Number of promises in this frame.
    promises: u32,
    counters: StreamCounters,
}

/// The levels of a map; empty if the source does not have it.
#[derive(Clone, Default)]
struct MapLevels {
    levels: Vec<Level>,
    /// How many of them are cut into parts.
    cut: usize,
}

#[derive(Clone)]
struct Level {
    present: TileSet,
    pool: Option<u16>,
    format: TileFormat,
    shape: TileShape,
}

impl Level {
    /// Bytes of a tile.
    fn bytes(&self) -> u64 {
        self.shape.bytes(self.format) as u64
    }
}

/// How the slots of a pool are used.
#[derive(Default)]
struct PoolState {
    slots: Vec<SlotState>,
    /// Slots promised to this frame's requests.
    promised: u32,
    /// Slots that hold a promised tile, whole or in part.
    held: u32,
    /// Promised tiles without a slot that are in this frame's picture.
    lacking_drawn: u32,
    /// Slots that are empty, or whose tile is neither allocated nor drawn in this frame.
    available: u32,
    /// Stand-ins give way: see why nothing waits forever in the module's documentation.
    is_starved: bool,
}

#[derive(Clone, Copy, Default)]
struct SlotState {
    tile: Option<TileKey>,
    /// The last frame that it was drawn in.
    drawn: u64,
    /// The last frame that it was drawn or promised in.
    used: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum TileStage {
    /// Nowhere: perhaps queued.
    #[default]
    Away,
    Loading,
    /// Decoded, without a slot.
    Decoded,
    /// Partly written to a slot of its level's pool.
    Uploading(u16),
    /// In a slot of its level's pool.
    Resident(u16),
}

#[derive(Clone, Copy, Default)]
struct TileState {
    stage: TileStage,
    /// The last frame that a slot was promised in.
    promised: u64,
    /// The last frame in which it was requested.
    asked: u64,
    /// For a part, at its last request: the level with an allocated slot.
    target: u8,
    /// The promise is for this frame's picture.
    is_drawn: bool,
    /// Place among the promises, 0 the most urgent.
    rank: u32,
    /// Failed loads since the last good one.
    failures: u32,
    /// After a failure: when to try again.
    retry_at: Option<Instant>,
    /// Its failure was reported.
    is_reported: bool,
}

/// Allocation for a block of a map.
#[derive(Clone, Copy, Default)]
struct Allocation {
    /// The last frame that it was requested in.
    frame: u64,
    /// The level that the pools have a slot for.
    target: u8,
    /// The same, or a coarser one if that tile cannot be read.
    goal: u8,
}

/// A decoded tile that is not wholly uploaded.
struct PendingUpload {
    key: TileKey,
    tile: Tile,
    /// Mip level and row of units to go on with.
    mip: u32,
    row: u32,
    /// There was no slot for it at the last upload.
    is_blocked: bool,
}

impl TileState {
    /// A slot is promised to it in this frame.
    fn is_promised(&self, frame: u64) -> bool {
        self.promised == frame
    }

    fn slot(&self) -> Option<u16> {
        match self.stage {
            TileStage::Uploading(slot) | TileStage::Resident(slot) => Some(slot),
            TileStage::Away | TileStage::Loading | TileStage::Decoded => None,
        }
    }
}

impl TileCache {
    /// For a source's maps and pools made by [`super::plan_pools`] from them. `decoded_bytes` is the host's limit for loading or waiting tiles.
    pub fn new(layers: &[LayerLayout], pools: Vec<Pool>, decoded_bytes: u64) -> Self {
        let mut maps: [MapLevels; MAP_LAYERS] = Default::default();
        let usable = usable(layers);
        let places = TilePlaces::new(&usable);
        for layout in usable {
            let cut = layout.cut_levels();
            let level = |(place, level): (usize, &LevelLayout)| Level {
                present: level.present.clone(),
                pool: pools
                    .iter()
                    .position(|pool| {
                        pool.layer == layout.layer && usize::from(pool.level) == place.max(cut)
                    })
                    .map(|pool| pool as u16),
                format: layout.format,
                shape: level.shape,
            };
            maps[layout.layer.index()] = MapLevels {
                levels: layout.levels.iter().enumerate().map(level).collect(),
                cut,
            };
        }
        let slots: u32 = pools.iter().map(|pool| pool.slots).sum();
        let pool_state = |pool: &Pool| PoolState {
            slots: vec![SlotState::default(); pool.slots as usize],
            available: pool.slots,
            ..PoolState::default()
        };
        Self {
            maps,
            pool_states: pools.iter().map(pool_state).collect(),
            pools,
            tiles: vec![TileState::default(); places.len()],
            places,
            allocations: vec![Allocation::default(); MAP_LAYERS * BLOCK_COUNT as usize],
            queue: Vec::with_capacity(slots as usize),
            targets: Vec::with_capacity(MAP_LAYERS * BLOCK_COUNT as usize + slots as usize),
            stand_ins: Vec::with_capacity(slots as usize),
            pending_loads: Vec::with_capacity(64),
            pending_uploads: Vec::with_capacity(64),
            retired: Vec::with_capacity(64),
            decoded_limit: decoded_bytes,
            frame: 1,
            promises: 0,
            counters: StreamCounters::default(),
        }
    }

    /// The pools.
    pub fn pools(&self) -> &[Pool] {
        &self.pools
    }

    /// Tiles to load, most urgent first. None of them is under way.
    pub fn queue(&self) -> &[TileKey] {
        &self.queue
    }

    /// Loads under way.
    pub fn pending_loads(&self) -> &[PendingLoad] {
        &self.pending_loads
    }

    /// Decoded tiles that are done with, for the host to drop where that does not disturb. Each was given by
    /// [`Self::finish`].
    pub fn retired(&mut self) -> std::vec::Drain<'_, Tile> {
        self.retired.drain(..)
    }

    /// Counts of requested, loaded and resident tiles, for statistics.
    pub fn counters(&self) -> StreamCounters {
        StreamCounters {
            queued: self.queue.len() as u32,
            loading: self.pending_loads.len() as u32,
            waiting_upload: self.pending_uploads.len() as u32,
            waiting_bytes: self
                .pending_uploads
                .iter()
                .map(|pending| pending.tile.texels.len() as u64)
                .sum(),
            ..self.counters
        }
    }

    /// Drawn requests of this frame that are not resident at the allocated level, although they could be.
    pub fn missing(&self) -> impl Iterator<Item = TileKey> + '_ {
        let is_missing = |key: &TileKey| !self.is_resident(*key);
        self.targets.iter().copied().filter(is_missing)
    }

    /// Whether there is nothing left to wait for: all tiles drawn in this frame are resident, or could not be read and their stand-ins are
    /// resident. A failed tile is tried again later and not waited for.
    pub fn is_settled(&self) -> bool {
        let could_not_be_read = |key: TileKey| self.tile(key).retry_at.is_some();
        let stands_in = |key: TileKey| self.is_resident(key) || could_not_be_read(key);
        let is_there = |key: TileKey| {
            let allocation = key.layer.index() * BLOCK_COUNT as usize + usize::from(key.block);
            let level = self.allocations[allocation].goal;
            let goal = TileKey {
                level,
                part: 0,
                ..key
            };
            self.is_resident(key)
                || could_not_be_read(key)
                    && (self.level(goal).is_none_or(|level| level.pool.is_none())
                        || self.is_resident(goal))
        };
        self.targets.iter().all(|key| is_there(*key))
            && self.stand_ins.iter().all(|key| stands_in(*key))
    }

    fn is_resident(&self, key: TileKey) -> bool {
        matches!(self.tile(key).stage, TileStage::Resident(_))
    }

    fn tile(&self, key: TileKey) -> &TileState {
        &self.tiles[self.places.of(key)]
    }

    fn tile_mut(&mut self, key: TileKey) -> &mut TileState {
        &mut self.tiles[self.places.of(key)]
    }

    /// A thread has taken a tile from the queue. False, and nothing else, if it is not there to be taken.
    pub fn begin(&mut self, key: TileKey, id: LoadId) -> bool {
        let known = self.level(key).is_some();
        if !known || self.tile(key).stage != TileStage::Away {
            return false;
        }
        self.tile_mut(key).stage = TileStage::Loading;
        self.queue.retain(|queued| *queued != key);
        self.pending_loads.push(PendingLoad {
            key,
            id,
            cancel: false,
            was_cancelled: false,
        });
        self.counters.loads += 1;
        true
    }

    /// A load has ended. Returns the error if it is the first of its tile, for a report. A tile that contradicts its layout is a failure.
    pub fn finish(
        &mut self,
        key: TileKey,
        now: Instant,
        result: Result<Tile, LoadError>,
    ) -> Option<LoadError> {
        let load = self.pending_loads.iter().position(|load| load.key == key)?;
        let load = self.pending_loads.swap_remove(load);
        let result = match (result, self.level(key)) {
            (Ok(tile), Some(level)) => check(tile, level.format, level.shape),
            (result, _) => result,
        };
        let state = &mut self.tiles[self.places.of(key)];
        state.stage = TileStage::Away;
        match result {
            Ok(tile) => {
                self.counters.decoded_bytes += tile.texels.len() as u64;
                (state.failures, state.retry_at) = (0, None);
                if state.is_promised(self.frame) {
                    state.stage = TileStage::Decoded;
                    self.pending_uploads.push(PendingUpload {
                        key,
                        tile,
                        mip: 0,
                        row: 0,
                        is_blocked: false,
                    });
                    self.sort_pending();
                } else {
                    self.counters.cancelled += 1;
                    self.retired.push(tile);
                }
                None
            }
            Err(LoadError::Source(TileError::Cancelled)) if load.was_cancelled => {
                self.counters.cancelled += 1;
                None
            }
            Err(error) => {
                self.counters.failures += 1;
                state.retry_at = Some(now + retry_pause(state.failures));
                state.failures = state.failures.saturating_add(1);
                (!std::mem::replace(&mut state.is_reported, true)).then_some(error)
            }
        }
    }

    /// The level of a tile, if it exists.
    fn level(&self, key: TileKey) -> Option<&Level> {
        let level = self.maps[key.layer.index()]
            .levels
            .get(usize::from(key.level))?;
        let is_there =
            u32::from(key.block) < BLOCK_COUNT && key.part < level.shape.tiles_of_block();
        is_there.then_some(level)
    }

    /// The pool of a tile's level.
    fn pool_of(&self, key: TileKey) -> Option<usize> {
        self.level(key)?.pool.map(usize::from)
    }

    /// The tile begun first, then the most urgent: one that is half in its slot is useless yet.
    fn sort_pending(&mut self) {
        let (tiles, places) = (&self.tiles, self.places);
        self.pending_uploads.sort_unstable_by_key(|pending| {
            let state = &tiles[places.of(pending.key)];
            (state.slot().is_none(), state.rank)
        });
    }
}

/// The tile, if it has the requested format and shape.
pub fn check(tile: Tile, format: TileFormat, shape: TileShape) -> Result<Tile, LoadError> {
    let (due, got) = (shape.bytes(format), tile.texels.len());
    if (tile.format, tile.shape, got) == (format, shape, due) {
        return Ok(tile);
    }
    let describe = |format, pixels, bytes| {
        format!("a tile of {bytes} bytes, {format:?}, {pixels} texels a side")
    };
    Err(LoadError::Unexpected {
        expected: describe(format, shape.pixels, due),
        got: describe(tile.format, tile.shape.pixels, got),
    })
}

/// Time to wait after so many failures and one more: 1, 2, 4 … 60 s.
fn retry_pause(failures: u32) -> Duration {
    Duration::from_secs((1_u64 << failures.min(6)).min(60))
}
