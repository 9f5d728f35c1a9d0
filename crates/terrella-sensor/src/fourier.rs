//! The discrete Fourier transform of arrays whose sides are powers of two.

use num_complex::Complex64;
use std::f64::consts::TAU;

/// Transforms of one length.
#[derive(Clone, Debug)]
struct Fourier {
    /// e^(−2πi k/n) for k below n/2.
    turns: Vec<Complex64>,
    length: usize,
}

impl Fourier {
    fn new(length: usize) -> Self {
        debug_assert!(length.is_power_of_two());
        let turn = |k: usize| Complex64::from_polar(1.0, -TAU * k as f64 / length as f64);
        Self {
            turns: (0..length / 2).map(turn).collect(),
            length,
        }
    }

    /// Decimation in time (Cooley and Tukey 1965), in place. The inverse is not divided by the length.
    fn transform(&self, values: &mut [Complex64], inverse: bool) {
        let n = self.length;
        let bits = n.trailing_zeros();
        for i in 0..n {
            let j = match bits {
                0 => 0,
                bits => i.reverse_bits() >> (usize::BITS - bits),
            };
            if i < j {
                values.swap(i, j);
            }
        }
        let mut half = 1;
        while half < n {
            let stride = n / (2 * half);
            for block in values.chunks_exact_mut(2 * half) {
                let (first, second) = block.split_at_mut(half);
                for (k, (a, b)) in first.iter_mut().zip(second).enumerate() {
                    let turn = self.turns[k * stride];
                    let turned = *b * if inverse { turn.conj() } else { turn };
                    (*a, *b) = (*a + turned, *a - turned);
                }
            }
            half *= 2;
        }
    }
}

/// Filters arrays of one size.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    across: Fourier,
    down: Fourier,
    /// By frequency, columns first, with the division by the size.
    transfer: Vec<Complex64>,
}

impl Filter {
    /// `transfer` gets frequencies across and down in cycles per sample, −½…½; it must be that of a real kernel.
    pub(crate) fn new(
        width: usize,
        height: usize,
        transfer: impl Fn(f64, f64) -> Complex64,
    ) -> Self {
        let frequency = |k: usize, n: usize| match k * 2 > n {
            true => k as f64 / n as f64 - 1.0,
            false => k as f64 / n as f64,
        };
        let scale = 1.0 / (width * height) as f64;
        let transfer = (0..width)
            .flat_map(|x| (0..height).map(move |y| (x, y)))
            .map(|(x, y)| scale * transfer(frequency(x, width), frequency(y, height)))
            .collect();
        Self {
            across: Fourier::new(width),
            down: Fourier::new(height),
            transfer,
        }
    }

    /// Convolves with a kernel as well, rows first, whose middle stays in place. It must fit into the array.
    pub(crate) fn convolve(&mut self, side: usize, kernel: &[f64]) {
        let (width, height) = (self.across.length, self.down.length);
        let mut values = vec![Complex64::ZERO; width * height];
        for (i, weight) in kernel.iter().enumerate() {
            let x = (i % side + width - side / 2) % width;
            let y = (i / side + height - side / 2) % height;
            values[x * height + y] += weight;
        }
        for column in values.chunks_exact_mut(height) {
            self.down.transform(column, false);
        }
        let mut row = vec![Complex64::ZERO; width];
        for y in 0..height {
            for (x, value) in row.iter_mut().enumerate() {
                *value = values[x * height + y];
            }
            self.across.transform(&mut row, false);
            for (x, value) in row.iter().enumerate() {
                self.transfer[x * height + y] *= value;
            }
        }
    }

    /// Filters real and imaginary parts, each a picture, rows first.
    pub(crate) fn apply(&self, values: &mut [Complex64]) {
        let (width, height) = (self.across.length, self.down.length);
        for row in values.chunks_exact_mut(width) {
            self.across.transform(row, false);
        }
        let mut column = vec![Complex64::ZERO; height];
        for x in 0..width {
            for (y, value) in column.iter_mut().enumerate() {
                *value = values[y * width + x];
            }
            self.down.transform(&mut column, false);
            let transfer = &self.transfer[x * height..(x + 1) * height];
            for (value, factor) in column.iter_mut().zip(transfer) {
                *value *= *factor;
            }
            self.down.transform(&mut column, true);
            for (y, value) in column.iter().enumerate() {
                values[y * width + x] = *value;
            }
        }
        for row in values.chunks_exact_mut(width) {
            self.across.transform(row, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, summed term by term.
    #[test]
    fn a_transform_is_its_sum() {
        let n = 16;
        let values: Vec<_> = (0..n)
            .map(|k| Complex64::new((k * k % 7) as f64, (k % 3) as f64))
            .collect();
        for inverse in [false, true] {
            let mut found = values.clone();
            Fourier::new(n).transform(&mut found, inverse);
            for (k, found) in found.iter().enumerate() {
                let sign = if inverse { 1.0 } else { -1.0 };
                let sum: Complex64 = (0..n)
                    .map(|j| {
                        values[j]
                            * Complex64::from_polar(1.0, sign * TAU * (j * k) as f64 / n as f64)
                    })
                    .sum();
                assert!((sum - found).norm() < 1e-12, "{k}");
            }
        }
    }

    /// An uneven kernel, so that a mirrored one would show.
    #[test]
    fn a_point_becomes_the_kernel() {
        let kernel = [0.0, 1.0, 0.0, 2.0, 4.0, 8.0, 0.0, 0.0, 0.5];
        let mut filter = Filter::new(16, 8, |_, _| Complex64::ONE);
        filter.convolve(3, &kernel);
        let mut values = vec![Complex64::ZERO; 128];
        values[3 * 16 + 5] = Complex64::ONE;
        filter.apply(&mut values);
        for (i, value) in values.iter().enumerate() {
            let (x, y) = ((i % 16).wrapping_sub(4), (i / 16).wrapping_sub(2));
            let wanted = if x < 3 && y < 3 {
                kernel[y * 3 + x]
            } else {
                0.0
            };
            assert!((value - wanted).norm() < 1e-12, "{i}: {value}");
        }
    }

    #[test]
    fn a_filter_scales_waves_by_its_transfer() {
        let filter = Filter::new(32, 8, |x, y| (1.0 - x.abs() - 0.5 * y.abs()).into());
        let wave =
            |x: usize, y: usize| (TAU * (3.0 * x as f64 / 32.0 - 2.0 * y as f64 / 8.0)).cos();
        let mut values: Vec<_> = (0..256)
            .map(|i| Complex64::new(wave(i % 32, i / 32), 2.0))
            .collect();
        filter.apply(&mut values);
        for (i, value) in values.iter().enumerate() {
            let wanted = (1.0 - 3.0 / 32.0 - 0.125) * wave(i % 32, i / 32);
            assert!(
                (value - Complex64::new(wanted, 2.0)).norm() < 1e-12,
                "{i}: {value}"
            );
        }
    }
}
