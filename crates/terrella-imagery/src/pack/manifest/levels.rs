//! Reading the levels of a map, and which tiles they have.

use super::fields::{Table, Value};
use super::{LevelEntry, MAX_LEVELS_1, TileFile};
use crate::pack::container::MAX_OVERHEAD_BYTES;
use crate::pack::error::PackError;
use crate::tile::{
    MAX_COARSEST_PIXELS, MAX_LEVELS, MAX_PART_PIXELS, MAX_PARTS, MAX_PIXELS, MIN_PIXELS, MapLayer,
    Storage, TileShape,
};
use terrella_ground::globe::BLOCK_COUNT;

const FILES_KEYS: [&str; 2] = ["bytes", "checksums"];
const CUT_KEYS: [&str; 1] = ["block"];
const BLOCK_KEYS: [&str; 3] = ["block", "bytes", "checksums"];

const BLOCKS: usize = BLOCK_COUNT as usize;

/// Files in the order of [`LevelEntry::tiles`].
type Files = Vec<Option<TileFile>>;

/// The levels of a map, the finest first.
pub(super) fn levels(
    value: &Value<'_>,
    layer: MapLayer,
    storages: &[Storage],
    format: u32,
) -> Result<Vec<LevelEntry>, PackError> {
    let mut known = vec!["pixels", "side"];
    let most_levels = if format == 1 {
        MAX_LEVELS_1
    } else {
        known.push("parts");
        MAX_LEVELS
    };
    known.extend(storages.iter().map(|storage| storage.name()));
    let mut levels: Vec<LevelEntry> = Vec::new();
    for item in value.list(1..=most_levels)? {
        let table = item.table(&known)?;
        let shape = shape(&table, levels.last().map(|finer| finer.shape))?;
        let side = u64::from(shape.side());
        table.need("side")?.whole(side..=side)?;
        let tiles = tiles(&table, layer, shape, storages)?;
        levels.push(LevelEntry { shape, tiles });
    }
    let coarsest = levels.last().ok_or_else(|| value.reject("is empty"))?;
    if coarsest.shape.block_pixels() > MAX_COARSEST_PIXELS || coarsest.shape.parts > 1 {
        let pixels = coarsest.shape.block_pixels();
        return Err(value.reject(format!(
            "the coarsest level of \"{}\" has {pixels} pixels and may have at most {MAX_COARSEST_PIXELS}, and no parts",
            layer.name()
        )));
    }
    let missing = coarsest.tiles.iter().flatten().position(Option::is_none);
    if let Some(block) = missing {
        let block = block % BLOCKS;
        return Err(value.reject(format!(
            "the coarsest level of \"{}\" must have all {BLOCKS} blocks, and block {block} is missing",
            layer.name()
        )));
    }
    check_parts(value, layer, &levels)?;
    Ok(levels)
}

/// Size of a level's tiles, coarser than those of the level before it.
fn shape(level: &Table<'_>, finer: Option<TileShape>) -> Result<TileShape, PackError> {
    let parts = match level.get("parts") {
        Some(value) => {
            let parts = value.whole(2..=u64::from(MAX_PARTS))? as u32;
            if !parts.is_power_of_two() {
                return Err(
                    value.reject("must be 2, 4, 8 or 16; a level that is not cut has no such key")
                );
            }
            parts
        }
        None => 1,
    };
    let pixels = level.need("pixels")?;
    let most = if parts == 1 {
        MAX_PIXELS
    } else {
        parts * MAX_PART_PIXELS
    };
    let number = pixels.whole(u64::from(MIN_PIXELS * parts)..=u64::from(most))? as u32;
    let shape = number
        .is_multiple_of(parts)
        .then(|| TileShape::cut(number / parts, parts))
        .flatten()
        .ok_or_else(|| pixels.reject(format!("must be a multiple of {parts}, its parts")))?;
    let Some(finer) = finer else {
        return Ok(shape);
    };
    if finer.block_pixels() <= number {
        let finer = finer.block_pixels();
        return Err(pixels.reject(format!(
            "must be less than {finer}, that of the level before: levels stand with the finest first, each once"
        )));
    }
    if parts > 1 && finer.parts == 1 {
        return Err(pixels.reject(
            "is cut into parts, and the level before is not: levels that are cut stand first; build the pack again",
        ));
    }
    if finer.parts > 1 && finer.pixels != shape.pixels {
        let of_finer = finer.pixels;
        return Err(pixels.reject(format!(
            "has tiles of {} pixels and the level before has tiles of {of_finer}: all levels that are cut and the next one have \
             tiles of one size; build the pack again",
            shape.pixels
        )));
    }
    Ok(shape)
}

/// A block that has parts has a tile at the finest level that is not cut.
fn check_parts(value: &Value<'_>, layer: MapLayer, levels: &[LevelEntry]) -> Result<(), PackError> {
    let cut = levels.iter().take_while(|level| level.shape.parts > 1);
    let base = cut.clone().count();
    if base > 0 && base + 1 >= levels.len() {
        return Err(value.reject(format!(
            "\"{}\" has levels that are cut and no other but the coarsest, which is never streamed; build the pack again with one \
             between them",
            layer.name()
        )));
    }
    let Some(base) = levels.get(base) else {
        return Ok(());
    };
    for level in cut {
        // Storages have the same tiles.
        let present = level.places().zip(level.tiles.iter().flatten());
        for ((block, _), file) in present {
            let block = block.index();
            if file.is_some() && base.file(0, block as u8, 0).is_none() {
                return Err(value.reject(format!(
                    "block {block} of \"{}\" has parts of {} pixels and no tile of {}, the finest level that is not cut, which \
                     stands in for them; build the pack again",
                    layer.name(),
                    level.shape.block_pixels(),
                    base.shape.pixels
                )));
            }
        }
    }
    Ok(())
}

/// The files of a level's tiles in each storage.
fn tiles(
    level: &Table<'_>,
    layer: MapLayer,
    shape: TileShape,
    storages: &[Storage],
) -> Result<Vec<Files>, PackError> {
    let mut tiles: Vec<Files> = Vec::new();
    for storage in storages {
        let most = (shape.bytes(layer.tile_format(*storage)) + MAX_OVERHEAD_BYTES) as u64;
        let value = level.need(storage.name())?;
        let files = if shape.parts == 1 {
            let mut files = Vec::with_capacity(BLOCKS);
            read_files(&value.table(&FILES_KEYS)?, BLOCKS, most, &mut files)?;
            files
        } else {
            cut_files(&value.table(&CUT_KEYS)?, shape, most)?
        };
        let differs = |first: &Files| {
            let both = first.iter().zip(&files);
            both.map(|(one, other)| one.is_some() != other.is_some())
                .position(|differs| differs)
        };
        if let Some(at) = tiles.first().and_then(differs) {
            let parts = usize::from(shape.tiles_of_block());
            let part = match shape.parts {
                1 => String::new(),
                _ => format!(", part {},", at % parts),
            };
            return Err(value.reject(format!(
                "block {}{part} has a tile in one storage and none in the other; it must be in both or in neither",
                at / parts
            )));
        }
        tiles.push(files);
    }
    Ok(tiles)
}

/// The files of a level that is cut: of blocks that have any.
fn cut_files(table: &Table<'_>, shape: TileShape, most: u64) -> Result<Files, PackError> {
    let parts = usize::from(shape.tiles_of_block());
    // At most 32 768 of 32 bytes.
    let mut files = Vec::with_capacity(BLOCKS * parts);
    for item in table.need("block")?.list(1..=BLOCKS)? {
        let of_block = item.table(&BLOCK_KEYS)?;
        let block = of_block.need("block")?;
        let number = block.whole(0..=BLOCKS as u64 - 1)? as usize;
        if number * parts < files.len() {
            return Err(block.reject(
                "must be greater than that of the table before: blocks stand in order, each once",
            ));
        }
        files.resize(number * parts, None);
        read_files(&of_block, parts, most, &mut files)?;
        if files[number * parts..].iter().all(Option::is_none) {
            return Err(block.reject("has no part; a block without any has no table: take it out"));
        }
    }
    files.resize(BLOCKS * parts, None);
    Ok(files)
}

/// Appends so many files.
fn read_files(
    table: &Table<'_>,
    count: usize,
    most: u64,
    files: &mut Files,
) -> Result<(), PackError> {
    let bytes = table.need("bytes")?.list(count..=count)?;
    let checksums = table.need("checksums")?.list(count..=count)?;
    for (bytes, checksum) in bytes.zip(checksums) {
        files.push(tile_file(&bytes, &checksum, most)?);
    }
    Ok(())
}

/// One tile's file; 0 bytes and no checksum for a missing one.
fn tile_file(
    bytes: &Value<'_>,
    checksum: &Value<'_>,
    most: u64,
) -> Result<Option<TileFile>, PackError> {
    let digits = checksum.string()?;
    let count = bytes.whole(0..=most)?;
    if digits.is_empty() != (count == 0) {
        return Err(checksum.reject("must be empty just where the bytes are 0"));
    }
    if count == 0 {
        return Ok(None);
    }
    let checksum = read_hex(digits)
        .ok_or_else(|| checksum.reject("must be 32 digits of 0 to 9 and a to f"))?;
    Ok(Some(TileFile {
        bytes: count,
        checksum,
    }))
}

/// 16 bytes from 32 hexadecimal digits, small letters only: one checksum has one text.
pub(super) fn read_hex(digits: &str) -> Option<[u8; 16]> {
    let digit = |byte: u8| match byte {
        b'0'..=b'9' => Some(byte - b'0'),
        b'a'..=b'f' => Some(byte - b'a' + 10),
        _ => None,
    };
    let (pairs, rest) = digits.as_bytes().as_chunks::<2>();
    if pairs.len() != 16 || !rest.is_empty() {
        return None;
    }
    let mut bytes = [0; 16];
    for (byte, [high, low]) in bytes.iter_mut().zip(pairs) {
        *byte = digit(*high)? << 4 | digit(*low)?;
    }
    Some(bytes)
}
