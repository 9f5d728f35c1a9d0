//! Maps that a worker decodes: read there and sent in bands of rows, uploaded here.

use crate::posted::{BAND_BYTES, END, post};
use crate::thrown;
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;
use terrella::celestial::{CelestialOptions, CelestialSelection, MILKY_WAY_FILE, MOON_FILE};
use terrella::{
    CityLights, EarthLayers, ImageryError, LayerImage, LayerSelection, MapBands, MapError,
    MapLayer, MapRows, MapSink, MapUploader, Season, TexelFormat, UploadedMaps,
    load_seasonal_layers, wgpu,
};
use wasm_bindgen::prelude::{JsCast, JsValue, wasm_bindgen};

/// Number of the Moon's map in messages from the worker, behind those of the Earth; that of the Milky Way follows.
const MOON: usize = MapLayer::ALL.len();

/// Number of the city lights, behind those of the sky: bytes of [`CityLights`] in place of texels.
const CITY_LIGHTS: usize = MOON + 2;

/// How the texels of a map are stored.
fn format_of(layer: MapLayer) -> TexelFormat {
    match layer {
        MapLayer::Day => TexelFormat::Rgba8Srgb,
        MapLayer::Normals => TexelFormat::Rg8Snorm,
        MapLayer::Clouds | MapLayer::NightLights | MapLayer::Water => TexelFormat::R8Unorm,
    }
}

/// Decodes maps: an object of `Uint8Array`s by the names of the starter maps (`day.jpg`, `clouds.jpg`, `elevation.png`, `night_lights.png`,
/// `water.png`, `seasons.png`, `moon.jpg`, `milky_way.jpg`, `places.bin`), of which the first must be there. For a worker. With `places.bin` the light of cities is divided into points. Snow and sea ice are those of a time since the start of the year, as a
/// fraction of it; without it, or without `seasons.png`, there are those of the day map. `take` is called with each band: number of the map, its width and height, level, first
/// row, and texels; after the last band of a map with the level −1.
///
/// # Errors
/// The first map that cannot be read.
#[wasm_bindgen(js_name = decodeMaps)]
pub fn decode_maps(
    maps: js_sys::Object,
    year_fraction: Option<f64>,
    take: js_sys::Function,
) -> Result<(), JsValue> {
    let mut files = HashMap::new();
    for entry in js_sys::Object::entries(&maps).iter() {
        let pair: js_sys::Array = entry.unchecked_into();
        let name = pair.get(0).as_string().unwrap_or_default();
        let bytes: js_sys::Uint8Array = pair.get(1).dyn_into().map_err(|_| {
            thrown(format!(
                "the map {name} is no Uint8Array; give the bytes of its file"
            ))
        })?;
        files.insert(name, bytes.to_vec());
    }
    drop(maps);
    let has = |name: &str| files.contains_key(name);
    let selection = LayerSelection {
        clouds: has("clouds.jpg") || has("clouds.png"),
        normals: has("elevation.png"),
        night_lights: has("night_lights.png"),
        water: has("water.png"),
    };
    let sink = Sender {
        take,
        failed: RefCell::new(None),
    };
    let season = match year_fraction {
        Some(fraction) => Season::load(&files, fraction).map_err(thrown)?,
        None => None,
    };
    let loaded = load_seasonal_layers(&files, selection, season.as_ref(), &sink);
    let (_, damaged) = loaded.map_err(thrown)?;
    let in_sky = CelestialSelection {
        stars: false,
        moon: has(MOON_FILE),
        milky_way: has(MILKY_WAY_FILE),
        ..CelestialSelection::default()
    };
    let sky = CelestialOptions::load(&files, in_sky).map_err(thrown)?;
    for (number, map) in (MOON as u32..).zip([sky.moon, sky.milky_way]) {
        if let Some(map) = map {
            let size = (map.width, map.height);
            sink.send(number, size, 0, 0, &map.levels[0]);
            sink.send(number, size, END, 0, &[]);
        }
    }
    if let Some(lights) = CityLights::load(&files).map_err(thrown)? {
        sink.send(CITY_LIGHTS as u32, (0, 0), END, 0, &lights.to_bytes());
    }
    match (sink.failed.into_inner(), damaged.into_iter().next()) {
        (Some(error), _) => Err(error),
        (None, Some(damaged)) => Err(thrown(damaged.error)),
        (None, None) => Ok(()),
    }
}

/// Sends maps to the page.
struct Sender {
    take: js_sys::Function,
    /// The first error of a call.
    failed: RefCell<Option<JsValue>>,
}

struct Sent<'s> {
    sender: &'s Sender,
    number: u32,
    size: (u32, u32),
    bands: MapBands,
}

impl Sender {
    fn send(&self, number: u32, size: (u32, u32), level: i32, first: u32, texels: &[u8]) {
        if let Err(error) = post(&self.take, number, size, level, first, texels) {
            self.failed.borrow_mut().get_or_insert(error);
        }
    }
}

impl MapSink for Sender {
    fn begin(
        &self,
        layer: MapLayer,
        (width, height): (u32, u32),
        format: TexelFormat,
    ) -> Option<Box<dyn MapRows + '_>> {
        let map = LayerImage {
            width,
            height,
            format,
            levels: [].into(),
        };
        Some(Box::new(Sent {
            sender: self,
            number: layer.index() as u32,
            size: (width, height),
            bands: MapBands::new(&map, BAND_BYTES),
        }))
    }
}

impl MapRows for Sent<'_> {
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        let (sender, number, size) = (self.sender, self.number, self.size);
        self.bands.rows(level, first, texels, |level, first, band| {
            sender.send(number, size, level as i32, first, band);
        });
    }

    fn finish(self: Box<Self>) {
        self.sender.send(self.number, self.size, END, 0, &[]);
    }
}

/// Maps that are coming from a worker.
pub struct Incoming {
    uploader: MapUploader,
    coming: [Option<Box<dyn MapRows>>; MapLayer::ALL.len()],
    /// Descriptions of the maps that came.
    came: [Option<LayerImage>; MapLayer::ALL.len()],
    /// Texels of the maps of the sky that are coming, and the maps that came, from [`MOON`] on.
    sky_texels: [Vec<u8>; 2],
    sky: [Option<Arc<LayerImage>>; 2],
    city_lights: Option<Arc<CityLights>>,
}

/// Maps that came.
pub struct Received {
    /// The Earth's, described.
    pub layers: EarthLayers,
    /// The Earth's, on the GPU.
    pub uploaded: UploadedMaps,
    /// The Moon's.
    pub moon: Option<Arc<LayerImage>>,
    /// The Milky Way's.
    pub milky_way: Option<Arc<LayerImage>>,
    /// The Earth's cities, as points.
    pub city_lights: Option<Arc<CityLights>>,
}

/// Why maps that came cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum IncomingError {
    /// The map is larger than the device's textures.
    #[error(
        "the {layer} map has {width} × {height} texels; this device takes {limit} a side, give a smaller map"
    )]
    TooLarge {
        layer: &'static str,
        width: u32,
        height: u32,
        limit: u32,
    },
    /// City lights of a worker of another version.
    #[error("the city lights are not of this version; take all files of one folder")]
    CityLights,
    /// The day map did not come.
    #[error("the day map is missing; give day.jpg")]
    NoDay,
    /// The device rejected a map.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A map of the sky without all its rows.
    #[error(transparent)]
    Sky(#[from] ImageryError),
}

impl Incoming {
    /// For this device.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            uploader: MapUploader::new(device, queue, Default::default()),
            coming: Default::default(),
            came: Default::default(),
            sky_texels: Default::default(),
            sky: Default::default(),
            city_lights: None,
        }
    }

    /// Takes a band of [`decode_maps`].
    ///
    /// # Errors
    /// A map that is too large, city lights of another version.
    pub fn band(
        &mut self,
        device: &wgpu::Device,
        (map, width, height): (usize, u32, u32),
        (level, first): (i32, u32),
        texels: &[u8],
    ) -> Result<(), IncomingError> {
        if map == CITY_LIGHTS {
            let lights = CityLights::from_bytes(texels).ok_or(IncomingError::CityLights)?;
            self.city_lights = Some(Arc::new(lights));
            return Ok(());
        }
        let Some(layer) = MapLayer::ALL.get(map).copied() else {
            return self.sky_band(map - MOON, (width, height), level, texels);
        };
        let rows = match &mut self.coming[map] {
            Some(rows) => rows,
            none => {
                let format = format_of(layer);
                let rows = self.uploader.rows(layer, (width, height), format);
                let rows = rows.ok_or(IncomingError::TooLarge {
                    layer: layer.name(),
                    width,
                    height,
                    limit: device.limits().max_texture_dimension_2d,
                })?;
                none.insert(rows)
            }
        };
        if let Ok(level) = usize::try_from(level) {
            rows.rows(level, first, texels);
            return Ok(());
        }
        if let Some(rows) = self.coming[map].take() {
            rows.finish();
        }
        self.came[map] = Some(LayerImage {
            width,
            height,
            format: format_of(layer),
            levels: [].into(),
        });
        Ok(())
    }

    /// Takes rows of a map of the sky, from north to south.
    fn sky_band(
        &mut self,
        map: usize,
        (width, height): (u32, u32),
        level: i32,
        texels: &[u8],
    ) -> Result<(), IncomingError> {
        let (Some(coming), Some(came)) = (self.sky_texels.get_mut(map), self.sky.get_mut(map))
        else {
            return Ok(());
        };
        coming.extend_from_slice(texels);
        if level == END {
            let map = LayerImage::from_rgba8(width, height, std::mem::take(coming))?;
            *came = Some(Arc::new(map));
        }
        Ok(())
    }

    /// The maps, after all have come.
    ///
    /// # Errors
    /// A missing day map, or one that the device rejected.
    pub fn finish(self) -> Result<Received, IncomingError> {
        let [day, clouds, normals, night_lights, water] = self.came;
        let layers = EarthLayers {
            day: day.ok_or(IncomingError::NoDay)?,
            clouds,
            normals,
            night_lights,
            water,
        };
        let [moon, milky_way] = self.sky;
        Ok(Received {
            layers,
            uploaded: self.uploader.finish()?,
            moon,
            milky_way,
            city_lights: self.city_lights,
        })
    }
}
