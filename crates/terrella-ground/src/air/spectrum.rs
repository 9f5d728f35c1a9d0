//! Light, or a coefficient, at the eight wavelengths of the atmosphere model.

use glam::{Vec3, Vec4};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Values at 672, 632, 598, 564, 548, 511, 460 and 424 nm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spectrum([Vec4; 2]);

/// Linear sRGB of light at these wavelengths, each relative to the Sun's. Rows sum to 1, so white stays white.
///
/// Wavelengths and matrix were fitted to spectra of light after up to 40 air masses and 50 columns of ozone. That light was scattered zero, one or
/// two times. The spectra are sums over 380–780 nm, every 5 nm, of the CIE 1931 2° observer under the Sun of ASTM E490. The root mean square error is
/// 0.02 %, the largest 0.1 %.
const RGB: [Spectrum; 3] = [
    Spectrum::new([
        0.076_89, 0.401_95, 0.757_21, 0.011_40, 0.071_78, -0.356_31, -0.003_96, 0.041_04,
    ]),
    Spectrum::new([
        -0.010_64, -0.026_08, 0.044_83, 0.303_30, 0.337_22, 0.418_86, -0.025_46, -0.042_03,
    ]),
    Spectrum::new([
        0.001_48, -0.019_89, 0.018_62, -0.114_00, -0.004_59, 0.067_20, 0.745_14, 0.306_04,
    ]),
];

impl Spectrum {
    pub const ZERO: Self = Self([Vec4::ZERO; 2]);
    pub const ONE: Self = Self([Vec4::ONE; 2]);

    pub const fn new(v: [f32; 8]) -> Self {
        Self([
            Vec4::new(v[0], v[1], v[2], v[3]),
            Vec4::new(v[4], v[5], v[6], v[7]),
        ])
    }

    /// e^(−v).
    pub fn exp_of_minus(self) -> Self {
        Self(self.0.map(|v| (-v).exp()))
    }

    pub fn max(self, least: f32) -> Self {
        Self(self.0.map(|v| v.max(Vec4::splat(least))))
    }

    pub fn min(self, most: f32) -> Self {
        Self(self.0.map(|v| v.min(Vec4::splat(most))))
    }

    pub fn lerp(self, other: Self, part: f32) -> Self {
        self + (other - self) * part
    }

    /// Linear sRGB.
    pub fn rgb(self) -> Vec3 {
        let [r, g, b] = RGB.map(|row| {
            let [first, second] = (row * self).0;
            first.element_sum() + second.element_sum()
        });
        Vec3::new(r, g, b)
    }

    fn zip(self, other: Self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

impl Add for Spectrum {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Spectrum {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Spectrum {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Spectrum {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Mul<f32> for Spectrum {
    type Output = Self;
    fn mul(self, by: f32) -> Self {
        Self(self.0.map(|v| v * by))
    }
}

impl Div<f32> for Spectrum {
    type Output = Self;
    fn div(self, by: f32) -> Self {
        Self(self.0.map(|v| v / by))
    }
}

impl AddAssign for Spectrum {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for Spectrum {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::ZERO, Self::add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white() {
        let white = Spectrum::ONE.rgb();
        assert!((white - Vec3::ONE).abs().max_element() < 1e-5, "{white}");
    }
}
