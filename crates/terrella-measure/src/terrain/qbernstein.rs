//! The q-Bernstein basis of Phillips, for any q from 10⁻⁶ to 10⁶ and degrees to 12.
//!
//! B_i(t; q) = \[n choose i\]_q tⁱ Π_{s=0}^{n−i−1} (1 − qˢ t), with \[r\] = 1 + q + … + qʳ⁻¹.
//!
//! How it stays exact: \[r\] is summed, not taken as (1 − qʳ)/(1 − q); 1 − qˢ is (1 − q)\[s\], whose difference is exact near
//! q = 1, and a factor 1 − qˢt is (1 − t) + t(1 − qˢ), whose two parts have one sign for q ≤ 1. At q = 1 that is 1 − t and
//! everything is the Bernstein basis to the last bit. Entries of both conversion matrices are sums of one sign for every q
//! (see [`QBasis::bernstein_from_q`]), so that each is exact to some roundings however ill-conditioned the matrix is. What
//! is beyond an f64 is computed in `ExtendedFloat`.
//!
//! For q > 1 the basis changes sign and its terms can be far larger than their sum: no formula avoids that, and [`QBasis::condition`] gives the
//! loss of accuracy.

mod extended_float;
#[cfg(test)]
mod tests;

use extended_float::ExtendedFloat;

/// Highest degree.
pub const MAX_DEGREE: usize = 12;
/// Smallest and largest q.
pub const Q_RANGE: (f64, f64) = (1e-6, 1e6);

/// One number for each of degree + 1 basis functions; the rest are 0.
pub type Row = [f64; MAX_DEGREE + 1];

/// A basis that is not offered.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum QError {
    /// The degree is not from 1 to 12.
    #[error("degree of a q-Bernstein basis is {0}; it must be from 1 to 12")]
    Degree(usize),
    /// q is outside 10⁻⁶…10⁶, or no number.
    #[error("q of a q-Bernstein basis is {0:?}; it must be from 1e-6 to 1e6")]
    Q(f64),
}

/// A basis: degree n and q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QBasis {
    degree: usize,
    q: f64,
    /// qˢ.
    powers: [f64; MAX_DEGREE + 1],
    /// 1 − qˢ.
    one_minus: [f64; MAX_DEGREE + 1],
    /// \[n choose i\]_q.
    binomials: [f64; MAX_DEGREE + 1],
}

/// A square matrix of degree + 1 rows that converts control values of one basis to those of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    size: usize,
    rows: [[ExtendedFloat; MAX_DEGREE + 1]; MAX_DEGREE + 1],
}

/// How much a change of basis can enlarge a relative error: ‖M‖·‖M⁻¹‖ in two norms, as common logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// In the norm of the largest column sum.
    pub log10_columns: f64,
    /// In the norm of the largest row sum.
    pub log10_rows: f64,
    /// Of the basis itself: the most that Σ|B_i(t)| comes to over 0 ≤ t ≤ 1, by which values of a curve amplify errors of
    /// its control values. 0 for q ≤ 1.
    pub log10_lebesgue: f64,
}

/// \[r\] = 1 + q + … + qʳ⁻¹: r itself at q = 1.
pub fn q_integer(r: usize, q: f64) -> f64 {
    (0..r).fold(0.0, |sum, _| sum * q + 1.0)
}

impl QBasis {
    /// The basis of a degree (1…12) for q (10⁻⁶…10⁶).
    pub fn new(degree: usize, q: f64) -> Result<Self, QError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(QError::Degree(degree));
        }
        if !(Q_RANGE.0..=Q_RANGE.1).contains(&q) {
            return Err(QError::Q(q));
        }
        let mut basis = Self {
            degree,
            q,
            powers: [1.0; MAX_DEGREE + 1],
            one_minus: [0.0; MAX_DEGREE + 1],
            binomials: [0.0; MAX_DEGREE + 1],
        };
        for s in 1..=MAX_DEGREE {
            basis.powers[s] = basis.powers[s - 1] * q;
            basis.one_minus[s] = (1.0 - q) * q_integer(s, q);
        }
        basis.binomials[0] = 1.0;
        for i in 1..=degree {
            // \[n choose i\] = \[n choose i − 1\]·\[n − i + 1\]/\[i\]: quotients of positive sums.
            basis.binomials[i] =
                basis.binomials[i - 1] * q_integer(degree - i + 1, q) / q_integer(i, q);
        }
        Ok(basis)
    }

    /// n.
    pub fn degree(&self) -> usize {
        self.degree
    }

    pub fn q(&self) -> f64 {
        self.q
    }

    /// The factor 1 − qˢt.
    fn factor(&self, s: usize, t: f64) -> f64 {
        (1.0 - t) + t * self.one_minus[s]
    }

    fn extended_values(&self, t: f64) -> [ExtendedFloat; MAX_DEGREE + 1] {
        let mut values = [ExtendedFloat::ZERO; MAX_DEGREE + 1];
        for (i, value) in values.iter_mut().enumerate().take(self.degree + 1) {
            let mut product = ExtendedFloat::from(self.binomials[i]);
            for _ in 0..i {
                product = product * ExtendedFloat::from(t);
            }
            for s in 0..self.degree - i {
                product = product * ExtendedFloat::from(self.factor(s, t));
            }
            *value = product;
        }
        values
    }

    /// B_0…B_n at t in 0…1. Values beyond an f64 are ±∞, which happens from q⁶⁶ > 10³⁰⁸ on at degree 12.
    pub fn values(&self, t: f64) -> Row {
        self.extended_values(t).map(ExtendedFloat::to_f64)
    }

    /// The curve Σ c_i B_i(t; q) and its derivative by t, with degree + 1 control values, by the q-de Casteljau scheme
    /// c_i ← (1 − qᵏt) c_i + qᵏt c_{i+1}, k = m − 1 − i while m + 1 values are left.
    ///
    /// It follows from \[n choose i\] = qⁿ⁻ⁱ [n−1 choose i−1] + [n−1 choose i]. The weights of each step add up to 1, so that
    /// equal control values give that value exactly, for q ≤ 1 they lie in 0…1 (the curve stays within the control
    /// values), and at q = 1 it is de Casteljau's own. Missing control values count as 0.
    pub fn point_and_slope(&self, control: &[f64], t: f64) -> (f64, f64) {
        let mut c = [(ExtendedFloat::ZERO, ExtendedFloat::ZERO); MAX_DEGREE + 1];
        for (to, from) in c.iter_mut().zip(control) {
            to.0 = ExtendedFloat::from(*from);
        }
        for m in (1..=self.degree).rev() {
            for i in 0..m {
                let k = m - 1 - i;
                let power = ExtendedFloat::from(self.powers[k]);
                let (a, b) = (c[i], c[i + 1]);
                let rise = b.0 - a.0;
                c[i] = if self.q <= 1.0 {
                    // a + (b − a)s is exact for equal values and never leaves them for s in 0…1, to rounding.
                    let s = power * ExtendedFloat::from(t);
                    (a.0 + rise * s, a.1 + (b.1 - a.1) * s + rise * power)
                } else {
                    let s = power * ExtendedFloat::from(t);
                    let rest = ExtendedFloat::from(self.factor(k, t));
                    let value = if rise == ExtendedFloat::ZERO {
                        a.0
                    } else {
                        a.0 * rest + b.0 * s
                    };
                    (value, a.1 * rest + b.1 * s + rise * power)
                };
            }
        }
        (c[0].0.to_f64(), c[0].1.to_f64())
    }

    /// The curve alone, see [`Self::point_and_slope`].
    pub fn point(&self, control: &[f64], t: f64) -> f64 {
        self.point_and_slope(control, t).0
    }

    /// M with b = M c: from q-control values c to the Bernstein (ordinary Bézier) control values b of the same curve.
    ///
    /// With w_s = 1 − qˢ, Π_{s<m} ((1 − t) + t w_s) = Σ_k e_k(w) (1 − t)^{m−k} tᵏ, so M_ji = \[n choose i\]_q e_{j−i}(w_0…w_{n−i−1})
    /// / (n choose j). All w_s have one sign, so no elementary symmetric sum e_k cancels. M is the identity at q = 1.
    pub fn bernstein_from_q(&self) -> Conversion {
        let n = self.degree;
        let plain = Self::plain_binomials(n);
        let mut rows = [[ExtendedFloat::ZERO; MAX_DEGREE + 1]; MAX_DEGREE + 1];
        for i in 0..=n {
            let mut e = [ExtendedFloat::ZERO; MAX_DEGREE + 1];
            e[0] = ExtendedFloat::ONE;
            for s in 0..n - i {
                for k in (1..=s + 1).rev() {
                    e[k] = e[k] + e[k - 1] * ExtendedFloat::from(self.one_minus[s]);
                }
            }
            for k in 0..=n - i {
                rows[i + k][i] = ExtendedFloat::from(self.binomials[i]) * e[k] / plain[i + k];
            }
        }
        Conversion { size: n + 1, rows }
    }

    /// M⁻¹ with c = M⁻¹ b: from Bernstein control values to q-control values of the same curve.
    ///
    /// With N_i^m = tⁱ Π_{s<m−i} (1 − qˢt): (1 − t)·N_i^m = N_i^{m+1} + (q^{m−i} − 1) N_{i+1}^{m+1} and t·N_i^m = N_{i+1}^{m+1}. For
    /// q ≥ 1 every coefficient is ≥ 0, for q < 1 they alternate: neither cancels, so this is as exact as M itself.
    pub fn q_from_bernstein(&self) -> Conversion {
        let n = self.degree;
        let plain = Self::plain_binomials(n);
        let mut rows = [[ExtendedFloat::ZERO; MAX_DEGREE + 1]; MAX_DEGREE + 1];
        // Coefficients of (1 − t)^m over N_0^m…N_m^m, m growing; column j needs m = n − j, shifted by tʲ.
        let mut a = [ExtendedFloat::ZERO; MAX_DEGREE + 1];
        a[0] = ExtendedFloat::ONE;
        for m in 0..=n {
            let j = n - m;
            for i in 0..=m {
                rows[i + j][j] = a[i] * plain[j] / ExtendedFloat::from(self.binomials[i + j]);
            }
            for i in (1..=(m + 1).min(n)).rev() {
                a[i] = a[i] + a[i - 1] * ExtendedFloat::from(-self.one_minus[m + 1 - i]);
            }
        }
        Conversion { size: n + 1, rows }
    }

    fn plain_binomials(n: usize) -> [ExtendedFloat; MAX_DEGREE + 1] {
        let mut plain = [1.0; MAX_DEGREE + 1];
        for i in 1..=n {
            plain[i] = plain[i - 1] * (n - i + 1) as f64 / i as f64;
        }
        plain.map(ExtendedFloat::from)
    }

    /// The condition of the basis.
    pub fn condition(&self) -> Condition {
        let (to, back) = (self.bernstein_from_q(), self.q_from_bernstein());
        let lebesgue = (0..=256).map(|k| {
            self.extended_values(f64::from(k) / 256.0)
                .into_iter()
                .fold(ExtendedFloat::ZERO, |sum, value| sum + value.abs())
        });
        Condition {
            log10_columns: (to.norm(false) * back.norm(false)).log10(),
            log10_rows: (to.norm(true) * back.norm(true)).log10(),
            log10_lebesgue: if self.q <= 1.0 {
                0.0
            } else {
                lebesgue
                    .fold(ExtendedFloat::ZERO, ExtendedFloat::max)
                    .log10()
            },
        }
    }
}

impl Conversion {
    /// An entry, ±∞ where no f64 holds it; 0 outside.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.rows
            .get(row)
            .and_then(|row| row.get(column))
            .map_or(0.0, |entry| entry.to_f64())
    }

    /// Takes control values to the other basis. Values beyond an f64 are ±∞. Missing ones count as 0.
    pub fn apply(&self, control: &[f64]) -> Row {
        let mut out = [0.0; MAX_DEGREE + 1];
        for (to, row) in out.iter_mut().zip(&self.rows).take(self.size) {
            *to = row
                .iter()
                .zip(control)
                .fold(ExtendedFloat::ZERO, |sum, (entry, c)| {
                    sum + *entry * ExtendedFloat::from(*c)
                })
                .to_f64();
        }
        out
    }

    /// Largest row sum, or column sum, of absolute values.
    fn norm(&self, of_rows: bool) -> ExtendedFloat {
        let sum = |k: usize| {
            (0..self.size).fold(ExtendedFloat::ZERO, |sum, l| {
                sum + if of_rows {
                    self.rows[k][l]
                } else {
                    self.rows[l][k]
                }
                .abs()
            })
        };
        (0..self.size)
            .map(sum)
            .fold(ExtendedFloat::ZERO, ExtendedFloat::max)
    }
}
