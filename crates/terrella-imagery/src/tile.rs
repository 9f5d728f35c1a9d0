//! Tiles: a block of a map at one level, with its border and mip levels. Names, sizes and formats; no files here.
//!
//! A map of a pack is stored at several levels, the finest first. Each level is cut into 16 × 8 tiles, one for each [`Block`]. A tile has `pixels`
//! × `pixels` texels of its block and a border of its neighbours' texels, so that a filter finds the same texels on both sides of an edge: across
//! the date line, and over a pole on the opposite meridian. Its side is padded to a multiple of eight (more border on the east and south), so that
//! four mip levels halve it exactly and the base level is a whole number of compressed 4 × 4 blocks.
//!
//! Levels too fine for a tile of that size are cut further: each block into 2 × 2, 4 × 4 … *parts*, tiles of the same size as those of the finest
//! uncut level. Parts of a block are numbered row by row from its north-west corner.

use std::fmt;
use terrella_ground::globe::Block;
pub use terrella_ground::globe::BlockSet;

/// Most levels of one map.
pub const MAX_LEVELS: usize = 10;

/// Most parts along a block's side.
pub const MAX_PARTS: u32 = 16;

/// Most texels of a part's side, border not counted: with it a texture of 2048 texels.
pub const MAX_PART_PIXELS: u32 = 2048 - 2 * TILE_BORDER;

/// Mip levels of a tile, the base included. The border is half a texel wide at the last one: just what bilinear
/// filtering reaches at an edge.
pub const TILE_MIPS: u32 = 4;

/// Texels of the neighbours around a tile's own at its base level: at least this many on every side.
pub const TILE_BORDER: u32 = 4;

/// Fewest texels of a block's side at any level.
pub const MIN_PIXELS: u32 = 16;

/// Most texels of a block's side at any level: with its border a texture of 8192 texels, which every adapter takes.
pub const MAX_PIXELS: u32 = 8192 - 2 * TILE_BORDER;

/// Most texels of a block's side at the coarsest level, which is drawn as one map of 16 × 8 blocks and always held.
pub const MAX_COARSEST_PIXELS: u32 = 256;

/// The paper's Table 1, texels per block of the surface, the finest first.
pub const PAPER_SURFACE_PIXELS: [u32; 5] = [1350, 675, 450, 270, 135];

/// The paper's Table 1, texels per block of clouds and normals, the finest first.
pub const PAPER_CLOUD_PIXELS: [u32; 5] = [750, 375, 250, 150, 75];

/// A map of the Earth that an imagery pack can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MapLayer {
    /// Surface colour by day.
    Day,
    /// Cloud cover, 0…1.
    Clouds,
    /// Terrain slopes to the east and to the north.
    Normals,
    /// City lights, 0…1.
    NightLights,
    /// Open water, 0…1, the coast where it is one half.
    Water,
}

/// Number of [`MapLayer`]s.
pub const MAP_LAYERS: usize = MapLayer::ALL.len();

impl MapLayer {
    /// All of them, in the order of [`Self::index`].
    pub const ALL: [Self; 5] = [
        Self::Day,
        Self::Clouds,
        Self::Normals,
        Self::NightLights,
        Self::Water,
    ];

    /// 0…4.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name in manifests, folders and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Day => "day",
            Self::Clouds => "clouds",
            Self::Normals => "normals",
            Self::NightLights => "night_lights",
            Self::Water => "water",
        }
    }

    /// The layer of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|layer| layer.name() == name)
    }

    /// How its texels are stored in a kind of storage.
    pub fn tile_format(self, storage: Storage) -> TileFormat {
        match (self, storage) {
            (Self::Day, Storage::Plain) => TileFormat::Rgba8Srgb,
            (Self::Day, Storage::Bc) => TileFormat::Bc7Srgb,
            (Self::Normals, Storage::Plain) => TileFormat::Rg8Snorm,
            (Self::Normals, Storage::Bc) => TileFormat::Bc5Snorm,
            (Self::Clouds | Self::NightLights | Self::Water, Storage::Plain) => TileFormat::R8Unorm,
            (Self::Clouds | Self::NightLights | Self::Water, Storage::Bc) => TileFormat::Bc4Unorm,
        }
    }

    /// The paper's texels per block, the finest first: Table 1.
    pub fn paper_pixels(self) -> &'static [u32; 5] {
        match self {
            Self::Day | Self::NightLights | Self::Water => &PAPER_SURFACE_PIXELS,
            Self::Clouds | Self::Normals => &PAPER_CLOUD_PIXELS,
        }
    }
}

/// How a pack keeps its tiles. A pack may hold both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Storage {
    /// Uncompressed texels: what software adapters draw fastest.
    Plain,
    /// BC7, BC5 and BC4 blocks: a quarter to a half of the memory on an adapter that reads them.
    Bc,
}

impl Storage {
    /// Both storages.
    pub const ALL: [Self; 2] = [Self::Plain, Self::Bc];

    /// Name in manifests, folders and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Bc => "bc",
        }
    }
}

/// How the texels of a tile are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TileFormat {
    /// Four bytes a texel, colour in sRGB encoding, alpha unused (255).
    Rgba8Srgb,
    /// One byte, 0…1.
    R8Unorm,
    /// Two signed bytes, −1…1.
    Rg8Snorm,
    /// 16 bytes per 4 × 4 texels, colour in sRGB encoding.
    Bc7Srgb,
    /// 8 bytes per 4 × 4 texels, 0…1.
    Bc4Unorm,
    /// 16 bytes per 4 × 4 texels, two values −1…1.
    Bc5Snorm,
}

impl TileFormat {
    /// Side of the smallest unit that is stored, texels: 1, or 4 where texels are compressed in blocks.
    pub fn unit_side(self) -> u32 {
        match self {
            Self::Rgba8Srgb | Self::R8Unorm | Self::Rg8Snorm => 1,
            Self::Bc7Srgb | Self::Bc4Unorm | Self::Bc5Snorm => 4,
        }
    }

    /// Bytes of that unit.
    pub fn unit_bytes(self) -> u32 {
        match self {
            Self::R8Unorm => 1,
            Self::Rg8Snorm => 2,
            Self::Rgba8Srgb => 4,
            Self::Bc4Unorm => 8,
            Self::Bc7Srgb | Self::Bc5Snorm => 16,
        }
    }

    /// The uncompressed format that it decodes to; itself where it is one.
    pub fn decoded(self) -> Self {
        match self {
            Self::Rgba8Srgb | Self::Bc7Srgb => Self::Rgba8Srgb,
            Self::R8Unorm | Self::Bc4Unorm => Self::R8Unorm,
            Self::Rg8Snorm | Self::Bc5Snorm => Self::Rg8Snorm,
        }
    }

    /// Rows of units of a square image of this side, and bytes of each.
    pub fn rows(self, side: u32) -> (u32, u32) {
        let units = side.div_ceil(self.unit_side());
        (units, units * self.unit_bytes())
    }

    /// Bytes of a square image of this side. A side of at most 8192 gives at most 268 435 456.
    pub fn image_bytes(self, side: u32) -> usize {
        let (rows, row_bytes) = self.rows(side);
        rows as usize * row_bytes as usize
    }
}

/// Size of the tiles of one level, and how many of them a block has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TileShape {
    /// Texels of a tile's side, border not counted.
    pub pixels: u32,
    /// Tiles along a block's side: 1, or a power of two where blocks are cut into parts.
    pub parts: u32,
}

impl TileShape {
    /// The shape of whole-block tiles with this many texels of their own a side; `None` outside [`MIN_PIXELS`]…[`MAX_PIXELS`].
    pub fn new(pixels: u32) -> Option<Self> {
        (MIN_PIXELS..=MAX_PIXELS)
            .contains(&pixels)
            .then_some(Self { pixels, parts: 1 })
    }

    /// The shape of tiles of so many texels, of which `parts` × `parts` make a block. `parts` is a power of two up to [`MAX_PARTS`], and
    /// where it is not 1 a tile has at most [`MAX_PART_PIXELS`]; `None` otherwise.
    pub fn cut(pixels: u32, parts: u32) -> Option<Self> {
        let most = if parts == 1 {
            MAX_PIXELS
        } else {
            MAX_PART_PIXELS
        };
        let is_good =
            parts.is_power_of_two() && parts <= MAX_PARTS && (MIN_PIXELS..=most).contains(&pixels);
        is_good.then_some(Self { pixels, parts })
    }

    /// Texels of a block's side, borders not counted.
    pub fn block_pixels(self) -> u32 {
        self.pixels * self.parts
    }

    /// Tiles of a block.
    pub fn tiles_of_block(self) -> u16 {
        (self.parts * self.parts) as u16
    }

    /// Texels of the tile's side: its own, the border, and the padding to a multiple of eight.
    pub fn side(self) -> u32 {
        (self.pixels + 2 * TILE_BORDER).next_multiple_of(1 << (TILE_MIPS - 1))
    }

    /// Side of a mip level, texels.
    pub fn mip_side(self, mip: u32) -> u32 {
        self.side() >> mip
    }

    /// Bytes of all mip levels.
    pub fn bytes(self, format: TileFormat) -> usize {
        (0..TILE_MIPS)
            .map(|mip| format.image_bytes(self.mip_side(mip)))
            .sum()
    }

    /// Width of the whole map at this level, texels.
    pub fn map_width(self) -> u32 {
        self.block_pixels() * terrella_ground::globe::COLUMNS
    }

    /// Height of the whole map at this level, texels.
    pub fn map_height(self) -> u32 {
        self.block_pixels() * terrella_ground::globe::ROWS
    }

    /// Tiles of the whole map from west to east.
    pub fn tile_columns(self) -> u32 {
        self.parts * terrella_ground::globe::COLUMNS
    }

    /// Tiles of the whole map from north to south.
    pub fn tile_rows(self) -> u32 {
        self.parts * terrella_ground::globe::ROWS
    }
}

/// One tile of a pack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TileKey {
    /// Map that the tile is cut from.
    pub layer: MapLayer,
    /// Place of its level in the layer's list, 0 the finest (the paper's level 1).
    pub level: u8,
    /// [`Block::index`], 0…127.
    pub block: u8,
    /// Which part of the block, row by row from its north-west corner; 0 at levels that are not cut.
    pub part: u16,
}

impl TileKey {
    /// The tile of a whole block.
    pub fn whole(layer: MapLayer, level: u8, block: u8) -> Self {
        Self {
            layer,
            level,
            block,
            part: 0,
        }
    }

    /// Block of the globe that the tile covers.
    pub fn block(self) -> Block {
        let index = u32::from(self.block);
        Block {
            column: index % terrella_ground::globe::COLUMNS,
            row: index / terrella_ground::globe::COLUMNS,
        }
    }
}

/// Counts levels from 1, as the paper does.
impl fmt::Display for TileKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Block { column, row } = self.block();
        write!(
            f,
            "{} level {} block r{row}c{column}",
            self.layer.name(),
            u32::from(self.level) + 1
        )?;
        match self.part {
            0 => Ok(()),
            part => write!(f, " part {part}"),
        }
    }
}

/// A set of tiles of one level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileSet {
    parts: u32,
    words: Vec<u64>,
}

impl TileSet {
    /// None of the tiles of a shape.
    pub fn none(shape: TileShape) -> Self {
        let tiles =
            terrella_ground::globe::BLOCK_COUNT as usize * usize::from(shape.tiles_of_block());
        Self {
            parts: shape.parts,
            words: vec![0; tiles.div_ceil(64)],
        }
    }

    /// All of them.
    pub fn all(shape: TileShape) -> Self {
        Self::of_blocks(shape, BlockSet::ALL)
    }

    /// All of these blocks.
    pub fn of_blocks(shape: TileShape, blocks: BlockSet) -> Self {
        let mut set = Self::none(shape);
        for block in
            (0..terrella_ground::globe::BLOCK_COUNT as u8).filter(|block| blocks.contains(*block))
        {
            for part in 0..shape.tiles_of_block() {
                set.insert(block, part);
            }
        }
        set
    }

    fn place(&self, block: u8, part: u16) -> Option<(usize, u64)> {
        let of_block = self.parts * self.parts;
        if u32::from(block) >= terrella_ground::globe::BLOCK_COUNT || u32::from(part) >= of_block {
            return None;
        }
        let tile = u32::from(block) * of_block + u32::from(part);
        Some((tile as usize / 64, 1 << (tile % 64)))
    }

    /// Whether a part of a block, by its index, has a tile.
    #[inline]
    pub fn contains(&self, block: u8, part: u16) -> bool {
        self.place(block, part)
            .is_some_and(|(word, bit)| self.words[word] & bit != 0)
    }

    /// Adds a tile; those that there are not are skipped.
    pub fn insert(&mut self, block: u8, part: u16) {
        if let Some((word, bit)) = self.place(block, part) {
            self.words[word] |= bit;
        }
    }

    /// Number of tiles.
    pub fn len(&self) -> u32 {
        self.words.iter().map(|word| word.count_ones()).sum()
    }

    /// Whether there are no texels.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|word| *word == 0)
    }
}

/// One level of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelLayout {
    /// Size of its tiles.
    pub shape: TileShape,
    /// Which tiles there are.
    pub present: TileSet,
}

impl LevelLayout {
    /// A level with all tiles of these blocks.
    pub fn of_blocks(shape: TileShape, blocks: BlockSet) -> Self {
        Self {
            shape,
            present: TileSet::of_blocks(shape, blocks),
        }
    }
}

/// One map of a source of tiles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerLayout {
    /// Which map.
    pub layer: MapLayer,
    /// How [`TileSource::read`] gives its texels.
    pub format: TileFormat,
    /// Its levels, the finest first, 1…[`MAX_LEVELS`]. The last has all blocks and at most [`MAX_COARSEST_PIXELS`]. Levels that are cut into parts
    /// come first, and their tiles are as large as those of the finest uncut level, which has a tile of every block that has parts.
    pub levels: Vec<LevelLayout>,
}

impl LayerLayout {
    /// How many of the levels are cut into parts: those before this place.
    pub fn cut_levels(&self) -> usize {
        self.levels
            .iter()
            .take_while(|level| level.shape.parts > 1)
            .count()
    }
}

/// The texels of a tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// How they are stored.
    pub format: TileFormat,
    /// Size.
    pub shape: TileShape,
    /// All mip levels, the base first, each row-major and tightly packed: [`TileShape::bytes`] bytes.
    pub texels: Vec<u8>,
}

impl Tile {
    /// The texels of one mip level, 0…[`TILE_MIPS`] − 1; empty beyond.
    pub fn mip(&self, mip: u32) -> &[u8] {
        let size = |mip| self.format.image_bytes(self.shape.mip_side(mip));
        let start: usize = (0..mip.min(TILE_MIPS)).map(size).sum();
        let len = if mip < TILE_MIPS { size(mip) } else { 0 };
        self.texels.get(start..start + len).unwrap_or(&[])
    }
}

/// Where tiles come from: a pack on disk, or a test's own.
pub trait TileSource: Send + Sync {
    /// The maps that there are, in the order of [`MapLayer::index`], each once.
    fn layers(&self) -> &[LayerLayout];

    /// Reads and decodes a tile. Called from decoder threads; may take long. `cancelled` is called between its steps and, once true, ends the
    /// reading with [`TileError::Cancelled`].
    fn read(&self, key: TileKey, cancelled: &dyn Fn() -> bool) -> Result<Tile, TileError>;
}

/// Why there are no texels.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum TileError {
    /// The source has no such tile.
    #[error("there is no tile {0}")]
    Absent(TileKey),
    /// The file could not be read.
    #[error("{}: {source}; check the disk and the file's permissions, or build the pack again", path.display())]
    Unreadable {
        path: std::path::PathBuf,
        source: std::io::Error,
    },
    /// The file does not match the manifest.
    #[error("{}: {cause}; run `terrella pack verify` and build the pack again", path.display())]
    Corrupt {
        path: std::path::PathBuf,
        /// The decoder's error.
        cause: String,
    },
    /// The file did not come from its server.
    #[error("{address}: {cause}; check the address and the connection")]
    NotReceived {
        address: String,
        /// What the request ended with.
        cause: String,
    },
    /// No longer wanted.
    #[error("no longer wanted")]
    Cancelled,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_hold_the_border_and_halve_three_times() {
        for (pixels, side) in [(1350, 1360), (675, 688), (450, 464), (270, 280), (135, 144)] {
            let shape = TileShape::new(pixels).expect("in range");
            assert_eq!(shape.side(), side);
            assert!(shape.side() >= pixels + 2 * TILE_BORDER && shape.side().is_multiple_of(8));
        }
        assert_eq!(TileShape::new(MAX_PIXELS).map(TileShape::side), Some(8192));
        assert_eq!(TileShape::new(MIN_PIXELS - 1), None);
        assert_eq!(TileShape::new(MAX_PIXELS + 1), None);
    }

    #[test]
    fn bytes_count_all_mips_in_whole_blocks() {
        let shape = TileShape::new(16).expect("in range");
        assert_eq!(
            (0..4).map(|m| shape.mip_side(m)).collect::<Vec<_>>(),
            [24, 12, 6, 3]
        );
        assert_eq!(shape.bytes(TileFormat::R8Unorm), 576 + 144 + 36 + 9);
        assert_eq!(shape.bytes(TileFormat::Bc4Unorm), (36 + 9 + 4 + 1) * 8);
        let tile = Tile {
            format: TileFormat::Bc4Unorm,
            shape,
            texels: (0..400).map(|n| n as u8).collect(),
        };
        assert_eq!(tile.mip(3).len(), 8);
        assert_eq!(tile.mip(1)[0], (36 * 8) as u8);
        assert!(tile.mip(4).is_empty());
    }

    #[test]
    fn names_are_read_back() {
        for layer in MapLayer::ALL {
            assert_eq!(MapLayer::from_name(layer.name()), Some(layer));
            assert_eq!(MapLayer::ALL[layer.index()], layer);
        }
        let key = TileKey::whole(MapLayer::Day, 2, 28);
        assert_eq!(key.to_string(), "day level 3 block r1c12");
        let part = TileKey { part: 5, ..key };
        assert_eq!(part.to_string(), "day level 3 block r1c12 part 5");
    }

    #[test]
    fn sets_take_only_blocks() {
        let mut set = BlockSet::default();
        for block in [0, 127, 128, 255] {
            set.insert(block);
        }
        assert_eq!(set.len(), 2);
        assert!(set.contains(127) && !set.contains(128) && !set.contains(1));
        assert_eq!(BlockSet::ALL.len(), 128);
        let shape = TileShape::cut(1350, 4).expect("in range");
        let mut set = TileSet::none(shape);
        for (block, part) in [(0, 0), (127, 15), (127, 16), (128, 0), (3, 7)] {
            set.insert(block, part);
        }
        assert_eq!((set.len(), set.is_empty()), (3, false));
        assert!(set.contains(127, 15) && set.contains(3, 7));
        assert!(!set.contains(127, 16) && !set.contains(7, 3) && !set.contains(128, 0));
        assert_eq!(TileSet::all(shape).len(), 2048);
        assert_eq!(TileSet::of_blocks(shape, BlockSet(0b101)).len(), 32);
    }

    #[test]
    fn blocks_are_cut_by_powers_of_two_into_tiles_of_one_size() {
        let shape = TileShape::cut(1350, 4).expect("in range");
        assert_eq!((shape.block_pixels(), shape.side()), (5400, 1360));
        assert_eq!((shape.map_width(), shape.map_height()), (86_400, 43_200));
        assert_eq!(TileShape::cut(1350, 1), TileShape::new(1350));
        for (pixels, parts) in [(1350, 3), (1350, 0), (1350, 32), (15, 2), (2041, 2)] {
            assert_eq!(TileShape::cut(pixels, parts), None, "{pixels} {parts}");
        }
    }
}
