//! Tiles of a pack: a second Earth is made with them beside the one that is drawn, and takes its place.

use super::Globe;
use crate::maps::Incoming;
use crate::thrown;
use crate::tile_layout::layout_of_words;
use std::sync::Arc;
use terrella::{
    Earth, EarthOptions, HostedTiles, Tile, TileError, TileLoad, TileLoading, TileOptions, wgpu,
};
use terrella_imagery::residency::StreamCounters;
use terrella_imagery::tile::LayerLayout;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

/// Requests under way at once: as many as browsers send to a server of HTTP/1.1.
const AT_ONCE: usize = 6;

/// Memory of all textures, bytes: half of what the native program takes, as a page shares its device.
const TEXTURE_BYTES: u64 = 256_000_000;

/// Bytes uploaded a frame.
const UPLOAD_BYTES: u64 = 4_000_000;

/// An Earth that is being made, with a pack's tiles or without.
#[wasm_bindgen]
pub struct PackOpening {
    device: wgpu::Device,
    queue: wgpu::Queue,
    incoming: Incoming,
    layout: Vec<LayerLayout>,
    options: EarthOptions,
}

/// An Earth that may take the place of the drawn one.
#[wasm_bindgen]
pub struct PreparedEarth {
    earth: Earth,
    layout: Vec<LayerLayout>,
}

/// Tiles that the page is loading.
#[derive(Default)]
pub struct PageTiles {
    layout: Vec<LayerLayout>,
    /// By the number that the page knows; `None` for one that is free.
    loads: Vec<Option<TileLoad>>,
    /// Bytes uploaded until the last frame.
    uploaded_bytes: u64,
}

impl PageTiles {
    /// Whether tiles were uploaded in a frame of these counters: the next one draws them, or goes on.
    pub fn note_uploads(&mut self, counters: &StreamCounters) -> bool {
        let before = std::mem::replace(&mut self.uploaded_bytes, counters.uploaded_bytes);
        before < counters.uploaded_bytes
    }
}

#[wasm_bindgen]
impl PackOpening {
    /// Uploads a band of rows of one of the pack's whole maps, as [`super::Opening::band`] does.
    ///
    /// # Errors
    /// A map that is too large for the device, city lights of another version.
    pub fn band(
        &mut self,
        map: usize,
        width: u32,
        height: u32,
        level: i32,
        first: u32,
        texels: &[u8],
    ) -> Result<(), JsValue> {
        let (map, rows) = ((map, width, height), (level, first));
        let taken = self.incoming.band(&self.device, map, rows, texels);
        taken.map_err(thrown)
    }

    /// Makes the Earth of the maps that came, and of the page's own where the pack has none.
    ///
    /// # Errors
    /// A pack without a day map, a device without memory.
    pub async fn finish(self) -> Result<PreparedEarth, JsValue> {
        let Self {
            device,
            queue,
            incoming,
            layout,
            mut options,
        } = self;
        if !layout.is_empty() {
            let maps = incoming.finish().map_err(thrown)?;
            options.replace_uploaded(maps.layers, maps.uploaded);
            options.tiles = Some(TileOptions {
                loading: TileLoading::Host(AT_ONCE),
                texture_bytes: TEXTURE_BYTES,
                upload_bytes: UPLOAD_BYTES,
                ..TileOptions::new(Arc::new(HostedTiles(layout.clone())))
            });
        }
        let earth = Earth::create(&device, &queue, &options).await;
        let earth = earth.map_err(thrown)?;
        Ok(PreparedEarth { earth, layout })
    }
}

#[wasm_bindgen]
impl Globe {
    /// Whether the device reads BC textures.
    #[wasm_bindgen(js_name = hasBc)]
    pub fn has_bc(&self) -> bool {
        let features = self.canvas.device.features();
        features.contains(wgpu::Features::TEXTURE_COMPRESSION_BC)
    }

    /// Begins an Earth with tiles: their layout, and the factor of slopes, as `PackReader` gives them. An empty layout is an Earth without tiles, of
    /// the page's own maps.
    ///
    /// # Errors
    /// Numbers that are no layout.
    #[wasm_bindgen(js_name = openPack)]
    pub fn open_pack(&self, layout: &[u32], slope_factor: f64) -> Result<PackOpening, JsValue> {
        let layout = layout_of_words(layout).ok_or_else(|| thrown("this is no layout of tiles"))?;
        let mut options = self.options.clone();
        options.light.relief_exaggeration *= slope_factor;
        let (device, queue) = (self.canvas.device.clone(), self.canvas.queue.clone());
        Ok(PackOpening {
            incoming: Incoming::new(&device, &queue),
            device,
            queue,
            layout,
            options,
        })
    }

    /// Draws another Earth from the next frame on.
    ///
    /// # Errors
    /// A device that cannot draw it with the settings of the page.
    #[wasm_bindgen(js_name = showPack)]
    pub fn show_pack(&mut self, made: PreparedEarth) -> Result<(), JsValue> {
        let tiles = PageTiles {
            layout: made.layout,
            ..PageTiles::default()
        };
        self.adopt(made.earth, tiles)
    }

    /// The most urgent tile to load, as of the last frame: a number for it, then map, level, block and part. `None` if nothing is to be loaded now.
    #[wasm_bindgen(js_name = takeTile)]
    pub fn take_tile(&mut self) -> Option<Vec<u32>> {
        let load = self.earth.take_tile()?;
        let key = load.key();
        let loads = &mut self.tiles.loads;
        let free = loads.iter().position(Option::is_none);
        let number = free.unwrap_or_else(|| {
            loads.push(None);
            loads.len() - 1
        });
        loads[number] = Some(load);
        let map = key.layer.index() as u32;
        Some(vec![
            number as u32,
            map,
            key.level.into(),
            key.block.into(),
            key.part.into(),
        ])
    }

    /// Numbers of loads that are no longer wanted.
    #[wasm_bindgen(js_name = unwantedTiles)]
    pub fn unwanted_tiles(&self) -> Vec<u32> {
        let loads = self.tiles.loads.iter().enumerate();
        let unwanted =
            loads.filter(|(_, load)| load.as_ref().is_some_and(|load| !load.is_wanted()));
        unwanted.map(|(number, _)| number as u32).collect()
    }

    /// Takes the texels of a tile.
    #[wasm_bindgen(js_name = endTile)]
    pub fn end_tile(&mut self, number: usize, texels: Vec<u8>) {
        let Some(load) = self.tiles.loads.get_mut(number).and_then(Option::take) else {
            return;
        };
        let key = load.key();
        let layout = self.tiles.layout.iter().find(|of| of.layer == key.layer);
        let level = layout.and_then(|of| Some((of.format, of.levels.get(usize::from(key.level))?)));
        load.end(match level {
            Some((format, level)) => Ok(Tile {
                format,
                shape: level.shape,
                texels,
            }),
            None => Err(TileError::Absent(key)),
        });
    }

    /// Ends the load of a tile that did not come, or is no longer wanted. One that did not come is requested again after a pause.
    #[wasm_bindgen(js_name = failTile)]
    pub fn fail_tile(&mut self, number: usize, address: String, cause: String, is_unwanted: bool) {
        let load = self.tiles.loads.get_mut(number).and_then(Option::take);
        if let Some(load) = load {
            load.end(Err(match is_unwanted {
                true => TileError::Cancelled,
                false => TileError::NotReceived { address, cause },
            }));
        }
    }

    /// Whether tiles are missing that the last frame should have been drawn with.
    #[wasm_bindgen(js_name = isSharp)]
    pub fn is_sharp(&self) -> bool {
        self.is_complete && self.earth.missing_tiles().next().is_none()
    }
}

impl Globe {
    fn adopt(&mut self, mut earth: Earth, tiles: PageTiles) -> Result<(), JsValue> {
        let queue = &self.canvas.queue;
        let mut appearance = self.earth.appearance().clone();
        appearance.light.relief_exaggeration = earth.appearance().light.relief_exaggeration;
        earth
            .set_appearance(queue, &appearance)
            .and_then(|()| earth.set_quality(queue, self.earth.quality()))
            .and_then(|()| earth.set_exposure(self.options.exposure))
            .map_err(thrown)?;
        (self.earth, self.tiles) = (earth, tiles);
        self.overlay.follow(&self.earth).map_err(thrown)
    }
}
