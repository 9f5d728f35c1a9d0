//! Writing a tile.

use super::SCHEME_ZSTD;
use super::descriptor::{descriptor, vulkan_format};
use crate::pack::zstandard::compress;
use crate::tile::{TILE_MIPS, Tile};

/// Compression level of texels. Higher levels take several times as long for a few per cent; reading is equally fast for all of them.
const ZSTD_LEVEL: i32 = 3;

/// The key/value pairs, in the order of their keys. No version of the program, so that equal tiles are equal files.
const KEY_VALUES: [(&str, &str); 2] = [
    // Texels run right, then down.
    ("KTXorientation", "rd"),
    ("KTXwriter", "terrella"),
];

/// A tile as a KTX2 file. The same tile gives the same bytes.
///
/// # Panics
/// If the tile's texels are not as many as its shape has: [`TileShape::bytes`](crate::tile::TileShape::bytes).
pub fn write_ktx2(tile: &Tile) -> Vec<u8> {
    assert_eq!(
        tile.texels.len(),
        tile.shape.bytes(tile.format),
        "a tile has the texels of its shape"
    );
    let levels = (0..TILE_MIPS).map(|mip| compress(tile.mip(mip), ZSTD_LEVEL));
    let levels = levels.collect::<std::io::Result<Vec<_>>>();
    let levels = levels.expect("only lack of memory fails: parameters and buffers fit");
    let descriptor = descriptor(tile.format);
    let key_values = key_values();

    let index_offset = ktx2::Header::LENGTH;
    let descriptor_offset = index_offset + ktx2::LevelIndex::LENGTH * levels.len();
    // The descriptor consists of words of four bytes, so key/value data is correctly aligned.
    let key_values_offset = descriptor_offset + descriptor.len();
    let levels_offset = key_values_offset + key_values.len();
    let levels_bytes: usize = levels.iter().map(Vec::len).sum();

    let mut file = Vec::with_capacity(levels_offset + levels_bytes);
    file.extend_from_slice(&ktx2::MAGIC);
    let header_words = [
        vulkan_format(tile.format),
        // Size of a word for conversion of the byte order.
        1,
        tile.shape.side(),
        tile.shape.side(),
        // No depth, no array, one face.
        0,
        0,
        1,
        TILE_MIPS,
        SCHEME_ZSTD,
        descriptor_offset as u32,
        descriptor.len() as u32,
        key_values_offset as u32,
        key_values.len() as u32,
        // No supercompression global data: offset and length, 64 bits each.
        0,
        0,
        0,
        0,
    ];
    for word in header_words {
        file.extend_from_slice(&word.to_le_bytes());
    }
    // The smallest level comes first in the file; the index begins with the base. Compressed levels are not aligned.
    let mut end = levels_offset + levels_bytes;
    for (mip, level) in (0..).zip(&levels) {
        end -= level.len();
        let uncompressed = tile.format.image_bytes(tile.shape.mip_side(mip));
        for number in [end, level.len(), uncompressed] {
            file.extend_from_slice(&(number as u64).to_le_bytes());
        }
    }
    file.extend_from_slice(&descriptor);
    file.extend_from_slice(&key_values);
    for level in levels.iter().rev() {
        file.extend_from_slice(level);
    }
    file
}

fn key_values() -> Vec<u8> {
    let mut bytes = Vec::new();
    for (key, value) in KEY_VALUES {
        let entry = format!("{key}\0{value}\0");
        bytes.extend_from_slice(&(entry.len() as u32).to_le_bytes());
        bytes.extend_from_slice(entry.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}
