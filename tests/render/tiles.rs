//! Blocks drawn with tiles: in the right place, without seams between levels, like the whole map; never a hole.

use crate::common::tiles::FunctionTiles;
use crate::common::{self, Rig, day_only, down, looks_at, ray, tilted};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{
    Atmosphere, Earth, EarthOptions, EyeView, FrameRequest, Shading, Sky, TILED_SUBDIVISION,
    TileOptions,
};
use terrella_ground::globe::LevelRule;
use terrella_imagery::EarthLayers;
use terrella_imagery::tile::{MapLayer, TileSource};

const SIZE: (u32, u32) = (320, 180);
const LADDER: [u32; 3] = [128, 64, 32];

type Map = fn(f64, f64) -> [u8; 3];

fn source(map: Map) -> FunctionTiles<Map> {
    FunctionTiles::new(&LADDER, map)
}

/// Display values as they are in the map, with the Sun behind the eye.
fn options(tiles: Arc<FunctionTiles<Map>>) -> EarthOptions {
    let layers = day_only(tiles.whole(LADDER.len() - 1));
    let mut options = bare(layers);
    options.tiles = Some(TileOptions {
        // The finest level that there is.
        max_texel_px: 1e-9,
        texture_bytes: 64_000_000,
        ..TileOptions::new(tiles as Arc<dyn TileSource>)
    });
    options
}

fn bare(layers: EarthLayers) -> EarthOptions {
    let mut options = EarthOptions::new(layers);
    options.atmosphere = Atmosphere::None;
    options.shading = Shading::Paper;
    options.anisotropy = 1;
    // A pixel whose ray meets the ground in the next block finds its texel in the border only if the mesh is fine.
    options.subdivision = terrella::Subdivision::Cells(TILED_SUBDIVISION);
    options
}

/// One wave a block both ways, and one of longitude round the whole Earth.
fn waves(lat: f64, lon: f64) -> [u8; 3] {
    let wave = |angle: f64| (110.0 + 100.0 * angle.sin()).round() as u8;
    let (lat, lon) = (lat.to_radians(), lon.to_radians());
    [wave(16.0 * lat), wave(16.0 * lon), wave(lon)]
}

/// Nearly plain, as the sea is.
fn ocean(lat: f64, lon: f64) -> [u8; 3] {
    let swell = 4.0 * (lat.to_radians() * 3.0).sin() * (lon.to_radians() * 2.0).cos();
    [20, 50, (120.0 + swell).round() as u8]
}

/// So many waves round the Earth, which have nothing to do with the grid of blocks.
fn uneven(lat: f64, lon: f64, waves: f64) -> [u8; 3] {
    let wave = |angle: f64| (120.0 + 80.0 * angle.sin()).round() as u8;
    let (lat, lon) = (lat.to_radians(), lon.to_radians());
    [
        wave(waves * lat + 0.7),
        wave(waves * lon + 1.9),
        wave(waves * (lat + lon) + 0.3),
    ]
}

fn hills(lat: f64, lon: f64) -> [u8; 3] {
    uneven(lat, lon, 29.0)
}

/// As much detail as the coarsest map can hold: 4 of its texels a wave.
fn detail(lat: f64, lon: f64) -> [u8; 3] {
    uneven(lat, lon, 127.0)
}

fn views(aspect: f64) -> Vec<(&'static str, EyeView)> {
    let at = Geodetic::from_degrees;
    vec![
        ("north pole", down(at(90.0, 0.0, 2e6), 50.0, aspect)),
        ("south pole", down(at(-88.0, 30.0, 1e6), 50.0, aspect)),
        ("date line", down(at(10.0, 180.0, 1e6), 50.0, aspect)),
        (
            "corner",
            tilted(at(22.5, 45.0, 6e5), 80.0, -50.0, 40.0, aspect),
        ),
        ("whole disc", down(at(20.0, -100.0, 3e7), 26.0, aspect)),
    ]
}

/// Where a pixel looks at the ground, well inside the limb and not at a pole's last texels.
fn is_steady(view: &EyeView, x: u32, y: u32) -> Option<Geodetic> {
    let place = looks_at(view, x, y, SIZE)?;
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let is_steady = -up.dot(ray(view, x, y, SIZE)) > 0.25 && place.lat_rad.abs() < 1.565;
    is_steady.then_some(place)
}

#[test]
fn tiles_lie_where_the_map_says() {
    let mut rig = Rig::new(&options(Arc::new(source(waves))), SIZE);
    for (name, view) in views(rig.aspect()) {
        let sun = view.eye_world.normalize();
        let (picture, stats, missing) = rig.draw_complete(&view, sun);
        assert!(missing.is_empty(), "{missing:?}");
        assert_eq!(stats.tiles.fallbacks, 0);
        let (mut worst, mut count) = (0.0_f64, 0);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let Some(place) = is_steady(&view, x, y) else {
                continue;
            };
            let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
            let lit = (up.dot(sun) + 0.3).clamp(0.0, 1.0) * 1.1;
            let want = waves(place.lat_rad.to_degrees(), place.lon_rad.to_degrees());
            for (k, want) in want.into_iter().enumerate() {
                // Where a pixel covers much of a wave, filtering flattens it.
                let flat = k == 1 && place.lat_rad.abs() > 80_f64.to_radians();
                if flat || (name == "whole disc" && k < 2) {
                    continue;
                }
                let off = f64::from(pixel.0[k]) - f64::from(want) * lit;
                worst = worst.max(off.abs());
            }
            count += 1;
        }
        println!("{name}: worst {worst:.2} of 255 over {count} pixels");
        assert!(count > 5_000, "{name}: only {count} pixels");
        // Half a texel of the finest level aside is 2.5 units at the steepest; rounding of map, mips and target are 2.
        assert!(worst < 3.5, "{name}: off by {worst} of 255");
    }
}

#[test]
fn tiles_draw_the_same_as_the_whole_map() {
    // From afar the detail would be as fine as the smallest mip level, whose texels are displaced by half a texel in a tile.
    for (map, is_for_near) in [(detail as Map, true), (hills as Map, false)] {
        let tiles = Arc::new(source(map));
        let whole = EarthLayers {
            day: tiles.whole(0),
            ..options(tiles.clone()).layers
        };
        let mut of_tiles = Rig::new(&options(tiles), SIZE);
        let mut of_whole = Rig::new(&bare(whole), SIZE);
        for (name, view) in views(of_tiles.aspect()) {
            if is_for_near && name == "whole disc" {
                continue;
            }
            let sun = view.eye_world.normalize();
            let (with, _, missing) = of_tiles.draw_complete(&view, sun);
            assert!(missing.is_empty());
            let (without, _) = of_whole.draw(&view, sun);
            let (mut worst, mut sum, mut count) = (0, 0.0, 0);
            for (x, y, pixel) in with.enumerate_pixels() {
                let Some(place) = is_steady(&view, x, y) else {
                    continue;
                };
                // A tile has four mip levels. Its finest level is forced here on a view that needs a coarser one, and towards the limb would need a
                // fifth mip level.
                let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
                if name == "whole disc" && -up.dot(ray(&view, x, y, SIZE)) < 0.6 {
                    continue;
                }
                for k in 0..3 {
                    let off = pixel.0[k].abs_diff(without.get_pixel(x, y).0[k]);
                    worst = worst.max(off);
                    sum += f64::from(off);
                }
                count += 3;
            }
            let mean = sum / f64::from(count);
            println!("{name}: worst {worst}, mean {mean:.3} of 255 over {count} values");
            let (most, most_mean) = if name == "whole disc" {
                (10, 1.0)
            } else {
                (3, 0.1)
            };
            assert!(worst <= most && mean < most_mean, "{name}: {worst} {mean}");
        }
    }
}

/// Mean and largest colour step between neighbouring pixels, for pairs inside a block and for pairs in two blocks.
fn steps(picture: &RgbaImage, view: &EyeView) -> ([f64; 2], [f64; 2]) {
    let (mut sums, mut worst, mut counts) = ([0.0; 2], [0.0_f64; 2], [0.0; 2]);
    let block = |place: Geodetic| {
        let column = (place.lon_rad.to_degrees() + 180.0) / 22.5;
        let row = (90.0 - place.lat_rad.to_degrees()) / 22.5;
        (column.floor(), row.floor())
    };
    for y in 0..SIZE.1 - 1 {
        for x in 0..SIZE.0 - 1 {
            let Some(here) = is_steady(view, x, y) else {
                continue;
            };
            for (x2, y2) in [(x + 1, y), (x, y + 1)] {
                let Some(there) = is_steady(view, x2, y2) else {
                    continue;
                };
                let across = usize::from(block(here) != block(there));
                let (a, b) = (picture.get_pixel(x, y), picture.get_pixel(x2, y2));
                let step = (0..3)
                    .map(|k| f64::from(a.0[k].abs_diff(b.0[k])))
                    .fold(0.0, f64::max);
                sums[across] += step;
                worst[across] = worst[across].max(step);
                counts[across] += 1.0;
            }
        }
    }
    assert!(counts[1] > 50.0, "too few pairs across edges: {counts:?}");
    ([sums[0] / counts[0], sums[1] / counts[1]], worst)
}

#[test]
fn edges_between_blocks_are_no_steps_whatever_their_levels() {
    let at = Geodetic::from_degrees;
    for (name, map) in [
        ("ocean", ocean as Map),
        ("hills", hills as Map),
        ("detail", detail as Map),
    ] {
        for fine in 0..LADDER.len() {
            for coarse in fine..LADDER.len() {
                // A chessboard of the two levels.
                let is_white = |block: u8| (block % 16 + block / 16).is_multiple_of(2);
                let has = |level: usize| {
                    move |block| {
                        (level == fine && is_white(block)) || (level == coarse && !is_white(block))
                    }
                };
                let tiles = source(map).keep(0, has(0)).keep(1, has(1));
                let mut rig = Rig::new(&options(Arc::new(tiles)), SIZE);
                for (place, view) in [
                    ("corner", down(at(22.5, 45.0, 2.5e6), 60.0, rig.aspect())),
                    (
                        "date line",
                        down(at(-22.5, 180.0, 2.5e6), 60.0, rig.aspect()),
                    ),
                    ("far", down(at(0.0, 0.0, 2e7), 35.0, rig.aspect())),
                ] {
                    let (picture, stats, missing) =
                        rig.draw_complete(&view, view.eye_world.normalize());
                    assert!(missing.is_empty() && stats.tiles.fallbacks == 0);
                    let (mean, worst) = steps(&picture, &view);
                    println!(
                        "{name} {fine}|{coarse} {place}: mean {:.2} inside, {:.2} across; worst {} and {}",
                        mean[0], mean[1], worst[0], worst[1]
                    );
                    // Edges are few and meet the waves at a few phases only: their mean may differ by chance. Where a sharp block meets one that
                    // barely resolves the waves, part of their contrast ends there.
                    let blur = if name == "detail" && coarse > fine {
                        1.35
                    } else {
                        1.15
                    };
                    assert!(
                        mean[1] <= mean[0] * blur + 0.4 && worst[1] <= worst[0],
                        "{name}, levels {fine} and {coarse}, {place}: {mean:?} {worst:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn without_tiles_the_coarsest_map_is_drawn_and_said_so() {
    let tiles = Arc::new(source(waves));
    tiles.broken.store(true, Ordering::Relaxed);
    let coarse = options(tiles.clone()).layers;
    let mut of_tiles = Rig::new(&options(tiles.clone()), SIZE);
    let mut of_coarse = Rig::new(&bare(coarse), SIZE);
    let view = down(
        Geodetic::from_degrees(10.0, 20.0, 1e6),
        50.0,
        of_tiles.aspect(),
    );
    let sun = view.eye_world.normalize();
    let (expected, _) = of_coarse.draw(&view, sun);
    let (picture, stats) = of_tiles.draw(&view, sun);
    assert!(
        stats.tiles.fallbacks > 0 && stats.tiles.hits == 0,
        "{:?}",
        stats.tiles
    );
    let worst = worst_difference(&picture, &expected);
    assert!(worst <= 1, "{worst}");
    // Everything fails: nothing waits for it, and it is counted.
    let (picture, stats, _) = of_tiles.draw_complete(&view, sun);
    assert!(stats.tiles.failures > 0, "{:?}", stats.tiles);
    assert!(worst_difference(&picture, &expected) <= 1);
    assert!(stats.texels_per_pixel > 0.0);
}

fn worst_difference(a: &RgbaImage, b: &RgbaImage) -> u8 {
    a.iter()
        .zip(b.iter())
        .map(|(a, b)| a.abs_diff(*b))
        .max()
        .unwrap_or(0)
}

#[test]
fn uploads_keep_their_budget_and_the_picture_sharpens() {
    let mut given = options(Arc::new(source(waves)));
    if let Some(tiles) = &mut given.tiles {
        tiles.upload_bytes = 50_000;
    }
    let mut rig = Rig::new(&given, SIZE);
    let view = down(Geodetic::from_degrees(10.0, 20.0, 3e6), 50.0, rig.aspect());
    let sun = view.eye_world.normalize();
    let (mut before, mut sharp) = (0, 0.0);
    for frame in 0.. {
        let (_, stats) = rig.draw(&view, sun);
        let uploaded = stats.tiles.uploaded_bytes - before;
        assert!(uploaded <= 50_000, "{uploaded} bytes in frame {frame}");
        assert!(stats.texels_per_pixel >= sharp, "blunter in frame {frame}");
        (before, sharp) = (stats.tiles.uploaded_bytes, stats.texels_per_pixel);
        if stats.tiles.fallbacks == 0 {
            assert!(frame > 2, "all at once cannot be within the budget");
            break;
        }
        assert!(frame < 5_000, "never complete: {:?}", stats.tiles);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
}

#[test]
fn a_dark_side_wants_no_day_tiles() {
    let mut rig = Rig::new(&options(Arc::new(source(waves))), SIZE);
    let view = down(Geodetic::from_degrees(0.0, 0.0, 1e6), 50.0, rig.aspect());
    let (_, stats, _) = rig.draw_complete(&view, DVec3::NEG_X);
    assert_eq!(stats.tiles.requested.iter().sum::<u32>(), 0);
    let (_, stats, _) = rig.draw_complete(&view, DVec3::X);
    assert!(stats.tiles.requested.iter().sum::<u32>() > 0);
}

#[test]
fn a_night_under_the_moon_wants_day_tiles() {
    let mut given = options(Arc::new(source(waves)));
    given.shading = Shading::Sunlit;
    let requested = |options: &EarthOptions, moon: Option<DVec3>| {
        let mut rig = Rig::new(options, SIZE);
        let view = down(Geodetic::from_degrees(0.0, 0.0, 1e6), 50.0, rig.aspect());
        let sky = Sky {
            moon_itrf_m: moon.map(|direction| direction * 3.844e8),
            ..Sky::new(DVec3::NEG_X)
        };
        let stats = rig
            .earth
            .prepare(&common::gpu().queue, FrameRequest::new(&view, &sky, SIZE));
        stats.tiles.requested.iter().sum::<u32>()
    };
    // A Moon that is not drawn lights nothing.
    assert_eq!(requested(&given, Some(DVec3::X)), 0);
    given.light.moonlight = true;
    assert!(requested(&given, Some(DVec3::X)) > 0);
    // On the other side, and no Moon at all.
    assert_eq!(requested(&given, Some(DVec3::new(-0.8, 0.6, 0.0))), 0);
    assert_eq!(requested(&given, None), 0);
}

#[test]
fn expected_views_are_loaded_before_they_come() {
    let mut rig = Rig::new(&options(Arc::new(source(waves))), SIZE);
    let aspect = rig.aspect();
    let at = |lon| down(Geodetic::from_degrees(10.0, lon, 5e5), 40.0, aspect);
    let (here, there) = (at(0.0), at(40.0));
    let sun = DVec3::new(0.9, 0.4, 0.1).normalize();
    rig.earth.prefetch(&[there]);
    for _ in 0..2_000 {
        let (_, stats) = rig.draw(&here, sun);
        let tiles = stats.tiles;
        if tiles.fallbacks + tiles.queued + tiles.loading + tiles.waiting_upload == 0 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let (_, stats) = rig.draw(&there, sun);
    assert_eq!(stats.tiles.fallbacks, 0, "{:?}", stats.tiles);
    assert!(stats.tiles.hits > 0);
    // A place that was not expected is not resident.
    let (_, stats) = rig.draw(&at(-60.0), sun);
    assert!(stats.tiles.fallbacks > 0);
}

#[test]
fn the_papers_rule_gives_levels_by_distance() {
    let mut given = options(Arc::new(source(waves)));
    if let Some(tiles) = &mut given.tiles {
        tiles.rule = LevelRule::Paper;
    }
    let mut rig = Rig::new(&given, SIZE);
    // Three levels: the paper's last three. The coarsest is not counted, it is always there.
    for (height_m, level) in [
        (1e5, Some(0)),
        (1.5e6, Some(0)),
        (5e6, Some(1)),
        (3e7, None),
    ] {
        let place = Geodetic::from_degrees(11.0, 11.0, height_m);
        let view = down(place, 2.0, rig.aspect());
        let (_, stats, _) = rig.draw_complete(&view, view.eye_world.normalize());
        for (n, wanted) in stats.tiles.requested.iter().enumerate() {
            assert_eq!(*wanted > 0, level == Some(n), "{height_m} m, level {n}");
        }
    }
}

#[test]
fn compressed_tiles_need_a_device_that_reads_them() {
    let gpu = common::gpu();
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("terrella test without compressed textures"),
        ..Default::default()
    };
    let opened = pollster::block_on(gpu.adapter.request_device(&descriptor));
    let (device, queue) = opened.expect("a device");
    let rejected = |tiles: FunctionTiles<Map>| {
        let earth = Earth::new(&device, &queue, &options(Arc::new(tiles)));
        earth.err().map(|error| error.to_string())
    };
    assert_eq!(rejected(source(ocean)), None);
    let words = rejected(source(ocean).compressed()).expect("rejected");
    assert!(
        words.contains("TEXTURE_COMPRESSION_BC") && words.contains("decode"),
        "{words}"
    );
}

#[test]
fn tiles_of_a_map_that_is_not_drawn_are_rejected() {
    let gpu = common::gpu();
    let tiles = source(ocean).of(MapLayer::Water);
    let error = Earth::new(&gpu.device, &gpu.queue, &options(Arc::new(tiles))).err();
    let words = error.expect("rejected").to_string();
    assert!(words.contains("water"), "{words}");
}
