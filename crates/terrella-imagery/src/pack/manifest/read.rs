//! Reading a manifest, of which nothing is believed.

use super::fields::{ManifestText, Table, Value, nearest};
use super::heights::heights;
use super::levels::levels;
use super::{
    FORMAT_VERSION, LayerEntry, MAX_ATTRIBUTION_LINES, MAX_NAME_CHARS, MAX_TEXT_CHARS, Manifest,
};
use crate::pack::error::{MAX_MANIFEST_BYTES, MAX_MANIFEST_VALUES, PackError};
use crate::tile::{MAP_LAYERS, MapLayer, Storage, TILE_BORDER, TILE_MIPS};
use std::path::Path;
use terrella_ground::globe::{COLUMNS, ROWS};

/// The last of them since version 2.
const ROOT_KEYS: [&str; 10] = [
    "format",
    "name",
    "attribution",
    "columns",
    "rows",
    "border",
    "mips",
    "storages",
    "layer",
    "heights",
];
const LAYER_KEYS: [&str; 4] = ["name", "source", "exaggeration", "level"];

impl Manifest {
    /// Reads and checks the text of a manifest; `path` is the file that messages name.
    ///
    /// # Errors
    /// Text of more than [`MAX_MANIFEST_BYTES`] or [`MAX_MANIFEST_VALUES`] or not TOML, keys that are missing or unknown, values that no pack
    /// has: the first of them.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, PackError> {
        // Before the values are read: each takes many times the memory of its text.
        let ends = text.bytes().filter(|byte| matches!(byte, b',' | b'\n'));
        if text.len() as u64 > MAX_MANIFEST_BYTES || ends.count() > MAX_MANIFEST_VALUES {
            return Err(PackError::TooLarge { path: path.into() });
        }
        let source = ManifestText { path, text };
        let document = source.parse()?;
        let root = document.get_ref();
        // A later version may have any keys: it is named before they are looked at.
        let mut known = &ROOT_KEYS[..];
        if let Some((_, value)) = root.iter().find(|(name, _)| name.get_ref() == "format")
            && check_version(&Value::new(source, "format", value))? == 1
        {
            known = &ROOT_KEYS[..ROOT_KEYS.len() - 1];
        }
        let root = Table::root(source, root, known)?;
        let format = check_version(&root.need("format")?)?;
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
            layers: layers(&root.need("layer")?, &storages, format)?,
            storages,
            heights: root
                .get("heights")
                .map(|value| heights(&value))
                .transpose()?,
        })
    }
}

fn check_version(value: &Value<'_>) -> Result<u32, PackError> {
    let version = value.whole(0..=u64::from(u32::MAX))? as u32;
    if !(1..=FORMAT_VERSION).contains(&version) {
        return Err(value.reject(format!(
            "must be 1 to {FORMAT_VERSION}, the versions that this program reads; build the pack again with this program"
        )));
    }
    Ok(version)
}

/// The meaning of a name, each at most once in a list.
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
        return Err(value.reject(format!("must be one of \"{list}\"{hint}")));
    };
    if before.into_iter().any(|earlier| earlier == item) {
        return Err(value.reject("is given twice; each may stand once"));
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

fn layers(
    value: &Value<'_>,
    storages: &[Storage],
    format: u32,
) -> Result<Vec<LayerEntry>, PackError> {
    let mut layers: Vec<LayerEntry> = Vec::new();
    for item in value.list(1..=MAP_LAYERS)? {
        let table = item.table(&LAYER_KEYS)?;
        let name = table.need("name")?;
        let before = layers.iter().map(|entry| entry.layer);
        let layer = choose(&name, &MapLayer::ALL, MapLayer::name, before)?;
        let exaggeration = match table.get("exaggeration") {
            Some(value) if layer == MapLayer::Normals => Some(value.positive()?),
            Some(value) => {
                return Err(value.reject("is known for the layer \"normals\" only; take it out"));
            }
            None => None,
        };
        layers.push(LayerEntry {
            layer,
            source: table.need("source")?.text(MAX_TEXT_CHARS)?,
            exaggeration,
            levels: levels(&table.need("level")?, layer, storages, format)?,
        });
    }
    layers.sort_by_key(|entry| entry.layer.index());
    if layers.first().map(|entry| entry.layer) != Some(MapLayer::Day) {
        return Err(value.reject("no layer is named \"day\", which every pack has"));
    }
    Ok(layers)
}
