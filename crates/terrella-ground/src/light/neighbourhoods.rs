//! Coarse maps of neighbourhoods of the Earth, some 600 km wide.

use glam::{DVec3, Vec4};
use std::f64::consts::{PI, TAU};

/// Columns and rows of such a map: the whole Earth, north row first, left edge at 180° W. The last column is repeated before
/// the first, and the first after the last.
pub(super) const COLUMNS: usize = 66;
pub(super) const ROWS: usize = 32;

/// Light of lamps in each neighbourhood, the brightest lamps being 1. Empty without lamps.
#[derive(Clone, Debug, Default)]
pub struct Lamps(Vec<f32>);

impl Lamps {
    /// From 66 × 32 texels, row by row from the north, from 180° W. The last column is repeated before the first, and the first after the
    /// last.
    pub fn new(texels: Vec<f32>) -> Self {
        Self(texels)
    }

    /// Whether there are none anywhere.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Their light at the place with this normal (ITRF axes).
    pub fn at(&self, up: DVec3) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let texel = |at: usize| Vec4::splat(self.0.get(at).copied().unwrap_or_default());
        f64::from(between(up, texel).x)
    }
}

/// Texel value at a place, interpolated between texel centres.
pub(super) fn between(up: DVec3, texel: impl Fn(usize) -> Vec4) -> Vec4 {
    // The first column repeats the last one.
    let u = (up.y.atan2(up.x) / TAU + 0.5) * (COLUMNS - 2) as f64 + 0.5;
    let v = (0.5 - up.z.clamp(-1.0, 1.0).asin() / PI) * ROWS as f64 - 0.5;
    let at = |column: f64, row: f64| {
        let column = column.clamp(0.0, (COLUMNS - 1) as f64) as usize;
        let row = row.clamp(0.0, (ROWS - 1) as f64) as usize;
        texel(row * COLUMNS + column)
    };
    let (left, top) = (u.floor(), v.floor());
    let (across, down) = ((u - left) as f32, (v - top) as f32);
    let line = |row| at(left, row).lerp(at(left + 1.0, row), across);
    line(top).lerp(line(top + 1.0), down)
}
