//! Parser of a manifest's entry of elevation data.

use super::fields::Value;
use super::levels::read_hex;
use super::{MAX_ATTRIBUTION_LINES, MAX_TEXT_CHARS, TileFile};
use crate::pack::error::PackError;
use crate::pack::heights::{
    HeightKind, HeightsEntry, MAX_HEIGHT_BORDER, MAX_HEIGHT_LEVELS, MAX_HEIGHT_SIDE,
    MAX_HEIGHT_TILES, index_bytes,
};

const KEYS: [&str; 11] = [
    "sources",
    "levels",
    "columns",
    "side",
    "border",
    "samples",
    "offset_m",
    "scale_m",
    "tiles",
    "index_bytes",
    "index_checksum",
];

/// Reads the table `heights`.
pub(super) fn heights(value: &Value<'_>) -> Result<HeightsEntry, PackError> {
    let table = value.table(&KEYS)?;
    let whole = |key: &str, least: u32, most: u32| {
        let number = table.need(key)?.whole(u64::from(least)..=u64::from(most))?;
        Ok::<_, PackError>(number as u32)
    };
    let sources = table.need("sources")?;
    let sources = sources
        .list(1..=MAX_ATTRIBUTION_LINES)?
        .map(|line| line.text(MAX_TEXT_CHARS))
        .collect::<Result<_, _>>()?;
    let samples = table.need("samples")?;
    let kind = match samples.string()? {
        "i16" => HeightKind::I16 {
            offset_m: table.need("offset_m")?.finite()?,
            scale_m: table.need("scale_m")?.positive()?,
        },
        "f32" => {
            for key in ["offset_m", "scale_m"] {
                if let Some(value) = table.get(key) {
                    return Err(value.reject("is for samples \"i16\" only; take it out"));
                }
            }
            HeightKind::F32
        }
        _ => return Err(samples.reject("must be \"i16\" or \"f32\"")),
    };
    let tiles = whole("tiles", 1, MAX_HEIGHT_TILES)?;
    let needed = index_bytes(tiles);
    let checksum = table.need("index_checksum")?;
    let entry = HeightsEntry {
        sources,
        levels: whole("levels", 1, u32::from(MAX_HEIGHT_LEVELS))? as u8,
        columns: whole("columns", 16, 64)?,
        side: whole("side", 16, MAX_HEIGHT_SIDE)?,
        border: whole("border", 1, MAX_HEIGHT_BORDER)?,
        kind,
        tiles,
        index: TileFile {
            bytes: table.need("index_bytes")?.whole(needed..=needed)?,
            checksum: read_hex(checksum.string()?)
                .ok_or_else(|| checksum.reject("must be 32 digits of 0 to 9 and a to f"))?,
        },
    };
    if !entry.is_possible() {
        return Err(table.need("levels")?.reject(
            "with these columns (16, 32 or 64) and this side (even) there is no such pack: at most 2^30 samples go round the Earth; \
             build the pack again",
        ));
    }
    Ok(entry)
}
