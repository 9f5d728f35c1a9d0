//! Reading a manifest, of which nothing is believed.

use super::fields::{Source, Table, Value, nearest};
use super::{
    FORMAT_VERSION, LayerEntry, LevelEntry, MAX_ATTRIBUTION_LINES, MAX_NAME_CHARS, MAX_TEXT_CHARS,
    Manifest, TileFile,
};
use crate::globe::{BLOCK_COUNT, COLUMNS, ROWS};
use crate::imagery::pack::container::MAX_OVERHEAD_BYTES;
use crate::imagery::pack::error::{MAX_MANIFEST_BYTES, PackError};
use crate::imagery::tile::{
    MAP_LAYERS, MAX_COARSEST_PIXELS, MAX_LEVELS, MAX_PIXELS, MIN_PIXELS, MapLayer, Storage,
    TILE_BORDER, TILE_MIPS, TileShape,
};
use std::path::Path;

const ROOT_KEYS: [&str; 9] = [
    "format",
    "name",
    "attribution",
    "columns",
    "rows",
    "border",
    "mips",
    "storages",
    "layer",
];
const LAYER_KEYS: [&str; 4] = ["name", "source", "exaggeration", "level"];
const STORAGE_KEYS: [&str; 2] = ["bytes", "checksums"];

const BLOCKS: usize = BLOCK_COUNT as usize;

impl Manifest {
    /// Reads and checks the text of a manifest; `path` is the file that messages name.
    ///
    /// # Errors
    /// Text of more than [`MAX_MANIFEST_BYTES`] or not TOML, keys that are missing or unknown, values that no pack
    /// has: the first of them.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, PackError> {
        if text.len() as u64 > MAX_MANIFEST_BYTES {
            return Err(PackError::TooLarge { path: path.into() });
        }
        let source = Source { path, text };
        let document = source.parse()?;
        let root = document.get_ref();
        // A later version may have any keys: it is named before they are looked at.
        if let Some((_, value)) = root.iter().find(|(name, _)| name.get_ref() == "format") {
            check_version(&Value::new(source, "format", value))?;
        }
        let root = Table::root(source, root, &ROOT_KEYS)?;
        check_version(&root.need("format")?)?;
        for (key, value) in [
            ("columns", COLUMNS),
            ("rows", ROWS),
            ("border", TILE_BORDER),
            ("mips", TILE_MIPS),
        ] {
            root.need(key)?.whole(u64::from(value)..=u64::from(value))?;
        }
        let attribution = root.need("attribution")?;
        let attribution = attribution
            .list(0..=MAX_ATTRIBUTION_LINES)?
            .map(|line| line.text(MAX_TEXT_CHARS))
            .collect::<Result<_, _>>()?;
        let storages = storages(&root.need("storages")?)?;
        Ok(Self {
            name: root.need("name")?.text(MAX_NAME_CHARS)?,
            attribution,
            layers: layers(&root.need("layer")?, &storages)?,
            storages,
        })
    }
}

fn check_version(value: &Value<'_>) -> Result<(), PackError> {
    let version = value.whole(0..=u64::from(u32::MAX))?;
    if version != u64::from(FORMAT_VERSION) {
        return Err(value.refuse(format!(
            "must be {FORMAT_VERSION}, the version that this program reads; build the pack again with this program"
        )));
    }
    Ok(())
}

/// What a name stands for, each at most once in a list.
fn choose<T: Copy + PartialEq>(
    value: &Value<'_>,
    all: &[T],
    name: impl Fn(T) -> &'static str,
    before: impl IntoIterator<Item = T>,
) -> Result<T, PackError> {
    let word = value.string()?;
    let names: Vec<_> = all.iter().map(|item| name(*item)).collect();
    let Some(item) = all.iter().copied().find(|item| name(*item) == word) else {
        let hint = match nearest(word, &names) {
            Some(near) => format!("; did you mean \"{near}\"?"),
            None => String::new(),
        };
        let list = names.join("\", \"");
        return Err(value.refuse(format!("must be one of \"{list}\"{hint}")));
    };
    if before.into_iter().any(|earlier| earlier == item) {
        return Err(value.refuse("is given twice; each may stand once"));
    }
    Ok(item)
}

fn storages(value: &Value<'_>) -> Result<Vec<Storage>, PackError> {
    let mut storages = Vec::new();
    for item in value.list(1..=Storage::ALL.len())? {
        let storage = choose(
            &item,
            &Storage::ALL,
            Storage::name,
            storages.iter().copied(),
        )?;
        storages.push(storage);
    }
    Ok(storages)
}

fn layers(value: &Value<'_>, storages: &[Storage]) -> Result<Vec<LayerEntry>, PackError> {
    let mut layers: Vec<LayerEntry> = Vec::new();
    for item in value.list(1..=MAP_LAYERS)? {
        let table = item.table(&LAYER_KEYS)?;
        let name = table.need("name")?;
        let before = layers.iter().map(|entry| entry.layer);
        let layer = choose(&name, &MapLayer::ALL, MapLayer::name, before)?;
        let exaggeration = match table.get("exaggeration") {
            Some(value) if layer == MapLayer::Normals => Some(value.positive()?),
            Some(value) => {
                return Err(value.refuse("is known for the layer \"normals\" only; take it out"));
            }
            None => None,
        };
        layers.push(LayerEntry {
            layer,
            source: table.need("source")?.text(MAX_TEXT_CHARS)?,
            exaggeration,
            levels: levels(&table.need("level")?, layer, storages)?,
        });
    }
    layers.sort_by_key(|entry| entry.layer.index());
    if layers.first().map(|entry| entry.layer) != Some(MapLayer::Day) {
        return Err(value.refuse("no layer is named \"day\", which every pack has"));
    }
    Ok(layers)
}

fn levels(
    value: &Value<'_>,
    layer: MapLayer,
    storages: &[Storage],
) -> Result<Vec<LevelEntry>, PackError> {
    let mut known = vec!["pixels", "side"];
    known.extend(storages.iter().map(|storage| storage.name()));
    let mut levels: Vec<LevelEntry> = Vec::new();
    for item in value.list(1..=MAX_LEVELS)? {
        let table = item.table(&known)?;
        let pixels = table.need("pixels")?;
        let number = pixels.whole(MIN_PIXELS.into()..=MAX_PIXELS.into())? as u32;
        let shape = TileShape::new(number).ok_or_else(|| pixels.refuse("is out of range"))?;
        if let Some(finer) = levels.last()
            && finer.shape.pixels <= number
        {
            let finer = finer.shape.pixels;
            return Err(pixels.refuse(format!(
                "must be less than {finer}, that of the level before: levels stand with the finest first, each once"
            )));
        }
        let side = u64::from(shape.side());
        table.need("side")?.whole(side..=side)?;
        let tiles = tiles(&table, layer, shape, storages)?;
        levels.push(LevelEntry { shape, tiles });
    }
    let coarsest = levels.last().ok_or_else(|| value.refuse("is empty"))?;
    if coarsest.shape.pixels > MAX_COARSEST_PIXELS {
        let pixels = coarsest.shape.pixels;
        return Err(value.refuse(format!(
            "the coarsest level of \"{}\" has {pixels} pixels and may have at most {MAX_COARSEST_PIXELS}",
            layer.name()
        )));
    }
    let missing = coarsest.tiles.iter().flatten().position(Option::is_none);
    if let Some(block) = missing {
        let block = block % BLOCKS;
        return Err(value.refuse(format!(
            "the coarsest level of \"{}\" must have all {BLOCKS} blocks, and block {block} is missing",
            layer.name()
        )));
    }
    Ok(levels)
}

/// The files of a level's tiles in each storage.
fn tiles(
    level: &Table<'_>,
    layer: MapLayer,
    shape: TileShape,
    storages: &[Storage],
) -> Result<Vec<Vec<Option<TileFile>>>, PackError> {
    let mut tiles: Vec<Vec<Option<TileFile>>> = Vec::new();
    for storage in storages {
        let most = shape.bytes(layer.tile_format(*storage)) + MAX_OVERHEAD_BYTES;
        let value = level.need(storage.name())?;
        let table = value.table(&STORAGE_KEYS)?;
        let bytes = table.need("bytes")?.list(BLOCKS..=BLOCKS)?;
        let checksums = table.need("checksums")?.list(BLOCKS..=BLOCKS)?;
        let mut files = Vec::with_capacity(BLOCKS);
        for (block, (bytes, checksum)) in bytes.zip(checksums).enumerate() {
            let file = tile_file(&bytes, &checksum, most as u64)?;
            if let Some(first) = tiles.first()
                && first[block].is_some() != file.is_some()
            {
                return Err(bytes.refuse(format!(
                    "block {block} has a tile in one storage and none in the other; it must be in both or in neither"
                )));
            }
            files.push(file);
        }
        tiles.push(files);
    }
    Ok(tiles)
}

/// One block's file; 0 bytes and no checksum for none.
fn tile_file(
    bytes: &Value<'_>,
    checksum: &Value<'_>,
    most: u64,
) -> Result<Option<TileFile>, PackError> {
    let digits = checksum.string()?;
    let count = bytes.whole(0..=most)?;
    if digits.is_empty() != (count == 0) {
        return Err(checksum.refuse("must be empty just where the bytes are 0"));
    }
    if count == 0 {
        return Ok(None);
    }
    let checksum = read_hex(digits)
        .ok_or_else(|| checksum.refuse("must be 32 digits of 0 to 9 and a to f"))?;
    Ok(Some(TileFile {
        bytes: count,
        checksum,
    }))
}

/// 16 bytes from 32 hexadecimal digits, small letters only: one checksum has one text.
fn read_hex(digits: &str) -> Option<[u8; 16]> {
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
