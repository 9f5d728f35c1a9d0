//! Where texels land: against closed forms, and texel for texel.

use super::noise;
use crate::bands::{Band, Bands, first_texel, polar_rows, row_texels, tile_columns};
use crate::codes;
use crate::cut::cut;
use crate::memory::Pool;
use crate::resample::{Resampler, Sizes};
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use terrella_ground::globe::COLUMNS;
use terrella_imagery::srgb::{LINEAR_FROM_SRGB, SrgbEncoder};
use terrella_imagery::tile::{MapLayer, TILE_BORDER, Tile, TileShape};

/// Longitude of a column's centre and latitude of a row's, radians. Beyond the edges they go on.
fn place(column: f64, row: f64, width: u32, height: u32) -> (f64, f64) {
    (
        -PI + (column + 0.5) * TAU / f64::from(width),
        PI / 2.0 - (row + 0.5) * PI / f64::from(height),
    )
}

/// All rows of both lanes of a level: (lane, row, values).
fn resampled<const C: usize>(
    source: (u32, u32),
    level: (u32, u32),
    first: i64,
    count: usize,
    polar_rows: u32,
    texel: impl Fn(u32, u32) -> [f32; C],
) -> Vec<(usize, u32, Vec<f32>)> {
    let mut resampler = Resampler::<C>::new(Sizes { source, level }, first, count, polar_rows);
    let mut rows = Vec::new();
    for y in 0..source.1 {
        let row: Vec<f32> = (0..source.0).flat_map(|x| texel(x, y)).collect();
        let mut give = |lane: usize, y: u32, values: &[f32]| -> Result<(), ()> {
            rows.push((lane, y, values.to_vec()));
            Ok(())
        };
        resampler.push(y, &row, &mut give).expect("never stops");
    }
    rows
}

/// Compares every texel of the columns −5…width + 5 of all rows, and of the polar rows half a turn away, with a
/// function of longitude and latitude.
fn compare(
    source: (u32, u32),
    level: (u32, u32),
    texel: impl Fn(f64, f64) -> f64,
    expected: impl Fn(f64, f64) -> f64,
    tolerance: f64,
) {
    let count = level.0 as usize + 10;
    let rows = resampled::<1>(source, level, -5, count, 11, |x, y| {
        let (lon, lat) = place(f64::from(x), f64::from(y), source.0, source.1);
        [texel(lon, lat) as f32]
    });
    let mut own_rows = 0;
    let mut polar_rows = Vec::new();
    for (lane, y, values) in rows {
        if lane == 0 {
            assert_eq!(y, own_rows);
            own_rows += 1;
        } else {
            polar_rows.push(y);
        }
        let turned = f64::from(level.0 / 2) * lane as f64;
        for (n, value) in values.into_iter().enumerate() {
            let (lon, lat) = place(n as f64 - 5.0 + turned, f64::from(y), level.0, level.1);
            let error = (f64::from(value) - expected(lon, lat)).abs();
            assert!(
                error < tolerance,
                "{source:?} to {level:?}, lane {lane} column {} row {y}: off by {error}",
                n as i64 - 5
            );
        }
    }
    assert_eq!(own_rows, level.1);
    for y in (0..11).chain(level.1 - 11..level.1) {
        assert!(polar_rows.contains(&y), "{source:?} to {level:?}: row {y}");
    }
}

#[test]
fn means_over_whole_texels_are_those_of_the_closed_form() {
    for ratio in [1, 2, 3, 5] {
        let level = (256, 128);
        let source = (level.0 * ratio, level.1 * ratio);
        // The mean of r cosines a step apart: cos of the middle times sin(r s/2) / (r sin(s/2)).
        let shrink = |step: f64| {
            let r = f64::from(ratio);
            (r * step / 2.0).sin() / (r * (step / 2.0).sin())
        };
        let east = shrink(TAU / f64::from(source.0));
        let south = shrink(PI / f64::from(source.1));
        compare(
            source,
            level,
            |lon, lat| (lon - 0.3).cos() * (lat + 0.2).cos(),
            |lon, lat| (lon - 0.3).cos() * east * (lat + 0.2).cos() * south,
            2e-6,
        );
    }
}

#[test]
fn other_sizes_land_at_the_same_places() {
    // Smooth over the poles as well.
    let field = |lon: f64, lat: f64| {
        0.5 + lat.cos() * (0.3 * lon.cos() + 0.1 * lon.sin()) + 0.2 * lat.sin()
    };
    for (source, level) in [
        // Finer: texels counted in part; and sizes that are not quite two to one.
        ((1000, 500), (272, 136)),
        ((433, 216), (432, 216)),
        ((577, 289), (256, 128)),
        // Coarser.
        ((128, 64), (384, 192)),
        ((100, 50), (432, 216)),
        ((33, 16), (1024, 512)),
    ] {
        // A fifth of the coarser texel's step; half a texel of shift would be more than twice that.
        let step = TAU / f64::from(source.0.min(level.0)) * 0.4;
        compare(source, level, field, field, step * 0.2);
    }
}

#[test]
fn interpolation_does_not_overshoot() {
    // Bright land beside dark sea.
    let rows = resampled::<1>((64, 32), (512, 256), 0, 512, 4, |x, y| {
        [if x > 30 && y > 11 { 0.9 } else { 0.1 }]
    });
    for (_, _, values) in rows {
        assert!(values.iter().all(|value| (0.1..=0.9).contains(value)));
    }
}

#[test]
fn slopes_turn_round_beyond_a_pole() {
    // Uphill along one meridian circle: north on the one side of the pole is south on the other.
    let rows = resampled::<2>((32, 16), (512, 256), 0, 512, 4, |x, _| {
        [0.0, if x < 16 { 0.5 } else { -0.5 }]
    });
    for (lane, y, values) in rows {
        // Far from the meridians at which the sign changes.
        let north = values[2 * 128 + 1];
        let expected = if lane == 0 { 0.5 } else { -0.5 };
        assert!(
            (north - expected).abs() < 1e-6,
            "lane {lane} row {y}: {north}"
        );
    }
}

/// Row and column, and the tile there.
type PlacedTile = ((u32, u32), Tile);

/// All tiles, by row and column, of a map of noise that is as large as the level, made in passes of so many columns of blocks.
fn tiles<const C: usize>(
    shape: TileShape,
    columns: u32,
    layer: MapLayer,
) -> (Vec<u8>, Vec<PlacedTile>) {
    let (width, height) = (shape.map_width(), shape.map_height());
    let bytes = noise((width * height) as usize * C);
    let decoded = codes::decoded::<C>();
    let mut tiles = Vec::new();
    for start in (0..COLUMNS).step_by(columns as usize) {
        let columns: Range<u32> = tile_columns(shape, &(start..start + columns));
        let pool = Pool::new(u64::MAX);
        let mut bands = Bands::<C>::new(shape, columns.clone(), &pool).expect("goes on");
        let mut give = |band: Band| {
            for column in band.columns.clone() {
                let place = (band.tile_row, column);
                tiles.push((place, cut::<C>(&band, layer, column)));
            }
        };
        let mut resampler = Resampler::<C>::new(
            Sizes {
                source: (width, height),
                level: (width, height),
            },
            first_texel(shape, &columns),
            row_texels(shape, &columns),
            polar_rows(shape),
        );
        for (y, row) in bytes.chunks_exact(width as usize * C).enumerate() {
            let values: Vec<f32> = row.iter().map(|byte| decoded[usize::from(*byte)]).collect();
            let mut put = |lane, y, values: &[f32]| -> Result<(), ()> {
                bands
                    .put(lane, y, values, &mut give)
                    .then_some(())
                    .ok_or(())
            };
            resampler
                .push(y as u32, &values, &mut put)
                .expect("goes on");
        }
        bands.finish(&mut give);
    }
    (bytes, tiles)
}

/// Texel (column, row) of the map, which goes on round the date line and over the poles.
fn map_texel<const C: usize>(map: &[u8], shape: TileShape, column: i64, row: i64) -> [u8; C] {
    let (width, height) = (i64::from(shape.map_width()), i64::from(shape.map_height()));
    let beyond = row < 0 || row >= height;
    let row = if row < 0 {
        -1 - row
    } else if row >= height {
        2 * height - 1 - row
    } else {
        row
    };
    let column = (column + if beyond { width / 2 } else { 0 }).rem_euclid(width);
    let at = ((row * width + column) as usize) * C;
    std::array::from_fn(|channel| {
        let byte = map[at + channel];
        // −128 and −127 both mean −1.
        let byte = if C == 2 && byte == 128 { 129 } else { byte };
        if C == 2 && beyond {
            (byte as i8).wrapping_neg() as u8
        } else {
            byte
        }
    })
}

fn check_tiles<const C: usize>(shape: TileShape, columns: u32, layer: MapLayer) {
    let pixels = shape.pixels;
    let (map, tiles) = tiles::<C>(shape, columns, layer);
    let across = shape.tile_columns();
    let mut places: Vec<u32> = tiles
        .iter()
        .map(|((row, column), _)| row * across + column)
        .collect();
    places.sort_unstable();
    assert_eq!(places, (0..across * across / 2).collect::<Vec<_>>());
    let stored = if C == 3 { 4 } else { C };
    for ((row, column), tile) in tiles {
        assert_eq!(tile.shape, shape);
        assert_eq!(tile.texels.len(), shape.bytes(tile.format));
        for (n, texel) in tile.mip(0).chunks_exact(stored).enumerate() {
            let side = i64::from(shape.side());
            let (x, y) = (n as i64 % side, n as i64 / side);
            let at = |block: u32, offset: i64| {
                i64::from(block * pixels) + offset - i64::from(TILE_BORDER)
            };
            let expected = map_texel::<C>(&map, shape, at(column, x), at(row, y));
            assert_eq!(texel[..C], expected, "r{row}c{column} texel {x}, {y}");
            assert!(stored == C || texel[3] == 255);
        }
    }
}

#[test]
fn every_texel_of_every_tile_with_its_border_is_the_map_s() {
    // 17 has the widest padding; all widths of passes.
    let shape = |pixels| TileShape::new(pixels).expect("in range");
    for (pixels, columns) in [(16, 16), (17, 8), (17, 1), (20, 4), (24, 2)] {
        check_tiles::<1>(shape(pixels), columns, MapLayer::Water);
    }
    check_tiles::<3>(shape(17), 16, MapLayer::Day);
    check_tiles::<2>(shape(17), 4, MapLayer::Normals);
}

#[test]
fn every_texel_of_every_part_with_its_border_is_the_map_s() {
    let shape = |pixels, parts| TileShape::cut(pixels, parts).expect("in range");
    for (pixels, parts, columns) in [(17, 2, 16), (17, 2, 1), (20, 4, 4), (16, 4, 2)] {
        check_tiles::<1>(shape(pixels, parts), columns, MapLayer::Water);
    }
    check_tiles::<3>(shape(17, 2), 8, MapLayer::Day);
    check_tiles::<2>(shape(16, 4), 16, MapLayer::Normals);
}

#[test]
fn mips_are_means_in_linear_light_of_the_level_above() {
    let shape = TileShape::new(17).expect("in range");
    let (_, tiles) = tiles::<3>(shape, 16, MapLayer::Day);
    let srgb = SrgbEncoder::new();
    for (_, tile) in &tiles[..20] {
        for mip in 1..4 {
            let side = shape.mip_side(mip) as usize;
            let step = 1 << mip;
            for (n, texel) in tile.mip(mip).chunks_exact(4).enumerate() {
                let (x, y) = (n % side * step, n / side * step);
                for channel in 0..3 {
                    let base = |k: usize| {
                        let at = (y + k / step) * shape.side() as usize + x + k % step;
                        LINEAR_FROM_SRGB[usize::from(tile.mip(0)[at * 4 + channel])]
                    };
                    let mean = (0..step * step).map(base).sum::<f32>() / (step * step) as f32;
                    // Sums in another order may round to the other side.
                    assert!(
                        texel[channel].abs_diff(srgb.code(mean)) <= 1,
                        "mip {mip} {x} {y}"
                    );
                }
                assert_eq!(texel[3], 255);
            }
        }
    }
}
