//! Tiles on the GPU: fixed pools of textures, and for each block the bind group of the tiles that it is drawn with.

use super::BlockTiles;
use super::maps::Maps;
use crate::globe::{BLOCK_COUNT, Block, BlockSet, COLUMNS, ROWS};
use crate::imagery::residency::{Pool, Upload};
use crate::imagery::tile::{MAP_LAYERS, MapLayer, TILE_BORDER, TILE_MIPS, TileFormat, TileShape};
use glam::Vec4;

type Placements = [[Vec4; MAP_LAYERS]; BLOCK_COUNT as usize];
const PLACEMENTS_BYTES: usize = size_of::<Placements>();

/// Bytes of `Tiles` of `shaders/earth/maps/tile_placements.wgsl`: placements, and the set of blocks that have tiles.
pub(super) const TILES_BYTES: usize = PLACEMENTS_BYTES + size_of::<BlockSet>();

struct PoolTextures {
    layer: usize,
    format: TileFormat,
    shape: TileShape,
    slots: Vec<(wgpu::Texture, wgpu::TextureView)>,
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
    /// Bytes of all slots.
    pub bytes: u64,
}

impl TileTextures {
    /// Makes the textures of all pools, so that none has to be made while the Earth is drawn.
    pub fn new(device: &wgpu::Device, maps: &Maps, pools: &[Pool], display_values: bool) -> Self {
        let pools: Vec<_> = pools
            .iter()
            .map(|pool| PoolTextures {
                layer: pool.layer.index(),
                format: pool.format,
                shape: pool.shape,
                slots: (0..pool.slots)
                    .map(|_| slot_texture(device, pool, display_values))
                    .collect(),
            })
            .collect();
        let bytes = pools
            .iter()
            .map(|pool| pool.slots.len() as u64 * pool.shape.bytes(pool.format) as u64)
            .sum();
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
            buffer: super::uniform_buffer::<[u8; TILES_BYTES]>(device, "terrella tile placements"),
            is_stale: true,
            tiled: BlockSet::default(),
            bytes,
        }
    }

    /// The uniform that says where each block's texels lie.
    pub fn placements(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Whether there are tiles of this map.
    pub fn has(&self, layer: MapLayer) -> bool {
        let of_layer = |pool: &PoolTextures| pool.layer == layer.index() && !pool.slots.is_empty();
        self.pools.iter().any(of_layer)
    }

    /// What a block is bound with.
    pub fn bind_group(&self, block: Block) -> &wgpu::BindGroup {
        &self.blocks[block.index() as usize].bind_group
    }

    /// Writes a part of a tile. A slot that is not there is passed over: the caller has the pools from here.
    pub fn write(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        let Some(pool) = self.pools.get(usize::from(part.slot.pool)) else {
            return;
        };
        let Some((texture, _)) = pool.slots.get(usize::from(part.slot.index)) else {
            return;
        };
        let unit = pool.format.unit_side();
        // Mip levels of compressed textures are written in whole blocks, also where they reach over the edge.
        let side = pool.shape.mip_side(part.mip).next_multiple_of(unit);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: part.mip,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: part.first_row * unit,
                    z: 0,
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

    /// Has a block drawn with these tiles. Does nothing where it is already, so a view at rest costs nothing.
    pub fn choose(&mut self, device: &wgpu::Device, maps: &Maps, block: Block, tiles: BlockTiles) {
        let index = block.index() as usize;
        if self.blocks[index].tiles == tiles {
            return;
        }
        let mut placements = [whole_map(block); MAP_LAYERS];
        for tile in tiles.into_iter().flatten() {
            if let Some(pool) = self.pools.get(usize::from(tile.slot.pool)) {
                placements[pool.layer] = in_tile(pool.shape);
            }
        }
        let bind_group = bind(device, &self.pools, maps, tiles);
        self.blocks[index] = BlockMaps { tiles, bind_group };
        if self.placements[index] != placements {
            self.placements[index] = placements;
            self.is_stale = true;
        }
    }

    /// Makes the bind groups of all blocks anew, the maps having been arranged otherwise.
    pub fn bind_again(&mut self, device: &wgpu::Device, maps: &Maps) {
        for block in &mut self.blocks {
            block.bind_group = bind(device, &self.pools, maps, block.tiles);
        }
    }

    /// Blocks that are drawn with tiles: those of [`Self::find_tiled`].
    pub fn tiled(&self) -> BlockSet {
        self.tiled
    }

    /// Finds out which of the blocks in sight have tiles, of whatever map.
    pub fn find_tiled(&mut self, in_sight: impl Iterator<Item = Block>) {
        let mut tiled = BlockSet::default();
        for block in in_sight {
            let tiles = &self.blocks[block.index() as usize].tiles;
            if tiles.iter().any(Option::is_some) {
                tiled.insert(block.index() as u8);
            }
        }
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
        TILES_BYTES as u64
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
        let (_, view) = pool.slots.get(usize::from(slot.index))?;
        Some(view)
    });
    maps.bind(device, "terrella block", views)
}

/// Texture coordinates of a block's centre on the whole map, and their change per whole map.
fn whole_map(block: Block) -> Vec4 {
    let uv = block.center_uv().as_vec2();
    Vec4::new(uv.x, uv.y, 1.0, 1.0)
}

/// The same in a tile of this shape.
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

fn slot_texture(
    device: &wgpu::Device,
    pool: &Pool,
    display_values: bool,
) -> (wgpu::Texture, wgpu::TextureView) {
    let side = pool.shape.side();
    let label = format!("terrella {} tile", pool.layer.name());
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(&label),
        size: wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: 1,
        },
        mip_level_count: TILE_MIPS,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: texture_format(pool.format, display_values),
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let view = super::view(&texture);
    (texture, view)
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
