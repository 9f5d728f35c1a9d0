//! The water mask: the share of open water in each texel, from a land mask five times finer, with the lakes of the day map.

use super::map::{Map, smooth_step};
use crate::big_pack::mask::{self, Mask};
use anyhow::{Result, ensure};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::path::Path;

/// WebGPU guarantees textures up to 8192 texels wide.
const WIDTH: usize = 8192;
const HEIGHT: usize = 4096;

/// Generates `water.png` from the folder of source data. `day` is the mended day map.
pub fn make(data: &Path, day: &Map) -> Result<Vec<u8>> {
    let mut mask = Mask::open(&data.join(crate::big_pack::LAND_MASK))?;
    let mut cover = shares(WIDTH, HEIGHT, (mask::WIDTH, mask::HEIGHT), || {
        mask.next_row(1)
    })?;
    ensure!(
        WIDTH == 2 * day.width && HEIGHT == 2 * day.height && day.channels == 3,
        "the day map is {} texels wide, not half of {WIDTH}",
        day.width
    );
    add_lakes(&mut cover, day);
    take_ice_out(&mut cover, day);
    let texels = sharpened(&cover, WIDTH);
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(&texels, WIDTH as u32, HEIGHT as u32, ExtendedColorType::L8)?;
    Ok(png)
}

/// The share of water in each of `width` × `height` texels by area, 0…1, from integer sums. `row` returns the rows of a mask of `from` texels, 0 or
/// not.
fn shares(
    width: usize,
    height: usize,
    from: (usize, usize),
    mut row: impl FnMut() -> Result<Vec<u8>>,
) -> Result<Vec<f32>> {
    // In units of 1/(from · to) a mask texel has the length `to` and a target the length `from`. A whole target has the area from.0 · from.1.
    let (columns, rows) = from;
    ensure!(
        u32::try_from(columns * rows).is_ok() && width <= columns && height <= rows,
        "a mask of {columns} x {rows} makes no map of {width} x {height}"
    );
    let mut sums = vec![0_u32; width * height];
    for y in 0..rows {
        let mut line = vec![0_u32; width];
        for (x, water) in row()?.into_iter().enumerate() {
            if water != 0 {
                for (target, share) in overlaps(x, columns, width) {
                    line[target] += share;
                }
            }
        }
        for (target, share) in overlaps(y, rows, height) {
            let sums = &mut sums[target * width..(target + 1) * width];
            // A mask row is `height` units long and a target `rows` units; `share` units overlap.
            for (sum, part) in sums.iter_mut().zip(&line) {
                *sum += part * share;
            }
        }
    }
    let whole = (columns * rows) as f32;
    Ok(sums.into_iter().map(|sum| sum as f32 / whole).collect())
}

/// The targets that texel `at` of `from` overlaps, each with the overlap in 1/`to` of a texel.
fn overlaps(at: usize, from: usize, to: usize) -> impl Iterator<Item = (usize, u32)> {
    let (start, end) = (at * to, (at + 1) * to);
    let first = start / from;
    (first..to.min(first + 2)).filter_map(move |target| {
        let covered = end
            .min((target + 1) * from)
            .saturating_sub(start.max(target * from));
        (covered > 0).then_some((target, covered as u32))
    })
}

/// The mask counts lakes as land. In the day map they are black, and the Caspian Sea is blue: limits of the greatest of red and green, and of blue
/// without red.
const BLACK: (f64, f64) = (14.0, 26.0);
const BLUE: (f64, f64) = (15.0, 60.0);

/// Adds lakes to open water: black and blue texels away from the sea, whose colour blends into that of coasts, with the soft edges around them.
fn add_lakes(cover: &mut [f32], day: &Map) {
    let (width, height) = (day.width as isize, day.height as isize);
    let sea = extreme(&halved(cover), width, height, f32::max);
    let mut lakes = vec![0.0_f32; sea.len()];
    let mut edges = lakes.clone();
    for (n, color) in day.values.chunks_exact(3).enumerate() {
        let [r, g, b] = [0, 1, 2].map(|channel| f64::from(color[channel]));
        if sea[n] > 0.02 {
            continue;
        }
        let is_blue = b > 1.5 * r + 8.0 && b > g + 4.0 && b > 20.0;
        lakes[n] = f32::from(u8::from(r.max(g) < BLACK.0 || is_blue));
        let black = 1.0 - smooth_step(BLACK.0, BLACK.1, r.max(g));
        let blue = if b > 0.8 * g {
            smooth_step(BLUE.0, BLUE.1, b - r)
        } else {
            0.0
        };
        edges[n] = black.max(blue) as f32;
    }
    let near = extreme(&lakes, width, height, f32::max);
    let shares = near.iter().zip(&lakes).zip(&edges);
    let shares = Map {
        width: day.width,
        height: day.height,
        channels: 1,
        values: shares
            .map(|((near, lake), edge)| 255.0 * lake.max(near * edge))
            .collect(),
    }
    .resampled(WIDTH, HEIGHT);
    // Shores as narrow as those of the sea.
    for (cover, lake) in cover.iter_mut().zip(&shares.values) {
        *cover = cover.max((2.0 * lake / 255.0 - 0.5).clamp(0.0, 1.0));
    }
}

/// Means of four texels of a map of [`WIDTH`].
fn halved(cover: &[f32]) -> Vec<f32> {
    let texels = (0..cover.len() / 4).map(|n| {
        let (x, y) = (2 * (n % (WIDTH / 2)), 2 * (n / (WIDTH / 2)));
        let at = |dx: usize, dy: usize| cover[(y + dy) * WIDTH + x + dx];
        (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) * 0.25
    });
    texels.collect()
}

/// White in the day map is ice: shelves and fast ice.
const ICE: (f64, f64) = (150.0, 190.0);
/// Ice farther than this from water of another colour is not the soft edge of a snowy coast, texels of the day map.
const ICE_DEPTH: isize = 2;

/// Removes ice, which is white in the day map, from open water. Soft white edges of coasts are kept.
fn take_ice_out(cover: &mut [f32], day: &Map) {
    let (width, height) = (day.width as isize, day.height as isize);
    let darkest = |x: isize, y: isize| {
        let y = y.clamp(0, height - 1);
        let texel = ((y * width + x.rem_euclid(width)) * 3) as usize;
        let [r, g, b] = [0, 1, 2].map(|channel| day.values[texel + channel]);
        f64::from(r.min(g).min(b))
    };
    let mut ice = vec![0.0_f32; (width * height) as usize];
    for y in 0..height {
        for x in 0..width {
            let here = smooth_step(ICE.0, ICE.1, darkest(x, y));
            if here > 0.0 {
                ice[(y * width + x) as usize] = here as f32;
            }
        }
    }
    // The share of sea; land beside it does not count.
    let is_land: Vec<bool> = halved(cover).iter().map(|sea| *sea < 0.1).collect();
    // Land counts as neither: it must not stop ice from reaching its coast, nor grow a white edge.
    let with_land = |land: f32, values: &[f32]| -> Vec<f32> {
        let pairs = is_land.iter().zip(values);
        pairs
            .map(|(is_land, value)| if *is_land { land } else { *value })
            .collect()
    };
    let eroded = extreme(&with_land(1.0, &ice), width, height, f32::min);
    let opened = extreme(&with_land(0.0, &eroded), width, height, f32::max);
    let opened = Map {
        width: day.width,
        height: day.height,
        channels: 1,
        values: opened
            .iter()
            .zip(&ice)
            .map(|(a, b)| 255.0 * a.min(*b))
            .collect(),
    }
    .resampled(WIDTH, HEIGHT);
    for (cover, ice) in cover.iter_mut().zip(&opened.values) {
        *cover *= 1.0 - ice / 255.0;
    }
}

/// The smallest or the largest value within [`ICE_DEPTH`] texels.
fn extreme(values: &[f32], width: isize, height: isize, of: fn(f32, f32) -> f32) -> Vec<f32> {
    let at = |values: &[f32], x: isize, y: isize| {
        values[(y.clamp(0, height - 1) * width + x.rem_euclid(width)) as usize]
    };
    let pass = |values: &[f32], dx: isize, dy: isize| -> Vec<f32> {
        (0..width * height)
            .map(|n| {
                let (x, y) = (n % width, n / width);
                let near = (-ICE_DEPTH..=ICE_DEPTH).map(|k| at(values, x + k * dx, y + k * dy));
                near.fold(values[n as usize], of)
            })
            .collect()
    };
    pass(&pass(values, 1, 0), 0, 1)
}

/// Iterations of [`sharpened`].
const ROUNDS: usize = 16;
/// Sample positions in a texel along each axis for the drawn coast.
const PLACES: usize = 6;

/// Bytes whose drawn coast encloses the given share of water in each texel.
///
/// The coast is drawn at one half of the linearly interpolated map. If texels stored their own shares of water, every island and strait narrower
/// than a texel would be lost. So each value is adjusted until the drawn coast gives the texel its share.
fn sharpened(cover: &[f32], width: usize) -> Vec<u8> {
    let height = cover.len() / width;
    let mixed: Vec<usize> = (0..cover.len())
        .filter(|n| {
            let (x, y) = (n % width, n / width);
            let here = cover[*n];
            let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
            (here > 0.0 && here < 1.0)
                || rows
                    .flat_map(|y| [0, 1, 2].map(|dx| (x + width + dx - 1, y)))
                    .any(|(x, y)| cover[y * width + x % width] != here)
        })
        .collect();
    let mut values = cover.to_vec();
    for round in 0..ROUNDS {
        // Smaller steps towards the end: a small island's area jumps with its value.
        let step = 3.0 / (round + 5) as f32;
        let drawn: Vec<f32> = mixed
            .iter()
            .map(|n| drawn_water(&values, width, n % width, n / width))
            .collect();
        for (n, drawn) in mixed.iter().zip(drawn) {
            values[*n] = (values[*n] + step * (cover[*n] - drawn)).clamp(0.0, 1.0);
        }
    }
    values
        .iter()
        .map(|value| (value * 255.0 + 0.5) as u8)
        .collect()
}

/// The share of a texel on the water side of the drawn coast.
fn drawn_water(values: &[f32], width: usize, x: usize, y: usize) -> f32 {
    let height = values.len() / width;
    let at = |x: usize, y: usize| values[y * width + x % width];
    // The nine texels around it, rows from the north.
    let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
    let near = rows.map(|y| [at(x + width - 1, y), at(x, y), at(x + 1, y)]);
    let mut sum = 0.0;
    for j in 0..PLACES {
        let (row, v) = place(j);
        for i in 0..PLACES {
            let (column, u) = place(i);
            let mix = |row: usize| near[row][column] * (1.0 - u) + near[row][column + 1] * u;
            let value = mix(row) * (1.0 - v) + mix(row + 1) * v;
            // The slope of a coast drawn at PLACES pixels per texel.
            sum += ((value - 0.5) * PLACES as f32 + 0.5).clamp(0.0, 1.0);
        }
    }
    sum / (PLACES * PLACES) as f32
}

/// The two of three texels in a row between which position `n` of the middle one lies, and its fraction.
fn place(n: usize) -> (usize, f32) {
    let at = (n as f32 + 0.5) / PLACES as f32 + 0.5;
    if at < 1.0 { (0, at) } else { (1, at - 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_areas_where_texels_do_not_fit() {
        // Five columns become two: the third is shared.
        let mut rows = [[1_u8, 1, 1, 0, 0], [0, 0, 1, 0, 1], [0, 0, 0, 0, 1]].into_iter();
        let shares = shares(2, 1, (5, 3), || {
            Ok(rows.next().unwrap_or_default().to_vec())
        });
        let expected = [(2.5 + 0.5) / 7.5, (0.5 + 0.5 + 1.0 + 1.0) / 7.5];
        for (share, expected) in shares.expect("rows enough").iter().zip(expected) {
            assert!((share - expected).abs() < 1e-6, "{share} {expected}");
        }
    }

    #[test]
    fn small_islands_and_straits_keep_their_area() {
        // An island of a third of a texel, alone in the sea, and a strait of the same width.
        let (width, height) = (24, 12);
        let mut cover = vec![1.0; width * height];
        cover[5 * width + 5] = 0.67;
        for y in 0..height {
            for x in 14..width {
                cover[y * width + x] = if x == 18 { 0.33 } else { 0.0 };
            }
        }
        let bytes = sharpened(&cover, width);
        let values: Vec<f32> = bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect();
        let sum = |x: std::ops::Range<usize>, y: std::ops::Range<usize>| -> f32 {
            y.flat_map(|y| x.clone().map(move |x| (x, y)))
                .map(|(x, y)| drawn_water(&values, width, x, y))
                .sum()
        };
        // The two texels keep their shares; beyond them only a soft edge of a sixth of a texel is drawn, over full water or land.
        let island = 1.0 - sum(5..6, 5..6);
        assert!((island - 0.33).abs() < 0.02, "{island}");
        let strait = sum(18..19, 6..7);
        assert!((strait - 0.33).abs() < 0.02, "{strait}");
        let around = (9.0 - sum(4..7, 4..7), sum(17..20, 6..7));
        assert!(around.0 < 0.5 && around.1 < 0.5, "{around:?}");
        assert_eq!((bytes[0], bytes[5 * width + 22]), (255, 0));
    }

    #[test]
    fn black_and_blue_texels_inland_are_lakes() {
        let (width, height) = (WIDTH / 2, HEIGHT / 2);
        // Sea in the west, whose colour blends into that of its coast, and dark woods.
        let mut cover: Vec<f32> = (0..WIDTH * HEIGHT)
            .map(|n| f32::from(u8::from(n % WIDTH < 2000)))
            .collect();
        let color = |n: usize| match (n / width, n % width) {
            (_, 1000..1002) => [8.0, 12.0, 40.0],
            (200..220, 2000..2020) => [3.0, 6.0, 4.0],
            (300..320, 2000..2020) => [27.0, 68.0, 124.0],
            _ => [22.0, 30.0, 14.0],
        };
        let day = Map {
            width,
            height,
            channels: 3,
            values: (0..width * height).flat_map(color).collect(),
        };
        add_lakes(&mut cover, &day);
        let at = |x: usize, y: usize| cover[2 * y * WIDTH + 2 * x];
        assert_eq!(
            (at(900, 210), at(1001, 210), at(1500, 210)),
            (1.0, 0.0, 0.0)
        );
        assert_eq!((at(2010, 210), at(2010, 310)), (1.0, 1.0));
        assert_eq!((at(2010, 260), at(2040, 210)), (0.0, 0.0));
    }

    #[test]
    fn shelves_are_ice_and_snowy_coasts_are_not() {
        let (width, height) = (WIDTH / 2, HEIGHT / 2);
        let mut cover = vec![1.0; WIDTH * HEIGHT];
        // Land north of row 100 of the day map, white; a white rim of one texel, and a shelf to row 120 east of the middle.
        cover[..200 * WIDTH].fill(0.0);
        let color = |n: usize| match (n / width, n % width) {
            (0..101, _) => 250.0,
            (101..120, 2048..) => 230.0,
            _ => 40.0,
        };
        let values = (0..width * height).flat_map(|n| [color(n); 3]).collect();
        let day = Map {
            width,
            height,
            channels: 3,
            values,
        };
        take_ice_out(&mut cover, &day);
        let at = |x: usize, y: usize| cover[2 * y * WIDTH + 2 * x];
        assert_eq!((at(500, 101), at(500, 110)), (1.0, 1.0));
        assert!(at(3000, 101) < 0.01 && at(3000, 115) < 0.01);
        assert_eq!(at(3000, 130), 1.0);
    }
}
