//! Compressed texels made plain on the CPU, for adapters that do not read BC textures and for whole maps.

use crate::tile::{TILE_MIPS, Tile, TileFormat};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tile::TileShape;

    /// The first 4 × 4 texels of a tile all of whose blocks are these.
    fn decoded(format: TileFormat, block: &[u8]) -> Vec<Vec<u8>> {
        let shape = TileShape::new(16).expect("in range");
        let texels = block.repeat(shape.bytes(format) / block.len());
        let tile = decode_tile(Tile {
            format,
            shape,
            texels,
        });
        assert_eq!(tile.texels.len(), shape.bytes(format.decoded()));
        let texel_bytes = tile.format.unit_bytes() as usize;
        let rows = tile.mip(0).chunks_exact(24 * texel_bytes).take(4);
        let texels = rows.flat_map(|row| row[..4 * texel_bytes].chunks_exact(texel_bytes));
        texels.map(<[u8]>::to_vec).collect()
    }

    /// A BC4 block whose texels have the indices 0…7, 0…7.
    fn bc4(ends: [u8; 2]) -> [u8; 8] {
        let indices = (0..16).fold(0_u64, |bits, texel| bits | (texel % 8) << (3 * texel));
        let mut block = (indices << 16).to_le_bytes();
        block[..2].copy_from_slice(&ends);
        block
    }

    #[test]
    fn single_channels_are_interpolated_as_the_format_says() {
        let texels = decoded(TileFormat::Bc4Unorm, &bc4([200, 60]));
        // Eight values: the ends, then sevenths from the first to the second.
        let expected = [200, 60, 180, 160, 140, 120, 100, 80];
        let expected: Vec<_> = expected
            .into_iter()
            .cycle()
            .take(16)
            .map(|v| vec![v])
            .collect();
        assert_eq!(texels, expected);
        let texels = decoded(TileFormat::Bc4Unorm, &bc4([50, 200]));
        // Six values, fifths between, then 0 and 255.
        let expected = [50, 200, 80, 110, 140, 170, 0, 255];
        assert_eq!(texels[..8].concat(), expected);
    }

    #[test]
    fn slopes_are_signed() {
        let block = [bc4([70, -70_i8 as u8]), bc4([-50_i8 as u8, 50])].concat();
        let texels = decoded(TileFormat::Bc5Snorm, &block);
        let east: Vec<_> = texels[..8].iter().map(|texel| texel[0] as i8).collect();
        let north: Vec<_> = texels[..8].iter().map(|texel| texel[1] as i8).collect();
        assert_eq!(east, [70, -70, 50, 30, 10, -10, -30, -50]);
        assert_eq!(north, [-50, 50, -30, -10, 10, 30, -127, 127]);
    }

    #[test]
    fn colours_are_interpolated_as_the_format_says() {
        // Mode 6: per channel two ends of seven bits, two lowest bits, indices of four bits, the first of three.
        let ends = [[10, 100], [127, 0], [64, 64], [127, 127]];
        let lowest = [0_u32, 1];
        let mut block = 1_u128 << 6;
        for (channel, ends) in ends.iter().enumerate() {
            block |= ends[0] << (7 + 14 * channel) | ends[1] << (14 + 14 * channel);
        }
        block |= u128::from(lowest[0]) << 63 | u128::from(lowest[1]) << 64;
        for texel in 1..16_u128 {
            block |= texel << (64 + 4 * texel);
        }
        let texels = decoded(TileFormat::Bc7Srgb, &block.to_le_bytes());
        let weights = [0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64];
        for (texel, weight) in texels.iter().zip(weights) {
            let expected = ends.map(|ends| {
                let [from, to] = [0, 1].map(|end| (ends[end] as u32) << 1 | lowest[end]);
                (((64 - weight) * from + weight * to + 32) >> 6) as u8
            });
            assert_eq!(texel[..], expected, "weight {weight}");
        }
    }

    #[test]
    fn plain_tiles_stay_as_they_are() {
        let shape = TileShape::new(17).expect("in range");
        let tile = Tile {
            format: TileFormat::Rg8Snorm,
            shape,
            texels: vec![3; shape.bytes(TileFormat::Rg8Snorm)],
        };
        assert_eq!(decode_tile(tile.clone()), tile);
    }
}
