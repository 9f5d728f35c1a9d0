//! Blocks drawn with tiles of their parts: each part in place, without seams, and at the required level.

use crate::common::tiles::FunctionTiles;
use crate::common::{Rig, day_only, tilted};
use image::RgbaImage;
use std::sync::Arc;
use terrella::frames::Geodetic;
use terrella::{Atmosphere, EarthOptions, EyeView, FrameStats, Shading, Subdivision, TileOptions};
use terrella_imagery::tile::TileSource;

const SIZE: (u32, u32) = (320, 180);

/// Some waves a part both ways, and one of longitude round the whole Earth.
fn waves(lat: f64, lon: f64) -> [u8; 3] {
    let wave = |angle: f64| (110.0 + 100.0 * angle.to_radians().sin()).round() as u8;
    [wave(200.0 * lat), wave(200.0 * lon), wave(lon)]
}

type Map = fn(f64, f64) -> [u8; 3];

/// 256, 128, 64, 32, 16 texels a block, the first two of which are cut into parts or are not.
fn source(is_cut: bool) -> FunctionTiles<Map> {
    match is_cut {
        true => FunctionTiles::new(&[64, 32, 16], waves as Map).cut(&[4, 2]),
        false => FunctionTiles::new(&[256, 128, 64, 32, 16], waves as Map),
    }
}

fn options(tiles: FunctionTiles<Map>, texel_px: f64) -> EarthOptions {
    let coarsest = tiles.layers()[0].levels.len() - 1;
    let layers = day_only(tiles.whole(coarsest));
    let mut options = EarthOptions::new(layers);
    options.atmosphere = Atmosphere::None;
    options.shading = Shading::Paper;
    options.anisotropy = 1;
    options.subdivision = Subdivision::Cells(terrella::TILED_SUBDIVISION);
    options.tiles = Some(TileOptions {
        max_texel_px: texel_px,
        texture_bytes: 64_000_000,
        ..TileOptions::new(Arc::new(tiles) as Arc<dyn TileSource>)
    });
    options
}

fn drawn(rig: &mut Rig, view: &EyeView) -> (RgbaImage, FrameStats) {
    let (picture, stats, missing) = rig.draw_complete(view, view.eye_world.normalize());
    assert!(missing.is_empty(), "{missing:?}");
    (picture, stats)
}

fn over(lat: f64, lon: f64, height_m: f64, pitch_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(lat, lon, height_m);
    tilted(place, 40.0, pitch_deg, 50.0, 16.0 / 9.0)
}

fn views() -> Vec<(&'static str, EyeView)> {
    vec![
        ("middle of a block", over(33.7, 33.7, 2e5, -60.0)),
        ("corner of blocks", over(22.5, 45.0, 3e5, -50.0)),
        ("date line", over(-11.0, 179.9, 3e5, -40.0)),
        ("towards the horizon", over(20.0, 100.0, 1e5, -10.0)),
        ("near a pole", over(84.0, 10.0, 4e5, -70.0)),
    ]
}

/// How far two pictures differ, of 255: at 99.9 % of pixels, and at most.
fn differ(a: &RgbaImage, b: &RgbaImage) -> (u8, u8) {
    let pairs = a.pixels().zip(b.pixels());
    let off = pairs.map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0));
    let mut off: Vec<u8> = off.collect();
    off.sort_unstable();
    (off[off.len() * 999 / 1000], off[off.len() - 1])
}

#[test]
fn parts_show_what_whole_tiles_show() {
    // The finest level everywhere.
    let mut whole = Rig::new(&options(source(false), 1e-9), SIZE);
    let mut cut = Rig::new(&options(source(true), 1e-9), SIZE);
    assert!(cut.earth.diagnostics().features_on.contains(&"parts"));
    assert!(!whole.earth.diagnostics().features_on.contains(&"parts"));
    for (name, view) in views() {
        let (expected, of_whole) = drawn(&mut whole, &view);
        let (picture, stats) = drawn(&mut cut, &view);
        let (most_of_all, most) = differ(&expected, &picture);
        println!(
            "{name}: {most_of_all} of 255 at 99.9 %, {most} at most; {:?}",
            stats.day_levels
        );
        // Coordinates in a smaller tile are rounded otherwise; towards the horizon mip levels end where tiles do.
        assert!(most_of_all <= 2, "{name}: {most_of_all}, {most}");
        assert_eq!(stats.tiles.fallbacks, 0);
        assert!(stats.day_levels[0] > 0 && of_whole.day_levels[0] > 0);
        assert_eq!(stats.day_levels[1..].iter().sum::<u32>(), 0, "{name}");
    }
}

#[test]
fn parts_are_as_fine_as_they_are_near() {
    // 9.8 km a texel at the finest level, 1.9 km a pixel below the eye: coarser levels away from it.
    let mut rig = Rig::new(&options(source(true), 4.5), SIZE);
    let view = over(20.0, 100.0, 4e5, -25.0);
    let (_, stats) = drawn(&mut rig, &view);
    println!("{:?} of {:?}", stats.day_levels, stats.tiles.requested);
    let levels = stats.day_levels;
    assert!(levels[0] > 0 && levels[1] > levels[0], "{levels:?}");
    // From afar no part is requested.
    let (_, far) = drawn(&mut rig, &over(20.0, 100.0, 2e7, -90.0));
    assert_eq!(far.tiles.requested[..2], [0, 0]);
}

#[test]
fn where_parts_are_not_there_their_block_s_tile_is() {
    let view = over(33.7, 33.7, 2e5, -60.0);
    let blocks = FunctionTiles::new(&[64, 32, 16], waves as Map);
    let mut whole = Rig::new(&options_of_blocks(blocks), SIZE);
    let (expected, _) = drawn(&mut whole, &view);
    // No part can be read: the tiles of the whole blocks stand in for all of them, and nothing else is waited for.
    let none = source(true).keep(0, |_| false).keep(1, |_| false);
    let mut rig = Rig::new(&options(none, 1e-9), SIZE);
    let (picture, stats) = drawn(&mut rig, &view);
    assert_eq!(differ(&expected, &picture), (0, 0));
    assert_eq!((stats.tiles.fallbacks, stats.day_levels[0]), (0, 0));
    assert!(stats.tiles.requested[0] > 0);
}

fn options_of_blocks(tiles: FunctionTiles<Map>) -> EarthOptions {
    let mut options = options(source(true), 1e-9);
    options.layers = day_only(tiles.whole(2));
    options.tiles = Some(TileOptions {
        max_texel_px: 1e-9,
        texture_bytes: 64_000_000,
        ..TileOptions::new(Arc::new(tiles) as Arc<dyn TileSource>)
    });
    options
}

#[test]
fn a_frame_is_drawn_before_any_part_is_there() {
    let mut rig = Rig::new(&options(source(true), 1e-9), SIZE);
    let view = over(33.7, 33.7, 2e5, -60.0);
    let sun = view.eye_world.normalize();
    let mut pictures = Vec::new();
    for _ in 0..400 {
        let (picture, stats) = rig.draw(&view, sun);
        assert!(picture.pixels().all(|pixel| pixel.0[..3] != [0, 0, 0]));
        let is_done = stats.tiles.fallbacks == 0 && stats.tiles.hits > 0;
        pictures.push(picture);
        if is_done && stats.tiles.queued + stats.tiles.loading + stats.tiles.waiting_upload == 0 {
            break;
        }
    }
    let (complete, _) = drawn(&mut rig, &view);
    assert_eq!(pictures.last(), Some(&complete));
    assert!(
        differ(&pictures[0], &complete).1 > 20,
        "nothing was waited for"
    );
}
