//! Requests, loads, resident tiles and eviction: a state machine without threads or a clock.

use super::StreamedGroundError;
use super::viewer::EyePlace;
use crate::elevation::tiles::{BESIDE, FEATHER, HeldTile, NONE, Node, TilePyramid, Wants, wider};
use crate::elevation::{
    Bounds, Georeference, GridLimits, HeightChange, HeightGrid, HeightRange, HeightTileError,
    HeightTileKey, HeightTileLayout, HeightTileSource, Registration,
};
use crate::height::HeightTileStats;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// A tile is evicted for another only if the other appears this many times larger.
const WORTH: f64 = 1.5;

/// Maximum tiles per frame whose coarser ancestors are searched.
const CHAINS: usize = 512;

/// Number of remembered changes; for older versions everything counts as changed.
const REMEMBERED: usize = 256;

/// The key of an empty node.
const NOWHERE: HeightTileKey = HeightTileKey {
    level: 0,
    column: u32::MAX,
    row: u32::MAX,
};

/// A request for a tile that is missing.
#[derive(Clone, Copy, Debug)]
struct Request {
    /// Requested only as the finest data: the eyes decide whether it is visible.
    is_any: bool,
    /// Loaded and waiting to be accepted.
    has_come: bool,
}

/// State of the cache.
pub(super) struct HeightCache {
    pyramid: Arc<TilePyramid>,
    free: Vec<u32>,
    budget_bytes: u64,
    /// Bytes of tiles in memory.
    bytes: u64,
    tiles: u32,
    /// Largest tile so far, bytes.
    tile_bytes: u64,
    requests: BTreeMap<HeightTileKey, Request>,
    /// Tiles to load, the most visible first.
    queue: Vec<HeightTileKey>,
    /// Requests without room.
    rejected: Vec<HeightTileKey>,
    arrived: Vec<HeldTile>,
    failed: BTreeSet<HeightTileKey>,
    /// Whether requests may depend on tiles that will not load.
    has_lost: bool,
    version: u64,
    log: VecDeque<(u64, HeightChange)>,
}

impl HeightCache {
    /// Reads the coarsest level.
    pub fn new(
        source: Arc<dyn HeightTileSource>,
        budget_bytes: u64,
    ) -> Result<Self, StreamedGroundError> {
        let layout = source.layout();
        let base = read_base(source.as_ref(), &layout, budget_bytes)?;
        let coarsest = layout.coarsest();
        let poles_m = [1.0, -1.0].map(|side| {
            let pole_rad = std::f64::consts::FRAC_PI_2 * side;
            base.height_m(pole_rad, 0.0, 0.0)
        });
        let mut nodes = Vec::new();
        let mut range = base.stats().range;
        for row in 0..layout.rows(coarsest) {
            for column in 0..layout.columns(coarsest) {
                let key = HeightTileKey {
                    level: coarsest,
                    column,
                    row,
                };
                let of_tile = source.range_m(key);
                let of_tile = of_tile.ok_or(HeightTileError::Absent(key))?;
                range = wider(range, of_tile);
                nodes.push(node(source.as_ref(), key, NONE, None));
            }
        }
        let bytes = base.stats().bytes;
        let pyramid = TilePyramid {
            layout,
            source,
            base: Arc::new(base),
            nodes,
            has_wants: Arc::new(AtomicBool::new(false)),
            wants: Arc::new(Wants::new()),
            poles_m,
            range,
            finest_rad: layout.spacing_rad(0),
        };
        Ok(Self {
            pyramid: Arc::new(pyramid),
            free: Vec::new(),
            budget_bytes,
            bytes,
            tiles: 0,
            tile_bytes: 4 * layout.tile_samples() as u64,
            requests: BTreeMap::new(),
            queue: Vec::new(),
            rejected: Vec::new(),
            arrived: Vec::new(),
            failed: BTreeSet::new(),
            has_lost: false,
            version: 0,
            log: VecDeque::new(),
        })
    }

    /// The current tiles.
    pub fn pyramid(&self) -> &Arc<TilePyramid> {
        &self.pyramid
    }

    /// Increases with each change of heights.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Changes since a version; `None` if that is too long ago.
    pub fn changes_since(&self, version: u64) -> Option<Vec<HeightChange>> {
        let is_known = self.version - version.min(self.version) <= self.log.len() as u64;
        is_known.then(|| {
            let later = self.log.iter().filter(|(of, _)| *of > version);
            later.map(|(_, change)| *change).collect()
        })
    }

    /// Records a finished load.
    pub fn finish(&mut self, key: HeightTileKey, result: Result<HeldTile, HeightTileError>) {
        self.queue.retain(|queued| *queued != key);
        match result {
            Ok(tile) => {
                self.tile_bytes = tile.bytes();
                if let Some(request) = self.requests.get_mut(&key) {
                    request.has_come = true;
                }
                self.arrived.push(tile);
            }
            Err(HeightTileError::Cancelled(_)) => {}
            Err(error) => {
                tracing::warn!("the ground is drawn coarser: {error}");
                self.requests.remove(&key);
                self.failed.insert(key);
                self.has_lost = true;
            }
        }
    }

    /// Changes the heights: accepts at most `most` loaded tiles, and evicts others for them.
    pub fn take_over(&mut self, eyes: &[EyePlace], most: usize) {
        let layout = self.pyramid.layout;
        // Coarse tiles first: finer ones attach below them.
        self.arrived.sort_unstable_by_key(|tile| {
            let HeightTileKey { level, column, row } = tile.key;
            (level, std::cmp::Reverse((row, column)))
        });
        let mut victims: Option<Vec<(f64, u32)>> = None;
        let mut early = Vec::new();
        let mut left = most;
        while left > 0 {
            let Some(tile) = self.arrived.pop() else {
                break;
            };
            let key = tile.key;
            let parent = self.pyramid.find(key.parent());
            let (Some(parent), None) = (parent, self.pyramid.find(key)) else {
                if parent.is_none() && self.requests.contains_key(&key.parent()) {
                    // Its parent is still loading.
                    early.push(tile);
                } else {
                    self.requests.remove(&key);
                }
                continue;
            };
            left -= 1;
            let worth = value(&layout, key, eyes);
            let mut has_room = self.bytes + tile.bytes() <= self.budget_bytes;
            while !has_room {
                let victims = victims.get_or_insert_with(|| self.victims(eyes));
                let Some((_, victim)) = victims.pop().filter(|v| v.0 * WORTH < worth) else {
                    break;
                };
                // It may have received a child in the meantime.
                if victim != parent && self.is_leaf(victim) {
                    self.remove(victim);
                }
                has_room = self.bytes + tile.bytes() <= self.budget_bytes;
            }
            if has_room {
                self.requests.remove(&key);
                self.insert(parent, tile);
            } else if let Some(request) = self.requests.get_mut(&key) {
                request.has_come = false;
            }
        }
        self.arrived.append(&mut early);
    }

    /// Tiles that may be evicted, the least visible last.
    fn victims(&self, eyes: &[EyePlace]) -> Vec<(f64, u32)> {
        let nodes = (0..).zip(&self.pyramid.nodes);
        let leaves = nodes.filter(|(index, _)| self.is_leaf(*index));
        let layout = &self.pyramid.layout;
        let mut victims: Vec<_> = leaves
            .map(|(index, node)| (value(layout, node.key, eyes), index))
            .collect();
        victims.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        victims
    }

    fn is_leaf(&self, index: u32) -> bool {
        let node = &self.pyramid.nodes[index as usize];
        node.tile.is_some() && node.children == [NONE; 4]
    }

    /// Plans the loads.
    pub fn plan(&mut self, eyes: &[EyePlace]) {
        self.pyramid.wants.look(eyes.iter().map(EyePlace::near));
        self.note_wants();
        self.queue.clear();
        self.rejected.clear();
        let layout = self.pyramid.layout;
        let mut wanted: Vec<(f64, HeightTileKey)> = Vec::new();
        for (key, request) in self.requests.iter().filter(|(_, r)| !r.has_come) {
            let (worth, shows) = seen(&layout, *key, eyes);
            if !request.is_any || shows {
                wanted.push((worth, *key));
            }
        }
        // A tile appears at least twice as large as its children, so it precedes them.
        wanted.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        let free_bytes = self.budget_bytes.saturating_sub(self.bytes);
        let free = free_bytes / self.tile_bytes.max(1);
        let mut free = free.saturating_sub(self.arrived.len() as u64);
        let mut victims: Option<Vec<(f64, u32)>> = None;
        for (worth, key) in wanted {
            let has_room = if free > 0 {
                free -= 1;
                true
            } else {
                let victims = victims.get_or_insert_with(|| self.victims(eyes));
                victims.pop().is_some_and(|(of, _)| of * WORTH < worth)
            };
            match has_room {
                true => self.queue.push(key),
                false => self.rejected.push(key),
            }
        }
    }

    /// Collects the requests of surfaces: the next finer tile below a resident one, and its descendants down to the request.
    fn note_wants(&mut self) {
        self.forget_lost();
        let Self {
            pyramid,
            requests,
            failed,
            ..
        } = self;
        let mut request = |key: HeightTileKey, is_any: bool| {
            let request = requests.entry(key).or_insert(Request {
                is_any: true,
                has_come: false,
            });
            request.is_any &= is_any;
        };
        if pyramid.has_wants.swap(false, Ordering::Relaxed) {
            for node in &pyramid.nodes {
                // The bits stay set while the tile loads, so that no reader records it again.
                let bits = node.wanted.load(Ordering::Relaxed);
                for quarter in 0..4 {
                    let (own, any) = (bits >> quarter & 1 == 1, bits >> (quarter + 4) & 1 == 1);
                    let is_there = node.children[quarter as usize] != NONE;
                    let key = node.key.child(quarter);
                    let Some(key) = key.filter(|_| (own || any) && !is_there) else {
                        continue;
                    };
                    if !failed.contains(&key) {
                        request(key, !own);
                    }
                }
            }
        }
        pyramid.wants.take(CHAINS, |key, is_any| {
            let mut level = pyramid.layout.coarsest();
            while level > key.level {
                level -= 1;
                let above = key.over(level);
                if pyramid.find(above).is_some() {
                    continue;
                }
                if failed.contains(&above) || pyramid.source.range_m(above).is_none() {
                    break;
                }
                request(above, is_any);
            }
        });
    }

    /// Drops requests below tiles that are neither resident nor requested. They are requested again once those tiles are
    /// loaded.
    fn forget_lost(&mut self) {
        if !std::mem::take(&mut self.has_lost) {
            return;
        }
        // Coarse tiles first: finer ones depend on them.
        let all: Vec<_> = self.requests.keys().rev().copied().collect();
        for key in all {
            let parent = key.parent();
            if self.pyramid.find(parent).is_none() && !self.requests.contains_key(&parent) {
                self.requests.remove(&key);
            }
        }
    }

    /// Tiles to load, the most visible first.
    pub fn queue(&self) -> &[HeightTileKey] {
        &self.queue
    }

    /// Whether requests arrived since [`Self::plan`].
    pub fn has_wants(&self) -> bool {
        self.pyramid.has_wants.load(Ordering::Relaxed) || self.pyramid.wants.has_any()
    }

    /// Whether loaded tiles wait to be accepted.
    pub fn has_arrivals(&self) -> bool {
        !self.arrived.is_empty()
    }

    /// Requested tiles that have no room, could not be read, or are still loading.
    pub fn missing(&self) -> Vec<HeightTileKey> {
        let all = self.queue.iter().chain(&self.rejected).chain(&self.failed);
        all.copied().collect()
    }

    pub fn counters(&self) -> HeightTileStats {
        HeightTileStats {
            tiles: self.tiles,
            bytes: self.bytes,
            wanted: (self.queue.len() + self.arrived.len()) as u32,
            rejected: self.rejected.len() as u32,
            unreadable: self.failed.len() as u32,
            changes: self.version,
        }
    }

    fn insert(&mut self, parent: u32, tile: HeldTile) {
        let key = tile.key;
        self.bytes += tile.bytes();
        self.tiles += 1;
        let range = tile.range;
        let free = self.free.pop();
        let node = node(
            self.pyramid.source.as_ref(),
            key,
            parent,
            Some(Arc::new(tile)),
        );
        let pyramid = self.changed();
        let index = match free {
            Some(index) => {
                pyramid.nodes[index as usize] = node;
                index
            }
            None => {
                pyramid.nodes.push(node);
                pyramid.nodes.len() as u32 - 1
            }
        };
        pyramid.nodes[parent as usize].children[key.quarter()] = index;
        // Clears requests that are now satisfied.
        let noted = !(0b1_0001 << key.quarter());
        pyramid.nodes[parent as usize]
            .wanted
            .fetch_and(noted, Ordering::Relaxed);
        let mut missing = 0;
        for (bit, (east, south)) in BESIDE.into_iter().enumerate() {
            let Some(beside) = pyramid.layout.beside(key, east, south) else {
                continue;
            };
            match pyramid.find(beside) {
                Some(there) => pyramid.nodes[there as usize].missing &= !(1 << (7 - bit)),
                None => missing |= 1 << bit,
            }
        }
        pyramid.nodes[index as usize].missing = missing;
        self.log(key, range);
    }

    fn remove(&mut self, index: u32) {
        let pyramid = self.changed();
        let key = pyramid.nodes[index as usize].key;
        let Some(tile) = pyramid.nodes[index as usize].tile.take() else {
            return;
        };
        let parent = pyramid.nodes[index as usize].parent;
        pyramid.nodes[parent as usize].children[key.quarter()] = NONE;
        // A removed node matches no place and has no parent.
        pyramid.nodes[index as usize].key = NOWHERE;
        pyramid.nodes[index as usize].parent = NONE;
        for (bit, (east, south)) in BESIDE.into_iter().enumerate() {
            let beside = pyramid.layout.beside(key, east, south);
            if let Some(there) = beside.and_then(|beside| pyramid.find(beside)) {
                pyramid.nodes[there as usize].missing |= 1 << (7 - bit);
            }
        }
        self.bytes -= tile.bytes();
        self.tiles -= 1;
        self.free.push(index);
        self.has_lost = true;
        self.log(key, tile.range);
    }

    /// Mutable access to the tiles; snapshots in use stay unchanged.
    fn changed(&mut self) -> &mut TilePyramid {
        Arc::make_mut(&mut self.pyramid)
    }

    /// Records where heights changed: in the tile, and where its neighbours' blend into coarser tiles changed.
    fn log(&mut self, key: HeightTileKey, range: HeightRange) {
        let layout = &self.pyramid.layout;
        let own = layout.bounds(key);
        let more_rad = FEATHER * layout.tile_rad(key.level);
        let half_turn = std::f64::consts::FRAC_PI_2;
        let bounds = Bounds {
            south_rad: (own.south_rad - more_rad).max(-half_turn),
            north_rad: (own.north_rad + more_rad).min(half_turn),
            west_rad: own.west_rad - more_rad,
            width_rad: own.width_rad + 2.0 * more_rad,
        };
        self.version += 1;
        self.log.push_back((
            self.version,
            HeightChange {
                bounds,
                below_rad: 2.0 * layout.spacing_rad(key.level),
                range,
            },
        ));
        if self.log.len() > REMEMBERED {
            self.log.pop_front();
        }
    }
}

/// Apparent size of the samples of a tile's stand-in, radians: the maximum over all eyes.
fn value(layout: &HeightTileLayout, key: HeightTileKey, eyes: &[EyePlace]) -> f64 {
    seen(layout, key, eyes).0
}

/// The same, and whether it exceeds the tolerance of some eye.
fn seen(layout: &HeightTileLayout, key: HeightTileKey, eyes: &[EyePlace]) -> (f64, bool) {
    let spacing_rad = layout.spacing_rad(key.level + 1);
    if eyes.is_empty() {
        return (spacing_rad, true);
    }
    let bounds = layout.bounds(key);
    let (mut most, mut shows) = (0.0_f64, false);
    for eye in eyes {
        let seen = eye.seen_rad(&bounds, spacing_rad);
        most = most.max(seen);
        shows |= seen > eye.tolerance_rad();
    }
    (most, shows)
}

fn node(
    source: &dyn HeightTileSource,
    key: HeightTileKey,
    parent: u32,
    tile: Option<Arc<HeldTile>>,
) -> Node {
    let mut node = Node {
        key,
        tile,
        parent,
        children: [NONE; 4],
        exists: 0,
        below: [[0.0; 2]; 4],
        missing: 0,
        wanted: Arc::new(AtomicU8::new(0)),
    };
    for quarter in 0..4 {
        let range = key.child(quarter).and_then(|key| source.range_m(key));
        if let Some(HeightRange { low_m, high_m }) = range {
            node.exists |= 1 << quarter;
            let rounded = [(low_m as f32).next_down(), (high_m as f32).next_up()];
            node.below[quarter as usize] = rounded;
        }
    }
    node
}

/// Reads the coarsest level as one grid.
fn read_base(
    source: &dyn HeightTileSource,
    layout: &HeightTileLayout,
    budget_bytes: u64,
) -> Result<HeightGrid, StreamedGroundError> {
    let level = layout.coarsest();
    let (side, border, row) = (
        layout.side() as usize,
        layout.border() as usize,
        layout.row_samples(),
    );
    let columns = layout.columns(level) as usize * side;
    let rows = layout.rows(level) as usize * side;
    let limits = GridLimits {
        bytes: budget_bytes,
    };
    limits.check(columns as u32, rows as u32)?;
    let mut heights_m = vec![0.0_f32; columns * rows];
    for tile_row in 0..layout.rows(level) {
        for tile_column in 0..layout.columns(level) {
            let key = HeightTileKey {
                level,
                column: tile_column,
                row: tile_row,
            };
            let samples = source.read(key, &|| false)?;
            // Validates only the tile just read.
            let samples = HeldTile::new(key, layout, samples)?;
            for j in 0..side {
                let start = (tile_row as usize * side + j) * columns + tile_column as usize * side;
                for i in 0..side {
                    heights_m[start + i] = samples.sample_m((j + border) * row + i + border) as f32;
                }
            }
        }
    }
    let place = Georeference::from_bounds(
        Registration::Cells,
        &Bounds::GLOBE,
        columns as u32,
        rows as u32,
    )?;
    Ok(HeightGrid::new(&place, heights_m, &limits)?)
}
