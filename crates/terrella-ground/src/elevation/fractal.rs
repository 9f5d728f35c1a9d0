//! Synthetic terrain: as rough as real terrain at every scale, and reproducible.

/// Heights of `side` × `side` posts by midpoint displacement, metres about 0. The corners and the first midpoints are displaced
/// by up to `first_m`. Each halving scales the displacement by `factor` (2⁻ᴴ, H about 0.8 for mountains). `side` must be a power
/// of two plus one; with another size only the corners have a height.
pub fn fractal_heights_m(side: u32, mut seed: u64, first_m: f64, factor: f64) -> Vec<f64> {
    let size = side as usize;
    let mut z = vec![0.0f64; size * size];
    if size == 0 {
        return z;
    }
    let mut amplitude = first_m;
    for k in [0, size - 1, size * (size - 1), size * size - 1] {
        z[k] = amplitude * noise(&mut seed);
    }
    let mut step = size - 1;
    while step > 1 && step.is_power_of_two() {
        let half = step / 2;
        // First the centres of squares, then the middles of their edges.
        for is_middle in [true, false] {
            for j in (0..size).step_by(half) {
                for i in (0..size).step_by(half) {
                    let odd = ((i / half) % 2 == 1, (j / half) % 2 == 1);
                    let about: &[(i64, i64)] = match (is_middle, odd) {
                        (true, (true, true)) => &[(1, 1), (-1, 1), (1, -1), (-1, -1)],
                        (false, (true, false) | (false, true)) => {
                            &[(1, 0), (-1, 0), (0, 1), (0, -1)]
                        }
                        _ => continue,
                    };
                    let (mut sum, mut count) = (0.0, 0.0);
                    for (di, dj) in about {
                        let x = i as i64 + di * half as i64;
                        let y = j as i64 + dj * half as i64;
                        if (0..size as i64).contains(&x) && (0..size as i64).contains(&y) {
                            sum += z[y as usize * size + x as usize];
                            count += 1.0;
                        }
                    }
                    z[j * size + i] = sum / count + amplitude * noise(&mut seed);
                }
            }
        }
        amplitude *= factor;
        step = half;
    }
    z
}

/// Pseudo-random numbers in −1…1 (Knuth's MMIX).
fn noise(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::fractal_heights_m;

    #[test]
    fn the_ground_is_the_same_again_and_rough_at_every_scale() {
        let z = fractal_heights_m(129, 7, 1_000.0, 0.5);
        assert_eq!(z, fractal_heights_m(129, 7, 1_000.0, 0.5));
        assert_ne!(z, fractal_heights_m(129, 8, 1_000.0, 0.5));
        // With a factor of a half, posts twice as far apart differ about twice as much.
        let rise = |step: usize| {
            let at = |k: usize| (z[k * 129 + 64] - z[(k - step) * 129 + 64]).abs();
            (step..129).step_by(step).map(at).sum::<f64>() / (128 / step) as f64
        };
        for step in [2, 4, 8] {
            let ratio = rise(2 * step) / rise(step);
            assert!((1.2..3.2).contains(&ratio), "{step}: {ratio}");
        }
        for side in [0, 1, 2, 100] {
            assert_eq!(
                fractal_heights_m(side, 1, 5.0, 0.5).len(),
                (side * side) as usize
            );
        }
    }
}
