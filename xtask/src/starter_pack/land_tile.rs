//! Land detail smaller than the day map's texels: a tile of terrain that rivers have eroded.
//!
//! Land rises everywhere and rivers cut it down: the stream power law, ∂h/∂t = u − k √A |∇h|, with the drained area A. It is integrated implicitly
//! from the outlets upstream (Braun and Willett 2013, Geomorphology 180, 170). Erodibility k is uneven, so that ridges and valleys bend. The square
//! repeats in both directions, so it has no seam.

use super::plane::Plane;

/// Texels along a side of the tile, and of the coarsest grid that is eroded.
pub const SIDE: usize = 1024;
const COARSEST: usize = 64;
/// Steps on each grid; the finer one starts with the heights of the coarser one.
const STEPS: [usize; 5] = [300, 150, 80, 50, 30];
/// Uplift in a step. Lengths are in texels of the tile.
const UPLIFT: f64 = 1.0;
/// Erodibility in a step, with the uplift.
const ERODIBILITY: f64 = 0.3;
/// Share of the difference from its neighbours that a texel loses in a step: soil creeps.
const CREEP: f64 = 0.05;
/// Number of outlets, whose height is 0.
const OUTLETS: usize = 24;
/// Structures larger than about three times this are removed: the maps show them. Texels.
const LARGEST: usize = 13;
/// Radius within which contrast is equalized, texels.
const EVENING: usize = 32;

/// Heights with mean 0 and variance 1.
pub fn make() -> Plane {
    let heights = Plane {
        width: SIDE,
        height: SIDE,
        values: eroded(),
    };
    let large = around(&heights, LARGEST, 3);
    let fine = heights.zip(&large, |height, large| height - large);
    // Slopes from texel to texel are those of the grid.
    let fine = fine.zip(&around(&fine, 1, 1), |sharp, soft| 0.2 * sharp + 0.8 * soft);
    let power = around(&fine.zip(&fine, |a, b| a * b), EVENING, 3);
    let contrast: Vec<f64> = power.values.iter().map(|p| p.max(0.0).sqrt()).collect();
    let least = 0.2 * contrast.iter().sum::<f64>() / contrast.len() as f64;
    fine.zip(&fine.with(contrast), |fine, contrast| {
        fine / contrast.max(least)
    })
    .standardised()
}

/// Blurred as [`Plane::blurred`], of a square that repeats.
fn around(plane: &Plane, radius: usize, times: usize) -> Plane {
    let margin = radius * times;
    let side = plane.width + 2 * margin;
    let from = |at: usize| (at + plane.width - margin) % plane.width;
    let wider = Plane {
        width: side,
        height: side,
        values: (0..side * side)
            .map(|n| plane.values[from(n / side) * plane.width + from(n % side)])
            .collect(),
    };
    wider
        .blurred(radius, times)
        .cut((margin, margin), plane.width)
}

/// Heights of the tile's texels.
fn eroded() -> Vec<f64> {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let outlets: Vec<[f64; 2]> = (0..OUTLETS)
        .map(|_| [random.fraction(), random.fraction()])
        .collect();
    let mut side = COARSEST;
    let mut heights: Vec<f64> = (0..side * side).map(|_| random.fraction()).collect();
    for steps in STEPS {
        if heights.len() < side * side {
            heights = enlarged(&heights, side / 2);
            let rough = 0.3 * (SIDE / side) as f64;
            heights
                .iter_mut()
                .for_each(|height| *height += rough * random.fraction());
        }
        let mut land = Land::new(heights, side, &outlets, &mut random);
        (0..steps).for_each(|_| land.step());
        heights = land.heights;
        side *= 2;
    }
    heights
}

/// A square grid that repeats, while it is eroded.
struct Land {
    heights: Vec<f64>,
    side: usize,
    /// Distance of neighbours, texels of the tile.
    cell: f64,
    is_outlet: Vec<bool>,
    erodibility: Vec<f64>,
    /// Factors of the slopes by which water chooses its way, used in turn: a grid's eight directions would be seen.
    preferences: Vec<f64>,
}

impl Land {
    fn new(heights: Vec<f64>, side: usize, outlets: &[[f64; 2]], random: &mut Random) -> Self {
        let mut is_outlet = vec![false; side * side];
        for outlet in outlets {
            let [row, column] = outlet.map(|at| (at * side as f64) as usize);
            is_outlet[row * side + column] = true;
        }
        // A prime number of them.
        let preferences = (0..1_000_003).map(|_| 0.6 + 0.8 * random.fraction());
        Self {
            heights,
            side,
            cell: (SIDE / side) as f64,
            is_outlet,
            erodibility: erodibility(side),
            preferences: preferences.collect(),
        }
    }

    fn step(&mut self) {
        let down: Vec<(usize, f64)> = (0..self.heights.len()).map(|n| self.down(n)).collect();
        let mut upstream: Vec<usize> = (0..self.heights.len()).collect();
        let heights = &self.heights;
        upstream.sort_unstable_by(|a, b| heights[*a].total_cmp(&heights[*b]).then(a.cmp(b)));
        let mut areas = vec![self.cell * self.cell; self.heights.len()];
        for n in upstream.iter().rev() {
            if down[*n].0 != *n {
                areas[down[*n].0] += areas[*n];
            }
        }
        for n in upstream {
            let (to, distance) = down[n];
            self.heights[n] = if self.is_outlet[n] {
                0.0
            } else if to == n {
                self.heights[n] + UPLIFT
            } else {
                let cut = self.erodibility[n] * areas[n].sqrt() / distance;
                (self.heights[n] + UPLIFT + cut * self.heights[to]) / (1.0 + cut)
            };
        }
        let before = self.heights.clone();
        for (n, height) in self.heights.iter_mut().enumerate() {
            if !self.is_outlet[n] {
                let around = [(0, 1), (0, self.side - 1), (1, 0), (self.side - 1, 0)];
                let near = around.map(|step| before[neighbour(n, step, self.side)]);
                *height += CREEP * (near.iter().sum::<f64>() - 4.0 * before[n]);
            }
        }
    }

    /// The neighbour to which water flows, itself in a hollow, and its distance.
    fn down(&self, n: usize) -> (usize, f64) {
        let back = self.side - 1;
        let steps = [
            (0, 1),
            (0, back),
            (1, 0),
            (back, 0),
            (1, 1),
            (1, back),
            (back, 1),
            (back, back),
        ];
        let mut found = (n, self.cell);
        let mut steepest = 0.0;
        for (direction, step) in steps.into_iter().enumerate() {
            let to = neighbour(n, step, self.side);
            let length = if direction < 4 {
                1.0
            } else {
                std::f64::consts::SQRT_2
            };
            let preference = self.preferences[(8 * n + direction) % self.preferences.len()];
            let slope = preference * (self.heights[n] - self.heights[to]) / length;
            if slope > steepest {
                steepest = slope;
                found = (to, length * self.cell);
            }
        }
        found
    }
}

/// The texel some rows and columns farther on, in a square that repeats.
fn neighbour(n: usize, (rows, columns): (usize, usize), side: usize) -> usize {
    (n / side + rows) % side * side + (n % side + columns) % side
}

/// Erodibility of each texel: octaves of smooth noise, the same ground on each grid.
fn erodibility(side: usize) -> Vec<f64> {
    let mut random = Random(77);
    let mut hardness = vec![0.0; side * side];
    for octave in [8, 16, 32, 64, 128]
        .into_iter()
        .filter(|octave| *octave <= side / 2)
    {
        let corners: Vec<f64> = (0..octave * octave)
            .map(|_| 2.0 * random.fraction() - 1.0)
            .collect();
        let place = |at: usize| {
            let exact = (at * octave) as f64 / side as f64;
            let t = exact.fract();
            (exact as usize, t * t * (3.0 - 2.0 * t))
        };
        for (n, hardness) in hardness.iter_mut().enumerate() {
            *hardness += between(&corners, octave, place(n / side), place(n % side));
        }
    }
    // Nearly exp(0.55 x), which has not the same bits on every machine.
    let factor = |x: f64| (1.0 + 0.55 / 8.0 * x).powi(8);
    hardness
        .into_iter()
        .map(|x| ERODIBILITY * factor(x))
        .collect()
}

/// A square that repeats, in twice as many rows and columns.
fn enlarged(values: &[f64], side: usize) -> Vec<f64> {
    let place = |at: usize| {
        let exact = (at + 2 * side) as f64 / 2.0 - 0.25;
        (exact as usize, exact.fract())
    };
    let texels = (0..4 * side * side)
        .map(|n| between(values, side, place(n / (2 * side)), place(n % (2 * side))));
    texels.collect()
}

/// A value of a square that repeats, linearly between rows and columns: the first of two, and the second's weight.
fn between(values: &[f64], side: usize, row: (usize, f64), column: (usize, f64)) -> f64 {
    let at = |row: usize, column: usize| values[row % side * side + column % side];
    let of_row =
        |row: usize| at(row, column.0) * (1.0 - column.1) + at(row, column.0 + 1) * column.1;
    of_row(row.0) * (1.0 - row.1) + of_row(row.0 + 1) * row.1
}

/// Marsaglia's xorshift generator.
struct Random(u64);

impl Random {
    /// 0…1.
    fn fraction(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rivers_reach_the_outlets_and_cut_valleys() {
        let side = 64;
        let mut random = Random(1);
        let heights = (0..side * side).map(|_| random.fraction()).collect();
        let mut land = Land::new(heights, side, &[[0.5, 0.5]], &mut random);
        (0..300).for_each(|_| land.step());
        let outlet = 32 * side + 32;
        assert_eq!(land.heights[outlet], 0.0);
        let mut texels = 0;
        for first in 0..side * side {
            let mut at = first;
            // Downhill all the way.
            while at != outlet && land.down(at).0 != at {
                assert!(land.heights[land.down(at).0] < land.heights[at]);
                at = land.down(at).0;
            }
            texels += usize::from(at == outlet);
        }
        // The rest has hollows, which fill in time.
        assert!(texels > side * side / 2, "{texels}");
    }
}
