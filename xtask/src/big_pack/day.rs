//! The enlarged day map, with coasts redrawn from the land mask and shaded slopes.
//!
//! An enlarged coast is a soft transition from the colour of the land to that of the sea. The land mask gives the share of sea in each texel,
//! exactly and with the map's softness. The difference between the two shares scales the difference between the colours of pure sea and pure land
//! near by, which is added.

use super::enlarge::{Bytes, Enlarger};
use super::mask::{self, Mask};
use crate::starter_pack::day;
use crate::starter_pack::map::{Map, open};
use anyhow::{Result, ensure};
use std::path::Path;

/// Radius of the search for pure land and sea colours near a coast, source texels.
const REACH: isize = 4;

/// Relative brightening of land by a slope of 1 towards the north-west.
const RELIEF: f32 = 2.5;
/// Limit on the relative change of brightness by relief.
const MOST_RELIEF: f32 = 0.25;

/// Produces the rows of the large map.
pub struct Day<R> {
    colour: Enlarger,
    /// Share of sea, 0…255, as soft as the colours.
    soft_sea: Enlarger,
    /// Half of the sea's colour minus the land's, plus 128.
    contrast: Enlarger,
    /// Brightness of the land; 128 is flat.
    relief: Enlarger,
    mask: Mask<R>,
    width: usize,
    rows: [Vec<f32>; 4],
}

/// Opens the sources for a map of half the mask's size.
pub fn open_day(data: &Path) -> Result<Day<impl std::io::Read>> {
    let (width, height) = (mask::WIDTH / 2, mask::HEIGHT / 2);
    let mask_path = data.join(super::LAND_MASK);
    let map = Map::read(&data.join(day::JUNE), 3)?;
    let colour = Bytes::of(&day::mended(map, data)?);
    ensure!(
        mask::WIDTH.is_multiple_of(colour.width),
        "the day map is {} texels wide, no part of {}",
        colour.width,
        mask::WIDTH
    );
    let mut sea = Vec::with_capacity(colour.width * colour.height);
    let mut mask = Mask::open(&mask_path)?;
    for _ in 0..colour.height {
        sea.extend(mask.next_row(mask::WIDTH / colour.width)?);
    }
    let sea = Bytes {
        channels: 1,
        values: sea,
        ..colour
    };
    let contrast = contrast(&colour, &sea);
    let relief = relief(&data.join(super::ELEVATION))?;
    let enlarged = |bytes| Enlarger::new(bytes, width, height);
    Ok(Day {
        soft_sea: enlarged(softened(&sea)),
        colour: enlarged(colour),
        contrast: enlarged(contrast),
        relief: enlarged(relief),
        mask: Mask::open(&mask_path)?,
        width,
        rows: [3, 1, 3, 1].map(|channels| vec![0.0; width * channels]),
    })
}

impl<R: std::io::Read> Day<R> {
    /// Writes row `y`; rows must be requested in order.
    pub fn row(&mut self, y: usize, out: &mut [u8]) -> Result<()> {
        let [colour, soft_sea, contrast, relief] = &mut self.rows;
        self.colour.row(y, colour);
        self.soft_sea.row(y, soft_sea);
        self.contrast.row(y, contrast);
        self.relief.row(y, relief);
        let sea = self.mask.next_row(2)?;
        for x in 0..self.width {
            let sea = f32::from(sea[x]) / 255.0;
            let missing = sea - soft_sea[x] / 255.0;
            let light = 1.0 + (1.0 - sea) * (relief[x] - 128.0) / 128.0 * MOST_RELIEF;
            for channel in 0..3 {
                let place = 3 * x + channel;
                let contrast = 2.0 * (contrast[place] - 128.0);
                let value = (colour[place] + missing * contrast) * light;
                out[place] = (value.clamp(0.0, 255.0) + 0.5) as u8;
            }
        }
        Ok(())
    }
}

/// The share of sea, blurred over three texels each way: about as soft as the photograph's coasts.
fn softened(sea: &Bytes) -> Bytes {
    let (width, height) = (sea.width as isize, sea.height as isize);
    let at = |x: isize, y: isize| {
        let (x, y) = (x.rem_euclid(width), y.clamp(0, height - 1));
        u32::from(sea.values[(y * width + x) as usize])
    };
    let value = |n: isize| {
        let (x, y) = (n % width, n / width);
        let row = |y| at(x - 1, y) + 2 * at(x, y) + at(x + 1, y);
        ((row(y - 1) + 2 * row(y) + row(y + 1) + 8) / 16) as u8
    };
    Bytes {
        values: (0..width * height).map(value).collect(),
        ..*sea
    }
}

/// Half of the mean colour of pure sea minus that of pure land near each texel, plus 128; 128 if either is missing there.
fn contrast(colour: &Bytes, sea: &Bytes) -> Bytes {
    let (width, height) = (colour.width as isize, colour.height as isize);
    let mut values = vec![128; colour.values.len()];
    let place = |x: isize, y: isize| (y * width + x.rem_euclid(width)) as usize;
    for y in 0..height {
        let rows = (y - REACH).max(0)..=(y + REACH).min(height - 1);
        for x in 0..width {
            let near = || {
                rows.clone()
                    .flat_map(move |y| (x - REACH..=x + REACH).map(move |x| (x, y)))
            };
            let is_uniform = |other: u8| (other == 0 || other == 255).then_some(other);
            // Most texels are far from any coast: test the corners and edge centres first.
            let far = [-REACH, 0, REACH];
            let mut probes = far.iter().flat_map(|dy| far.iter().map(move |dx| (dx, dy)));
            let first = sea.values[place(x, y)];
            let is_inland = is_uniform(first).is_some()
                && probes.all(|(dx, dy)| {
                    let y = (y + dy).clamp(0, height - 1);
                    sea.values[place(x + dx, y)] == first
                });
            if is_inland {
                continue;
            }
            let (mut sums, mut counts) = ([[0_u32; 3]; 2], [0_u32; 2]);
            for (x, y) in near() {
                let place = place(x, y);
                let Some(kind) = is_uniform(sea.values[place]) else {
                    continue;
                };
                let kind = usize::from(kind == 255);
                counts[kind] += 1;
                for (sum, value) in sums[kind].iter_mut().zip(&colour.values[3 * place..]) {
                    *sum += u32::from(*value);
                }
            }
            if counts.contains(&0) {
                continue;
            }
            for channel in 0..3 {
                let mean = |kind: usize| sums[kind][channel] as f32 / counts[kind] as f32;
                let half = (mean(1) - mean(0)) / 2.0 + 128.5;
                values[3 * place(x, y) + channel] = half.clamp(0.0, 255.0) as u8;
            }
        }
    }
    Bytes { values, ..*colour }
}

/// Brightness of the land under light from the north-west, from elevations in metres + 11 000.
fn relief(path: &Path) -> Result<Bytes> {
    let picture = open(path)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    ensure!(
        width == 2 * height,
        "{} is {width} x {height}, not a map of the whole Earth",
        path.display()
    );
    let elevation = picture.into_luma16().into_raw();
    let at = |x: usize, y: usize| f32::from(elevation[y * width + x % width]);
    let texel_m = 40_030_000.0 / width as f32;
    let mut values = Vec::with_capacity(width * height);
    for y in 0..height {
        let (north, south) = (y.saturating_sub(1), (y + 1).min(height - 1));
        let latitude = (0.5 - (y as f32 + 0.5) / height as f32) * std::f32::consts::PI;
        // Rows shrink to zero length at a pole, and slopes along them would grow without bound.
        let east_m = 2.0 * texel_m * latitude.cos().max(0.1);
        for x in 0..width {
            let east = (at(x + 1, y) - at(x + width - 1, y)) / east_m;
            let north = (at(x, north) - at(x, south)) / (2.0 * texel_m);
            // Terrain that falls towards the light is brighter.
            let light = RELIEF * (east - north) * std::f32::consts::FRAC_1_SQRT_2 / MOST_RELIEF;
            values.push((128.0 + 127.0 * light.clamp(-1.0, 1.0)) as u8);
        }
    }
    Ok(Bytes {
        width,
        height,
        channels: 1,
        values,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// West half land, east half sea, with one mixed column between.
    fn coast() -> (Bytes, Bytes) {
        let (width, height) = (40, 20);
        let sea = |n: usize| match n % width {
            0..20 => 0,
            20 => 128,
            _ => 255,
        };
        let sea: Vec<u8> = (0..width * height).map(sea).collect();
        let colour = |sea: &u8| match sea {
            0 => [90, 120, 40],
            128 => [50, 90, 80],
            _ => [10, 60, 120],
        };
        let colour = Bytes {
            width,
            height,
            channels: 3,
            values: sea.iter().flat_map(colour).collect(),
        };
        let sea = Bytes {
            channels: 1,
            values: sea,
            ..colour
        };
        (colour, sea)
    }

    #[test]
    fn contrast_is_found_near_coasts_only() {
        let (colour, sea) = coast();
        let contrast = contrast(&colour, &sea);
        let at = |x: usize| &contrast.values[(10 * 40 + x) * 3..][..3];
        for x in [17, 20, 23, 0, 39] {
            assert_eq!(at(x), [88, 98, 168], "{x}");
        }
        for x in [10, 30] {
            assert_eq!(at(x), [128; 3], "{x}");
        }
    }

    #[test]
    fn softening_keeps_the_sum_and_plains() {
        let (_, sea) = coast();
        let soft = softened(&sea);
        let row = |map: &Bytes| map.values[10 * 40..11 * 40].to_vec();
        assert_eq!(row(&soft)[19..22], [32, 128, 223]);
        assert_eq!((row(&soft)[10], row(&soft)[30]), (0, 255));
    }
}
