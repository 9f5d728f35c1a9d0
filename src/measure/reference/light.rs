//! What falls on the ground: the Sun, and the sky.

use super::air::{Air, gather, spread};
use super::grid::{Gauss, Table1d};
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Sine of the Sun's angular radius, 0.27°.
const SUN_RADIUS: f64 = 0.004_65;

/// Light on the ground as a fraction of the Sun's irradiance in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    /// Irradiance of a sheet that faces the Sun.
    pub sun: DVec3,
    /// Irradiance of level ground by the sky.
    pub sky: DVec3,
}

/// Light on the ground under the air against the Sun's zenith cosine.
#[derive(Debug)]
pub(super) struct GroundLight {
    sun: Table1d,
    sky: Table1d,
}

/// How much finer the Sun's cosines are divided at the terminator, as the parameter of a sinh: there 5e-5 apart.
const SUN_SPREAD: f64 = 6.0;

impl GroundLight {
    /// Under the Earth's air. Made once per process.
    pub fn earth() -> &'static Self {
        static LIGHT: OnceLock<GroundLight> = OnceLock::new();
        LIGHT.get_or_init(|| Self::new(Air::earth(), 2048, 128, 16))
    }

    /// Computes both tables with so many values; the sky from `2 · around²` directions.
    pub fn new(air: &Air, sun: usize, sky: usize, around: usize) -> Self {
        let up = Gauss::new(around);
        Self {
            sun: Table1d::fill(sun, |x| {
                disc(
                    (SUN_SPREAD * (2.0 * x - 1.0)).sinh() / SUN_SPREAD.sinh(),
                    air,
                )
            }),
            sky: Table1d::fill(sky, |x| air.skylight(spread(x), &up, around)),
        }
    }

    /// The light where the Sun's middle stands at zenith cosine `mu`.
    pub fn at(&self, mu: f64) -> Light {
        let x = 0.5 + 0.5 * (mu * SUN_SPREAD.sinh()).asinh() / SUN_SPREAD;
        Light {
            // Cubics may swing below nothing where night begins.
            sun: self.sun.at(x).max(DVec3::ZERO),
            sky: self.sky.at(gather(mu)).max(DVec3::ZERO),
        }
    }
}

/// Sunlight on the ground, averaged over the Sun's disc by chords of equal height: Chebyshev's rule of the second kind,
/// whose weight √(1 − x²) is the chord's length.
fn disc(mu: f64, air: &Air) -> DVec3 {
    const CHORDS: u32 = 24;
    let across = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
    let chord = |i: u32| {
        let angle = PI * f64::from(i) / f64::from(CHORDS + 1);
        let (sin, cos) = (SUN_RADIUS * angle.cos()).sin_cos();
        let weight = angle.sin().powi(2) * 2.0 / f64::from(CHORDS + 1);
        air.sunlight(0.0, mu * cos + across * sin) * weight
    };
    (1..=CHORDS).map(chord).sum()
}

/// The light of a Sun without air: its disc sets gradually, by the cubic 3x² − 2x³ between its first and last edge.
pub(super) fn without_air(mu: f64) -> Light {
    Light {
        sun: DVec3::splat(smooth_step(-SUN_RADIUS, SUN_RADIUS, mu)),
        sky: DVec3::ZERO,
    }
}

/// 0 below `from`, 1 above `to`, between them 3x² − 2x³.
pub(super) fn smooth_step(from: f64, to: f64, x: f64) -> f64 {
    let x = ((x - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
