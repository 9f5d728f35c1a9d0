//! Texel format of a KTX2 file: the Vulkan format number and the data format descriptor.

use crate::tile::TileFormat;

/// Colour models of the Khronos Data Format Specification 1.3.
const MODEL_RGBSDA: u8 = 1;
const MODEL_BC4: u8 = 131;
const MODEL_BC5: u8 = 132;
const MODEL_BC7: u8 = 134;

/// Primaries of ITU-R BT.709, as sRGB has them.
const PRIMARIES_BT709: u8 = 1;

const TRANSFER_LINEAR: u8 = 1;
const TRANSFER_SRGB: u8 = 2;

/// Channels: red, or all there is in a block of BC4 and BC7; green; blue; alpha.
const RED: u8 = 0;
const GREEN: u8 = 1;
const BLUE: u8 = 2;
const ALPHA: u8 = 15;
/// Qualifiers in a channel's upper four bits: not in the transfer function's encoding; two's complement.
const LINEAR: u8 = 0x10;
const SIGNED: u8 = 0x40;

/// Position in the descriptor of the bytes per unit of each of eight planes.
pub(super) const PLANE_SIZES: std::ops::Range<usize> = 20..28;

/// Bits of one channel of a texel or a block, and its smallest and largest values.
struct Sample {
    bit_offset: u16,
    bits: u8,
    channel: u8,
    lower: i32,
    upper: u32,
}

/// The format's number in Vulkan.
pub(super) fn vulkan_format(format: TileFormat) -> u32 {
    match format {
        TileFormat::R8Unorm => 9,
        TileFormat::Rg8Snorm => 17,
        TileFormat::Rgba8Srgb => 43,
        TileFormat::Bc4Unorm => 139,
        TileFormat::Bc5Snorm => 142,
        TileFormat::Bc7Srgb => 146,
    }
}

/// The data format descriptor with its leading total size: one basic block, version 1.3.
pub(super) fn descriptor(format: TileFormat) -> Vec<u8> {
    let (model, transfer) = match format {
        TileFormat::Rgba8Srgb => (MODEL_RGBSDA, TRANSFER_SRGB),
        TileFormat::R8Unorm | TileFormat::Rg8Snorm => (MODEL_RGBSDA, TRANSFER_LINEAR),
        TileFormat::Bc7Srgb => (MODEL_BC7, TRANSFER_SRGB),
        TileFormat::Bc4Unorm => (MODEL_BC4, TRANSFER_LINEAR),
        TileFormat::Bc5Snorm => (MODEL_BC5, TRANSFER_LINEAR),
    };
    let samples = samples(format);
    let block_bytes = 24 + 16 * samples.len() as u32;
    // One less than the texels of a unit's sides.
    let side = (format.unit_side() - 1) as u8;

    let mut bytes = Vec::new();
    let mut word = |value: u32| bytes.extend_from_slice(&value.to_le_bytes());
    word(4 + block_bytes);
    // Khronos's own kind of block, the basic one.
    word(0);
    word(2 | block_bytes << 16);
    // Straight alpha.
    word(u32::from_le_bytes([model, PRIMARIES_BT709, transfer, 0]));
    word(u32::from_le_bytes([side, side, 0, 0]));
    // Bytes of a unit in the first plane; there is no other.
    word(format.unit_bytes());
    word(0);
    for sample in samples {
        word(
            u32::from(sample.bit_offset)
                | u32::from(sample.bits - 1) << 16
                | u32::from(sample.channel) << 24,
        );
        // At the unit's corner.
        word(0);
        word(sample.lower.cast_unsigned());
        word(sample.upper);
    }
    bytes
}

fn samples(format: TileFormat) -> Vec<Sample> {
    let byte = |index: u16, channel| Sample {
        bit_offset: 8 * index,
        bits: 8,
        channel,
        lower: 0,
        upper: 255,
    };
    let signed = |bit_offset, bits, channel, lower, upper| Sample {
        bit_offset,
        bits,
        channel: channel | SIGNED,
        lower,
        upper,
    };
    let block = |bits| Sample {
        bit_offset: 0,
        bits,
        channel: RED,
        lower: 0,
        upper: u32::MAX,
    };
    match format {
        TileFormat::Rgba8Srgb => vec![
            byte(0, RED),
            byte(1, GREEN),
            byte(2, BLUE),
            byte(3, ALPHA | LINEAR),
        ],
        TileFormat::R8Unorm => vec![byte(0, RED)],
        TileFormat::Rg8Snorm => vec![signed(0, 8, RED, -127, 127), signed(8, 8, GREEN, -127, 127)],
        TileFormat::Bc7Srgb => vec![block(128)],
        TileFormat::Bc4Unorm => vec![block(64)],
        TileFormat::Bc5Snorm => vec![
            signed(0, 64, RED, i32::MIN, i32::MAX as u32),
            signed(64, 64, GREEN, i32::MIN, i32::MAX as u32),
        ],
    }
}
