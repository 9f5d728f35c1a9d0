//! Tiles compressed in blocks of 4 × 4: BC7 for colour, BC4 for amounts, BC5 for slopes.

use block_compression::encode::compress_rgba8;
use block_compression::{BC7Settings, CompressionVariant};
use terrella_imagery::tile::{MapLayer, Storage, TILE_MIPS, Tile};

/// The tile compressed. `plain` is the uncompressed tile of this layer.
pub(super) fn compress(plain: &Tile, layer: MapLayer) -> Tile {
    let format = layer.tile_format(Storage::Bc);
    let mut texels = Vec::with_capacity(plain.shape.bytes(format));
    for mip in 0..TILE_MIPS {
        let side = plain.shape.mip_side(mip) as usize;
        let image = Padded::new(plain.mip(mip), side, plain.format.unit_bytes() as usize);
        match layer {
            MapLayer::Day => image.push_bc7(&mut texels),
            MapLayer::Normals => image.push_channels::<true>(&mut texels),
            MapLayer::Clouds | MapLayer::NightLights | MapLayer::Water => {
                image.push_channels::<false>(&mut texels);
            }
        }
    }
    Tile {
        format,
        shape: plain.shape,
        texels,
    }
}

/// A square image whose last texels are repeated up to whole blocks.
struct Padded<'a> {
    texels: std::borrow::Cow<'a, [u8]>,
    side: usize,
    channels: usize,
}

impl<'a> Padded<'a> {
    fn new(texels: &'a [u8], side: usize, channels: usize) -> Self {
        let padded = side.next_multiple_of(4);
        if padded == side {
            return Self {
                texels: texels.into(),
                side,
                channels,
            };
        }
        let mut whole = Vec::with_capacity(padded * padded * channels);
        for y in 0..padded {
            let row = &texels[y.min(side - 1) * side * channels..][..side * channels];
            whole.extend_from_slice(row);
            for _ in side..padded {
                whole.extend_from_slice(&row[(side - 1) * channels..]);
            }
        }
        Self {
            texels: whole.into(),
            side: padded,
            channels,
        }
    }

    fn push_bc7(&self, out: &mut Vec<u8>) {
        // One mode (6) with two endpoints of seven bits and a shared bit: within a code or two for nearly all blocks of
        // a map, at a twentieth of the time of the better settings.
        let variant = CompressionVariant::BC7(BC7Settings::opaque_ultra_fast());
        // At most 8192.
        let side = self.side as u32;
        let start = out.len();
        out.resize(start + variant.blocks_byte_size(side, side), 0);
        compress_rgba8(
            variant,
            &self.texels,
            &mut out[start..],
            side,
            side,
            side * 4,
        );
    }

    /// Blocks of 8 bytes, one a channel.
    fn push_channels<const SIGNED: bool>(&self, out: &mut Vec<u8>) {
        let units = self.side / 4;
        for block in 0..units * units {
            let (x, y) = (block % units * 4, block / units * 4);
            for channel in 0..self.channels {
                let values = std::array::from_fn(|n| {
                    let byte = self.texels
                        [((y + n / 4) * self.side + x + n % 4) * self.channels + channel];
                    if SIGNED {
                        // −128 and −127 both mean −1.
                        i32::from(byte as i8).max(-127)
                    } else {
                        i32::from(byte)
                    }
                });
                out.extend_from_slice(&bc4_block::<SIGNED>(values));
            }
        }
    }
}

/// Values are compared in fifths of sevenths, in which both palettes are whole numbers.
const SCALE: i32 = 35;

/// The better of the two palettes: eight steps from the largest to the smallest value, or six steps between the values strictly inside the range,
/// plus the range's two ends exactly.
fn bc4_block<const SIGNED: bool>(values: [i32; 16]) -> [u8; 8] {
    let (low, high) = if SIGNED { (-127, 127) } else { (0, 255) };
    let min_max = |values: &mut dyn Iterator<Item = i32>| {
        values.fold((high, low), |(min, max), value| {
            (value.min(min), value.max(max))
        })
    };
    let (min, max) = min_max(&mut values.into_iter());
    if min == max {
        return pack(min, min, [0; 16]);
    }
    let (eight, error) = nearest(&values, eight_steps(max, min));
    if error == 0 || (min != low && max != high) {
        return pack(max, min, eight);
    }
    let (inner_min, inner_max) =
        min_max(&mut values.into_iter().filter(|v| *v != low && *v != high));
    // Without inner values the ends are all there is; then any two in rising order serve.
    let (first, second) = if inner_min <= inner_max {
        (inner_min, inner_max)
    } else {
        (low, high)
    };
    let (six, six_error) = nearest(&values, six_steps(first, second, low, high));
    if six_error < error {
        pack(first, second, six)
    } else {
        pack(max, min, eight)
    }
}

/// First end, second end, then the steps between, as the decoder numbers them.
fn eight_steps(first: i32, second: i32) -> [i32; 8] {
    std::array::from_fn(|n| match n as i32 {
        0 => SCALE * first,
        1 => SCALE * second,
        n => 5 * ((8 - n) * first + (n - 1) * second),
    })
}

fn six_steps(first: i32, second: i32, low: i32, high: i32) -> [i32; 8] {
    std::array::from_fn(|n| match n as i32 {
        0 => SCALE * first,
        1 => SCALE * second,
        6 => SCALE * low,
        7 => SCALE * high,
        n => 7 * ((6 - n) * first + (n - 1) * second),
    })
}

/// The nearest palette entry of each value and the sum of squared errors.
fn nearest(values: &[i32; 16], palette: [i32; 8]) -> ([u8; 16], i64) {
    let mut sum = 0;
    let indices = values.map(|value| {
        let error_of = |entry: i32| (entry - SCALE * value).abs();
        let mut best = 0;
        for n in 1..8 {
            if error_of(palette[n]) < error_of(palette[best]) {
                best = n;
            }
        }
        sum += i64::from(error_of(palette[best])).pow(2);
        best as u8
    });
    (indices, sum)
}

fn pack(first: i32, second: i32, indices: [u8; 16]) -> [u8; 8] {
    let mut bits = u64::from(first as u8) | u64::from(second as u8) << 8;
    for (n, index) in indices.into_iter().enumerate() {
        bits |= u64::from(index) << (16 + 3 * n);
    }
    bits.to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_imagery::tile::TileShape;

    /// Bytes without pattern, the same at every run.
    fn noise(count: usize, seed: u64) -> Vec<u8> {
        let mut state = seed | 1;
        (0..count)
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 32) as u8
            })
            .collect()
    }

    fn decode<const SIGNED: bool>(block: &[u8; 8]) -> [i32; 16] {
        let mut bytes = [0u8; 16];
        bcdec_rs::bc4(block, &mut bytes, 4, SIGNED);
        bytes.map(|byte| {
            if SIGNED {
                i32::from(byte as i8)
            } else {
                i32::from(byte)
            }
        })
    }

    #[test]
    fn blocks_decode_to_within_half_a_step() {
        for seed in 1..400u64 {
            // With narrow and wide spread.
            let spread = 1 + (seed % 254) as i32;
            let bytes = noise(16, seed * 7919);
            let unsigned: [i32; 16] = std::array::from_fn(|n| i32::from(bytes[n]) % (spread + 1));
            let signed = unsigned.map(|value| value - spread / 2);
            // Half a step of the coarser palette, and the decoder's own rounding.
            let tolerance = spread as f64 / 10.0 + 1.0;
            for (value, got) in unsigned
                .into_iter()
                .zip(decode::<false>(&bc4_block::<false>(unsigned)))
            {
                assert!(
                    f64::from((value - got).abs()) <= tolerance,
                    "{seed}: {value} {got}"
                );
            }
            for (value, got) in signed
                .into_iter()
                .zip(decode::<true>(&bc4_block::<true>(signed)))
            {
                assert!(
                    f64::from((value - got).abs()) <= tolerance,
                    "{seed}: {value} {got}"
                );
            }
        }
    }

    #[test]
    fn one_value_two_values_and_the_ends_are_exact() {
        for value in [0, 1, 128, 255] {
            assert_eq!(
                decode::<false>(&bc4_block::<false>([value; 16])),
                [value; 16]
            );
        }
        for value in [-127, -1, 0, 127] {
            assert_eq!(decode::<true>(&bc4_block::<true>([value; 16])), [value; 16]);
        }
        let two = std::array::from_fn(|n| if n % 3 == 0 { 17 } else { 201 });
        assert_eq!(decode::<false>(&bc4_block::<false>(two)), two);
        // A coast in a mask: the ends exact, values in between approximate.
        let coast = [
            0, 0, 0, 255, 0, 0, 120, 255, 0, 130, 255, 255, 255, 255, 255, 255,
        ];
        let got = decode::<false>(&bc4_block::<false>(coast));
        for (value, got) in coast.into_iter().zip(got) {
            assert!((value - got).abs() <= 1, "{value} {got}");
        }
        let ends = std::array::from_fn(|n| if n < 9 { -127 } else { 127 });
        assert_eq!(decode::<true>(&bc4_block::<true>(ends)), ends);
    }

    #[test]
    fn all_mips_of_all_layers_decode_to_their_texels() {
        // 27 texels at the third mip level: not whole blocks.
        let shape = TileShape::new(200).expect("in range");
        for layer in MapLayer::ALL {
            let format = layer.tile_format(Storage::Plain);
            let channels = format.unit_bytes() as usize;
            let mut texels = Vec::new();
            for mip in 0..TILE_MIPS {
                let side = shape.mip_side(mip) as usize;
                // Smooth, a code or two from texel to texel.
                for n in 0..side * side {
                    let (x, y) = (n % side, n / side);
                    let level = ((x + y) * 45 / side) as u8 + 20;
                    texels
                        .extend((0..channels).map(|c| if c == 3 { 255 } else { level + c as u8 }));
                }
            }
            let plain = Tile {
                format,
                shape,
                texels,
            };
            let packed = compress(&plain, layer);
            assert_eq!(packed.texels.len(), shape.bytes(packed.format));
            for mip in 0..TILE_MIPS {
                let side = shape.mip_side(mip) as usize;
                let units = side.div_ceil(4);
                let unit_bytes = packed.format.unit_bytes() as usize;
                for (block, bytes) in packed.mip(mip).chunks_exact(unit_bytes).enumerate() {
                    let mut decoded = vec![0u8; 16 * channels];
                    match unit_bytes {
                        16 if channels == 4 => bcdec_rs::bc7(bytes, &mut decoded, 16),
                        16 => bcdec_rs::bc5(bytes, &mut decoded, 8, true),
                        _ => bcdec_rs::bc4(bytes, &mut decoded, 4, false),
                    }
                    for n in 0..16 {
                        let (x, y) = (block % units * 4 + n % 4, block / units * 4 + n / 4);
                        if x >= side || y >= side {
                            continue;
                        }
                        for c in 0..channels {
                            let value = plain.mip(mip)[(y * side + x) * channels + c];
                            let got = decoded[n * channels + c];
                            assert!(
                                value.abs_diff(got) <= 2,
                                "{layer:?} {mip} {x} {y} {c}: {value} {got}"
                            );
                        }
                    }
                }
            }
        }
    }
}
