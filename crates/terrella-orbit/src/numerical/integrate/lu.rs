//! Gaussian elimination for a few unknowns, real and complex. Our own: the matrices are 6 × 6 and on the stack; linear algebra crates would take
//! ten times the code.

use num_complex::Complex64;
use std::ops::{Add, Div, Mul, Sub};

/// Elements of a matrix.
pub(super) trait Scalar:
    Copy
    + Default
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// Size, to choose a pivot by.
    fn size(self) -> f64;
}

impl Scalar for f64 {
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Scalar for Complex64 {
    fn size(self) -> f64 {
        self.l1_norm()
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
        let mut rows = matrix.map(|row| row.map(|x| S::from(-x)));
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
        let mut x = [S::default(); N];
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
        let shift = Complex64::new(0.3, -2.0);
        let complex = Lu::of_shifted(shift, &matrix)
            .unwrap()
            .solve(&b.map(Complex64::from));
        for i in 0..6 {
            let mut left = 0.3 * real[i];
            let mut left_complex = shift * complex[i];
            for j in 0..6 {
                left -= matrix[i][j] * real[j];
                left_complex -= Complex64::from(matrix[i][j]) * complex[j];
            }
            assert!((left - b[i]).abs() < 1e-11, "{i}: {left}");
            assert!((left_complex - Complex64::from(b[i])).size() < 1e-11, "{i}");
        }
    }

    #[test]
    fn singular_matrices_are_rejected() {
        assert!(Lu::of_shifted(0.0, &[[1.0, 2.0], [2.0, 4.0]]).is_none());
        assert!(Lu::of_shifted(1.0, &[[f64::NAN, 0.0], [0.0, 0.0]]).is_none());
    }
}
