//! Which tiles of a pack a frame requests, and which it is drawn with.

use super::quality::Quality;
use super::sky::{LIGHTS_OUT, ROOM_SIN};
use super::tile_parts::{PartLevels, PartRequests};
use super::tile_rule::{Ladder, NONE, TileRule};
use super::tile_view::{TileDetail, TileView};
use super::{EarthError, EyeView};
use crate::gpu::GLINT_ENDS_SIN;
use crate::plan::{BlockTiles, ChosenTiles};
use glam::DVec3;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;
use terrella_files::clock::Instant;
use terrella_ground::globe::{
    BLOCK_COUNT, Block, BlockGrid, BlockSet, Figure, LevelRule, PartSight, Visibility,
    select_blocks, texels_per_pixel,
};
use terrella_ground::height::HeightRange;
use terrella_imagery::EarthLayers;
use terrella_imagery::residency::{PartTable, Pool, StreamCounters, Upload};
use terrella_imagery::stream::{StreamOptions, TileLoad, TileLoading, TileRequest, TileStream};
use terrella_imagery::tile::{LayerLayout, MAP_LAYERS, MAX_LEVELS, MapLayer, TileKey, TileSource};

/// Limit of expected views.
const MAX_EXPECTED: usize = 4;

/// Below this sine of the elevation of Sun and Moon a block is drawn black: the sky is dark (18° below the horizon), and the
/// paper's shading ends at −0.3.
const DARK: f64 = -0.32;

/// Below this sine the sea shows no sunglint, with a margin for the ellipsoid.
const NO_GLINT: f64 = GLINT_ENDS_SIN - ROOM_SIN;

/// How tiles are selected, loaded and held.
///
/// An Earth of a pack:
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use std::sync::Arc;
/// use terrella::{EarthOptions, MapLayer, Pack, PackTiles, Storage, TileOptions};
///
/// let pack = Arc::new(Pack::open("earth".as_ref())?);
/// let tiles = PackTiles::new(pack, Storage::Plain, false, &[MapLayer::Day, MapLayer::Clouds])?;
/// let (layers, _unreadable) = tiles.coarsest_maps()?;
/// let options = EarthOptions {
///     tiles: Some(TileOptions::new(Arc::new(tiles))),
///     ..EarthOptions::new(layers)
/// };
/// # Ok(())
/// # }
/// ```
///
/// `Storage::Bc` needs a device with `TEXTURE_COMPRESSION_BC`, or tiles that are decoded on the way.
#[derive(Clone)]
pub struct TileOptions {
    /// Source of the tiles. Every map of it must be among the Earth's whole maps.
    pub source: Arc<dyn TileSource>,
    /// How levels are selected.
    pub rule: LevelRule,
    /// [`LevelRule::Screen`]: most screen pixels that a texel may cover.
    pub max_texel_px: f64,
    /// Memory limit for the textures of tiles and whole maps together, bytes. Whole maps are kept even if they alone exceed it.
    pub texture_bytes: u64,
    /// Bytes of tiles that one [`super::Earth::prepare`] may upload.
    pub upload_bytes: u64,
    /// Who loads tiles; threads by default.
    pub loading: TileLoading,
}

impl TileOptions {
    /// The defaults: one screen pixel a texel, 512 MB of textures, 4 MB uploaded a frame, which takes a processor a millisecond to copy.
    pub fn new(source: Arc<dyn TileSource>) -> Self {
        Self {
            source,
            rule: LevelRule::default(),
            max_texel_px: 1.0,
            texture_bytes: 512_000_000,
            upload_bytes: 4_000_000,
            loading: TileLoading::Threads(None),
        }
    }

    /// Most screen pixels that a texel may cover.
    pub(super) fn texel_px(&self) -> f64 {
        self.max_texel_px
    }

    /// Whether the device reads the tiles' formats.
    pub(super) fn can_be_read_by(&self, device: &wgpu::Device) -> bool {
        let is_plain = |layer: &LayerLayout| layer.format.unit_side() == 1;
        let has_bc = device.features();
        self.source.layers().iter().all(is_plain)
            || has_bc.contains(wgpu::Features::TEXTURE_COMPRESSION_BC)
    }
}

impl fmt::Debug for TileOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TileOptions")
            .field("layers", &self.source.layers())
            .field("rule", &self.rule)
            .field("max_texel_px", &self.max_texel_px)
            .field("texture_bytes", &self.texture_bytes)
            .field("upload_bytes", &self.upload_bytes)
            .field("loading", &self.loading)
            .finish()
    }
}

/// Elevation range for testing the visibility of parts, metres. All ground lies within it.
const ANY_GROUND: HeightRange = HeightRange {
    low_m: -500.0,
    high_m: 9_000.0,
};

pub(super) struct TileDriver {
    stream: TileStream,
    rule: TileRule,
    /// Which maps are drawn, by [`MapLayer::index`].
    shown: [bool; MAP_LAYERS],
    upload_bytes: u64,
    visibility: Visibility,
    /// By [`MapLayer::index`].
    ladders: [Ladder; MAP_LAYERS],
    expected: Vec<EyeView>,
    /// The tiles of each block in this frame.
    chosen: Box<[BlockTiles; BLOCK_COUNT as usize]>,
    in_sight: BlockSet,
    // Kept to allocate nothing in steady state.
    near: Vec<(f64, Block)>,
    expected_blocks: Vec<Block>,
    wanted: Vec<Wanted>,
    parts: PartRequests,
    requests: Vec<TileRequest>,
}

/// A request and its urgency: the size of a pixel on its block, metres, then its turn.
struct Wanted {
    pixel_m: f64,
    turn: u32,
    request: TileRequest,
}

/// Levels assigned to the blocks of one view in this and the previous frame, for the hysteresis.
#[derive(Clone)]
pub(super) struct TileLevels {
    now: [[u8; BLOCK_COUNT as usize]; MAP_LAYERS],
    before: [[u8; BLOCK_COUNT as usize]; MAP_LAYERS],
    parts: [PartLevels; MAP_LAYERS],
}

impl Default for TileLevels {
    fn default() -> Self {
        Self {
            now: [[NONE; BLOCK_COUNT as usize]; MAP_LAYERS],
            before: [[NONE; BLOCK_COUNT as usize]; MAP_LAYERS],
            parts: Default::default(),
        }
    }
}

impl TileLevels {
    fn begin(&mut self, ladders: &[Ladder; MAP_LAYERS]) {
        self.before = self.now;
        self.now = [[NONE; BLOCK_COUNT as usize]; MAP_LAYERS];
        for (parts, ladder) in self.parts.iter_mut().zip(ladders) {
            parts.begin(ladder);
        }
    }
}

impl TileDriver {
    pub fn new(
        options: &TileOptions,
        layers: &EarthLayers,
        visibility: Visibility,
        figure: Figure,
    ) -> Result<Self, EarthError> {
        let mut ladders: [Ladder; MAP_LAYERS] = Default::default();
        for tiled in options.source.layers() {
            if layers.get(tiled.layer).is_none() {
                return Err(EarthError::NoWholeMap(tiled.layer.name()));
            }
            ladders[tiled.layer.index()] = Ladder::new(tiled);
        }
        let stream = StreamOptions {
            texture_bytes: options.texture_bytes.saturating_sub(layers.texture_bytes()),
            loading: options.loading,
            ..StreamOptions::default()
        };
        Ok(Self {
            stream: TileStream::new(options.source.clone(), &stream),
            rule: TileRule {
                rule: options.rule,
                max_texel_px: options.max_texel_px,
                radius_m: figure.ellipsoid().equatorial_radius_m,
            },
            shown: [true; MAP_LAYERS],
            upload_bytes: options.upload_bytes,
            visibility,
            ladders,
            expected: Vec::with_capacity(MAX_EXPECTED),
            chosen: Box::new([[None; MAP_LAYERS]; BLOCK_COUNT as usize]),
            in_sight: BlockSet::default(),
            near: Vec::with_capacity(BLOCK_COUNT as usize),
            expected_blocks: Vec::with_capacity(BLOCK_COUNT as usize),
            wanted: Vec::with_capacity(MAP_LAYERS * BLOCK_COUNT as usize),
            parts: PartRequests::default(),
            requests: Vec::with_capacity((1 + MAX_EXPECTED) * MAP_LAYERS * BLOCK_COUNT as usize),
        })
    }

    /// Requests tiles for this quality from now on. Resident tiles stay until others need their slot.
    pub fn set_quality(&mut self, quality: &Quality) {
        self.rule.max_texel_px = quality.texel_px;
        self.shown = quality.maps;
        self.shown[MapLayer::Day.index()] = true;
    }

    /// The pools that the GPU must have.
    pub fn pools(&self) -> &[Pool] {
        self.stream.pools()
    }

    /// Sets the expected positions of the eye, the nearest time first.
    pub fn prefetch(&mut self, views: &[EyeView]) {
        self.expected.clear();
        self.expected.extend(views.iter().take(MAX_EXPECTED));
    }

    /// Begins a frame.
    pub fn begin(&mut self) {
        self.wanted.clear();
        self.parts.clear();
        self.requests.clear();
        self.in_sight = BlockSet::default();
    }

    /// Requests tiles for the blocks that one view of the frame has in sight.
    pub fn add(
        &mut self,
        grid: &BlockGrid,
        view: &TileView,
        blocks: &[Block],
        levels: &mut TileLevels,
    ) {
        levels.begin(&self.ladders);
        let sight = self.sight(grid, view);
        sort_by_distance(&mut self.near, grid, view.eye_itrf_m, blocks);
        for place in 0..self.near.len() {
            let (distance_m, block) = self.near[place];
            self.in_sight.insert(block.index() as u8);
            self.request(grid, view, sight.as_ref(), distance_m, block, Some(levels));
        }
    }

    /// Selects tiles for the views that were added, and then prefetches for the expected positions of the first view. Lists each block in sight
    /// with its resident tiles.
    pub fn choose(&mut self, grid: &BlockGrid, first: Option<&TileView>, tiles: &mut ChosenTiles) {
        // If several views request a block, the one with the smallest pixel on it comes first and decides.
        self.wanted.sort_unstable_by(|a, b| {
            let by_size = a.pixel_m.total_cmp(&b.pixel_m);
            by_size.then(a.turn.cmp(&b.turn))
        });
        self.requests
            .extend(self.wanted.iter().map(|wanted| wanted.request));
        self.parts.request(&mut self.requests);
        if let Some(first) = first {
            self.request_expected(grid, first);
        }
        self.stream.update(Instant::now(), &self.requests);
        tiles.blocks.clear();
        tiles.parts.clear();
        for block in Block::all() {
            let index = block.index() as u8;
            if !self.in_sight.contains(index) {
                continue;
            }
            let drawn = MapLayer::ALL.map(|layer| {
                let ladder = &self.ladders[layer.index()];
                if ladder.pixels.is_empty() || !self.shown[layer.index()] {
                    return None;
                }
                let own = self.stream.draw(layer, index)?;
                if own.level == ladder.whole() && own.level > 0 {
                    let wanted = self.parts.of(layer, index);
                    self.stream
                        .draw_parts(layer, index, own, wanted, &mut tiles.parts);
                    self.parts.note_drawn(layer, index, ladder, &tiles.parts);
                }
                Some(own)
            });
            self.chosen[usize::from(index)] = drawn;
            tiles.blocks.push((block, drawn));
        }
        // If not all fit, the most finely divided tables come first: their parts are nearest.
        let order = |table: &PartTable| (std::cmp::Reverse(table.depth), table.block, table.layer);
        tiles.parts.tables.sort_unstable_by_key(order);
    }

    /// Detail of the selected tiles for one of the views.
    pub fn detail(&self, grid: &BlockGrid, view: &TileView, blocks: &[Block]) -> TileDetail {
        let mut fewest = f64::INFINITY;
        let mut day_levels = [0; MAX_LEVELS];
        let pixels = &self.ladders[MapLayer::Day.index()].pixels;
        let coarsest = pixels.len().saturating_sub(1);
        for block in blocks {
            if lit_at_most(grid, *block, view) <= DARK {
                continue;
            }
            let day = self.chosen[block.index() as usize][MapLayer::Day.index()];
            let level = day.map_or(coarsest, |tile| tile.level.into());
            let mut note = |level: usize, distance_m| {
                if let Some(tiles) = day_levels.get_mut(level) {
                    *tiles += 1;
                }
                if let Some(pixels) = pixels.get(level) {
                    let radius_m = self.rule.radius_m;
                    let sharp = texels_per_pixel(*pixels, radius_m, distance_m, view.pixel_rad);
                    fewest = fewest.min(sharp);
                }
            };
            // Parts are drawn only over the block's own tile, which they refine.
            let is_own = level == usize::from(self.ladders[MapLayer::Day.index()].whole());
            let index = block.index() as u8;
            if is_own && self.parts.is_out_of_sight(MapLayer::Day, index) {
                continue;
            }
            let parts = self.parts.drawn(MapLayer::Day, index);
            match parts.is_empty() || !is_own {
                true => note(level, grid.distance_m(*block, view.eye_itrf_m)),
                false => parts
                    .iter()
                    .for_each(|part| note(usize::from(part.drawn), part.distance_m)),
            }
        }
        TileDetail {
            texels_per_pixel: if fewest.is_finite() { fewest } else { 0.0 },
            day_levels,
        }
    }

    /// Passes arrived tiles to `write` in parts, at most `budget` bytes or else the limit of a frame. Returns the bytes written.
    pub fn upload(&mut self, budget: Option<u64>, write: &mut dyn FnMut(Upload<'_>)) -> u64 {
        self.stream
            .upload(budget.unwrap_or(self.upload_bytes), write)
    }

    /// The most urgent tile for the host to load.
    pub fn take(&self) -> Option<TileLoad> {
        self.stream.take()
    }

    /// Counters of the tile stream.
    pub fn counters(&self) -> StreamCounters {
        self.stream.counters()
    }

    /// Tiles that the last frame's picture lacks.
    pub fn missing(&self) -> impl Iterator<Item = TileKey> + '_ {
        self.stream.missing()
    }

    /// Whether there is nothing left to wait for.
    pub fn is_settled(&self) -> bool {
        self.stream.is_settled()
    }

    /// Waits until a tile arrives.
    pub fn wait(&mut self, timeout: Duration) {
        self.stream.wait(timeout);
    }

    /// Visibility of parts for a view, over any elevation; `None` if no map has parts.
    fn sight(&self, grid: &BlockGrid, view: &TileView) -> Option<PartSight> {
        let has_parts = self.ladders.iter().any(|ladder| ladder.whole() > 0);
        has_parts.then(|| {
            PartSight::new(
                grid.ellipsoid(),
                ANY_GROUND,
                view.eye_itrf_m,
                &view.clip_from_eye,
            )
        })
    }

    /// Requests a block's tiles, and those of its parts in sight. With `levels` for a visible block, whose selected levels are stored there for the
    /// next frame's hysteresis.
    fn request(
        &mut self,
        grid: &BlockGrid,
        view: &TileView,
        sight: Option<&PartSight>,
        distance_m: f64,
        block: Block,
        mut levels: Option<&mut TileLevels>,
    ) {
        let index = block.index() as usize;
        for layer in MapLayer::ALL {
            let ladder = &self.ladders[layer.index()];
            let is_drawn = !ladder.pixels.is_empty() && self.shown[layer.index()];
            if !is_drawn || !shows(grid, layer, block, view) {
                continue;
            }
            let before = levels.as_ref().map(|l| l.before[layer.index()][index]);
            let level = self.rule.level(ladder, distance_m, view.pixel_rad, before);
            if let Some(sight) = sight.filter(|_| level < ladder.whole()) {
                let parts = levels.as_mut().map(|l| &mut l.parts[layer.index()]);
                self.parts.find(
                    &self.rule,
                    ladder,
                    sight,
                    view.pixel_rad,
                    (layer, block),
                    parts,
                );
            }
            let request = TileRequest {
                key: TileKey::whole(layer, level.max(ladder.whole()), index as u8),
                drawn: levels.is_some(),
            };
            match &mut levels {
                Some(levels) => {
                    levels.now[layer.index()][index] = level;
                    self.wanted.push(Wanted {
                        pixel_m: distance_m * view.pixel_rad,
                        turn: self.wanted.len() as u32,
                        request,
                    });
                }
                None => self.requests.push(request),
            }
        }
    }

    fn request_expected(&mut self, grid: &BlockGrid, view: &TileView) {
        for place in 0..self.expected.len() {
            let (itrf_m, clip_from_eye) = self.expected[place].to_itrf();
            if !itrf_m.is_finite() || !clip_from_eye.is_finite() {
                continue;
            }
            let blocks = &mut self.expected_blocks;
            select_blocks(grid, self.visibility, itrf_m, &clip_from_eye, blocks);
            sort_by_distance(&mut self.near, grid, itrf_m, blocks);
            let seen = TileView {
                eye_itrf_m: itrf_m,
                clip_from_eye,
                ..*view
            };
            let sight = self.sight(grid, &seen);
            for place in 0..self.near.len() {
                let (distance_m, block) = self.near[place];
                self.request(grid, view, sight.as_ref(), distance_m, block, None);
            }
        }
        self.parts.request_expected(&mut self.requests);
    }
}

fn sort_by_distance(
    near: &mut Vec<(f64, Block)>,
    grid: &BlockGrid,
    eye_itrf_m: DVec3,
    blocks: &[Block],
) {
    near.clear();
    near.extend(
        blocks
            .iter()
            .map(|block| (grid.distance_m(*block, eye_itrf_m), *block)),
    );
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
}

/// Sine of the elevation of the Sun, or of a Moon that lights the Earth, where that is highest on a block.
fn lit_at_most(grid: &BlockGrid, block: Block, view: &TileView) -> f64 {
    let lights = [Some(view.sun_itrf), view.moon_itrf].into_iter().flatten();
    let highest = lights.map(|light| grid.sun_range(block, light).1);
    highest.fold(-1.0, f64::max)
}

/// Whether anything of a map can be seen on a block.
fn shows(grid: &BlockGrid, layer: MapLayer, block: Block, view: &TileView) -> bool {
    match layer {
        MapLayer::Day | MapLayer::Clouds | MapLayer::Normals => {
            lit_at_most(grid, block, view) > DARK
        }
        MapLayer::NightLights => grid.sun_range(block, view.sun_itrf).0 < LIGHTS_OUT,
        MapLayer::Water => lit_at_most(grid, block, view) > NO_GLINT,
    }
}
