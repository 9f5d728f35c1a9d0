//! Separation of land and sea: with a water map the day map's colours are the land's alone, and its alpha is the depth of the sea.
//!
//! The coast is drawn from the water map, which is sharper than the day map. The day map's own coast is a soft transition from land to painted sea,
//! which must not be visible on either side. Texels at the coast therefore get the colour of the nearby land, some way out to sea. Colours farther
//! out are kept, and are visible only where the water map is not drawn.

mod neighbours;

use super::layer::LayerImage;
use neighbours::{each_row_near, neighbours};
use std::borrow::Cow;

/// A texel with less water than this is land and nothing else.
const DRY: u8 = 10;
/// Land beside texels with more water than this is darkened by it.
const NO_LONGER_DRY: u8 = 50;
/// Water value above which a texel's colour is not representative of land.
const MOSTLY_WET: u8 = 215;
/// A texel with more water than this is sea and nothing else.
const WET: u8 = 250;
/// Rings of texels that land is grown by: first from land alone; then also from islands too far from any.
const RINGS: [usize; 2] = [8, 12];
/// How often the colours of islands are averaged with those around them: texels of little land have colours of much noise.
const ISLAND_SMOOTHINGS: usize = 2;
/// Texels around one in which the colour of its sea is looked for.
const SEA_REACH: isize = 3;
/// Least share of land for which the colour of a mixture is divided by it: noise grows as much.
const LEAST_DRY: f32 = 0.3;

/// Depth of the sea's floor for alpha 1, metres: deeper floors reflect no light that leaves the water.
pub const FLOOR_SEEN_M: f64 = 40.0;

/// How much of each texel of a map of this size is water, 0…255, from the water map's level that is nearest in size.
pub(super) fn water_at(water: &LayerImage, width: usize, height: usize) -> Cow<'_, [u8]> {
    let level = water.level_of_width(width);
    let (from_width, from_height) = water.level_size(level);
    let (from_width, from_height) = (from_width as usize, from_height as usize);
    let Some(texels) = water.levels.get(level) else {
        return vec![0; width * height].into();
    };
    if (from_width, from_height) == (width, height) {
        return texels.into();
    }
    let nearest =
        |at: usize, from: usize, to: usize| ((2 * at + 1) * from / (2 * to)).min(from - 1);
    let columns: Vec<usize> = (0..width).map(|x| nearest(x, from_width, width)).collect();
    let rows = (0..height).map(|y| nearest(y, from_height, height) * from_width);
    rows.flat_map(|row| columns.iter().map(move |x| texels[row + x]))
        .collect()
}

/// Texels of a row that are looked at together.
const RUN: usize = 16;

/// State of a texel while land grows.
const IS_LAND: u8 = 1;
const IS_QUEUED: u8 = 2;

/// Spreads the land's colours over the coast, in RGBA texels `width` to a row.
pub(super) fn grow_land(rgba: &mut [u8], width: usize, water: &LayerImage) {
    let height = rgba.len() / 4 / width.max(1);
    let water = water_at(water, width, height);
    let near = |n: usize| neighbours(n, width, height);
    let mut known = Vec::with_capacity(water.len());
    each_row_near(&water, width, |here, wettest_near| {
        let is_pure = |(water, near): (&u8, &u8)| *water < DRY && *near < NO_LONGER_DRY;
        let land = here.iter().zip(wettest_near).map(is_pure);
        known.extend(land.map(|is_land| if is_land { IS_LAND } else { 0 }));
    });
    let (mut ring, mut islands) = (Vec::new(), Vec::new());
    let mut first = 0;
    each_row_near(&known, width, |here, land_near| {
        let wet = &water[first..first + here.len()];
        for part in (0..here.len()).step_by(RUN) {
            let end = (part + RUN).min(here.len());
            let all = |row: &[u8], value: u8| row[part..end].iter().all(|at| *at == value);
            // Most of a map: land alone, or open sea.
            if all(here, IS_LAND) || all(land_near, 0) && all(wet, u8::MAX) {
                continue;
            }
            for x in part..end {
                if here[x] == IS_LAND {
                    continue;
                }
                if land_near[x] > 0 {
                    ring.push(first + x);
                }
                if wet[x] < MOSTLY_WET {
                    islands.push(first + x);
                }
            }
        }
        first += here.len();
    });
    ring.iter().for_each(|n| known[*n] |= IS_QUEUED);
    // Texels of a ring are grown each by itself, so that their order is of no account.
    for round in 0..RINGS[1] {
        if round == RINGS[0] {
            islands.retain(|n| known[*n] & IS_LAND == 0);
            let colors: Vec<_> = islands
                .iter()
                .map(|n| without_sea(rgba, *n, &water, width))
                .collect();
            for (n, color) in islands.iter().zip(colors) {
                rgba[4 * n..4 * n + 3].copy_from_slice(&color);
                known[*n] |= IS_LAND;
            }
            for island in &islands {
                for n in near(*island).as_slice() {
                    if known[*n] & IS_QUEUED == 0 {
                        known[*n] |= IS_QUEUED;
                        ring.push(*n);
                    }
                }
            }
            ring.retain(|n| known[*n] & IS_LAND == 0);
        }
        let grown: Vec<_> = ring
            .iter()
            .filter_map(|n| Some((*n, mean_land(rgba, &known, near(*n).as_slice())?)))
            .collect();
        for (n, color) in &grown {
            rgba[4 * n..4 * n + 3].copy_from_slice(color);
            known[*n] |= IS_LAND;
        }
        ring.clear();
        for (n, _) in &grown {
            for n in near(*n).as_slice() {
                if known[*n] == 0 {
                    known[*n] = IS_QUEUED;
                    ring.push(*n);
                }
            }
        }
    }
    for _ in 0..ISLAND_SMOOTHINGS {
        let smooth: Vec<_> = islands
            .iter()
            .map(|n| mean_land(rgba, &known, &[near(*n).as_slice(), &[*n]].concat()))
            .collect();
        for (n, color) in islands.iter().zip(smooth) {
            if let Some(color) = color {
                rgba[4 * n..4 * n + 3].copy_from_slice(&color);
            }
        }
    }
}

/// The mean colour of the land among some texels; `None` if there is none.
fn mean_land(rgba: &[u8], known: &[u8], texels: &[usize]) -> Option<[u8; 3]> {
    let (rgba, _) = rgba.as_chunks::<4>();
    // Sums of up to 257 bytes in three lanes of 16 bits.
    let (mut sums, mut count) = (0_u64, 0_u64);
    for n in texels {
        let texel = u64::from(u32::from_le_bytes(rgba[*n]));
        let lanes = texel & 0xFF | (texel & 0xFF00) << 8 | (texel & 0xFF_0000) << 16;
        let is_land = u64::from(known[*n] & IS_LAND);
        sums += lanes * is_land;
        count += is_land;
    }
    let count = count as u32;
    let mean = |lane: u32| (((sums >> (16 * lane)) as u16 as u32 + count / 2) / count) as u8;
    (count > 0).then(|| [mean(0), mean(1), mean(2)])
}

/// The mean colour of texels; `None` if there are none.
fn mean_color(rgba: &[u8], texels: impl Iterator<Item = usize>) -> Option<[u8; 3]> {
    let (rgba, _) = rgba.as_chunks::<4>();
    let (mut sums, mut count) = ([0_u32; 3], 0);
    for n in texels {
        let [red, green, blue, _] = rgba[n].map(u32::from);
        sums = [sums[0] + red, sums[1] + green, sums[2] + blue];
        count += 1;
    }
    (count > 0).then(|| sums.map(|sum| ((sum + count / 2) / count) as u8))
}

/// A mixed texel's colour after the sea's share is subtracted.
fn without_sea(rgba: &[u8], n: usize, water: &[u8], width: usize) -> [u8; 3] {
    let (x, y) = ((n % width) as isize, (n / width) as isize);
    let height = (water.len() / width) as isize;
    let near =
        (-SEA_REACH..=SEA_REACH).flat_map(|dy| (-SEA_REACH..=SEA_REACH).map(move |dx| (dx, dy)));
    let near = near
        .filter(|(_, dy)| (0..height).contains(&(y + dy)))
        .map(|(dx, dy)| (y + dy) as usize * width + (x + dx).rem_euclid(width as isize) as usize);
    let here = [0, 1, 2].map(|channel| rgba[4 * n + channel]);
    let Some(sea) = mean_color(rgba, near.filter(|n| water[*n] > WET)) else {
        return here;
    };
    let dry = (f32::from(255 - water[n]) / 255.0).max(LEAST_DRY);
    let mut color = [0, 1, 2].map(|channel| {
        let (here, sea) = (f32::from(here[channel]), f32::from(sea[channel]));
        (sea + (here - sea) / dry).clamp(0.0, 255.0)
    });
    // Noise of the mixture that is bluer or redder than any land is desaturated.
    color[2] = color[2].min(0.9 * color[1].max(color[0]));
    color[0] = color[0].max(0.8 * color[1]);
    color[1] = color[1].max(0.65 * color[0]);
    color[2] = color[2].max(0.35 * color[0]);
    color.map(|value| value as u8)
}

/// Latitude up to which the sea is assumed to be clear, and from which on it hides its floor, degrees. Shelf seas of higher latitudes are green or
/// brown with plankton and suspended matter (Case 2 waters), and there is no map of them here.
const CLEAR_DEG: [f64; 2] = [28.0, 40.0];
/// Texels that depths are carried on towards a coast.
const FLOOR_RINGS: usize = 3;

/// How much green light the water leaves of that from the sea's floor: what shows, and so what is averaged.
pub(super) struct SeaFloor {
    width: usize,
    height: usize,
    /// 0…255.
    light: Vec<u8>,
}

/// Down to the floor and up again, twice the diffuse attenuation of clear water for green light, per metre.
const ATTENUATION_PER_M: f64 = 0.124;
/// Water higher than this above the sea is a lake: its depth is unknown, and its floor is taken to be out of sight. Metres.
const LAKE_M: f64 = 20.0;
/// From this depth on less than 1e-10 of a code is left of the light, metres.
const DARK_M: f32 = 250.0;

impl SeaFloor {
    /// From elevations of the whole Earth, metres + `offset_m`.
    ///
    /// A texel at the coast holds the mean of land and sea floor, which is not a depth: it gets that of nearby open water.
    pub fn new(
        width: usize,
        height: usize,
        elevation: &[u16],
        offset_m: u16,
        water: &LayerImage,
    ) -> Self {
        let share = water_at(water, width, height);
        let depth_of =
            |n: usize| (share[n] > 250).then(|| f64::from(offset_m) - f64::from(elevation[n]));
        let mut depths_m: Vec<f32> = (0..width * height)
            .map(|n| match depth_of(n) {
                None => f32::NAN,
                Some(depth_m) if depth_m < -LAKE_M => DARK_M,
                Some(depth_m) => depth_m.max(0.0) as f32,
            })
            .collect();
        let (mut waiting, mut first) = (Vec::new(), 0);
        each_row_near(&share, width, |here, wettest_near| {
            let places = (first..).zip(wettest_near);
            let is_coast = |(n, near): &(usize, &u8)| depths_m[*n].is_nan() && **near > 25;
            waiting.extend(places.filter(is_coast).map(|(n, _)| n));
            first += here.len();
        });
        for _ in 0..FLOOR_RINGS {
            let mut found = Vec::new();
            waiting.retain(|n| {
                let near = neighbours(*n, width, height);
                let near = near.as_slice().iter().map(|n| depths_m[*n]);
                let known = near.filter(|depth_m| !depth_m.is_nan());
                let (sum, count) = known.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
                if count > 0.0 {
                    found.push((*n, sum / count));
                }
                count == 0.0
            });
            for (n, depth_m) in found {
                depths_m[n] = depth_m;
            }
        }
        // As soft as the depths are coarse: of each row and those beside it.
        let sharp = |y: usize, row: &mut [f64]| {
            row.fill(0.0);
            let mut is_lit = false;
            let latitude_deg = 90.0 - y as f64 * 180.0 / height as f64;
            let t = (latitude_deg.abs() - CLEAR_DEG[0]) / (CLEAR_DEG[1] - CLEAR_DEG[0]);
            let clear = 1.0 - t.clamp(0.0, 1.0);
            if clear == 0.0 {
                return is_lit;
            }
            let depths_m = &depths_m[y * width..(y + 1) * width];
            let pairs = row.iter_mut().zip(depths_m);
            for (light, depth_m) in pairs.filter(|(_, depth_m)| **depth_m < DARK_M) {
                *light = 255.0 * clear * (-ATTENUATION_PER_M * f64::from(*depth_m)).exp();
                is_lit = true;
            }
            is_lit
        };
        let mut light = Vec::with_capacity(width * height);
        let mut are_lit = [false; 3];
        let [mut north, mut here, mut south] = [(); 3].map(|()| vec![0.0; width]);
        are_lit[2] = sharp(0, &mut south);
        for y in 0..height {
            std::mem::swap(&mut north, &mut here);
            std::mem::swap(&mut here, &mut south);
            are_lit.rotate_left(1);
            are_lit[2] = match y + 1 < height {
                true => sharp(y + 1, &mut south),
                false => {
                    south.fill(0.0);
                    false
                }
            };
            if are_lit == [false; 3] {
                light.resize(light.len() + width, 0);
                continue;
            }
            light.extend((0..width).map(|x| {
                let (west, east) = ((x + width - 1) % width, (x + 1) % width);
                let near: f64 = [
                    north[west],
                    north[x],
                    north[east],
                    here[west],
                    here[east],
                    south[west],
                    south[x],
                    south[east],
                ]
                .iter()
                .sum();
                ((4.0 * here[x] + near) / 12.0).round() as u8
            }));
        }
        Self {
            width,
            height,
            light,
        }
    }

    /// Writes the depths to the alpha of RGBA texels, `width` to a row, linearly between its own.
    pub fn write_alpha(&self, rgba: &mut [u8], width: usize) {
        let height = rgba.len() / 4 / width.max(1);
        let depth_of: [u8; 256] = std::array::from_fn(|light| {
            let depth_m = -(light as f64 / 255.0).max(1e-9).ln() / ATTENUATION_PER_M;
            (255.0 * (depth_m / FLOOR_SEEN_M).min(1.0)).round() as u8
        });
        // Position of texels of the target: the first of two, and the second's weight in 256.
        let place = |at: usize, from: usize, to: usize| {
            let place = ((2 * at + 1) * from * 128) as isize / to as isize - 128;
            (place.div_euclid(256), place.rem_euclid(256) as u32)
        };
        let columns: Vec<_> = (0..width)
            .map(|x| {
                let (first, weight) = place(x, self.width, width);
                let wrap = |x: isize| x.rem_euclid(self.width as isize) as usize;
                (wrap(first), wrap(first + 1), weight)
            })
            .collect();
        let lines = self.light.chunks_exact(self.width.max(1));
        let are_dark: Vec<bool> = lines
            .map(|line| line.iter().all(|light| *light == 0))
            .collect();
        for (y, row) in rgba.chunks_exact_mut(4 * width).enumerate() {
            let (first, down) = place(y, self.height, height);
            let is_dark = |y: isize| are_dark[y.clamp(0, self.height as isize - 1) as usize];
            if is_dark(first) && is_dark(first + 1) {
                let (texels, _) = row.as_chunks_mut::<4>();
                texels.iter_mut().for_each(|texel| texel[3] = depth_of[0]);
                continue;
            }
            let line = |y: isize| {
                let y = y.clamp(0, self.height as isize - 1) as usize;
                &self.light[y * self.width..(y + 1) * self.width]
            };
            let (north, south) = (line(first), line(first + 1));
            let (texels, _) = row.as_chunks_mut::<4>();
            for (texel, (west, east, right)) in texels.iter_mut().zip(&columns) {
                let mix = |line: &[u8]| {
                    u32::from(line[*west]) * (256 - right) + u32::from(line[*east]) * right
                };
                let sum = mix(north) * (256 - down) + mix(south) * down;
                texel[3] = depth_of[((sum + 0x8000) >> 16) as usize];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 128;
    const HEIGHT: usize = 64;

    fn water(share: impl Fn(usize, usize) -> u8) -> LayerImage {
        let texels = (0..WIDTH * HEIGHT).map(|n| share(n % WIDTH, n / WIDTH));
        LayerImage::from_r8(WIDTH as u32, HEIGHT as u32, texels.collect()).expect("a sound map")
    }

    /// Land west of column 50, sea east of it, one mixed column between, and the other coast at the seam.
    fn coast(x: usize, _: usize) -> u8 {
        match x {
            0..50 => 0,
            50 => 128,
            _ => 255,
        }
    }

    const LAND: [u8; 4] = [90, 120, 40, 255];
    const SEA: [u8; 4] = [10, 60, 120, 255];

    #[test]
    fn land_reaches_out_to_sea_and_the_far_sea_stays() {
        let color = |n: usize| match n % WIDTH {
            0..50 => LAND,
            50 => [50, 90, 80, 255],
            _ => SEA,
        };
        let mut rgba: Vec<u8> = (0..WIDTH * HEIGHT).flat_map(color).collect();
        grow_land(&mut rgba, WIDTH, &water(coast));
        let at = |x: usize, y: usize| &rgba[(y * WIDTH + x) * 4..][..4];
        for y in [0, 30, HEIGHT - 1] {
            for x in [0, 30, 49, 50, 51, 55, 58, 127, 122] {
                assert_eq!(at(x, y), LAND, "{x} {y}");
            }
            for x in [75, 90, 110] {
                assert_eq!(at(x, y), SEA, "{x} {y}");
            }
        }
    }

    #[test]
    fn an_island_of_mixed_texels_keeps_its_own_colour() {
        let share = |x: usize, y: usize| if (x, y) == (60, 30) { 60 } else { 255 };
        // The sea's share of the texel is in its colour.
        let wet = 60.0 / 255.0;
        let mixed: [u8; 4] = std::array::from_fn(|c| {
            (f32::from(LAND[c]) * (1.0 - wet) + f32::from(SEA[c]) * wet).round() as u8
        });
        let mut rgba: Vec<u8> = (0..WIDTH * HEIGHT)
            .flat_map(|n| if n == 30 * WIDTH + 60 { mixed } else { SEA })
            .collect();
        grow_land(&mut rgba, WIDTH, &water(share));
        let at = |x: usize, y: usize| &rgba[(y * WIDTH + x) * 4..][..4];
        for (x, y) in [(60, 30), (61, 30), (59, 29), (62, 31)] {
            let is_near = |(found, land): (&u8, &u8)| found.abs_diff(*land) <= 8;
            assert!(
                at(x, y).iter().zip(&LAND).all(is_near),
                "{x} {y}: {:?}",
                at(x, y)
            );
        }
        assert_eq!(at(80, 30), SEA);
    }

    /// A texel of sea with a little red noise, as JPEG leaves it at coasts.
    #[test]
    fn little_land_is_not_red() {
        let mut rgba = [27, 67, 120, 255].repeat(49);
        let mut water = [255; 49];
        rgba[4 * 24..4 * 24 + 3].copy_from_slice(&[60, 70, 100]);
        water[24] = 210;
        let [red, green, blue] = without_sea(&rgba, 24, &water, 7).map(f32::from);
        assert!(red < 140.0, "{red}");
        assert!(
            green > 0.6 * red && blue > 0.3 * red,
            "{red} {green} {blue}"
        );
    }

    #[test]
    fn floors_of_lakes_are_out_of_sight() {
        let elevation = vec![11_800; WIDTH * HEIGHT];
        let lake = |x: usize, _| if x < 50 { 0 } else { 255 };
        let floor = SeaFloor::new(WIDTH, HEIGHT, &elevation, 11_000, &water(lake));
        let mut rgba = vec![0; 4 * WIDTH * HEIGHT];
        floor.write_alpha(&mut rgba, WIDTH);
        assert!(rgba.chunks_exact(4).all(|texel| texel[3] == 255));
    }

    #[test]
    fn depths_are_open_water_s_and_carried_to_the_coast() {
        // 10 m deep; at the coast the mean with the land is 100 m above the sea.
        let elevation: Vec<u16> = (0..WIDTH * HEIGHT)
            .map(|n| match n % WIDTH {
                0..50 => 11_200,
                50 => 11_100,
                51..90 => 10_990,
                _ => 7_000,
            })
            .collect();
        let floor = SeaFloor::new(WIDTH, HEIGHT, &elevation, 11_000, &water(coast));
        let mut rgba = vec![7; 4 * WIDTH * HEIGHT];
        floor.write_alpha(&mut rgba, WIDTH);
        let at = |x: usize, y: usize| rgba[(y * WIDTH + x) * 4 + 3];
        // A quarter of the visible depth.
        for x in [52, 55, 87] {
            assert!(at(x, 32).abs_diff(64) < 2, "{x}: {}", at(x, 32));
        }
        assert!(at(50, 32) < 80, "the coast: {}", at(50, 32));
        for x in [20, 95, 120] {
            assert_eq!(at(x, 32), 255, "{x}");
        }
        // 47° north: not clear.
        assert_eq!(at(55, 15), 255);
        assert!(rgba.chunks_exact(4).all(|texel| texel[..3] == [7; 3]));
        // At twice the size the same place has the same depth.
        let mut large = vec![0; 16 * WIDTH * HEIGHT];
        floor.write_alpha(&mut large, 2 * WIDTH);
        assert!(large[(64 * 2 * WIDTH + 110) * 4 + 3].abs_diff(64) < 2);
    }
}
