//! Taking single wrong heights out of a grid before anything is made of it: one of them is a needle in what is drawn, and
//! bends every plane that is fitted to the ground around.

/// What counts as wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Denoise {
    /// Residuals this many robust standard deviations out are suspect: 1.4826 times the median absolute deviation of the
    /// residuals of the 7 × 7 samples around.
    pub deviations: f64,
    /// Residuals below this are never suspect, metres.
    pub least_m: f64,
}

impl Default for Denoise {
    fn default() -> Self {
        Self {
            deviations: 8.0,
            least_m: 30.0,
        }
    }
}

/// What was replaced and what was left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Denoised {
    /// Samples replaced.
    pub replaced: u64,
    /// Suspect samples left as they were, because two or more neighbours stand with them: cliffs, ridges, walls.
    pub kept: u64,
    /// Farthest that a replaced one was moved, metres.
    pub moved_m: f64,
}

/// Heights row by row; what is no number is not there.
struct HeightRows<'a> {
    columns: usize,
    heights_m: &'a [f32],
}

/// The upper of the two in the middle where their number is even.
fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

impl HeightRows<'_> {
    /// Rows and columns up to `reach` away, the grid's own.
    fn near(
        &self,
        row: usize,
        column: usize,
        reach: usize,
    ) -> impl Iterator<Item = (usize, usize)> {
        let rows = self.heights_m.len() / self.columns;
        let last = (column + reach).min(self.columns - 1);
        let first = column.saturating_sub(reach);
        (row.saturating_sub(reach)..=(row + reach).min(rows - 1))
            .flat_map(move |row| (first..=last).map(move |column| (row, column)))
    }

    fn at(&self, (row, column): (usize, usize)) -> f64 {
        f64::from(self.heights_m[row * self.columns + column])
    }

    /// The samples around one, up to eight.
    fn around(&self, row: usize, column: usize) -> ([f64; 8], usize) {
        let (mut out, mut count) = ([0.0; 8], 0);
        for place in self.near(row, column, 1) {
            let height_m = self.at(place);
            if place != (row, column) && height_m.is_finite() {
                out[count] = height_m;
                count += 1;
            }
        }
        (out, count)
    }

    /// How far a sample lies above the median of those around.
    fn residual_m(&self, row: usize, column: usize) -> f64 {
        let (mut near, count) = self.around(row, column);
        if count == 0 {
            return 0.0;
        }
        self.at((row, column)) - median(&mut near[..count])
    }

    /// No neighbour is so far off that the median could be.
    fn is_plain(&self, row: usize, column: usize, least_m: f64) -> bool {
        let height_m = self.at((row, column));
        let (near, count) = self.around(row, column);
        near[..count]
            .iter()
            .all(|z| (z - height_m).abs() <= least_m)
    }
}

impl Denoise {
    /// Takes the outliers out of heights that stand row by row: a sample farther from the median of its eight neighbours
    /// than both limits, with at most one neighbour on its side, becomes that median. A straight or rounded cliff has at
    /// least two there and stays, as does a summit in ground that is rough all around. All decisions are made on the grid
    /// as it was. Samples that are no numbers are left alone, and so are rows that are not whole.
    pub fn clean(&self, columns: usize, heights_m: &mut [f32]) -> Denoised {
        let mut found = Denoised::default();
        if columns == 0 || !heights_m.len().is_multiple_of(columns) {
            return found;
        }
        let least_m = self.least_m.max(0.0);
        let grid = HeightRows { columns, heights_m };
        let mut replaced = Vec::new();
        for index in 0..grid.heights_m.len() {
            let (row, column) = (index / columns, index % columns);
            let height_m = grid.at((row, column));
            if !height_m.is_finite() || grid.is_plain(row, column, least_m) {
                continue;
            }
            let off_m = grid.residual_m(row, column);
            if off_m.abs() <= least_m {
                continue;
            }
            let (mut spread, mut count) = ([0.0; 49], 0);
            for (row, column) in grid.near(row, column, 3) {
                if grid.at((row, column)).is_finite() {
                    spread[count] = grid.residual_m(row, column).abs();
                    count += 1;
                }
            }
            if off_m.abs() <= self.deviations * 1.4826 * median(&mut spread[..count]) {
                continue;
            }
            let (near, count) = grid.around(row, column);
            // On its side: nearer to it than to the median.
            let with = near[..count]
                .iter()
                .filter(|z| (*z - height_m).abs() < 0.5 * off_m.abs())
                .count();
            // At the grid's edge half of a wall's neighbours are missing.
            if with >= if count < 8 { 1 } else { 2 } || count < 3 {
                found.kept += 1;
                continue;
            }
            replaced.push((index, (height_m - off_m) as f32));
            found.replaced += 1;
            found.moved_m = found.moved_m.max(off_m.abs());
        }
        for (index, height_m) in replaced {
            heights_m[index] = height_m;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 40;

    /// A slope with a mountain of 900 m that falls by 60 m from sample to sample, and a little roughness.
    fn ground() -> Vec<f32> {
        (0..SIDE * SIDE)
            .map(|k| {
                let (row, column) = ((k / SIDE) as f32, (k % SIDE) as f32);
                let peak = 900.0 - 60.0 * (row - 25.0).hypot(column - 12.0);
                3.0 * column + peak.max(0.0) + ((k * 7919) % 11) as f32
            })
            .collect()
    }

    #[test]
    fn a_spike_goes_and_a_peak_stays() {
        let clean = ground();
        let spikes = [5 * SIDE + 30, 0, 17 * SIDE + SIDE - 1, 24 * SIDE + 13];
        let mut heights = clean.clone();
        for (k, at) in spikes.into_iter().enumerate() {
            heights[at] += if k % 2 == 0 { 2_000.0 } else { -3_000.0 };
        }
        let found = Denoise::default().clean(SIDE, &mut heights);
        assert_eq!(found.replaced, spikes.len() as u64, "{found:?}");
        assert!((1_900.0..3_200.0).contains(&found.moved_m));
        for (k, (was, is)) in clean.iter().zip(&heights).enumerate() {
            let most = if spikes.contains(&k) { 130.0 } else { 0.0 };
            assert!((was - is).abs() <= most, "{k}: {was} {is}");
        }
        let again = Denoise::default().clean(SIDE, &mut heights);
        assert_eq!(again.replaced, 0, "{again:?}");
    }

    #[test]
    fn holes_and_odd_sizes_are_left_alone() {
        let mut heights = ground();
        for k in [3, SIDE + 3, 2 * SIDE + 3, 9 * SIDE] {
            heights[k] = f32::NAN;
        }
        let spike = 10 * SIDE + 1;
        heights[spike] = 5_000.0;
        let before: Vec<u32> = heights.iter().map(|z| z.to_bits()).collect();
        let found = Denoise::default().clean(SIDE, &mut heights);
        assert_eq!(found.replaced, 1);
        let same = before
            .iter()
            .zip(&heights)
            .filter(|(a, b)| **a == b.to_bits());
        assert_eq!(same.count(), before.len() - 1);
        for columns in [0, 3, 7] {
            let mut odd = [9_000.0, 0.0, 0.0, 0.0];
            let found = Denoise::default().clean(columns, &mut odd);
            assert_eq!((found, odd[0]), (Denoised::default(), 9_000.0));
        }
        let mut row = vec![f32::NAN; 5];
        assert_eq!(Denoise::default().clean(1, &mut row), Denoised::default());
    }
}
