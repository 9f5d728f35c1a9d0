//! Properties of a map that an Earth needs without its texels: computed row by row, so that the texels need not be in memory.

use super::albedo::MapAlbedo;
use super::ground_kinds::{GroundKindRows, MapGroundKinds};
use super::layer::LayerImage;
use super::map_rows::MapRows;
use super::texel::TexelFormat;
use super::tile::MapLayer;

/// Properties of a map without its texels.
#[derive(Clone, Debug)]
pub struct MapSummary {
    /// Its contribution to the light of the air; `None` for a map without one.
    pub albedo: Option<MapAlbedo>,
    /// Land and sea according to it; `None` for a map without this information.
    pub kinds: Option<MapGroundKinds>,
}

/// The same while rows of the map come in.
pub struct MapSummaryRows {
    layer: MapLayer,
    /// Its size and format.
    map: LayerImage,
    albedo_level: usize,
    /// Texels of that level.
    albedo_texels: Vec<u8>,
    kinds: Option<GroundKindRows>,
}

impl MapSummary {
    /// That of a map in memory.
    pub fn of(layer: MapLayer, map: &LayerImage) -> Self {
        let mut rows = MapSummaryRows::new(layer, (map.width, map.height), map.format);
        map.rows_to(&mut rows);
        rows.summary()
    }
}

impl MapSummaryRows {
    /// For a map of this size, texels.
    pub fn new(layer: MapLayer, (width, height): (u32, u32), format: TexelFormat) -> Self {
        let map = LayerImage {
            width,
            height,
            format,
            levels: [].into(),
        };
        let albedo_level = MapAlbedo::level(layer, &map);
        let (columns, rows) = map.level_size(albedo_level);
        let albedo_bytes = columns as usize * rows as usize * format.texel_bytes();
        Self {
            layer,
            albedo_level,
            albedo_texels: vec![0; albedo_bytes],
            kinds: GroundKindRows::new(layer, &map),
            map,
        }
    }

    /// The result after all rows.
    pub fn summary(self) -> MapSummary {
        let size = self.map.level_size(self.albedo_level);
        let format = self.map.format;
        MapSummary {
            albedo: MapAlbedo::of_texels(self.layer, &self.albedo_texels, size, format),
            kinds: self.kinds.map(GroundKindRows::finish),
        }
    }
}

impl MapRows for MapSummaryRows {
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        if level == self.albedo_level {
            let (columns, _) = self.map.level_size(level);
            let row_bytes = columns as usize * self.map.format.texel_bytes();
            let places = self
                .albedo_texels
                .iter_mut()
                .skip(first as usize * row_bytes);
            places
                .zip(texels)
                .for_each(|(place, texel)| *place = *texel);
        }
        if let Some(kinds) = &mut self.kinds {
            kinds.rows(level, first, texels);
        }
    }

    fn finish(self: Box<Self>) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EarthLayers, GroundKinds, NeighbourhoodAlbedo, tile::MAP_LAYERS};

    #[test]
    fn rows_one_by_one_give_what_the_whole_map_gives() {
        for (width, height) in [(4096, 2048), (300, 150), (64, 32), (2, 1)] {
            let texels = |bytes: usize| -> Vec<u8> {
                let count = (width * height) as usize * bytes;
                (0..count)
                    .map(|n| ((n * 2_654_435_761) >> 13) as u8)
                    .collect()
            };
            let layers = EarthLayers {
                day: LayerImage::from_rgba8(width, height, texels(4)).expect("a map"),
                clouds: Some(LayerImage::from_r8(width, height, texels(1)).expect("a map")),
                normals: None,
                night_lights: None,
                water: Some(
                    LayerImage::from_r8(width, height, vec![0; (width * height) as usize])
                        .expect("a map"),
                ),
            };
            let summaries = MapLayer::ALL.map(|layer| {
                let map = layers.get(layer)?;
                let mut rows = MapSummaryRows::new(layer, (width, height), map.format);
                for (level, texels) in map.levels.iter().enumerate() {
                    let row_bytes = map.level_size(level).0 as usize * map.format.texel_bytes();
                    let numbered: Vec<_> = (0..).zip(texels.chunks_exact(row_bytes)).collect();
                    // From the south: the order does not matter.
                    for (number, row) in numbered.into_iter().rev() {
                        rows.rows(level, number, row);
                    }
                }
                Some(rows.summary())
            });
            let of = |layer: MapLayer| summaries[layer.index()].as_ref();
            let albedo = NeighbourhoodAlbedo::of_parts(|layer| of(layer)?.albedo.clone());
            let shown = [true; MAP_LAYERS];
            let whole = NeighbourhoodAlbedo::new(&layers);
            assert_eq!(albedo.texels(&shown), whole.texels(&shown));
            let part = |layer| of(layer).and_then(|found| found.kinds.as_ref());
            let parts = part(MapLayer::Water).zip(part(MapLayer::Day));
            let (water, day) = parts.expect("both say something");
            let kinds = GroundKinds::of_parts(water, day);
            let expected = GroundKinds::new(&layers).expect("a map of water");
            let cells = (0..768).flat_map(|x| (0..384).map(move |y| (x, y)));
            let differ = |cell: &(u32, u32)| kinds.of(48, *cell) != expected.of(48, *cell);
            assert_eq!(cells.filter(differ).count(), 0);
        }
    }
}
