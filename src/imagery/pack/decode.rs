//! Compressed texels made plain on the CPU, for adapters that do not read BC textures and for whole maps.

use crate::imagery::tile::{TILE_MIPS, Tile, TileFormat};

/// Side of a compressed block, texels.
const SIDE: usize = 4;

/// The tile with plain texels: [`TileFormat::decoded`]. One that has them already is returned as it is.
pub fn decode_tile(tile: Tile) -> Tile {
    let decode: fn(&[u8], &mut [u8], usize) = match tile.format {
        TileFormat::Rgba8Srgb | TileFormat::R8Unorm | TileFormat::Rg8Snorm => return tile,
        TileFormat::Bc7Srgb => bcdec_rs::bc7,
        TileFormat::Bc4Unorm => |block, texels, pitch| bcdec_rs::bc4(block, texels, pitch, false),
        TileFormat::Bc5Snorm => |block, texels, pitch| bcdec_rs::bc5(block, texels, pitch, true),
    };
    let format = tile.format.decoded();
    let mut texels = Vec::with_capacity(tile.shape.bytes(format));
    for mip in 0..TILE_MIPS {
        let side = tile.shape.mip_side(mip) as usize;
        decode_image(
            tile.format,
            format,
            tile.mip(mip),
            side,
            decode,
            &mut texels,
        );
    }
    Tile {
        format,
        shape: tile.shape,
        texels,
    }
}

/// Appends the texels of a square image; of its last blocks only what is inside.
fn decode_image(
    from: TileFormat,
    to: TileFormat,
    blocks: &[u8],
    side: usize,
    decode: fn(&[u8], &mut [u8], usize),
    texels: &mut Vec<u8>,
) {
    let texel_bytes = to.unit_bytes() as usize;
    let row_bytes = side * texel_bytes;
    let blocks_per_row = side.div_ceil(SIDE);
    let pitch = blocks_per_row * SIDE * texel_bytes;
    // Four rows of texels, as wide as the blocks are.
    let mut rows = vec![0; SIDE * pitch];
    let block_bytes = from.unit_bytes() as usize;
    for (row, blocks) in blocks
        .chunks_exact(blocks_per_row * block_bytes)
        .enumerate()
    {
        for (column, block) in blocks.chunks_exact(block_bytes).enumerate() {
            decode(block, &mut rows[column * SIDE * texel_bytes..], pitch);
        }
        for row in rows.chunks_exact(pitch).take(side - row * SIDE) {
            texels.extend_from_slice(&row[..row_bytes]);
        }
    }
}
