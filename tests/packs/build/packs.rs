//! Whole builds, read back as a program would.

use super::maps::{f32_tiff, png, read};
use image::ExtendedColorType;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrella_ground::globe::Block;
use terrella_imagery::pack::{Pack, PackTiles};
use terrella_imagery::tile::{MapLayer, Storage, TILE_BORDER, Tile, TileKey, TileSource};
use terrella_pack::{BuildOptions, Relief, build};

/// A smooth field over the sphere, 0…1; x and y go on beyond the edges.
fn field(x: f64, y: f64, width: f64) -> f64 {
    let lon = (x + 0.5) / width * std::f64::consts::TAU - std::f64::consts::PI;
    let lat = std::f64::consts::FRAC_PI_2 - (y + 0.5) / width * std::f64::consts::TAU;
    0.5 + lat.cos() * (0.3 * lon.cos() + 0.12 * lon.sin()) + 0.15 * lat.sin()
}

fn write_field(dir: &Path, name: &str, width: u32) -> PathBuf {
    let grey: Vec<u8> = (0..width * width / 2)
        .flat_map(|n| {
            let value = field(f64::from(n % width), f64::from(n / width), f64::from(width));
            ((value * 65_535.0) as u16).to_ne_bytes()
        })
        .collect();
    let path = dir.join(name);
    std::fs::write(&path, png(width, width / 2, ExtendedColorType::L16, &grey)).expect("writable");
    path
}

fn tile(tiles: &PackTiles, layer: MapLayer, level: u8, block: Block) -> Tile {
    let key = TileKey {
        layer,
        level,
        block: block.index() as u8,
        part: 0,
    };
    tiles
        .read(key, &|| false)
        .unwrap_or_else(|error| panic!("{key}: {error}"))
}

/// Corners of all blocks and of their borders, at levels finer and coarser than the map, in both storages.
#[test]
fn texels_land_where_the_map_says_at_the_corners_of_all_blocks() {
    let folder = tempfile::tempdir().expect("a folder");
    let map = write_field(folder.path(), "map.png", 720);
    let ladder = [72_u32, 40, 17];
    let options = BuildOptions {
        clouds: Some(map.clone()),
        pixels: vec![
            (MapLayer::Clouds, ladder.to_vec()),
            (MapLayer::Day, vec![16]),
        ],
        ..BuildOptions::new(&map, folder.path().join("pack"))
    };
    let manifest = build(&options, &()).expect("builds");
    let pack = Arc::new(Pack::open(&options.out).expect("a pack"));
    assert_eq!(pack.manifest(), &manifest);
    for storage in Storage::ALL {
        let tiles =
            PackTiles::new(Arc::clone(&pack), storage, true, &[MapLayer::Clouds]).expect("has it");
        for (level, pixels) in (0..).zip(ladder) {
            for block in Block::all() {
                let tile = tile(&tiles, MapLayer::Clouds, level, block);
                let side = tile.shape.side();
                let texels = tile.mip(0);
                let (b, p) = (TILE_BORDER, pixels);
                let places = [0, b, b + p - 1, side - 1];
                for (x, y) in places.into_iter().flat_map(|x| places.map(|y| (x, y))) {
                    let at = |block: u32, n: u32| f64::from(block * p + n) - f64::from(b);
                    let expected = field(at(block.column, x), at(block.row, y), f64::from(p * 16));
                    let got = f64::from(texels[(y * side + x) as usize]) / 255.0;
                    // Rounding to 8 bits, the mean over a texel, and the steps of BC4.
                    let tolerance = match storage {
                        Storage::Plain => 0.0035,
                        Storage::Bc => 0.02,
                    };
                    assert!(
                        (got - expected).abs() < tolerance,
                        "{storage:?} {pixels} {block:?} texel {x}, {y}: {got} for {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn slopes_come_from_heights_and_from_normal_maps_with_the_same_signs() {
    let folder = tempfile::tempdir().expect("a folder");
    let day = write_field(folder.path(), "day.png", 64);
    // Uphill to the east and to the north about (0, 0): 1000 m and 500 m a texel.
    let heights: Vec<f32> = (0..64 * 32)
        .map(|n| 40_000.0_f32.min((n % 64) as f32 * 100.0 + (31 - n / 64) as f32 * 50.0))
        .collect();
    let elevation = folder.path().join("heights.tif");
    std::fs::write(&elevation, f32_tiff(&heights)).expect("writable");
    // A slope of 0.25 to the east and 0.125 to the north leans the normal west and south.
    let code = |slope: f64| (128.0 - slope * 100.0) as u8;
    let normal = [code(0.25), code(0.125), 228];
    let normals = folder.path().join("normals.png");
    let texels: Vec<u8> = normal.iter().copied().cycle().take(64 * 32 * 3).collect();
    std::fs::write(&normals, png(64, 32, ExtendedColorType::Rgb8, &texels)).expect("writable");

    let slopes = |relief, out: &str| {
        let options = BuildOptions {
            relief: Some(relief),
            storages: vec![Storage::Plain],
            pixels: vec![(MapLayer::Normals, vec![16]), (MapLayer::Day, vec![16])],
            ..BuildOptions::new(&day, folder.path().join(out))
        };
        let manifest = build(&options, &()).expect("builds");
        let pack = Arc::new(Pack::open(&options.out).expect("a pack"));
        let tiles =
            PackTiles::new(pack, Storage::Plain, false, &[MapLayer::Normals]).expect("has it");
        let tile = tile(&tiles, MapLayer::Normals, 0, Block { column: 8, row: 3 });
        let at = 2 * (12 * tile.shape.side() as usize + 12);
        let slope = |n: usize| f64::from(tile.mip(0)[at + n] as i8) / 127.0;
        let exaggeration = manifest
            .layer(MapLayer::Normals)
            .and_then(|entry| entry.exaggeration);
        ([slope(0), slope(1)], exaggeration)
    };
    let (from_normals, exaggeration) = slopes(Relief::Normals(normals), "normals");
    assert_eq!(exaggeration, None);
    assert!((from_normals[0] - 0.25).abs() < 0.01, "{from_normals:?}");
    assert!((from_normals[1] - 0.125).abs() < 0.01, "{from_normals:?}");

    let relief = Relief::Elevation {
        path: elevation,
        offset_m: None,
        exaggeration: 500.0,
    };
    let (from_heights, exaggeration) = slopes(relief, "heights");
    assert_eq!(exaggeration, Some(500.0));
    // 100 m over a 64th of the equator (a texel's cosine aside), 50 m over as much of a meridian.
    let spacing_m = std::f64::consts::TAU * 6_371_008.8 / 64.0;
    assert!(
        (from_heights[0] - 500.0 * 100.0 / spacing_m).abs() < 0.012,
        "{from_heights:?}"
    );
    assert!(
        (from_heights[1] - 500.0 * 50.0 / spacing_m).abs() < 0.012,
        "{from_heights:?}"
    );
}

#[test]
fn the_map_s_own_texels_are_kept_where_the_level_has_its_size() {
    let folder = tempfile::tempdir().expect("a folder");
    let texels: Vec<u8> = (0..272 * 136 * 3)
        .map(|n: u32| (n.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    let bytes = png(272, 136, ExtendedColorType::Rgb8, &texels);
    let day = folder.path().join("day.png");
    std::fs::write(&day, &bytes).expect("writable");
    let options = BuildOptions {
        storages: vec![Storage::Plain],
        pixels: vec![(MapLayer::Day, vec![17])],
        ..BuildOptions::new(&day, folder.path().join("pack"))
    };
    build(&options, &()).expect("builds");
    let pack = Arc::new(Pack::open(&options.out).expect("a pack"));
    let tiles = PackTiles::new(pack, Storage::Plain, false, &[]).expect("has it");
    let (_, map) = read(&bytes).expect("a good map");
    for block in Block::all() {
        let tile = tile(&tiles, MapLayer::Day, 0, block);
        for y in 0..17 {
            let side = tile.shape.side() as usize;
            let start = ((y + 4) * side + 4) * 4;
            let row = tile.mip(0)[start..start + 17 * 4].chunks_exact(4);
            let at = ((block.row as usize * 17 + y) * 272 + block.column as usize * 17) * 3;
            let expected = map[at..at + 17 * 3].chunks_exact(3);
            assert!(
                row.zip(expected)
                    .all(|(got, rgb)| got[..3] == *rgb && got[3] == 255)
            );
        }
    }
}

/// First channel of a map's tiles, texel by texel, at a level of the map's own size.
fn first_channels(pack: &Path, layer: MapLayer, channels: usize) -> Vec<u8> {
    let pack = Arc::new(Pack::open(pack).expect("a pack"));
    let tiles = PackTiles::new(pack, Storage::Plain, false, &[layer]).expect("has it");
    let tile = tile(&tiles, layer, 0, Block { column: 8, row: 3 });
    let (side, border) = (tile.shape.side() as usize, TILE_BORDER as usize);
    let row = &tile.mip(0)[side * border * channels..][..side * channels];
    let texels = row.chunks_exact(channels).skip(border).take(17);
    texels.map(|texel| texel[0]).collect()
}

/// A level of 17 texels a block has the texels of a map 272 wide.
#[test]
fn alpha_is_cover_in_clouds_and_presence_in_colours() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, kind, texel: &dyn Fn(u32) -> Vec<u8>| {
        let texels: Vec<u8> = (0..272 * 136).flat_map(|n| texel(n % 272)).collect();
        let path = folder.path().join(name);
        std::fs::write(&path, png(272, 136, kind, &texels)).expect("written");
        path
    };
    let day = write("day.png", ExtendedColorType::Rgba8, &|x| {
        vec![90, 90, 90, if x % 2 == 0 { 255 } else { 0 }]
    });
    let clouds = write("clouds.png", ExtendedColorType::La8, &|x| {
        vec![255, (x % 250) as u8]
    });
    let options = BuildOptions {
        clouds: Some(clouds),
        storages: vec![Storage::Plain],
        pixels: vec![(MapLayer::Day, vec![17]), (MapLayer::Clouds, vec![17])],
        ..BuildOptions::new(day, folder.path().join("pack"))
    };
    build(&options, &()).expect("builds");
    // The block begins at texel 8 x 17 = 136.
    let cover: Vec<u8> = (136..153).collect();
    assert_eq!(first_channels(&options.out, MapLayer::Clouds, 1), cover);
    let day: Vec<u8> = (136..153)
        .map(|x| if x % 2 == 0 { 90 } else { 0 })
        .collect();
    assert_eq!(first_channels(&options.out, MapLayer::Day, 4), day);
}
