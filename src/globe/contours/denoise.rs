//! Taking single wrong heights out of a DEM before planes are fitted to it: one of them bends the plane of every node
//! above it.

use super::dem::{Dem, DemError};

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

/// What was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Denoised {
    /// Samples replaced.
    pub replaced: u64,
    /// Suspect samples left as they were, because two or more neighbours stand with them: cliffs, ridges, walls.
    pub kept: u64,
    /// Farthest that a replaced one was moved, metres.
    pub moved_m: f64,
}

/// The upper of the two in the middle where their number is even.
fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The median of the up to eight samples around one, and those samples.
fn around(dem: &Dem, i: i64, j: i64, out: &mut [f64; 8]) -> usize {
    let mut count = 0;
    for dj in -1..=1 {
        for di in -1..=1 {
            let (x, y) = (i + di, j + dj);
            let inside = (0..i64::from(dem.columns())).contains(&x)
                && (0..i64::from(dem.rows())).contains(&y);
            if (di, dj) != (0, 0) && inside {
                out[count] = dem.height_m(x, y);
                count += 1;
            }
        }
    }
    count
}

fn residual_m(dem: &Dem, i: i64, j: i64) -> f64 {
    let mut near = [0.0; 8];
    let count = around(dem, i, j, &mut near);
    if count == 0 {
        return 0.0;
    }
    dem.height_m(i, j) - median(&mut near[..count])
}

impl Denoise {
    /// The grid without its outliers: a sample farther from the median of its eight neighbours than both limits, with at
    /// most one neighbour on its side, becomes that median. A straight or rounded cliff has at least two there and stays,
    /// as does a summit in ground that is rough all around. All decisions are made on the grid as it was.
    pub fn apply(&self, dem: &Dem) -> Result<(Dem, Denoised), DemError> {
        let mut heights_m = dem.heights_m().to_vec();
        let mut found = Denoised::default();
        let (columns, rows) = (i64::from(dem.columns()), i64::from(dem.rows()));
        for j in 0..rows {
            for i in 0..columns {
                let off = residual_m(dem, i, j);
                if off.abs() <= self.least_m.max(0.0) {
                    continue;
                }
                let mut spread = [0.0; 49];
                let mut count = 0;
                for y in (j - 3).max(0)..=(j + 3).min(rows - 1) {
                    for x in (i - 3).max(0)..=(i + 3).min(columns - 1) {
                        spread[count] = residual_m(dem, x, y).abs();
                        count += 1;
                    }
                }
                let limit = self.deviations * 1.4826 * median(&mut spread[..count]);
                if off.abs() <= limit {
                    continue;
                }
                let mut near = [0.0; 8];
                let count = around(dem, i, j, &mut near);
                let height = dem.height_m(i, j);
                // On its side: nearer to it than to the median.
                let with = near[..count]
                    .iter()
                    .filter(|z| (*z - height).abs() < 0.5 * off.abs())
                    .count();
                // At the grid's edge half of a wall's neighbours are missing.
                if with >= if count < 8 { 1 } else { 2 } || count < 3 {
                    found.kept += 1;
                    continue;
                }
                heights_m[(j * columns + i) as usize] = (height - off) as f32;
                found.replaced += 1;
                found.moved_m = found.moved_m.max(off.abs());
            }
        }
        let clean = Dem::new(dem.columns(), dem.rows(), heights_m, dem.frame())?;
        Ok((clean, found))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::ground::{fractal, noise};
    use super::super::{ContourTree, Frame};
    use super::*;
    use glam::DVec2;

    fn with(dem: &Dem, change: impl Fn(&mut [f32])) -> Dem {
        let mut heights = dem.heights_m().to_vec();
        change(&mut heights);
        Dem::new(dem.columns(), dem.rows(), heights, dem.frame()).unwrap()
    }

    #[test]
    fn spikes_go_and_the_rest_stays() {
        let clean = fractal(129, 12);
        let mut seed = 4;
        let spikes: Vec<(usize, f32)> = (0..60)
            .map(|k| {
                let at = ((noise(&mut seed).abs() * 128.0) as usize) * 129 + k * 2;
                (at, if k % 2 == 0 { 8_000.0 } else { -9_999.0 })
            })
            .collect();
        let dirty = with(&clean, |h| spikes.iter().for_each(|(at, z)| h[*at] = *z));
        let (out, found) = Denoise::default().apply(&dirty).unwrap();
        println!("{found:?} of 60 spikes");
        assert!((55..=62).contains(&found.replaced), "{found:?}");
        let mut other = 0;
        for (k, (a, b)) in clean.heights_m().iter().zip(out.heights_m()).enumerate() {
            if !spikes.iter().any(|(at, _)| *at == k) {
                other += u32::from(a != b);
            } else {
                assert!((a - b).abs() < 2_000.0);
            }
        }
        assert!(other <= 2, "{other} good samples were moved");
        let (_, again) = Denoise::default().apply(&clean).unwrap();
        assert!(again.replaced <= 2, "{again:?}");
        // Fewer spikes, fewer nodes.
        let nodes = |dem: &Dem| {
            let tree = ContourTree::build(dem, 200.0, 1 << 30, &mut |_| ()).unwrap();
            tree.nodes.len()
        };
        assert!(nodes(&out) < nodes(&dirty));
    }

    #[test]
    fn cliffs_walls_and_flat_ground_stay() {
        type Inside = fn(u32, u32) -> bool;
        let shapes: [(&str, Inside); 5] = [
            ("straight", |i, _| i > 20),
            ("slanting", |i, j| i + 2 * j > 70),
            ("corner", |i, j| i > 20 && j > 14),
            ("wall", |i, _| i == 20),
            ("round", |i, j| {
                (i as i32 - 20).pow(2) + (j as i32 - 20).pow(2) < 90
            }),
        ];
        for (name, inside) in shapes {
            let heights = (0..41 * 41)
                .map(|k| {
                    if inside(k % 41, k / 41) {
                        9_000.0
                    } else {
                        -11_000.0
                    }
                })
                .collect();
            let step_m = DVec2::splat(30.0);
            let dem = Dem::new(41, 41, heights, Frame::Flat { step_m }).unwrap();
            let (out, found) = Denoise::default().apply(&dem).unwrap();
            assert!(out == dem, "{name}: {found:?}");
        }
        for (c, r) in [(1, 1), (2, 3), (1, 5)] {
            let heights = (0..c * r).map(|k| (k * 500) as f32).collect();
            let step_m = DVec2::ONE;
            let dem = Dem::new(c, r, heights, Frame::Flat { step_m }).unwrap();
            assert!(Denoise::default().apply(&dem).is_ok());
        }
    }
}
