//! Ground for tests.

use super::super::{Dem, Frame};
use glam::DVec2;

/// Numbers in −1…1 that look random.
pub fn noise(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Midpoint displacement over n × n samples, n = 2ᵏ + 1, 90 m apart: relief of about 1 500 m.
pub fn fractal(n: u32, mut seed: u64) -> Dem {
    let size = n as usize;
    let mut z = vec![0.0f64; size * size];
    let mut amplitude = 900.0 * f64::from(n) / 129.0;
    for k in [0, size - 1, size * (size - 1), size * size - 1] {
        z[k] = 2_000.0 + amplitude * noise(&mut seed);
    }
    let mut step = size - 1;
    while step > 1 {
        let half = step / 2;
        for odd in [true, false] {
            for j in (0..size).step_by(half) {
                for i in (0..size).step_by(half) {
                    let (oi, oj) = ((i / half) % 2 == 1, (j / half) % 2 == 1);
                    let pairs: &[(i64, i64)] = match (odd, oi, oj) {
                        (true, true, true) => &[(1, 1), (-1, 1), (1, -1), (-1, -1)],
                        (false, true, false) | (false, false, true) => {
                            &[(1, 0), (-1, 0), (0, 1), (0, -1)]
                        }
                        _ => continue,
                    };
                    let (mut sum, mut count) = (0.0, 0.0);
                    for (di, dj) in pairs {
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
        amplitude *= 0.5;
        step = half;
    }
    let heights = z.into_iter().map(|z| z as f32).collect();
    let step_m = DVec2::splat(90.0);
    Dem::new(n, n, heights, Frame::Flat { step_m }).unwrap()
}
