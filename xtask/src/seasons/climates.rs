//! Snow on land from a map of Köppen and Geiger's climates. A class bounds the temperatures of the coldest and the warmest month, so each has here a
//! year of its own: a mean, and a swing about it. The ground is white where that year is cold.

use super::{COLUMNS, Grid, MONTHS, ROWS, blurred, latitude};
use anyhow::{Context, Result, ensure};
use std::path::Path;

/// Day of the year when it is warmest on snow, north of the equator: snow lags behind the air, which is warmest in July.
const WARMEST_DAY: f64 = 212.0;
const YEAR_DAYS: f64 = 365.25;
/// Temperatures below which the first snow lies and above which not all is white, °C.
const FIRST_SNOW: f64 = 5.0;
const ALL_WHITE: f64 = -3.0;
/// Days after the land's snow when the ice of a sea with land on all sides is strongest, and temperatures of the land about it between which it
/// freezes, °C.
const ICE_LAG_DAYS: f64 = 45.0;
const FREEZING: [f64; 2] = [-1.0, -5.0];
/// Fraction of land about such a sea, by a Gaussian of this many degrees.
const ENCLOSED: [f64; 2] = [0.35, 0.45];
const ABOUT: f64 = 4.0;
/// Transition between classes, degrees on the ground.
const TRANSITION: f64 = 1.2;
/// Class of permanent frost, and the last class of land.
const FROST: u8 = 30;
const LAST_OF_LAND: u8 = 31;

/// Yearly temperatures and dryness of the ground.
pub struct Climates {
    mean: Grid,
    swing: Grid,
    /// Fraction of snow that lies, as winters are dry.
    lying: Grid,
    frost: Grid,
    /// Fraction of land.
    pub land: Grid,
    /// How much the sea is one with land on all sides, 0…1.
    pub enclosed: Grid,
}

/// Mean and swing, °C, and the fraction of snow that lies, of a class at a latitude. Names as in the package: numbers are alphabetical.
fn year(class: u8, latitude: f64) -> [f64; 3] {
    let from_40 = latitude.abs() - 40.0;
    match class {
        // BSk, BWk: colder away from the equator; the oceans of the southern hemisphere keep winters mild.
        6 | 8 if latitude < 0.0 => [12.0, 7.0, 0.3],
        6 => [10.0 - 0.8 * from_40, 12.0 + 0.5 * from_40, 0.6],
        8 => [12.6 - 0.8 * from_40, 14.0, 0.3],
        // Cfa and Csa, Cfb and Csb, Cfc and Csc, Cw.
        9 | 12 => [15.0, 10.0, 0.3],
        10 | 13 => [10.0, 8.0, 0.3],
        11 | 14 => [4.0, 5.0, 0.6],
        15..=17 => [13.0, 9.0, 0.3],
        // Dfa and Dsa, Dfb and Dsb, Dfc and Dsc, Dfd and Dsd.
        18 | 22 => [9.0, 14.0, 1.0],
        19 | 23 => [5.5, 14.5, 1.0],
        20 | 24 => [-3.0, 17.0, 1.0],
        21 | 25 => [-11.0, 28.0, 1.0],
        // Dwa, Dwb, Dwc, Dwd.
        26 => [8.0, 17.0, 0.5],
        27 => [3.0, 18.0, 0.6],
        28 => [-4.0, 19.0, 0.8],
        29 => [-12.0, 28.0, 0.95],
        FROST => [-25.0, 5.0, 1.0],
        // ET: the tundra, and mountains of lower latitudes.
        LAST_OF_LAND if latitude.abs() > 55.0 => [-10.0, 16.0, 1.0],
        LAST_OF_LAND => [-3.0, 10.0, 0.5],
        // The tropics, hot deserts and steppes.
        _ => [24.0, 4.0, 0.0],
    }
}

/// Reads the picture of the package: a class for each texel.
pub fn read(path: &Path) -> Result<Climates> {
    let name = || path.display().to_string();
    let mut reader = image::ImageReader::open(path).with_context(name)?;
    reader.no_limits();
    let classes = reader.decode().with_context(name)?.into_luma8();
    let (width, height) = (classes.width() as usize, classes.height() as usize);
    let side = width / COLUMNS;
    ensure!(
        (width, height) == (side * COLUMNS, side * ROWS) && side > 0,
        "{}: {width} × {height} texels are no whole number for each of {COLUMNS} × {ROWS} cells",
        path.display()
    );
    let texels = classes.as_raw();
    let [mut mean, mut swing, mut lying, mut frost, mut land] =
        [(); 5].map(|()| vec![0.0; COLUMNS * ROWS]);
    for cell in 0..COLUMNS * ROWS {
        let (column, row) = (cell % COLUMNS, cell / COLUMNS);
        let rows = (row * side..(row + 1) * side).map(|row| row * width + column * side);
        for class in rows.flat_map(|first| &texels[first..first + side]) {
            if (1..=LAST_OF_LAND).contains(class) {
                let [of_mean, of_swing, of_lying] = year(*class, latitude(row));
                mean[cell] += of_mean;
                swing[cell] += of_swing;
                lying[cell] += of_lying;
                frost[cell] += f64::from(u8::from(*class == FROST));
                land[cell] += 1.0;
            }
        }
    }
    let weight = blurred(&land, TRANSITION);
    let per_land = |sum: &Grid| means(&blurred(sum, TRANSITION), &weight, 1e-6);
    let frost = means(&frost, &land, 0.0);
    let land: Grid = land
        .iter()
        .map(|land| land / (side * side) as f64)
        .collect();
    let about = blurred(&land, ABOUT);
    let enclosed = about.iter().map(|about| share(ENCLOSED, *about));
    Ok(Climates {
        enclosed: enclosed.collect(),
        mean: per_land(&mean),
        swing: per_land(&swing),
        lying: per_land(&lying),
        frost,
        land,
    })
}

impl Climates {
    /// Cover with snow in the middle of a month, 0…1. Off the coast it is that of the coast.
    pub fn snow(&self, month: usize) -> Grid {
        let cells = 0..self.mean.len();
        let cover = cells.map(|cell| {
            let cold = share([FIRST_SNOW, ALL_WHITE], self.temperature(cell, month, 0.0));
            (cold * self.lying[cell]).max(self.frost[cell])
        });
        cover.collect()
    }

    /// Cover with ice of seas with land on all sides in the middle of a month, 0…1.
    pub fn ice(&self, month: usize) -> Grid {
        let cells = 0..self.mean.len();
        let cover = cells.map(|cell| share(FREEZING, self.temperature(cell, month, ICE_LAG_DAYS)));
        cover.collect()
    }

    /// In the middle of a month, °C, so many days late.
    fn temperature(&self, cell: usize, month: usize, lag_days: f64) -> f64 {
        let day = (month as f64 + 0.5) / MONTHS as f64 * YEAR_DAYS - lag_days;
        let is_north = latitude(cell / COLUMNS) > 0.0;
        let warmest = WARMEST_DAY - if is_north { 0.0 } else { 0.5 * YEAR_DAYS };
        let phase = std::f64::consts::TAU * (day - warmest) / YEAR_DAYS;
        self.mean[cell] + self.swing[cell] * phase.cos()
    }
}

/// Means from sums and their weights; 0 where the weight is no more than this.
fn means(sums: &Grid, weights: &Grid, least: f64) -> Grid {
    let pairs = sums.iter().zip(weights);
    pairs
        .map(|(sum, weight)| if *weight > least { sum / weight } else { 0.0 })
        .collect()
}

/// How far a value is from the first bound to the second, 0…1.
fn share([first, second]: [f64; 2], value: f64) -> f64 {
    ((value - first) / (second - first)).clamp(0.0, 1.0)
}
