//! The oracle: real numbers of 320 bits, for the exact result of a formula in f64 or f32.
//!
//! A thin wrapper around `astro-float-num`: operators, and the few functions that the formulas need. Every f32 and f64 is represented exactly; each
//! operation is rounded once, to 320 bits. A formula of a hundred operations that cancels 150 bits still has far more digits than an f64.

use astro_float_num::{BigFloat, Consts, RoundingMode};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Bits of every number.
const BITS: usize = 320;
const ROUNDING: RoundingMode = RoundingMode::ToEven;

thread_local! {
    /// π and similar constants, computed once a thread.
    static CONSTS: RefCell<Consts> =
        RefCell::new(Consts::new().expect("astro-float's table of constants needs a few bytes of memory"));
}

fn with_consts<T>(f: impl FnOnce(&mut Consts) -> T) -> T {
    CONSTS.with_borrow_mut(f)
}

/// A real number of 320 bits. Like a float it can be infinite or not a number.
#[derive(Clone, Debug)]
pub struct Real(BigFloat);

impl Real {
    /// The number of a decimal text, rounded to 320 bits: for constants as published. NaN if the text is invalid.
    pub fn decimal(text: &str) -> Self {
        let radix = astro_float_num::Radix::Dec;
        Self(with_consts(|consts| {
            BigFloat::parse(text, radix, BITS, ROUNDING, consts)
        }))
    }

    pub fn pi() -> Self {
        Self(with_consts(|consts| consts.pi(BITS, ROUNDING)))
    }

    /// Square root; not a number below 0.
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt(BITS, ROUNDING))
    }

    /// The square.
    pub fn squared(&self) -> Self {
        self * self
    }

    /// Absolute value.
    pub fn abs(&self) -> Self {
        Self(self.0.abs())
    }

    /// Sine of radians.
    pub fn sin(&self) -> Self {
        Self(with_consts(|consts| self.0.sin(BITS, ROUNDING, consts)))
    }

    /// Cosine of radians.
    pub fn cos(&self) -> Self {
        Self(with_consts(|consts| self.0.cos(BITS, ROUNDING, consts)))
    }

    /// Tangent of radians.
    pub fn tan(&self) -> Self {
        Self(with_consts(|consts| self.0.tan(BITS, ROUNDING, consts)))
    }

    /// Arc tangent, radians.
    pub fn atan(&self) -> Self {
        Self(with_consts(|consts| self.0.atan(BITS, ROUNDING, consts)))
    }

    /// Arc cosine, radians; not a number outside −1…1.
    pub fn acos(&self) -> Self {
        Self(with_consts(|consts| self.0.acos(BITS, ROUNDING, consts)))
    }

    /// Arc sine, radians; not a number outside −1…1.
    pub fn asin(&self) -> Self {
        Self(with_consts(|consts| self.0.asin(BITS, ROUNDING, consts)))
    }

    /// Angle of the vector (`x`, `self`) from the first axis, −π…π; 0 for no vector.
    pub fn atan2(&self, x: &Self) -> Self {
        if x.0.is_zero() && self.0.is_zero() {
            return Self::from(0.0);
        }
        // The smaller over the larger, so that neither quotient nor arc tangent becomes infinite.
        if self.abs() > x.abs() {
            let quarter = Self::pi() * Self::from(0.5);
            let rest = (x / self).atan();
            return if self.is_negative() {
                -quarter - rest
            } else {
                quarter - rest
            };
        }
        let angle = (self / x).atan();
        match (x.is_negative(), self.is_negative()) {
            (false, _) => angle,
            (true, false) => angle + Self::pi(),
            (true, true) => angle - Self::pi(),
        }
    }

    /// The whole number nearest to it at or below.
    pub fn floor(&self) -> Self {
        Self(self.0.floor())
    }

    /// Below 0.
    pub fn is_negative(&self) -> bool {
        self.0.is_negative() && !self.0.is_zero()
    }

    /// Exactly 0.
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// The nearest f64. Below 2⁻¹⁰²² it is rounded twice.
    pub fn to_f64(&self) -> f64 {
        if self.0.is_nan() {
            return f64::NAN;
        }
        let sign = if self.0.is_negative() { -1.0 } else { 1.0 };
        if self.0.is_inf() {
            return sign * f64::INFINITY;
        }
        let Some((words, _, _, exponent, _)) = self.0.as_raw_parts() else {
            return f64::NAN;
        };
        // The mantissa is 0.1… in binary, its most significant word last.
        let Some((top, below)) = words.split_last() else {
            return 0.0;
        };
        let top: u64 = *top;
        if top == 0 {
            return 0.0;
        }
        // 64 bits (the word size of astro-float on 64-bit machines) and a sticky bit: enough for a correct last rounding.
        let sticky = u64::from(below.iter().any(|word| *word != 0));
        let mantissa = (top | sticky) as f64;
        let power = exponent - 64;
        // In two steps: 2^power alone may be out of range.
        let half = power.clamp(-2_100, 2_100) / 2;
        let rest = power.clamp(-2_100, 2_100) - half;
        sign * mantissa * 2f64.powi(half) * 2f64.powi(rest)
    }

    /// |`value` − self| / |self| as an f64: how far a computed value is off. Infinite or not a number if `value` is;
    /// infinite where self is 0 and `value` is not.
    pub fn relative_error(&self, value: f64) -> f64 {
        let off = self.absolute_error(value);
        if off == 0.0 {
            return 0.0;
        }
        if self.is_zero() || !off.is_finite() {
            return if off.is_nan() { off } else { f64::INFINITY };
        }
        ((Self::from(value) - self).abs() / self.abs()).to_f64()
    }

    /// |`value` − self| as an f64.
    pub fn absolute_error(&self, value: f64) -> f64 {
        if !value.is_finite() {
            return value.abs();
        }
        (Self::from(value) - self).abs().to_f64()
    }
}

impl From<f64> for Real {
    fn from(value: f64) -> Self {
        // astro-float 0.3 reads a subnormal f64 as half its value.
        if value.is_subnormal() {
            let up = 2f64.powi(100);
            return Self::from(value * up) / Self::from(up);
        }
        Self(BigFloat::from_f64(value, BITS))
    }
}

impl From<f32> for Real {
    fn from(value: f32) -> Self {
        Self::from(f64::from(value))
    }
}

impl From<i64> for Real {
    fn from(value: i64) -> Self {
        Self(BigFloat::from_i64(value, BITS))
    }
}

impl PartialEq for Real {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(std::cmp::Ordering::Equal)
    }
}

impl PartialOrd for Real {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.0.cmp(&other.0).map(|order| order.cmp(&0))
    }
}

macro_rules! operator {
    ($name:ident, $method:ident) => {
        impl $name<&Real> for &Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                Real(self.0.$method(&other.0, BITS, ROUNDING))
            }
        }
        impl $name<Real> for Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                (&self).$method(&other)
            }
        }
        impl $name<&Real> for Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                (&self).$method(other)
            }
        }
        impl $name<Real> for &Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                self.$method(&other)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Real {
    type Output = Self;
    fn neg(self) -> Self {
        Self(BigFloat::neg(&self.0))
    }
}

impl Neg for &Real {
    type Output = Real;
    fn neg(self) -> Real {
        Real(BigFloat::neg(&self.0))
    }
}

/// Three real numbers.
pub type Real3 = [Real; 3];

/// The vector, exactly.
pub fn real3(v: glam::DVec3) -> Real3 {
    v.to_array().map(Real::from)
}

pub fn dot(a: &Real3, b: &Real3) -> Real {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Each component by its own factor.
pub fn scaled(a: &Real3, by: &Real3) -> Real3 {
    std::array::from_fn(|k| &a[k] * &by[k])
}

/// a + t·b.
pub fn along(a: &Real3, t: &Real, b: &Real3) -> Real3 {
    std::array::from_fn(|k| &a[k] + t * &b[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Real, b: Real) {
        let off = (&a - &b).abs();
        assert!(
            off <= Real::decimal("1e-90"),
            "{} and {}: {}",
            a.to_f64(),
            b.to_f64(),
            off.to_f64()
        );
    }

    #[test]
    fn published_digits() {
        near(
            Real::pi(),
            Real::decimal(
                "3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211706798",
            ),
        );
        near(
            Real::from(2.0).sqrt(),
            Real::decimal(
                "1.41421356237309504880168872420969807856967187537694807317667973799073247846210703885038753432764157273",
            ),
        );
        near(
            Real::from(1.0).sin(),
            Real::decimal(
                "0.84147098480789650665250232163029899962256306079837106567275170999191040439123966894863974354305269585",
            ),
        );
        near(Real::from(1.0).atan() * Real::from(4.0), Real::pi());
    }

    #[test]
    fn functions_agree_with_each_other() {
        for x in [1e-30, 1e-9, 0.1, 0.5, 0.75, 0.999_999_999] {
            let x = Real::from(x);
            near(x.sin().squared() + x.cos().squared(), Real::from(1.0));
            near(x.tan(), x.sin() / x.cos());
            near(x.tan().atan(), x.clone());
            near(x.sin().asin(), x.clone());
            near(x.sqrt().squared(), x);
        }
        for x in [0.1, 0.5, 3.0] {
            near(Real::from(x).cos().acos(), Real::from(x));
        }
        for k in -7..=7 {
            let angle = Real::pi() * Real::from(f64::from(k) / 8.0);
            near(angle.sin().atan2(&angle.cos()), angle);
        }
        assert_eq!(Real::from(-2.5).floor(), Real::from(-3.0));
    }

    #[test]
    fn floats_go_in_and_come_out_unchanged() {
        for x in [
            0.0,
            1.0,
            -1.0,
            0.1,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            -1e12,
            1.0 + f64::EPSILON,
            f64::INFINITY,
        ] {
            assert_eq!(Real::from(x).to_f64(), x);
            let single = x as f32;
            assert_eq!(Real::from(single).to_f64(), f64::from(single));
        }
        assert!(Real::from(f64::NAN).to_f64().is_nan());
        // Halfway between two floats to the even one, a hair above to the next.
        let half = Real::from(0.5 * f64::EPSILON);
        let hair = Real::from(1e-60);
        assert_eq!((Real::from(1.0) + &half).to_f64(), 1.0);
        assert_eq!(
            (Real::from(1.0) + &half + &hair).to_f64(),
            1.0 + f64::EPSILON
        );
        assert_eq!((Real::from(1.0) + &half - &hair).to_f64(), 1.0);
    }

    #[test]
    fn errors_are_measured() {
        let third = Real::from(1.0) / Real::from(3.0);
        let off = third.relative_error(1.0 / 3.0);
        assert!(off > 1e-17 && off < 1.2e-16, "{off}");
        assert!(third.relative_error(f64::NAN).is_nan());
        assert_eq!(third.relative_error(f64::NEG_INFINITY), f64::INFINITY);
        assert_eq!(Real::from(0.0).relative_error(1.0), f64::INFINITY);
        assert_eq!(Real::from(0.0).relative_error(0.0), 0.0);
        assert!((third.absolute_error(1.0) - 2.0 / 3.0).abs() < 1e-15);
    }
}
