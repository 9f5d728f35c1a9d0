//! Small maps whose every texel encodes its tile.

use terrella_imagery::tile::{
    BlockSet, LayerLayout, LevelLayout, MapLayer, Storage, Tile, TileKey, TileShape,
};

/// A number that looks random, different for each input.
pub fn scramble(number: u64) -> u64 {
    let mut x = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A map with small tiles: the sides of its levels in texels, the finest first.
pub fn layout(layer: MapLayer, storage: Storage, pixels: &[u32]) -> LayerLayout {
    LayerLayout {
        layer,
        format: layer.tile_format(storage),
        levels: pixels
            .iter()
            .map(|pixels| LevelLayout::of_blocks(TileShape::new(*pixels).unwrap(), BlockSet::ALL))
            .collect(),
    }
}

/// A map whose finest levels are cut: texels of a tile's side, and number of parts along a block's side at each of them, the finest first; and the
/// sides of the coarser ones.
pub fn cut_layout(layer: MapLayer, pixels: u32, parts: &[u32], coarser: &[u32]) -> LayerLayout {
    let whole = [&[pixels][..], coarser].concat();
    let mut layout = layout(layer, Storage::Plain, &whole);
    let cut = parts.iter().map(|parts| {
        let shape = TileShape::cut(pixels, *parts).unwrap();
        LevelLayout::of_blocks(shape, BlockSet::ALL)
    });
    layout.levels = cut.chain(layout.levels.iter().cloned()).collect();
    layout
}

/// The tile of these layouts.
pub fn tile(layers: &[LayerLayout], key: TileKey) -> Tile {
    let layer = layers.iter().find(|layer| layer.layer == key.layer);
    let layer = layer.unwrap();
    let level = &layer.levels[usize::from(key.level)];
    assert!(
        level.present.contains(key.block, key.part),
        "{key} is not there"
    );
    let name = ((key.layer.index() as u64) << 16) | (u64::from(key.level) << 8);
    let seed = scramble(name | u64::from(key.part) << 32 | u64::from(key.block));
    let bytes = level.shape.bytes(layer.format) as u64;
    Tile {
        format: layer.format,
        shape: level.shape,
        texels: (0..bytes).map(|n| scramble(seed ^ n) as u8).collect(),
    }
}
