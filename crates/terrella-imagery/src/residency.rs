//! Residency of tiles as streaming hands it to drawing: pools of slots, the tiles in them, parts of tiles on their way there, and counts.

use super::tile::{MAX_LEVELS, MapLayer, TileFormat, TileKey, TileShape};

/// Most slots of a pool that holds parts: the layers of a texture that every adapter takes.
pub const MAX_PART_SLOTS: u32 = 256;

/// A fixed number of slots for tiles of one level of one map, or of a level and all that are cut into parts of its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pool {
    /// The map.
    pub layer: MapLayer,
    /// The level, 0 the finest, that is not cut; never the coarsest, which is held as a whole.
    pub level: u8,
    /// Whether it holds the finer levels too, which are cut: then its slots are the layers of one texture.
    pub has_parts: bool,
    /// How texels are stored.
    pub format: TileFormat,
    /// Size of its tiles.
    pub shape: TileShape,
    /// Number of slots, 1…128, or with parts up to [`MAX_PART_SLOTS`].
    pub slots: u32,
}

impl Pool {
    /// Bytes of all slots.
    pub fn bytes(&self) -> u64 {
        u64::from(self.slots) * self.shape.bytes(self.format) as u64
    }
}

/// Place of a tile in the pools.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TileSlot {
    /// Index into the stream's list of pools.
    pub pool: u16,
    /// 0…[`Pool::slots`] − 1.
    pub index: u16,
}

/// A tile that can be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResidentTile {
    /// Its level, 0 the finest.
    pub level: u8,
    /// Slot of its texels.
    pub slot: TileSlot,
}

/// A square of a block, and its tile: that of a part that contains it, or the whole block's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartCell {
    /// The tile's slot, in the pool of the block's own tile.
    pub index: u16,
    /// How often the block is halved to get the part; 0 of the whole block.
    pub depth: u8,
}

/// Tiles of the parts of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartTable {
    /// The map.
    pub layer: MapLayer,
    /// The block, by its index.
    pub block: u8,
    /// The slot of the block's own tile.
    pub own: u16,
    /// How often the block is halved: it has 2^depth × 2^depth cells, row by row from the north-west.
    pub depth: u8,
    /// The first of them in [`PartTables::cells`].
    pub first: u32,
}

/// Tiles of the blocks whose tiles are in pools with parts: a table for each map of each of these.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartTables {
    /// The tables.
    pub tables: Vec<PartTable>,
    /// The cells of all tables.
    pub cells: Vec<PartCell>,
}

impl PartTables {
    /// The table of a block of a map.
    pub fn of(&self, layer: MapLayer, block: u8) -> Option<&PartTable> {
        let mut tables = self.tables.iter();
        tables.find(|table| (table.layer, table.block) == (layer, block))
    }

    /// The cells of a table.
    pub fn cells(&self, table: &PartTable) -> &[PartCell] {
        let first = table.first as usize;
        let cells = self.cells.get(first..first + (1 << (2 * table.depth)));
        cells.unwrap_or_default()
    }

    /// Forgets all; keeps the memory.
    pub fn clear(&mut self) {
        self.tables.clear();
        self.cells.clear();
    }
}

/// A part of a tile on its way into a slot: whole rows of one mip level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Upload<'a> {
    /// Its destination.
    pub slot: TileSlot,
    /// The tile.
    pub key: TileKey,
    /// Mip level, 0 the base.
    pub mip: u32,
    /// First row, counted in units of the format: see [`TileFormat::rows`].
    pub first_row: u32,
    /// Number of rows of units.
    pub rows: u32,
    /// Bytes of each.
    pub row_bytes: u32,
    /// `rows` × `row_bytes` bytes.
    pub texels: &'a [u8],
}

/// Counters of a stream. Counts per level are over all maps; the coarsest level is never counted, as it is always resident.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamCounters {
    /// Tiles requested in this frame at the required level, drawn or expected soon, each once.
    pub requested: [u32; MAX_LEVELS],
    /// Tiles that can be drawn.
    pub resident: [u32; MAX_LEVELS],
    /// Tiles that no thread has taken yet.
    pub queued: u32,
    /// Tiles that threads are working on.
    pub loading: u32,
    /// Decoded tiles that are not wholly uploaded.
    pub waiting_upload: u32,
    /// Bytes of those.
    pub waiting_bytes: u64,
    /// Bytes decoded since the start.
    pub decoded_bytes: u64,
    /// Bytes given to `write` since the start.
    pub uploaded_bytes: u64,
    /// Resident tiles that made room for another, since the start.
    pub evictions: u64,
    /// Draws in this frame at the allocated level, or finer. A tile that no pool could have held, or that the source does not have, is not a miss;
    /// a tile that cannot be read is.
    pub hits: u32,
    /// Draws in this frame of something coarser than that.
    pub fallbacks: u32,
    /// Loads that threads have taken, since the start. Each ends in one of the next three.
    pub loads: u64,
    /// Loads that ended with a resident tile, since the start.
    pub completed: u64,
    /// Loads that ended because the tile was no longer requested, since the start.
    pub cancelled: u64,
    /// Loads that failed, since the start.
    pub failures: u64,
}
