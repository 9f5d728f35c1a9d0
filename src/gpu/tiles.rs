//! Tiles on the GPU: fixed pools of textures, and for each block the bind group of its tiles.

use super::maps::{Maps, array_view};
use super::shader::{PART_CELL_WORDS, PART_INDEX_BITS};
use crate::plan::BlockTiles;
use glam::Vec4;
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockSet, COLUMNS, ROWS};
use terrella_imagery::residency::{PartCell, PartTables, Pool, Upload};
use terrella_imagery::tile::{MAP_LAYERS, MapLayer, TILE_BORDER, TILE_MIPS, TileFormat, TileShape};

type Placements = [[Vec4; MAP_LAYERS]; BLOCK_COUNT as usize];
const PLACEMENTS_BYTES: usize = size_of::<Placements>();

/// Offset of the cells of blocks with parts: after the placements and the set of blocks with tiles.
const CELLS_START: usize = PLACEMENTS_BYTES + size_of::<BlockSet>();

/// Limit of cells.
const MAX_CELLS: usize = 8 * PART_CELL_WORDS as usize;

/// Bytes of `Tiles` of `shaders/earth/bindings.wgsl`: placements, the set of blocks that have tiles, and cells.
pub(super) fn tiles_bytes(has_parts: bool) -> usize {
    CELLS_START
        + if has_parts {
            size_of::<u16>() * MAX_CELLS
        } else {
            0
        }
}

struct PoolTextures {
    layer: usize,
    format: TileFormat,
    shape: TileShape,
    slots: Slots,
    bytes: u64,
}

/// Storage of a pool's tiles.
enum Slots {
    Textures(Vec<(wgpu::Texture, wgpu::TextureView)>),
    /// For blocks and their parts: layers of one array texture.
    Layers(wgpu::Texture, wgpu::TextureView),
}

impl PoolTextures {
    fn new(device: &wgpu::Device, pool: &Pool, display_values: bool, has_parts: bool) -> Self {
        let slots = match pool.has_parts {
            true => {
                let texture = slot_texture(device, pool, display_values, pool.slots);
                let view = array_view(&texture);
                Slots::Layers(texture, view)
            }
            false => {
                let slot = |_| {
                    let texture = slot_texture(device, pool, display_values, 1);
                    let view = match has_parts {
                        true => array_view(&texture),
                        false => super::view(&texture),
                    };
                    (texture, view)
                };
                Slots::Textures((0..pool.slots).map(slot).collect())
            }
        };
        Self {
            layer: pool.layer.index(),
            format: pool.format,
            shape: pool.shape,
            slots,
            bytes: pool.bytes(),
        }
    }

    /// The texture of a slot, and its layer.
    fn slot(&self, index: u16) -> Option<(&wgpu::Texture, &wgpu::TextureView, u32)> {
        match &self.slots {
            Slots::Textures(slots) => {
                let (texture, view) = slots.get(usize::from(index))?;
                Some((texture, view, 0))
            }
            Slots::Layers(texture, view) => {
                let layer = u32::from(index);
                (layer < texture.depth_or_array_layers()).then_some((texture, view, layer))
            }
        }
    }
}

struct BlockMaps {
    tiles: BlockTiles,
    bind_group: wgpu::BindGroup,
}

/// Pools of tile textures.
pub(crate) struct TileTextures {
    pools: Vec<PoolTextures>,
    blocks: Vec<BlockMaps>,
    placements: Box<Placements>,
    buffer: wgpu::Buffer,
    is_stale: bool,
    tiled: BlockSet,
    /// The cells of blocks with parts, two to a word.
    cells: Vec<u32>,
    has_parts: bool,
    /// Bytes of all slots.
    pub bytes: u64,
}

impl TileTextures {
    /// Creates the textures of all pools, so that none is created while the Earth is drawn.
    pub fn new(device: &wgpu::Device, maps: &Maps, pools: &[Pool], display_values: bool) -> Self {
        let has_parts = pools.iter().any(|pool| pool.has_parts);
        let pools: Vec<_> = pools
            .iter()
            .map(|pool| PoolTextures::new(device, pool, display_values, has_parts))
            .collect();
        let bytes = pools.iter().map(|pool| pool.bytes).sum();
        let whole = [None; MAP_LAYERS];
        let blocks = (0..BLOCK_COUNT)
            .map(|_| BlockMaps {
                tiles: whole,
                bind_group: bind(device, &pools, maps, whole),
            })
            .collect();
        let mut placements = Box::new([[Vec4::ZERO; MAP_LAYERS]; BLOCK_COUNT as usize]);
        for (block, of_block) in Block::all().zip(placements.iter_mut()) {
            *of_block = [whole_map(block); MAP_LAYERS];
        }
        Self {
            pools,
            blocks,
            placements,
            buffer: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("terrella tile placements"),
                size: tiles_bytes(has_parts) as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            is_stale: true,
            tiled: BlockSet::default(),
            cells: Vec::new(),
            has_parts,
            bytes,
        }
    }

    /// The uniform buffer with the placement of each block's texels.
    pub fn placements(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Whether blocks may be cut into parts.
    pub fn has_parts(&self) -> bool {
        self.has_parts
    }

    /// Whether there are tiles of this map.
    pub fn has(&self, layer: MapLayer) -> bool {
        let of_layer = |pool: &PoolTextures| pool.layer == layer.index() && pool.bytes > 0;
        self.pools.iter().any(of_layer)
    }

    /// The bind group of a block.
    pub fn bind_group(&self, block: Block) -> &wgpu::BindGroup {
        &self.blocks[block.index() as usize].bind_group
    }

    /// Uploads a part of a tile. An unknown slot is skipped: the caller has the same pools.
    pub fn write(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        let Some(pool) = self.pools.get(usize::from(part.slot.pool)) else {
            return;
        };
        let Some((texture, _, layer)) = pool.slot(part.slot.index) else {
            return;
        };
        let unit = pool.format.unit_side();
        // Mip levels of compressed textures are written in whole compression blocks, even beyond the edge.
        let side = pool.shape.mip_side(part.mip).next_multiple_of(unit);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: part.mip,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: part.first_row * unit,
                    z: layer,
                },
                aspect: wgpu::TextureAspect::All,
            },
            part.texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(part.row_bytes),
                rows_per_image: Some(part.rows),
            },
            wgpu::Extent3d {
                width: side,
                height: part.rows * unit,
                depth_or_array_layers: 1,
            },
        );
    }

    /// Draws a block with these tiles from now on. It does nothing if the tiles are unchanged, so a static view costs nothing.
    pub fn choose(&mut self, device: &wgpu::Device, maps: &Maps, block: Block, tiles: BlockTiles) {
        let index = block.index() as usize;
        // In a pool with parts, the whole pool is bound.
        let tiles = tiles.map(|tile| {
            let mut tile = tile?;
            let pool = self.pools.get(usize::from(tile.slot.pool))?;
            if let Slots::Layers(..) = pool.slots {
                tile.slot.index = 0;
            }
            Some(tile)
        });
        if self.blocks[index].tiles == tiles {
            return;
        }
        let mut placements = [whole_map(block); MAP_LAYERS];
        for tile in tiles.into_iter().flatten() {
            let Some(pool) = self.pools.get(usize::from(tile.slot.pool)) else {
                continue;
            };
            placements[pool.layer] = match pool.slots {
                Slots::Textures(_) => in_tile(pool.shape),
                // Kept until the block's cells are placed.
                Slots::Layers(..) => self.placements[index][pool.layer],
            };
        }
        let bind_group = bind(device, &self.pools, maps, tiles);
        self.blocks[index] = BlockMaps { tiles, bind_group };
        if self.placements[index] != placements {
            self.placements[index] = placements;
            self.is_stale = true;
        }
    }

    /// Places the parts of blocks: each block with a tile in a pool with parts has a table. If the buffer is too small for all cells, the last
    /// blocks are drawn with their whole-block tiles.
    pub fn place_parts(&mut self, tables: &PartTables) {
        if !self.has_parts {
            return;
        }
        let mut cells = CellWriter {
            words: &mut self.cells,
            len: 0,
            is_changed: false,
        };
        for (n, table) in tables.tables.iter().enumerate() {
            let block = usize::from(table.block);
            let layer = table.layer.index();
            let Some(tile) = self.blocks.get(block).and_then(|block| block.tiles[layer]) else {
                continue;
            };
            let Some(pool) = self.pools.get(usize::from(tile.slot.pool)) else {
                continue;
            };
            let own = [PartCell {
                index: table.own,
                depth: 0,
            }];
            let of_table = tables.cells(table);
            // One cell is reserved for each remaining table.
            let others = tables.tables.len() - n - 1;
            let (depth, drawn) = match cells.len + of_table.len() + others <= MAX_CELLS {
                true => (table.depth, of_table),
                false => (0, &own[..]),
            };
            let placement = in_parts(pool.shape, cells.len, depth);
            drawn.iter().for_each(|cell| cells.push(*cell));
            if self.placements[block][layer] != placement {
                self.placements[block][layer] = placement;
                self.is_stale = true;
            }
        }
        self.is_stale |= cells.is_changed;
    }

    /// Creates the bind groups of all blocks again, for another arrangement of maps.
    pub fn bind_again(&mut self, device: &wgpu::Device, maps: &Maps) {
        for block in &mut self.blocks {
            block.bind_group = bind(device, &self.pools, maps, block.tiles);
        }
    }

    /// Sets the blocks that have tiles, for shaders.
    pub fn set_tiled(&mut self, tiled: BlockSet) {
        self.is_stale |= tiled != self.tiled;
        self.tiled = tiled;
    }

    /// Writes the placements if they have changed. Returns the bytes written.
    pub fn flush(&mut self, queue: &wgpu::Queue) -> u64 {
        if !std::mem::take(&mut self.is_stale) {
            return 0;
        }
        queue.write_buffer(
            &self.buffer,
            0,
            bytemuck::cast_slice(self.placements.as_flattened()),
        );
        let tiled = self.tiled.0.to_le_bytes();
        queue.write_buffer(&self.buffer, PLACEMENTS_BYTES as u64, &tiled);
        let cells: &[u8] = bytemuck::cast_slice(&self.cells);
        if !cells.is_empty() {
            queue.write_buffer(&self.buffer, CELLS_START as u64, cells);
        }
        (CELLS_START + cells.len()) as u64
    }
}

fn bind(
    device: &wgpu::Device,
    pools: &[PoolTextures],
    maps: &Maps,
    tiles: BlockTiles,
) -> wgpu::BindGroup {
    let views = tiles.map(|tile| {
        let slot = tile?.slot;
        let pool = pools.get(usize::from(slot.pool))?;
        let (_, view, _) = pool.slot(slot.index)?;
        Some(view)
    });
    maps.bind(device, "terrella block", views)
}

/// Texture coordinates of a block's centre on the whole map, and their scale.
fn whole_map(block: Block) -> Vec4 {
    let uv = block.center_uv().as_vec2();
    Vec4::new(uv.x, uv.y, 1.0, 1.0)
}

/// Texture coordinates of a block's centre in a tile of this shape, and their scale.
fn in_tile(shape: TileShape) -> Vec4 {
    let (side, pixels) = (f64::from(shape.side()), f64::from(shape.pixels));
    let center = (f64::from(TILE_BORDER) + 0.5 * pixels) / side;
    let per_block = pixels / side;
    Vec4::new(
        center as f32,
        center as f32,
        (per_block * f64::from(COLUMNS)) as f32,
        (per_block * f64::from(ROWS)) as f32,
    )
}

/// Index of a block's first cell, how often the block is halved for a cell, and its tiles: see `shaders/earth/maps.wgsl`.
fn in_parts(shape: TileShape, first: usize, depth: u8) -> Vec4 {
    let side = f64::from(shape.side());
    Vec4::new(
        first as f32,
        f32::from(depth),
        (-f64::from(TILE_BORDER) / side) as f32,
        (f64::from(shape.pixels) / side) as f32,
    )
}

/// Writes cells, two to a word, and records whether any has changed.
struct CellWriter<'a> {
    words: &'a mut Vec<u32>,
    len: usize,
    is_changed: bool,
}

impl CellWriter<'_> {
    fn push(&mut self, cell: PartCell) {
        let code = u32::from(cell.index) | u32::from(cell.depth) << PART_INDEX_BITS;
        let (word, shift) = (self.len / 2, 16 * (self.len % 2));
        self.len += 1;
        if word == self.words.len() {
            self.words.push(0);
        }
        let changed = self.words[word] & !(0xffff << shift) | code << shift;
        self.is_changed |= changed != self.words[word];
        self.words[word] = changed;
    }
}

fn slot_texture(
    device: &wgpu::Device,
    pool: &Pool,
    display_values: bool,
    layers: u32,
) -> wgpu::Texture {
    let side = pool.shape.side();
    let label = format!("terrella {} tile", pool.layer.name());
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(&label),
        size: wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: layers,
        },
        mip_level_count: TILE_MIPS,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: texture_format(pool.format, display_values),
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn texture_format(format: TileFormat, display_values: bool) -> wgpu::TextureFormat {
    use wgpu::TextureFormat as F;
    match format {
        TileFormat::Rgba8Srgb if display_values => F::Rgba8Unorm,
        TileFormat::Rgba8Srgb => F::Rgba8UnormSrgb,
        TileFormat::R8Unorm => F::R8Unorm,
        TileFormat::Rg8Snorm => F::Rg8Snorm,
        TileFormat::Bc7Srgb if display_values => F::Bc7RgbaUnorm,
        TileFormat::Bc7Srgb => F::Bc7RgbaUnormSrgb,
        TileFormat::Bc4Unorm => F::Bc4RUnorm,
        TileFormat::Bc5Snorm => F::Bc5RgSnorm,
    }
}
