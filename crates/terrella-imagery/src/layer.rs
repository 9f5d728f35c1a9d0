//! A map in memory with its mip levels, and the set of maps that an Earth is drawn with.

use super::error::ImageryError;
use super::mips;
use super::texel::{MAX_HEIGHT, TexelFormat};
use super::tile::MapLayer;
use std::sync::Arc;

/// One equirectangular map with its mip levels: north row first, left edge at 180° W.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerImage {
    /// Width of level 0, texels.
    pub width: u32,
    /// Height of level 0, texels.
    pub height: u32,
    /// How texels are stored.
    pub format: TexelFormat,
    /// Level 0 first, each row-major and tightly packed; level n is max(1, width >> n) × max(1, height >> n).
    /// Clones share them.
    pub levels: Arc<[Vec<u8>]>,
}

impl LayerImage {
    /// A colour map from sRGB-encoded RGBA texels, 4 bytes each. Mip levels are averaged in linear light.
    ///
    /// # Errors
    /// [`ImageryError::Dimensions`] or [`ImageryError::Length`] if size and texels do not fit.
    pub fn from_rgba8(width: u32, height: u32, texels: Vec<u8>) -> Result<Self, ImageryError> {
        Self::from_level_0(width, height, TexelFormat::Rgba8Srgb, texels)
    }

    /// A cover or intensity map from one byte a texel, 0…255 meaning 0…1.
    ///
    /// # Errors
    /// As [`LayerImage::from_rgba8`].
    pub fn from_r8(width: u32, height: u32, texels: Vec<u8>) -> Result<Self, ImageryError> {
        Self::from_level_0(width, height, TexelFormat::R8Unorm, texels)
    }

    /// A slope map from two bytes a texel: east then north, each a signed byte (two's complement), −127…127
    /// meaning −1…1.
    ///
    /// # Errors
    /// As [`LayerImage::from_rgba8`].
    pub fn from_slopes(width: u32, height: u32, texels: Vec<u8>) -> Result<Self, ImageryError> {
        Self::from_level_0(width, height, TexelFormat::Rg8Snorm, texels)
    }

    fn from_level_0(
        width: u32,
        height: u32,
        format: TexelFormat,
        texels: Vec<u8>,
    ) -> Result<Self, ImageryError> {
        check_dimensions(width, height)?;
        // At most 2^15 × 2^14 × 4 bytes: fits a usize, which has 64 bits on every machine with memory for such maps.
        let needed = width as usize * height as usize * format.texel_bytes();
        if texels.len() != needed {
            return Err(ImageryError::Length {
                width,
                height,
                format,
                needed,
                got: texels.len(),
            });
        }
        Ok(Self {
            width,
            height,
            format,
            levels: mips::chain(texels, width as usize, height as usize, format).into(),
        })
    }

    /// Width and height of a mip level, texels. Levels beyond the last are 1 × 1.
    pub fn level_size(&self, level: usize) -> (u32, u32) {
        let shrink = |n: u32| {
            n.checked_shr(u32::try_from(level).unwrap_or(u32::MAX))
                .unwrap_or(0)
                .max(1)
        };
        (shrink(self.width), shrink(self.height))
    }

    /// Size of all levels together, present or not, bytes.
    pub fn bytes(&self) -> u64 {
        let texels = |level| {
            let (width, height) = self.level_size(level);
            u64::from(width) * u64::from(height)
        };
        let levels = 0..mips::level_count(self.width, self.height);
        self.format.texel_bytes() as u64 * levels.map(texels).sum::<u64>()
    }

    /// Size and format of this map, without its texels: what is left of a map that is held on the GPU.
    pub fn without_texels(&self) -> Self {
        Self {
            levels: [].into(),
            ..*self
        }
    }

    /// The same map without its finest levels, but with one level at least.
    pub fn without_finest(&self, levels: usize) -> Self {
        let first = levels.min(self.levels.len().saturating_sub(1));
        let (width, height) = self.level_size(first);
        Self {
            width,
            height,
            format: self.format,
            levels: self.levels[first..].into(),
        }
    }

    /// The last level with at least this width, texels; level 0 if there is none.
    pub(super) fn level_of_width(&self, width: usize) -> usize {
        let is_wide = |level: &usize| self.level_size(*level).0 as usize >= width;
        let levels = 0..mips::level_count(self.width, self.height);
        levels.take_while(is_wide).last().unwrap_or(0)
    }

    /// Whether any level is in memory.
    pub fn has_texels(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Checks a map whose fields were filled in by hand: every level present and of the right length.
    ///
    /// # Errors
    /// [`ImageryError::Dimensions`] or [`ImageryError::Levels`], which names the first wrong level.
    pub fn check(&self) -> Result<(), ImageryError> {
        check_dimensions(self.width, self.height)?;
        let count = mips::level_count(self.width, self.height);
        for level in 0..count.max(self.levels.len()) {
            let (width, height) = self.level_size(level);
            let needed = width as usize * height as usize * self.format.texel_bytes();
            if level >= count || self.levels.get(level).map(Vec::len) != Some(needed) {
                return Err(ImageryError::Levels {
                    level,
                    width: self.width,
                    height: self.height,
                    format: self.format,
                });
            }
        }
        Ok(())
    }
}

/// The maps that an Earth is drawn with. A layer that is `None` is not loaded, uploaded, bound or in the shader.
#[derive(Clone, Debug)]
pub struct EarthLayers {
    /// Surface colour by day, `Rgba8Srgb`. With a water map its alpha is the depth of the sea's floor, 0…1 meaning 0 to
    /// [`FLOOR_SEEN_M`](super::FLOOR_SEEN_M), 1 where the floor is not seen; without one it means nothing.
    pub day: LayerImage,
    /// Cloud cover, `R8Unorm`.
    pub clouds: Option<LayerImage>,
    /// Terrain slopes (dh/d east, dh/d north), exaggerated as its maker states, `Rg8Snorm`.
    pub normals: Option<LayerImage>,
    /// City lights, `R8Unorm`.
    pub night_lights: Option<LayerImage>,
    /// Open water, `R8Unorm`: 0…1, the coast where it is one half. There the colour is water's and not the day map's.
    pub water: Option<LayerImage>,
}

impl EarthLayers {
    /// A map by its kind.
    pub fn get(&self, layer: MapLayer) -> Option<&LayerImage> {
        match layer {
            MapLayer::Day => Some(&self.day),
            MapLayer::Clouds => self.clouds.as_ref(),
            MapLayer::Normals => self.normals.as_ref(),
            MapLayer::NightLights => self.night_lights.as_ref(),
            MapLayer::Water => self.water.as_ref(),
        }
    }

    /// A map by its kind, to be changed.
    pub fn get_mut(&mut self, layer: MapLayer) -> Option<&mut LayerImage> {
        match layer {
            MapLayer::Day => Some(&mut self.day),
            MapLayer::Clouds => self.clouds.as_mut(),
            MapLayer::Normals => self.normals.as_mut(),
            MapLayer::NightLights => self.night_lights.as_mut(),
            MapLayer::Water => self.water.as_mut(),
        }
    }

    /// Replaces the maps that `others` has.
    pub fn replace(&mut self, others: Self) {
        let Self {
            day,
            clouds,
            normals,
            night_lights,
            water,
        } = others;
        self.day = day;
        for (own, other) in [
            (&mut self.clouds, clouds),
            (&mut self.normals, normals),
            (&mut self.night_lights, night_lights),
            (&mut self.water, water),
        ] {
            *own = other.or(own.take());
        }
    }

    /// The same layers with each map changed.
    pub fn mapped(&self, change: impl Fn(&LayerImage) -> LayerImage) -> Self {
        let changed = |map: &Option<LayerImage>| map.as_ref().map(&change);
        Self {
            day: change(&self.day),
            clouds: changed(&self.clouds),
            normals: changed(&self.normals),
            night_lights: changed(&self.night_lights),
            water: changed(&self.water),
        }
    }

    /// Bytes of all texels of all layers, mip levels included.
    pub fn texture_bytes(&self) -> u64 {
        MapLayer::ALL
            .into_iter()
            .filter_map(|layer| self.get(layer))
            .map(LayerImage::bytes)
            .sum()
    }
}

/// The size limits of maps in memory: those of files, with any aspect ratio.
pub(super) fn check_dimensions(width: u32, height: u32) -> Result<(), ImageryError> {
    if width == 0 || height == 0 || width > 2 * MAX_HEIGHT || height > MAX_HEIGHT {
        return Err(ImageryError::Dimensions { width, height });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_lengths_and_sizes_are_rejected() {
        assert!(matches!(
            LayerImage::from_rgba8(4, 2, vec![0; 31]),
            Err(ImageryError::Length {
                needed: 32,
                got: 31,
                ..
            })
        ));
        assert!(matches!(
            LayerImage::from_r8(4, 2, vec![0; 9]),
            Err(ImageryError::Length { needed: 8, .. })
        ));
        assert!(matches!(
            LayerImage::from_slopes(4, 2, vec![0; 8]),
            Err(ImageryError::Length { needed: 16, .. })
        ));
        for (width, height) in [(0, 2), (4, 0), (40_000, 2), (2, 20_000)] {
            assert!(matches!(
                LayerImage::from_r8(width, height, Vec::new()),
                Err(ImageryError::Dimensions { .. })
            ));
        }
    }

    #[test]
    fn bytes_count_all_levels_and_check_finds_a_wrong_one() {
        let mut map = LayerImage::from_rgba8(8, 4, vec![255; 128]).expect("a good map");
        assert_eq!(map.bytes(), (32 + 8 + 2 + 1) * 4);
        assert_eq!(map.level_size(2), (2, 1));
        assert_eq!(map.level_size(99), (1, 1));
        map.check().expect("built by us");
        Arc::make_mut(&mut map.levels)[2].push(0);
        assert!(matches!(
            map.check(),
            Err(ImageryError::Levels { level: 2, .. })
        ));
        Arc::make_mut(&mut map.levels)[2].pop();
        map.levels = map.levels.iter().cloned().chain([vec![0; 4]]).collect();
        assert!(matches!(
            map.check(),
            Err(ImageryError::Levels { level: 4, .. })
        ));
        map.levels = map.levels[..3].into();
        assert!(matches!(
            map.check(),
            Err(ImageryError::Levels { level: 3, .. })
        ));
    }
}
