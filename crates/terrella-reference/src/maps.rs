//! Maps as functions of the place: bilinear between full-resolution texels, round the date line, held at the poles.

use super::ReferenceError;
use std::sync::Arc;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};
use terrella_imagery::{EarthLayers, LayerImage, TexelFormat};

/// A map's full-resolution texels: row-major, north row first, left edge at 180° W.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FullMap {
    /// Width, texels.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// How texels are stored.
    pub format: TexelFormat,
    pub texels: Vec<u8>,
}

/// The full-resolution maps of an Earth, no mip levels. A layer that is `None` is not drawn.
#[derive(Clone, Debug, Default)]
pub struct FullMaps {
    /// In the order of [`MapLayer::index`].
    pub layers: [Option<FullMap>; MAP_LAYERS],
}

impl FullMaps {
    /// Copies level 0 of each map.
    ///
    /// # Errors
    /// A map whose texels do not fit its description.
    pub fn copied(layers: &EarthLayers) -> Result<Self, ReferenceError> {
        let mut maps = Self::default();
        for layer in MapLayer::ALL {
            if let Some(image) = layers.get(layer) {
                image.check()?;
                maps.layers[layer.index()] = image.levels.first().map(|texels| FullMap {
                    width: image.width,
                    height: image.height,
                    format: image.format,
                    texels: texels.clone(),
                });
            }
        }
        Ok(maps)
    }

    /// Takes level 0 of each map and frees the others.
    ///
    /// # Errors
    /// As [`Self::copied`].
    pub fn taken(layers: EarthLayers) -> Result<Self, ReferenceError> {
        let take = |mut image: LayerImage| {
            image.check()?;
            Ok::<_, ReferenceError>(FullMap {
                width: image.width,
                height: image.height,
                format: image.format,
                texels: match Arc::get_mut(&mut image.levels) {
                    Some([finest, ..]) => std::mem::take(finest),
                    // Others hold them, too.
                    _ => image.levels.first().cloned().unwrap_or_default(),
                },
            })
        };
        let EarthLayers {
            day,
            clouds,
            normals,
            night_lights,
            water,
        } = layers;
        let all = [Some(day), clouds, normals, night_lights, water];
        let mut maps = Self::default();
        for (place, image) in maps.layers.iter_mut().zip(all) {
            *place = image.map(take).transpose()?;
        }
        Ok(maps)
    }

    /// Bytes of all texels.
    pub fn bytes(&self) -> u64 {
        let maps = self.layers.iter().flatten();
        maps.map(|map| map.texels.len() as u64).sum()
    }

    /// Checks formats and lengths, and that there is a day map.
    pub(super) fn check(&self) -> Result<(), ReferenceError> {
        for (layer, map) in MapLayer::ALL.into_iter().zip(&self.layers) {
            let Some(map) = map else { continue };
            let wanted = match layer {
                MapLayer::Day => TexelFormat::Rgba8Srgb,
                MapLayer::Normals => TexelFormat::Rg8Snorm,
                MapLayer::Clouds | MapLayer::NightLights | MapLayer::Water => TexelFormat::R8Unorm,
            };
            let bytes = map.width as usize * map.height as usize * wanted.texel_bytes();
            if map.format != wanted || bytes == 0 || map.texels.len() != bytes {
                return Err(ReferenceError::Map {
                    layer: layer.name(),
                    wanted,
                    width: map.width,
                    height: map.height,
                    format: map.format,
                    bytes: map.texels.len(),
                });
            }
        }
        match self.layers[MapLayer::Day.index()] {
            Some(_) => Ok(()),
            None => Err(ReferenceError::NoDay),
        }
    }

    pub(super) fn get(&self, layer: MapLayer) -> Option<&FullMap> {
        self.layers[layer.index()].as_ref()
    }

    /// Largest width and height of any map.
    pub(super) fn finest(&self) -> (u32, u32) {
        let maps = self.layers.iter().flatten();
        maps.fold((1, 1), |(width, height), map| {
            (width.max(map.width), height.max(map.height))
        })
    }
}

impl FullMap {
    /// The value at a place of the map, bilinear between the four texels about it: `u` 0…1 from 180° W eastwards, `v`
    /// 0…1 from the north pole. `decode` gives the meaning of a stored byte.
    pub(super) fn at<const CHANNELS: usize>(
        &self,
        u: f64,
        v: f64,
        decode: &[f64; 256],
    ) -> [f64; CHANNELS] {
        let (width, height) = (i64::from(self.width), i64::from(self.height));
        let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
        let (left, upper) = (x.floor(), y.floor());
        let (right, lower) = (x - left, y - upper);
        let columns = [left as i64, left as i64 + 1].map(|x| x.rem_euclid(width));
        let rows = [upper as i64, upper as i64 + 1].map(|y| y.clamp(0, height - 1));
        let texel_bytes = self.format.texel_bytes();
        let mut sum = [0.0; CHANNELS];
        for (row, down) in rows.into_iter().zip([1.0 - lower, lower]) {
            for (column, across) in columns.into_iter().zip([1.0 - right, right]) {
                let start = (row * width + column) as usize * texel_bytes;
                let texel = &self.texels[start..start + CHANNELS];
                for (sum, code) in sum.iter_mut().zip(texel) {
                    *sum += down * across * decode[usize::from(*code)];
                }
            }
        }
        sum
    }
}

/// Meanings of stored bytes.
#[derive(Debug)]
pub(super) struct Decode {
    /// sRGB to linear light (IEC 61966-2-1).
    pub srgb: [f64; 256],
    /// 0…1.
    pub unorm: [f64; 256],
    /// −1…1; −128 means −1 too.
    pub snorm: [f64; 256],
}

impl Decode {
    pub fn new() -> Self {
        let unorm = std::array::from_fn(|code| code as f64 / 255.0);
        Self {
            srgb: unorm.map(linear_from_srgb),
            unorm,
            snorm: std::array::from_fn(|code| (f64::from(code as u8 as i8) / 127.0).max(-1.0)),
        }
    }
}

/// Linear light of a display value 0…1.
pub(super) fn linear_from_srgb(value: f64) -> f64 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

/// Display value of linear light 0…1.
pub(super) fn srgb_from_linear(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}
