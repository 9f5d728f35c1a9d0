//! Mountains as elevation tiles: a source without a file, with the correct means at each level.

use super::{LEVELS, SIDE};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::time::Duration;
use terrella_ground::elevation::{
    Bounds, HeightRange, HeightSamples, HeightTileError, HeightTileKey, HeightTileLayout,
    HeightTileSource,
};

/// The part of the Earth that has the finest tiles, degrees: south, north, west, east.
const DEEP_DEG: (f64, f64, f64, f64) = (40.0, 52.0, 0.0, 28.0);

/// A wave of the ground: height by latitude times height by longitude.
struct Wave {
    height_m: f64,
    along: f64,
    down: f64,
    phase: f64,
}

impl Wave {
    /// Its mean over a cell is less by this.
    fn damped(&self, cell_rad: f64) -> f64 {
        let part = |waves: f64| (0.5 * waves * cell_rad).sin() / (0.5 * waves * cell_rad);
        self.height_m * part(self.along) * part(self.down)
    }

    fn of_column(&self, lon_rad: f64) -> f64 {
        (self.along * lon_rad + self.phase).sin()
    }

    fn of_row(&self, lat_rad: f64) -> f64 {
        (self.down * lat_rad + 0.7 * self.phase).cos()
    }

    /// Least and most between two places, of sin(`waves` · x + `phase`).
    fn range(waves: f64, phase: f64, from: f64, to: f64) -> (f64, f64) {
        let (a, b) = (waves * from + phase, waves * to + phase);
        let has = |peak: f64| ((b - peak) / TAU).floor() > ((a - peak) / TAU).floor();
        let (low, high) = (a.sin().min(b.sin()), a.sin().max(b.sin()));
        (
            if has(-FRAC_PI_2) { -1.0 } else { low },
            if has(FRAC_PI_2) { 1.0 } else { high },
        )
    }
}

/// Mountains, from a thousand kilometres down to a hundred metres, as tiles with the means that they must have.
pub struct Mountains {
    pub layout: HeightTileLayout,
    waves: Vec<Wave>,
    ranges: HashMap<HeightTileKey, HeightRange>,
    takes: Duration,
}

impl Mountains {
    /// Each tile takes this long to read.
    pub fn new(takes: Duration) -> Self {
        let layout = HeightTileLayout::new(LEVELS, 16, SIDE, 1).expect("sound");
        // Every wave goes round the Earth a whole number of times.
        let waves = (0..14_i32).map(|octave| Wave {
            height_m: 2200.0 * 0.56_f64.powi(octave),
            along: (24.0 * 2.03_f64.powi(octave)).round(),
            down: (19.0 * 2.07_f64.powi(octave)).round(),
            phase: 1.3 * f64::from(octave),
        });
        let mut mountains = Self {
            layout,
            waves: waves.collect(),
            ranges: HashMap::new(),
            takes,
        };
        let mut level: Vec<_> = (0..layout.rows(layout.coarsest()))
            .flat_map(|row| (0..layout.columns(layout.coarsest())).map(move |column| (column, row)))
            .map(|(column, row)| HeightTileKey {
                level: layout.coarsest(),
                column,
                row,
            })
            .collect();
        while !level.is_empty() {
            for key in &level {
                let range = mountains.range_of(&layout.bounds(*key));
                mountains.ranges.insert(*key, range);
            }
            let (south, north, west, east) = DEEP_DEG;
            let deep = Bounds {
                south_rad: south.to_radians(),
                north_rad: north.to_radians(),
                west_rad: west.to_radians(),
                width_rad: (east - west).to_radians(),
            };
            let quarters = level
                .iter()
                .flat_map(|key| (0..4).filter_map(|k| key.child(k)));
            level = quarters
                .filter(|key| key.level >= 5 || layout.bounds(*key).meets(&deep))
                .collect();
        }
        mountains
    }

    fn range_of(&self, bounds: &Bounds) -> HeightRange {
        // Borders and rounding.
        let more = 2.0
            * self
                .layout
                .spacing_rad(self.layout.coarsest())
                .min(bounds.width_rad);
        let (mut low_m, mut high_m) = (-1.0, 1.0);
        for wave in &self.waves {
            let west = bounds.west_rad - more;
            let east = bounds.west_rad + bounds.width_rad + more;
            let x = Wave::range(wave.along, wave.phase, west, east);
            let phase = 0.7 * wave.phase + FRAC_PI_2;
            let (south, north) = (bounds.south_rad - more, bounds.north_rad + more);
            let y = Wave::range(wave.down, phase, south, north);
            let all = [x.0 * y.0, x.0 * y.1, x.1 * y.0, x.1 * y.1];
            low_m += wave.height_m * all.iter().copied().fold(f64::INFINITY, f64::min).min(0.0);
            high_m += wave.height_m
                * all
                    .iter()
                    .copied()
                    .fold(f64::NEG_INFINITY, f64::max)
                    .max(0.0);
        }
        HeightRange { low_m, high_m }
    }

    /// Means of cells: rows from the north, each from the west, from the middle of the first.
    pub fn cells(
        &self,
        north_rad: f64,
        west_rad: f64,
        step_rad: f64,
        size: (usize, usize),
    ) -> Vec<f32> {
        let mut cells = vec![0.0; size.0 * size.1];
        for wave in &self.waves {
            let height_m = wave.damped(step_rad);
            let column = |i: usize| wave.of_column(west_rad + i as f64 * step_rad);
            let columns: Vec<_> = (0..size.0).map(column).collect();
            for (j, row) in cells.chunks_exact_mut(size.0).enumerate() {
                let of_row_m = height_m * wave.of_row(north_rad - j as f64 * step_rad);
                for (cell, of_column) in row.iter_mut().zip(&columns) {
                    *cell += (of_row_m * of_column) as f32;
                }
            }
        }
        cells
    }
}

impl HeightTileSource for Mountains {
    fn layout(&self) -> HeightTileLayout {
        self.layout
    }

    fn range_m(&self, key: HeightTileKey) -> Option<HeightRange> {
        self.ranges.get(&key).copied()
    }

    fn read(
        &self,
        key: HeightTileKey,
        _: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError> {
        if key.level < self.layout.coarsest() {
            std::thread::sleep(self.takes);
        }
        let (bounds, step) = (self.layout.bounds(key), self.layout.spacing_rad(key.level));
        let row = self.layout.row_samples();
        // Counted from the corner of the Earth, so that borders are their neighbours' samples to the last bit.
        let count = |tile: u32| f64::from(tile) * f64::from(SIDE) - 0.5;
        let north_rad = FRAC_PI_2 - count(key.row) * step;
        let west_rad = count(key.column) * step - PI;
        debug_assert!((west_rad - bounds.west_rad).abs() < step);
        Ok(HeightSamples::F32(self.cells(
            north_rad,
            west_rad,
            step,
            (row, row),
        )))
    }
}
