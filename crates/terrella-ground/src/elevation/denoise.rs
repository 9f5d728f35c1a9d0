//! Removes single wrong heights from a grid before any use. Such a height is drawn as a needle, and it tilts every plane
//! fitted to the ground around it.

/// Criteria for a wrong height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Denoise {
    /// Residuals beyond this many robust standard deviations are suspect. The deviation is 1.4826 times the median
    /// absolute deviation of the residuals of the surrounding 7 × 7 samples.
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

/// Counts of replaced and kept samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Denoised {
    /// Samples replaced.
    pub replaced: u64,
    /// Suspect samples kept because two or more neighbours agree with them: cliffs, ridges, walls.
    pub kept: u64,
    /// Largest change of a replaced sample, metres.
    pub moved_m: f64,
}

/// Heights row by row; NaN marks a missing sample.
struct HeightRows<'a> {
    columns: usize,
    heights_m: &'a [f32],
}

/// Median; the upper of the two middle values if their number is even.
fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

impl HeightRows<'_> {
    /// Rows and columns up to `reach` away, within the grid.
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

    /// The up to eight samples around a sample.
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

    /// Height of a sample above the median of its neighbours.
    fn residual_m(&self, row: usize, column: usize) -> f64 {
        let (mut near, count) = self.around(row, column);
        if count == 0 {
            return 0.0;
        }
        self.at((row, column)) - median(&mut near[..count])
    }

    /// Whether no neighbour differs enough for the median to differ.
    fn is_plain(&self, row: usize, column: usize, least_m: f64) -> bool {
        let height_m = self.at((row, column));
        let (near, count) = self.around(row, column);
        near[..count]
            .iter()
            .all(|z| (z - height_m).abs() <= least_m)
    }
}

impl Denoise {
    /// Replaces outliers in heights stored row by row. An outlier is farther from the median of its eight neighbours than
    /// both limits, with at most one neighbour on its side. It becomes that median. A straight or rounded cliff has at
    /// least two such neighbours and stays, as does a summit in ground that is rough all around. All decisions use the
    /// original grid. NaN samples are left alone, and so is a grid with incomplete rows.
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
            // A neighbour is on its side if it is nearer to it than to the median.
            let with = near[..count]
                .iter()
                .filter(|z| (*z - height_m).abs() < 0.5 * off_m.abs())
                .count();
            // At the edge of the grid half of a wall's neighbours are missing.
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

    /// A slope with a mountain of 900 m that falls by 60 m per sample, with a little roughness.
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
