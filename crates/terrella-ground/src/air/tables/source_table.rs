//! Source functions of multiply scattered light, by height and Sun.

use super::height_coordinate;
use crate::air::spectrum::Spectrum;
use std::ops::AddAssign;

/// Coefficients of a source function.
pub(super) const COEFFICIENTS: usize = 6;
/// Sun cosines of the table, by `sun_coordinate`.
pub(super) const SUNS: usize = 48;
/// Heights of the table, by `height_coordinate`.
pub(super) const HEIGHTS: usize = 24;

/// Coefficients a0, bx, bz, cxx, czz, cxz of a source function.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SourceFunction(pub [Spectrum; COEFFICIENTS]);

impl SourceFunction {
    pub fn scaled(&self, by: Spectrum) -> Self {
        Self(self.0.map(|c| c * by))
    }

    fn lerp(&self, other: &Self, part: f32) -> Self {
        let mut out = *self;
        for (a, b) in out.0.iter_mut().zip(&other.0) {
            *a += (*b - *a) * part;
        }
        out
    }
}

impl AddAssign for SourceFunction {
    fn add_assign(&mut self, other: Self) {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a += *b;
        }
    }
}

/// Source functions per scattering coefficient, by height and Sun cosine. The division keeps them smooth where
/// densities are not.
#[derive(Clone)]
pub(super) struct SourceTable {
    /// Values in order of height.
    pub texels: Vec<SourceFunction>,
}

impl SourceTable {
    pub fn zero() -> Self {
        Self {
            texels: vec![SourceFunction::default(); HEIGHTS * SUNS],
        }
    }

    /// Values for all Suns at radius `r`.
    pub fn at(&self, r: f64) -> Vec<SourceFunction> {
        let at = height_coordinate(r) * (HEIGHTS - 1) as f64;
        let low = (at as usize).min(HEIGHTS - 2);
        let part = (at - low as f64) as f32;
        let row = |n: usize| &self.texels[n * SUNS..(n + 1) * SUNS];
        let pairs = row(low).iter().zip(row(low + 1));
        pairs.map(|(a, b)| a.lerp(b, part)).collect()
    }
}
