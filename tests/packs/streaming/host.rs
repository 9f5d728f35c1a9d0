//! The host of a cache: a simulated loader and textures, with separate bookkeeping that each frame is compared with.

use super::source::{scramble, tile};
use std::collections::{HashMap, HashSet};
use std::time::{Duration, Instant};
use terrella_ground::globe::Part;
use terrella_imagery::stream::{
    LoadError, LoadId, PartTables, Pool, ResidentTile, StreamCounters, TileCache, TileRequest,
    TileSlot, Upload,
};
use terrella_imagery::tile::{
    LayerLayout, MAX_LEVELS, MapLayer, TILE_MIPS, Tile, TileError, TileKey, TileShape,
};

/// How the simulated loader behaves.
#[derive(Clone, Debug)]
pub struct Loading {
    pub threads: usize,
    /// Bytes of tiles under way or waiting, at most; one tile is always allowed.
    pub limit: u64,
    /// How many of 256 loads fail.
    pub failing: u64,
    /// Frames that a load takes, at most.
    pub slowest: u64,
    pub seed: u64,
}

struct Load {
    key: TileKey,
    id: LoadId,
    frames_left: u64,
}

/// Content of a slot of the simulated textures.
#[derive(Default)]
struct Held {
    key: Option<TileKey>,
    texels: Vec<u8>,
    is_whole: bool,
}

pub struct Host {
    cache: TileCache,
    loading: Loading,
    /// A tile that cannot be read.
    pub bad: Option<TileKey>,
    /// Tiles whose loads do not end.
    pub stuck: Vec<TileKey>,
    pub now: Instant,
    slots: HashMap<TileSlot, Held>,
    loads: Vec<Load>,
    /// Bytes of tiles under way or waiting.
    reserved: u64,
    /// Tiles that the cache has and has not given back.
    decoded: HashSet<TileKey>,
    loads_begun: u64,
    uploaded: u64,
    evictions: u64,
    truth: Truth,
    /// The parts requested in the last frame that were drawn, each with its coarsest drawn level.
    pub parts_drawn: Vec<(TileKey, u8)>,
}

/// Expected content of the tiles.
struct Truth {
    layers: Vec<LayerLayout>,
    tiles: HashMap<TileKey, Tile>,
    names: HashMap<Vec<u8>, TileKey>,
}

impl Truth {
    fn tile(&mut self, key: TileKey) -> &Tile {
        self.tiles.entry(key).or_insert_with(|| {
            let tile = tile(&self.layers, key);
            self.names.insert(tile.texels[..32].to_vec(), key);
            tile
        })
    }

    fn name(&self, tile: &Tile) -> TileKey {
        self.names[&tile.texels[..32]]
    }
}

impl Host {
    pub fn new(layers: &[LayerLayout], pools: &[Pool], loading: Loading) -> Self {
        Self {
            cache: TileCache::new(layers, pools.to_vec(), loading.limit),
            loading,
            bad: None,
            stuck: Vec::new(),
            now: Instant::now(),
            slots: HashMap::new(),
            loads: Vec::new(),
            reserved: 0,
            decoded: HashSet::new(),
            loads_begun: 0,
            uploaded: 0,
            evictions: 0,
            truth: Truth {
                layers: layers.to_vec(),
                tiles: HashMap::new(),
                names: HashMap::new(),
            },
            parts_drawn: Vec::new(),
        }
    }

    pub fn counters(&self) -> StreamCounters {
        self.cache.counters()
    }

    pub fn missing(&self) -> usize {
        self.cache.missing().count()
    }

    pub fn bytes(&mut self, key: TileKey) -> u64 {
        self.truth.tile(key).texels.len() as u64
    }

    /// The tile is whole in a slot.
    pub fn is_resident(&self, key: TileKey) -> bool {
        let is_it = |held: &Held| held.is_whole && held.key == Some(key);
        self.slots.values().any(is_it)
    }

    /// No load fails any more, and failed ones are due for a retry.
    pub fn heal(&mut self) {
        self.loading.failing = 0;
        self.now += Duration::from_secs(61);
    }

    /// Levels of a map that are cut into parts.
    fn cut(&self, layer: MapLayer) -> u8 {
        let mut layouts = self.truth.layers.iter();
        let layout = layouts.find(|layout| layout.layer == layer);
        layout.map_or(0, |layout| layout.cut_levels()) as u8
    }

    /// Tiles along a block's side at a level.
    fn parts(&self, layer: MapLayer, level: u8) -> u32 {
        let mut layouts = self.truth.layers.iter();
        let layout = layouts.find(|layout| layout.layer == layer).unwrap();
        layout.levels[usize::from(level)].shape.parts
    }

    /// Draws the requested parts of a block; each cell must be resident. Returns the coarsest drawn level of each.
    fn draw_parts(
        &mut self,
        requests: &[TileRequest],
        own_key: TileKey,
        own: ResidentTile,
        pictures: &mut Vec<(TileSlot, TileKey)>,
    ) -> Vec<(TileKey, u8)> {
        let TileKey { layer, block, .. } = own_key;
        let cut = self.cut(layer);
        let of_block = requests.iter().filter(|request| {
            let key = request.key;
            request.drawn && (key.layer, key.block) == (layer, block) && key.level < cut
        });
        let mut keys: Vec<TileKey> = of_block.map(|request| request.key).collect();
        keys.sort_by_key(|key| std::cmp::Reverse(key.level));
        keys.dedup();
        let wanted: Vec<_> = keys
            .iter()
            .map(|key| {
                let parts = self.parts(layer, key.level);
                let part = Part {
                    block: key.block(),
                    depth: parts.ilog2() as u8,
                    row: key.part / parts as u16,
                    column: key.part % parts as u16,
                };
                (part, key.level)
            })
            .collect();
        let mut tables = PartTables::default();
        let before = self.cache.counters();
        self.cache
            .draw_parts(layer, block, own, &wanted, &mut tables);
        if own.level != cut {
            assert_eq!(tables, PartTables::default());
            return Vec::new();
        }
        let after = self.cache.counters();
        let counted = after.hits + after.fallbacks - before.hits - before.fallbacks;
        assert_eq!(counted as usize, wanted.len());
        let table = tables.tables[0];
        let cells = tables.cells(&table);
        let mut levels = Vec::new();
        for (n, cell) in cells.iter().enumerate() {
            let place = Part {
                block: own_key.block(),
                depth: table.depth,
                row: (n >> table.depth) as u16,
                column: (n & ((1 << table.depth) - 1)) as u16,
            };
            let level = (0..=cut).find(|level| self.parts(layer, *level) == 1 << cell.depth);
            let level = level.expect("a level of this depth");
            let slot = TileSlot {
                pool: own.slot.pool,
                index: cell.index,
            };
            let key = TileKey {
                level,
                part: place.index_at(cell.depth),
                ..own_key
            };
            self.check_slot(slot, key);
            pictures.push((slot, key));
            levels.push((place, level));
        }
        // Each part by the cells in it, or the cell that contains it.
        let drawn = wanted.iter().zip(keys).map(|((part, _), key)| {
            let depth = part.depth.min(table.depth);
            let in_part = levels
                .iter()
                .filter(|(place, _)| place.index_at(depth) == part.index_at(depth));
            (key, in_part.map(|(_, level)| *level).max().expect("a cell"))
        });
        drawn.collect()
    }

    /// One frame. Returns the level that each map of each block was drawn with.
    pub fn frame(
        &mut self,
        requests: &[TileRequest],
        draws: bool,
        budget: u64,
    ) -> HashMap<(MapLayer, u8), Option<u8>> {
        self.now += Duration::from_millis(16);
        self.end_loads();
        self.cache.allocate(self.now, requests, self.reserved);
        self.free();
        self.begin_loads();
        let mut drawn = HashMap::new();
        let mut pictures = Vec::new();
        self.parts_drawn.clear();
        if draws {
            for request in requests.iter().filter(|request| request.drawn) {
                let TileKey { layer, block, .. } = request.key;
                let has_layer = self.truth.layers.iter().any(|l| l.layer == layer);
                if !has_layer || block > 127 {
                    assert_eq!(self.cache.draw(layer, block), None);
                    continue;
                }
                if drawn.contains_key(&(layer, block)) {
                    continue;
                }
                let got = self.cache.draw(layer, block);
                drawn.insert((layer, block), got.map(|tile| tile.level));
                let Some(tile) = got else {
                    continue;
                };
                let key = TileKey::whole(layer, tile.level, block);
                self.check_slot(tile.slot, key);
                pictures.push((tile.slot, key));
                if self.cut(layer) > 0 {
                    let parts = self.draw_parts(requests, key, tile, &mut pictures);
                    self.parts_drawn.extend(parts);
                }
            }
            let StreamCounters {
                hits, fallbacks, ..
            } = self.cache.counters();
            let counted = drawn.len() + self.parts_drawn.len();
            assert_eq!((hits + fallbacks) as usize, counted);
        }
        self.upload(budget);
        for (slot, key) in pictures {
            self.check_slot(slot, key);
        }
        self.check_counters(requests);
        drawn
    }

    /// The slot holds just this tile, bit for bit.
    fn check_slot(&mut self, slot: TileSlot, key: TileKey) {
        let held = &self.slots[&slot];
        assert_eq!(held.key, Some(key), "{slot:?} holds another tile");
        assert!(held.is_whole, "{key} is there in part only");
        let is_right = held.texels == self.truth.tile(key).texels;
        assert!(is_right, "{key} has wrong texels");
    }

    fn random(&mut self, below: u64) -> u64 {
        self.loading.seed = scramble(self.loading.seed);
        self.loading.seed % below
    }

    fn end_loads(&mut self) {
        for place in (0..self.loads.len()).rev() {
            let Load { key, id, .. } = self.loads[place];
            let mut loads = self.cache.pending_loads().iter().filter(|f| f.key == key);
            let load = loads.next().copied().expect("the load is known");
            assert!(loads.next().is_none(), "{key} is loaded twice");
            assert_eq!(load.id, id);
            let is_given_up = load.cancel && self.random(2) == 0;
            if self.stuck.contains(&key) && !is_given_up {
                continue;
            }
            if self.loads[place].frames_left > 0 && !is_given_up {
                self.loads[place].frames_left -= 1;
                continue;
            }
            self.loads.swap_remove(place);
            let fails = self.random(256) < self.loading.failing || self.bad == Some(key);
            let result = if is_given_up {
                Err(LoadError::Source(TileError::Cancelled))
            } else if fails {
                self.failure(key)
            } else {
                assert!(self.decoded.insert(key), "{key} is decoded twice");
                Ok(self.truth.tile(key).clone())
            };
            let is_wrong = result.as_ref().is_ok_and(|tile| tile.texels.len() < 32);
            if result.is_err() || is_wrong {
                self.reserved -= self.bytes(key);
            }
            self.cache.finish(key, self.now, result);
        }
        assert_eq!(self.cache.pending_loads().len(), self.loads.len());
        self.free();
    }

    /// All the ways in which a source can fail; a tile of a wrong shape is one.
    fn failure(&mut self, key: TileKey) -> Result<Tile, LoadError> {
        match self.random(4) {
            0 => Err(LoadError::Panicked("on purpose".to_owned())),
            1 => Err(LoadError::Source(TileError::Absent(key))),
            // Without a request to cancel.
            2 => Err(LoadError::Source(TileError::Cancelled)),
            _ => Ok(Tile {
                shape: TileShape::new(16).unwrap(),
                texels: Vec::new(),
                ..self.truth.tile(key).clone()
            }),
        }
    }

    fn begin_loads(&mut self) {
        while self.loads.len() < self.loading.threads {
            let Some(key) = self.cache.queue().first().copied() else {
                break;
            };
            let bytes = self.bytes(key);
            if self.reserved > 0 && self.reserved + bytes > self.loading.limit {
                break;
            }
            assert!(!self.decoded.contains(&key), "{key} is decoded already");
            assert!(!self.is_resident(key), "{key} is resident already");
            self.loads_begun += 1;
            let id = LoadId {
                worker: 0,
                number: self.loads_begun,
            };
            assert!(self.cache.begin(key, id));
            assert!(!self.cache.begin(key, id), "begun twice");
            self.reserved += bytes;
            let frames_left = self.random(self.loading.slowest + 1);
            self.loads.push(Load {
                key,
                id,
                frames_left,
            });
        }
    }

    fn free(&mut self) {
        for tile in self.cache.retired() {
            self.reserved -= tile.texels.len() as u64;
            assert!(self.decoded.remove(&self.truth.name(&tile)));
        }
    }

    fn upload(&mut self, budget: u64) {
        let (mut written, mut evictions) = (0_u64, 0);
        let pools = self.cache.pools().to_vec();
        let cut = MapLayer::ALL.map(|layer| self.cut(layer));
        let slots = &mut self.slots;
        let mut write = |part: Upload<'_>| {
            let Upload { slot, key, .. } = part;
            let pool = &pools[usize::from(slot.pool)];
            let level = key.level.max(cut[key.layer.index()]);
            assert_eq!((pool.layer, pool.level), (key.layer, level));
            assert!(u32::from(slot.index) < pool.slots);
            let (rows, row_bytes) = pool.format.rows(pool.shape.mip_side(part.mip));
            assert!(part.mip < TILE_MIPS && part.first_row + part.rows <= rows);
            assert_eq!(part.row_bytes, row_bytes);
            assert_eq!(part.texels.len(), (part.rows * row_bytes) as usize);
            let held = slots.entry(slot).or_default();
            if (part.mip, part.first_row) == (0, 0) {
                evictions += u64::from(held.is_whole);
                *held = Held {
                    key: Some(key),
                    ..Held::default()
                };
            }
            assert_eq!(held.key, Some(key), "{key} goes on in another's slot");
            let finer = (0..part.mip).map(|mip| pool.format.image_bytes(pool.shape.mip_side(mip)));
            let start = finer.sum::<usize>() + (part.first_row * row_bytes) as usize;
            assert_eq!(held.texels.len(), start, "{key} has a gap");
            held.texels.extend(part.texels);
            held.is_whole = held.texels.len() == pool.shape.bytes(pool.format);
            let is_least = written == 0 && part.rows == 1 && budget > 0;
            written += part.texels.len() as u64;
            assert!(written <= budget || is_least, "over budget");
        };
        let said = self.cache.upload(budget, &mut write);
        assert_eq!(said, written);
        self.uploaded += written;
        self.evictions += evictions;
        self.free();
    }

    /// Compares the counters with these books.
    fn check_counters(&mut self, requests: &[TileRequest]) {
        let counters = self.cache.counters();
        let mut resident = [0; MAX_LEVELS];
        for held in self.slots.values().filter(|held| held.is_whole) {
            resident[usize::from(held.key.unwrap().level)] += 1;
        }
        assert_eq!(counters.resident, resident);
        assert_eq!(counters.uploaded_bytes, self.uploaded);
        assert_eq!(counters.evictions, self.evictions);
        assert_eq!(counters.loads, self.loads_begun);
        assert_eq!(counters.loading as usize, self.loads.len());
        assert_eq!(counters.waiting_upload as usize, self.decoded.len());
        let ended = counters.completed + counters.cancelled + counters.failures;
        let open = u64::from(counters.loading + counters.waiting_upload);
        assert_eq!(counters.loads, ended + open, "a load is lost");
        let loading: Vec<_> = self.loads.iter().map(|load| load.key).collect();
        let loading: u64 = loading.into_iter().map(|key| self.bytes(key)).sum();
        assert_eq!(self.reserved, loading + counters.waiting_bytes);
        assert!(self.reserved <= self.loading.limit || open == 1);
        let queue: HashSet<_> = self.cache.queue().iter().collect();
        assert_eq!(queue.len(), self.cache.queue().len(), "queued twice");
        let distinct: HashSet<_> = requests.iter().map(|request| request.key).collect();
        assert!(counters.requested.iter().sum::<u32>() as usize <= distinct.len());
    }
}
