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
/// Days after the land's snow when the ice of enclosed waters is strongest, and temperatures of the land about them between which they freeze, °C.
const ICE_LAG_DAYS: f64 = 25.0;
const FREEZING: [f64; 2] = [-4.0, -9.0];
/// Transition between classes of the lowlands, and of mountains and tundra, degrees on the ground. The first is wide: between a class with mild and
/// one with cold winters the temperature falls over a thousand kilometres.
const LOWLANDS: f64 = 4.0;
const HIGHLANDS: f64 = 1.2;
/// Class of permanent frost, and the last class of land.
const FROST: u8 = 30;
const LAST_OF_LAND: u8 = 31;

/// Yearly temperatures and dryness of the ground.
pub struct Climates {
    /// Of the lowlands, and of mountains and tundra.
    years: [Years; 2],
    /// Fraction of mountains and tundra on the land.
    highlands: Grid,
    frost: Grid,
    /// Fraction of land.
    pub land: Grid,
}

/// Means of some classes.
struct Years {
    mean: Grid,
    swing: Grid,
    /// Fraction of snow that lies, as winters are dry.
    lying: Grid,
}

/// Sums over the texels of a cell: mean, swing, lying and their number.
type Sums = [Grid; 4];

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
    let grid = || vec![0.0; COLUMNS * ROWS];
    let mut sums: [Sums; 2] = [(); 2].map(|()| [(); 4].map(|()| grid()));
    let mut frost = grid();
    for cell in 0..COLUMNS * ROWS {
        let (column, row) = (cell % COLUMNS, cell / COLUMNS);
        let rows = (row * side..(row + 1) * side).map(|row| row * width + column * side);
        for class in rows.flat_map(|first| &texels[first..first + side]) {
            if (1..=LAST_OF_LAND).contains(class) {
                let [mean, swing, lying] = year(*class, latitude(row));
                let sums = &mut sums[usize::from(*class >= FROST)];
                for (sum, value) in sums.iter_mut().zip([mean, swing, lying, 1.0]) {
                    sum[cell] += value;
                }
                frost[cell] += f64::from(u8::from(*class == FROST));
            }
        }
    }
    let land: Grid = sums[0][3]
        .iter()
        .zip(&sums[1][3])
        .map(|(a, b)| a + b)
        .collect();
    let about = |grid: &Grid| blurred(grid, HIGHLANDS);
    let highlands = means(&about(&sums[1][3]), &about(&land), 1e-6);
    let frost = means(&frost, &land, 0.0);
    let [low, high] = sums;
    Ok(Climates {
        years: [Years::of(&low, LOWLANDS), Years::of(&high, HIGHLANDS)],
        highlands,
        frost,
        land: land
            .iter()
            .map(|land| land / (side * side) as f64)
            .collect(),
    })
}

impl Years {
    fn of([mean, swing, lying, count]: &Sums, transition: f64) -> Self {
        let weight = blurred(count, transition);
        let [mean, swing, lying] =
            [mean, swing, lying].map(|sum| means(&blurred(sum, transition), &weight, 1e-6));
        Self { mean, swing, lying }
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

impl Climates {
    /// Cover with snow in the middle of a month, 0…1. Off the coast it is that of the coast.
    pub fn snow(&self, month: usize) -> Grid {
        let mut cover = self.mixed(|years, cell| {
            let temperature = years.temperature(cell, month, 0.0);
            share([FIRST_SNOW, ALL_WHITE], temperature) * years.lying[cell]
        });
        for (cover, frost) in cover.iter_mut().zip(&self.frost) {
            *cover = cover.max(*frost);
        }
        cover
    }

    /// Cover with ice of enclosed waters in the middle of a month, 0…1.
    pub fn ice(&self, month: usize) -> Grid {
        self.mixed(|years, cell| share(FREEZING, years.temperature(cell, month, ICE_LAG_DAYS)))
    }

    /// Values of the lowlands and of the highlands, by the fraction of these in each cell.
    fn mixed(&self, value: impl Fn(&Years, usize) -> f64) -> Grid {
        let cells = self.highlands.iter().enumerate();
        let values = cells.map(|(cell, highlands)| {
            let [low, high] = [&self.years[0], &self.years[1]].map(|years| value(years, cell));
            low + highlands * (high - low)
        });
        values.collect()
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
pub fn share([first, second]: [f64; 2], value: f64) -> f64 {
    ((value - first) / (second - first)).clamp(0.0, 1.0)
}
