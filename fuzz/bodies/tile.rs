//! A pack's tile: a byte for the format, one for the size, then the file.

use terrella_imagery::pack::{decode_tile, read_ktx2, write_ktx2};
use terrella_imagery::tile::{Tile, TileFormat, TileShape};

const FORMATS: [TileFormat; 6] = [
    TileFormat::Rgba8Srgb,
    TileFormat::R8Unorm,
    TileFormat::Rg8Snorm,
    TileFormat::Bc7Srgb,
    TileFormat::Bc4Unorm,
    TileFormat::Bc5Snorm,
];
const PIXELS: [u32; 4] = [16, 17, 33, 75];

/// Reads any bytes. An accepted tile must have the right size and be decodable.
pub fn run(data: &[u8]) {
    let [format, pixels, file @ ..] = data else {
        return;
    };
    let format = FORMATS[usize::from(*format) % FORMATS.len()];
    let pixels = PIXELS[usize::from(*pixels) % PIXELS.len()];
    let shape = TileShape::new(pixels).expect("in range");
    if let Ok(tile) = read_ktx2(file, format, shape) {
        assert_eq!(tile.texels.len(), shape.bytes(format));
        assert_eq!((tile.format, tile.shape), (format, shape));
        let again = read_ktx2(&write_ktx2(&tile), format, shape);
        assert_eq!(again.as_ref(), Ok(&tile));
        let plain = decode_tile(tile);
        assert_eq!(plain.texels.len(), shape.bytes(format.decoded()));
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for (place, format) in (0..).zip(FORMATS) {
        for (size, pixels) in (0..2).zip(PIXELS) {
            let shape = TileShape::new(pixels).expect("in range");
            let count = shape.bytes(format);
            let texels = (0..count).map(|n| (n * n / 61) as u8).collect();
            let tile = Tile {
                format,
                shape,
                texels,
            };
            let mut seed = vec![place, size];
            seed.extend(write_ktx2(&tile));
            seeds.push(seed);
        }
    }
    seeds
}
