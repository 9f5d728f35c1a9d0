//! An imagery pack whose files a page fetches: what `worker-pack.js` calls. A file of its own, so that pages without a pack do not load it.
//!
//! Tiles are named by four numbers: map, level, block and part, as in [`TileKey`].

// `wasm-bindgen` exports what is here; on other targets nothing uses it.
#![cfg_attr(not(target_family = "wasm"), allow(dead_code))]

#[path = "../../src/posted.rs"]
mod posted;
#[allow(dead_code)]
#[path = "../../src/tile_layout.rs"]
mod tile_layout;

use posted::{BAND_BYTES, END, post};
use std::path::Path;
use std::sync::Arc;
use terrella_imagery::MapBands;
use terrella_imagery::pack::{CoarsestMap, Pack, PackTiles};
use terrella_imagery::slopes::SLOPE_EXAGGERATION;
use terrella_imagery::tile::{MapLayer, Storage, TileError, TileKey, TileSource};
use tile_layout::layout_words;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

/// An open pack.
#[wasm_bindgen]
pub struct PackReader {
    tiles: PackTiles,
    /// The map that is being assembled.
    whole: Option<(MapLayer, CoarsestMap)>,
}

#[wasm_bindgen]
impl PackReader {
    /// The pack of a manifest's bytes, at this address. Tiles are compressed (BC) where pack and device have that, else plain.
    ///
    /// # Errors
    /// A manifest that is none, in the words of the native program.
    pub fn open(manifest: Vec<u8>, address: &str, has_bc: bool) -> Result<PackReader, JsValue> {
        let pack = Pack::from_manifest(Path::new(address), manifest).map_err(thrown)?;
        let storages = &pack.manifest().storages;
        let has = |storage| storages.contains(&storage);
        let (storage, decode) = match has(Storage::Bc) && (has_bc || !has(Storage::Plain)) {
            true => (Storage::Bc, !has_bc),
            false => (Storage::Plain, false),
        };
        let layers: Vec<_> = pack
            .manifest()
            .layers
            .iter()
            .map(|entry| entry.layer)
            .collect();
        let tiles = PackTiles::new(Arc::new(pack), storage, decode, &layers).map_err(thrown)?;
        Ok(Self { tiles, whole: None })
    }

    /// Its name.
    pub fn name(&self) -> String {
        self.tiles.pack().manifest().name.clone()
    }

    /// Whose data it is.
    pub fn attribution(&self) -> Vec<String> {
        self.tiles.pack().manifest().attribution.clone()
    }

    /// The layout of its tiles, for `Globe.openPack`.
    pub fn layout(&self) -> Vec<u32> {
        layout_words(self.tiles.layers())
    }

    /// Factor of the slopes of a default Earth that gives this pack's.
    #[wasm_bindgen(js_name = slopeFactor)]
    pub fn slope_factor(&self) -> f64 {
        let entry = self.tiles.pack().manifest().layer(MapLayer::Normals);
        let stored = entry.map_or(SLOPE_EXAGGERATION, |entry| {
            entry.exaggeration.unwrap_or(1.0)
        });
        SLOPE_EXAGGERATION / stored
    }

    /// Begins to assemble a map of the coarsest level. Answers the levels that may give a block's texels, the first preferred; none beyond the last
    /// map.
    #[wasm_bindgen(js_name = beginMap)]
    pub fn begin_map(&mut self, place: usize) -> Vec<u32> {
        let Some(layout) = self.tiles.layers().get(place) else {
            return Vec::new();
        };
        self.whole = Some((layout.layer, CoarsestMap::new(layout)));
        // Levels that are cut into parts are not used.
        let levels = layout.cut_levels() as u32..layout.levels.len() as u32;
        levels.rev().collect()
    }

    /// Map of the one that is being assembled.
    pub fn map(&self) -> Option<usize> {
        self.whole.as_ref().map(|(layer, _)| layer.index())
    }

    /// Adds a block of the map from the bytes of a tile.
    ///
    /// # Errors
    /// Bytes that do not match the manifest.
    #[wasm_bindgen(js_name = addBlock)]
    pub fn add_block(&mut self, level: u8, block: u8, bytes: &[u8]) -> Result<(), JsValue> {
        if let Some((layer, map)) = &mut self.whole {
            let tile = self
                .tiles
                .tile_of(TileKey::whole(*layer, level, block), bytes);
            map.add(block, tile.map_err(thrown)?);
        }
        Ok(())
    }

    /// Ends the map. `take` is called with each band, as by `decodeMaps`.
    ///
    /// # Errors
    /// What `take` throws.
    #[wasm_bindgen(js_name = endMap)]
    pub fn end_map(&mut self, take: &js_sys::Function) -> Result<(), JsValue> {
        let Some((layer, map)) = self.whole.take() else {
            return Ok(());
        };
        let map = map.finish().map_err(thrown)?;
        let (number, size) = (layer.index() as u32, (map.width, map.height));
        let mut bands = MapBands::new(&map, BAND_BYTES);
        let mut posted = Ok(());
        for (level, texels) in map.levels.iter().enumerate() {
            bands.rows(level, 0, texels, |level, first, band| {
                if posted.is_ok() {
                    posted = post(take, number, size, level as i32, first, band);
                }
            });
        }
        posted?;
        post(take, number, size, END, 0, &[])
    }

    /// Address of a tile's file.
    ///
    /// # Errors
    /// A tile that the pack has not.
    pub fn file(&self, map: usize, level: u8, block: u8, part: u16) -> Result<String, JsValue> {
        let file = key(map, level, block, part).and_then(|key| self.tiles.file(key));
        let (path, _) = file.map_err(thrown)?;
        Ok(path.display().to_string())
    }

    /// Its length, bytes; 0 for a tile that the pack has not.
    #[wasm_bindgen(js_name = fileBytes)]
    pub fn file_bytes(&self, map: usize, level: u8, block: u8, part: u16) -> f64 {
        let file = key(map, level, block, part).and_then(|key| self.tiles.file(key));
        // At most a tile's texels and its overhead.
        file.map_or(0.0, |(_, bytes)| bytes as f64)
    }

    /// The texels of a tile's file, as the Earth takes them.
    ///
    /// # Errors
    /// Bytes that do not match the manifest.
    pub fn tile(
        &self,
        map: usize,
        level: u8,
        block: u8,
        part: u16,
        bytes: &[u8],
    ) -> Result<Vec<u8>, JsValue> {
        let tile = key(map, level, block, part).and_then(|key| self.tiles.tile_of(key, bytes));
        Ok(tile.map_err(thrown)?.texels)
    }
}

fn key(map: usize, level: u8, block: u8, part: u16) -> Result<TileKey, TileError> {
    let whole = |layer| TileKey::whole(layer, level, block);
    match MapLayer::ALL.get(map) {
        Some(layer) => Ok(TileKey {
            part,
            ..whole(*layer)
        }),
        None => Err(TileError::Absent(whole(MapLayer::Day))),
    }
}

fn thrown(error: impl std::fmt::Display) -> JsValue {
    js_sys::Error::new(&error.to_string()).into()
}
