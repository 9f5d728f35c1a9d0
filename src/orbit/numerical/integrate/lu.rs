//! Gaussian elimination for a few unknowns, real and complex.

use std::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Complex {
    pub re: f64,
    pub im: f64,
}

/// What a matrix is made of.
pub(super) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    const ZERO: Self;
    fn from_real(x: f64) -> Self;
    /// Size, to choose a pivot by.
    fn size(self) -> f64;
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    fn from_real(x: f64) -> Self {
        x
    }
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Scalar for Complex {
    const ZERO: Self = Self { re: 0.0, im: 0.0 };
    fn from_real(x: f64) -> Self {
        Self { re: x, im: 0.0 }
    }
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            re: self.re + o.re,
            im: self.im + o.im,
        }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self {
            re: self.re - o.re,
            im: self.im - o.im,
        }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self {
            re: self.re * o.re - self.im * o.im,
            im: self.re * o.im + self.im * o.re,
        }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        // Smith's division: no square of a large number.
        if o.re.abs() >= o.im.abs() {
            let ratio = o.im / o.re;
            let d = o.re + o.im * ratio;
            Self {
                re: (self.re + self.im * ratio) / d,
                im: (self.im - self.re * ratio) / d,
            }
        } else {
            let ratio = o.re / o.im;
            let d = o.re * ratio + o.im;
            Self {
                re: (self.re * ratio + self.im) / d,
                im: (self.im * ratio - self.re) / d,
            }
        }
    }
}

/// A matrix taken apart, rows exchanged.
#[derive(Clone, Debug)]
pub(super) struct Lu<S, const N: usize> {
    rows: [[S; N]; N],
    order: [usize; N],
}

impl<S: Scalar, const N: usize> Lu<S, N> {
    /// `diagonal` · 1 − `matrix`, decomposed; `None` if it is singular or not finite.
    pub fn of_shifted(diagonal: S, matrix: &[[f64; N]; N]) -> Option<Self> {
        let mut rows = matrix.map(|row| row.map(|x| S::from_real(-x)));
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] = row[i] + diagonal;
        }
        let mut order: [usize; N] = std::array::from_fn(|i| i);
        for k in 0..N {
            let pivot = (k..N).max_by(|&a, &b| rows[a][k].size().total_cmp(&rows[b][k].size()))?;
            let size = rows[pivot][k].size();
            if size == 0.0 || !size.is_finite() {
                return None;
            }
            rows.swap(k, pivot);
            order.swap(k, pivot);
            let top = rows[k];
            for row in rows.iter_mut().skip(k + 1) {
                let factor = row[k] / top[k];
                row[k] = factor;
                for j in k + 1..N {
                    row[j] = row[j] - factor * top[j];
                }
            }
        }
        Some(Self { rows, order })
    }

    /// x with M x = b.
    pub fn solve(&self, b: &[S; N]) -> [S; N] {
        let mut x = [S::ZERO; N];
        for i in 0..N {
            x[i] = b[self.order[i]];
            for j in 0..i {
                x[i] = x[i] - self.rows[i][j] * x[j];
            }
        }
        for i in (0..N).rev() {
            for j in i + 1..N {
                x[i] = x[i] - self.rows[i][j] * x[j];
            }
            x[i] = x[i] / self.rows[i][i];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_fulfil_their_equations() {
        let matrix: [[f64; 6]; 6] = std::array::from_fn(|i| {
            std::array::from_fn(|j| ((i * 7 + j * 3) as f64 * 1.7).sin() * 10f64.powi(i as i32 - 3))
        });
        let b: [f64; 6] = std::array::from_fn(|i| (i as f64).cos());
        let real = Lu::of_shifted(0.3, &matrix).unwrap().solve(&b);
        let shift = Complex { re: 0.3, im: -2.0 };
        let complex = Lu::of_shifted(shift, &matrix)
            .unwrap()
            .solve(&b.map(Complex::from_real));
        for i in 0..6 {
            let mut left = 0.3 * real[i];
            let mut left_complex = shift * complex[i];
            for j in 0..6 {
                left -= matrix[i][j] * real[j];
                left_complex = left_complex - Complex::from_real(matrix[i][j]) * complex[j];
            }
            assert!((left - b[i]).abs() < 1e-11, "{i}: {left}");
            assert!(
                (left_complex - Complex::from_real(b[i])).size() < 1e-11,
                "{i}"
            );
        }
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert!(Lu::of_shifted(0.0, &[[1.0, 2.0], [2.0, 4.0]]).is_none());
        assert!(Lu::of_shifted(1.0, &[[f64::NAN, 0.0], [0.0, 0.0]]).is_none());
    }
}
