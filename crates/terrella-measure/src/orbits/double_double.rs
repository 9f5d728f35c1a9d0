//! Double-double arithmetic: the sum of two f64, 32 decimal digits (Dekker 1971; Knuth, TAOCP 2, 4.2.2).
//!
//! Not a library: `twofloat` 0.8 brings another version of `syn` (1.0, for hexadecimal literals) beside the two that are already used, and `libm`.
//! The numbers of `astro-float-num`, with which the tests below compare, are some thirty times slower, and a report integrates ten months of orbits
//! with these.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// high + low, where low is below half a last digit of high.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// The f64 nearest to it.
    pub fn to_f64(self) -> f64 {
        self.high + self.low
    }

    /// Square root of a number above 0; 0 of anything else.
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::default();
        }
        // One round of Newton's method doubles the digits of f64's.
        let root = Self::from(self.high.sqrt());
        root + (self - root * root) / (root + root)
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }
}

/// a + b and its rounding error.
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble {
        high,
        low: (a - (high - part)) + (b - part),
    }
}

/// The same where |a| ≥ |b|.
fn quick_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble {
        high,
        low: b - (high - a),
    }
}

/// Halves of 26 digits.
fn split(a: f64) -> (f64, f64) {
    let t = 134_217_729.0 * a;
    let high = t - (t - a);
    (high, a - high)
}

/// a b and its rounding error.
fn two_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    DoubleDouble {
        high,
        low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2,
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (s, t) = (two_sum(self.high, o.high), two_sum(self.low, o.low));
        let s = quick_sum(s.high, s.low + t.high);
        quick_sum(s.high, s.low + t.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = two_product(self.high, o.high);
        quick_sum(p.high, p.low + self.high * o.low + self.low * o.high)
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let first = self.high / o.high;
        let rest = self - o * Self::from(first);
        let second = rest.high / o.high;
        let rest = rest - o * Self::from(second);
        quick_sum(first, second) + Self::from(rest.high / o.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::oracle::Real;

    fn real(x: DoubleDouble) -> Real {
        Real::from(x.high) + Real::from(x.low)
    }

    #[test]
    fn thirty_one_digits_are_right() {
        let mut x = DoubleDouble::from(1.0 / 3.0);
        for k in 1..200 {
            let y = DoubleDouble::from(f64::from(k).sin()) + x * DoubleDouble::from(1e-17);
            let off =
                |found: DoubleDouble, exact: Real| ((real(found) - &exact) / &exact).abs().to_f64();
            for (name, found, exact) in [
                ("+", x + y, real(x) + real(y)),
                ("-", x - y, real(x) - real(y)),
                ("*", x * y, real(x) * real(y)),
                ("/", x / y, real(x) / real(y)),
                ("√", (x * x).sqrt(), (real(x * x)).sqrt()),
            ] {
                assert!(
                    off(found, exact.clone()) < 1e-30 || exact.abs().to_f64() < 1e-3,
                    "{k} {name}"
                );
            }
            x = x * DoubleDouble::from(1.01) + DoubleDouble::from(1e-3);
        }
    }
}
