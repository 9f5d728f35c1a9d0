//! Numbers with the digits of an f64 and a far larger range.
//!
//! At q = 10⁶ and degree 12 entries of the conversion matrices reach q⁶⁶ = 10³⁹⁶, which no f64 holds.
//!
//! Why no crate: double-double types (`twofloat`) add digits and keep the range of an f64. Arbitrary precision
//! (`astro-float-num`, which the tests compare with) rounds to whole words of 64 bits, so at q = 1 it would not give the
//! Bernstein basis to the last bit of an f64, and allocates for every number; `f128` is not stable yet.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// m·2ᵉ with ½ ≤ |m| < 1, or 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtendedFloat {
    m: f64,
    e: i32,
}

/// 2ᵉ for −1022 ≤ e ≤ 1023.
fn power(e: i32) -> f64 {
    f64::from_bits(((i64::from(e) + 1023) as u64) << 52)
}

impl ExtendedFloat {
    /// 0.
    pub const ZERO: Self = Self { m: 0.0, e: 0 };
    /// 1.
    pub const ONE: Self = Self { m: 0.5, e: 1 };

    fn new(m: f64, e: i32) -> Self {
        if m == 0.0 {
            return Self::ZERO;
        }
        // Mantissas that come in are products, sums and quotients of normal ones; from outside they may be tiny.
        let (m, e) = if m.abs() < f64::MIN_POSITIVE {
            (m * power(200), e - 200)
        } else {
            (m, e)
        };
        let bits = m.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32 - 1022;
        Self {
            m: f64::from_bits(bits & !(0x7ff << 52) | (1022 << 52)),
            e: e + exponent,
        }
    }

    /// Absolute value.
    pub fn abs(self) -> Self {
        Self {
            m: self.m.abs(),
            e: self.e,
        }
    }

    /// The larger of two that are not negative.
    pub fn max(self, other: Self) -> Self {
        let order = match (self.m == 0.0, other.m == 0.0) {
            (true, _) => Ordering::Less,
            (_, true) => Ordering::Greater,
            _ => self.e.cmp(&other.e).then(self.m.total_cmp(&other.m)),
        };
        if order == Ordering::Less { other } else { self }
    }

    /// The nearest f64: ±∞ beyond its range, 0 below.
    pub fn to_f64(self) -> f64 {
        match self.e {
            1025.. => f64::INFINITY.copysign(self.m),
            ..-1100 => 0.0,
            // In two steps: the first is exact.
            e => self.m * power(e / 2) * power(e - e / 2),
        }
    }

    /// Common logarithm of the absolute value; −∞ for 0.
    pub fn log10(self) -> f64 {
        self.m.abs().log10() + f64::from(self.e) * std::f64::consts::LOG10_2
    }
}

impl From<f64> for ExtendedFloat {
    fn from(x: f64) -> Self {
        Self::new(x, 0)
    }
}

impl Mul for ExtendedFloat {
    type Output = Self;
    fn mul(self, by: Self) -> Self {
        Self::new(self.m * by.m, self.e + by.e)
    }
}

/// The divisor must not be 0.
impl Div for ExtendedFloat {
    type Output = Self;
    fn div(self, by: Self) -> Self {
        Self::new(self.m / by.m, self.e - by.e)
    }
}

impl Neg for ExtendedFloat {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            m: -self.m,
            e: self.e,
        }
    }
}

impl Add for ExtendedFloat {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.m == 0.0 {
            return other;
        }
        if other.m == 0.0 {
            return self;
        }
        let (large, small) = if self.e >= other.e {
            (self, other)
        } else {
            (other, self)
        };
        match large.e - small.e {
            // Below a quarter of the last digit.
            56.. => large,
            by => Self::new(large.m + small.m * power(-by), large.e),
        }
    }
}

impl Sub for ExtendedFloat {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

#[cfg(test)]
mod tests {
    use super::ExtendedFloat;

    #[test]
    fn agrees_with_f64_where_f64_reaches() {
        let values = [
            0.0,
            1.0,
            -1.0,
            0.1,
            -3e5,
            1e-300,
            1e300,
            5e-324,
            0.999_999_9,
        ];
        for a in values {
            assert_eq!(ExtendedFloat::from(a).to_f64(), a);
            for b in values {
                let (x, y) = (ExtendedFloat::from(a), ExtendedFloat::from(b));
                assert_eq!((x + y).to_f64(), a + b, "{a} + {b}");
                assert_eq!((x - y).to_f64(), a - b, "{a} - {b}");
                let product = a * b;
                if product == 0.0 || product.abs() > 1e-290 {
                    let ours = (x * y).to_f64();
                    assert!(ours == product || product == 0.0 && ours.abs() < 1e-300);
                }
            }
        }
    }

    #[test]
    fn holds_what_f64_cannot() {
        let mut x = ExtendedFloat::ONE;
        for _ in 0..66 {
            x = x * ExtendedFloat::from(1e6);
        }
        assert!((x.log10() - 396.0).abs() < 1e-12);
        assert_eq!(x.to_f64(), f64::INFINITY);
        assert_eq!((-x).to_f64(), f64::NEG_INFINITY);
        assert_eq!((ExtendedFloat::ONE / x).to_f64(), 0.0);
        assert_eq!((x - x).to_f64(), 0.0);
        assert!(((x / x).to_f64() - 1.0).abs() < 1e-15);
        assert_eq!(x.max(ExtendedFloat::ONE), x);
        assert_eq!(
            ExtendedFloat::ZERO.max(ExtendedFloat::ONE),
            ExtendedFloat::ONE
        );
    }
}
