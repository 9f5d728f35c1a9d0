//! The layout of a pack's tiles as numbers, from the worker that reads the pack to the Earth that is drawn with it.
//!
//! For each map: its number, the format, the number of levels, and of each level the texels of a tile, the parts along a block's edge and a bit for
//! each tile, block by block, 32 to a number.

use terrella_imagery::tile::{
    BlockSet, LayerLayout, LevelLayout, MAX_LEVELS, MapLayer, TileFormat, TileSet, TileShape,
};

const FORMATS: [TileFormat; 6] = [
    TileFormat::Rgba8Srgb,
    TileFormat::R8Unorm,
    TileFormat::Rg8Snorm,
    TileFormat::Bc7Srgb,
    TileFormat::Bc4Unorm,
    TileFormat::Bc5Snorm,
];

/// The layout as numbers.
pub fn layout_words(layers: &[LayerLayout]) -> Vec<u32> {
    let mut words = Vec::new();
    for layout in layers {
        let format = FORMATS.iter().position(|format| *format == layout.format);
        words.push(layout.layer.index() as u32);
        words.push(format.unwrap_or_default() as u32);
        words.push(layout.levels.len() as u32);
        for LevelLayout { shape, present } in &layout.levels {
            words.extend([shape.pixels, shape.parts]);
            let tiles: Vec<bool> = tiles_of(*shape)
                .map(|(block, part)| present.contains(block, part))
                .collect();
            words.extend(tiles.chunks(32).map(|bits| {
                let bits = bits.iter().enumerate();
                bits.fold(0, |word, (bit, is_there)| {
                    word | u32::from(*is_there) << bit
                })
            }));
        }
    }
    words
}

/// The layout of numbers; `None` for others than [`layout_words`] gives.
pub fn layout_of_words(words: &[u32]) -> Option<Vec<LayerLayout>> {
    let mut words = words.iter().copied();
    let mut layers = Vec::new();
    while let Some(layer) = words.next() {
        let layer = *MapLayer::ALL.get(layer as usize)?;
        let format = *FORMATS.get(words.next()? as usize)?;
        let count = words.next()? as usize;
        if count > MAX_LEVELS {
            return None;
        }
        let mut levels = Vec::with_capacity(count);
        for _ in 0..count {
            let shape = TileShape::cut(words.next()?, words.next()?)?;
            let mut present = TileSet::none(shape);
            let mut bits = 0;
            for (n, (block, part)) in tiles_of(shape).enumerate() {
                if n % 32 == 0 {
                    bits = words.next()?;
                }
                if bits >> (n % 32) & 1 == 1 {
                    present.insert(block, part);
                }
            }
            levels.push(LevelLayout { shape, present });
        }
        layers.push(LayerLayout {
            layer,
            format,
            levels,
        });
    }
    Some(layers)
}

/// Block and part of each place.
fn tiles_of(shape: TileShape) -> impl Iterator<Item = (u8, u16)> {
    let blocks = (0..=u8::MAX).filter(|block| BlockSet::ALL.contains(*block));
    blocks.flat_map(move |block| (0..shape.tiles_of_block()).map(move |part| (block, part)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_comes_back() {
        let level = |pixels, parts, every: u16| {
            let shape = TileShape::cut(pixels, parts).unwrap();
            let mut present = TileSet::none(shape);
            for (block, part) in tiles_of(shape) {
                if (u16::from(block) + part).is_multiple_of(every) {
                    present.insert(block, part);
                }
            }
            LevelLayout { shape, present }
        };
        let layers = vec![
            LayerLayout {
                layer: MapLayer::Day,
                format: TileFormat::Bc7Srgb,
                levels: vec![level(450, 4, 7), level(450, 1, 3), level(135, 1, 1)],
            },
            LayerLayout {
                layer: MapLayer::Water,
                format: TileFormat::R8Unorm,
                levels: vec![level(135, 1, 1)],
            },
        ];
        let words = layout_words(&layers);
        assert_eq!(layout_of_words(&words), Some(layers));
        for end in [1, 2, 5, words.len() - 1] {
            assert_eq!(layout_of_words(&words[..end]), None, "{end}");
        }
        for (at, wrong) in [(0, 9), (1, 6), (2, 99), (3, 1), (4, 3)] {
            let mut words = words.clone();
            words[at] = wrong;
            assert_eq!(layout_of_words(&words), None, "{at}");
        }
    }
}
