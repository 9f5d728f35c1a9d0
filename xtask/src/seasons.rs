//! `cargo xtask seasons`: makes `textures/seasons.png`, the snow and the sea ice of each month, from a map of climates and from temperatures of the
//! sea. `textures/SOURCES.md` describes both sources and the rules.

mod climates;
mod ocean;

use crate::files::write_bytes;
use anyhow::Result;
use std::path::Path;

/// A grid of the whole Earth, one degree wide, north row first, from 180° W.
const COLUMNS: usize = 360;
const ROWS: usize = 180;
const MONTHS: usize = 12;
/// Maps across the file, and down: snow of the months, their ice, and one empty map.
const ACROSS: usize = 5;

/// Values of the grid.
type Grid = Vec<f64>;

/// Reads the sources and writes the maps.
///
/// # Errors
/// A file cannot be read or written, or is not as expected.
pub fn run(climates: &Path, ocean: &Path, textures: &Path) -> Result<()> {
    let climates = climates::read(climates)?;
    let ocean = ocean::read(ocean)?;
    let mut maps = Vec::new();
    for month in 0..MONTHS {
        maps.push(climates.snow(month));
    }
    for month in 0..MONTHS {
        maps.push(ocean.ice(&climates, month));
    }
    report(&maps, &climates.land);
    let mut pixels = vec![0; ACROSS * COLUMNS * ACROSS * ROWS];
    for (number, map) in maps.iter().enumerate() {
        let (left, top) = (number % ACROSS * COLUMNS, number / ACROSS * ROWS);
        for (row, values) in map.chunks(COLUMNS).enumerate() {
            let first = (top + row) * ACROSS * COLUMNS + left;
            for (pixel, value) in pixels[first..].iter_mut().zip(values) {
                *pixel = (255.0 * value).round() as u8;
            }
        }
    }
    let image =
        image::GrayImage::from_raw((ACROSS * COLUMNS) as u32, (ACROSS * ROWS) as u32, pixels)
            .expect("as many pixels as the size says");
    let mut file = std::io::Cursor::new(Vec::new());
    image.write_to(&mut file, image::ImageFormat::Png)?;
    let out = textures.join("seasons.png");
    write_bytes(&out, file.get_ref())?;
    println!("{}: {} bytes", out.display(), file.get_ref().len());
    Ok(())
}

/// Prints what `textures/SOURCES.md` states: areas of each month.
fn report(maps: &[Grid], land: &Grid) {
    println!("month: snow north of the equator, ice north and south of it, million km²");
    for month in 0..MONTHS {
        let (snow, ice) = (&maps[month], &maps[MONTHS + month]);
        let area = |cover: &Grid, north: bool, of_land: bool| -> f64 {
            let cells = (0..cover.len()).filter(|cell| {
                (latitude(cell / COLUMNS) > 0.0) == north
                    && cover[*cell] > if of_land { 0.5 } else { 0.15 }
            });
            cells
                .map(|cell| match of_land {
                    true => land[cell] * area(cell),
                    false => (1.0 - land[cell]) * area(cell),
                })
                .sum()
        };
        println!(
            "{:2}: {:5.1} {:5.1} {:5.1}",
            month + 1,
            area(snow, true, true),
            area(ice, true, false),
            area(ice, false, false)
        );
    }
}

/// Latitude of a row's middle, degrees.
fn latitude(row: usize) -> f64 {
    90.0 - (row as f64 + 0.5) * 180.0 / ROWS as f64
}

/// Area of a cell, million km².
fn area(cell: usize) -> f64 {
    let side = 111.195e-3;
    side * side * latitude(cell / COLUMNS).to_radians().cos()
}

/// A grid smoothed by a Gaussian of this standard deviation, degrees on the ground.
fn blurred(grid: &Grid, sigma: f64) -> Grid {
    let weights = gaussian(sigma);
    let reach = weights.len() as isize / 2;
    let mut down = vec![0.0; grid.len()];
    for (row, to) in down.chunks_mut(COLUMNS).enumerate() {
        for (weight, step) in weights.iter().zip(-reach..) {
            let from = (row as isize + step).clamp(0, ROWS as isize - 1) as usize * COLUMNS;
            for (to, from) in to.iter_mut().zip(&grid[from..]) {
                *to += weight * from;
            }
        }
    }
    let mut out = Vec::with_capacity(grid.len());
    for (row, values) in down.chunks(COLUMNS).enumerate() {
        // Half the Earth is wide enough near the poles.
        let sigma = (sigma / latitude(row).to_radians().cos()).min(COLUMNS as f64 / 6.0);
        let weights = gaussian(sigma);
        let reach = weights.len() as isize / 2;
        out.extend((0..COLUMNS as isize).map(|column| {
            let taps = weights.iter().zip(-reach..).map(|(weight, step)| {
                weight * values[(column + step).rem_euclid(COLUMNS as isize) as usize]
            });
            taps.sum::<f64>()
        }));
    }
    out
}

/// Weights of a Gaussian of this standard deviation, cells; their sum is 1.
fn gaussian(sigma: f64) -> Vec<f64> {
    let reach = (3.0 * sigma).ceil() as isize;
    let weights = (-reach..=reach).map(|step| (-0.5 * (step as f64 / sigma).powi(2)).exp());
    let weights: Vec<_> = weights.collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}
