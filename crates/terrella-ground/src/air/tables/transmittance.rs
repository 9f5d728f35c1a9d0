//! Transmittance of sunlight to a point in the atmosphere.

use super::{Lerp, TRANSMITTANCE};
use crate::air::model::{AirModel, RADIUS_M, TOP};
use crate::air::spectrum::Spectrum;

/// Transmittance from a point to the upper boundary, by cosine above the horizon and by height.
pub(super) struct TransmittanceTable {
    pub texels: Vec<Spectrum>,
}

/// One row of the table: transmittance at one height by Sun cosine.
pub(super) struct SunRow<T = Spectrum> {
    row: Vec<T>,
    horizon: f32,
    scale: f32,
}

impl<T: Lerp> SunRow<T> {
    /// A row of transmittances from a point whose horizon has this cosine.
    pub fn new(row: Vec<T>, horizon: f64) -> Self {
        Self {
            row,
            horizon: horizon as f32,
            scale: (1.0 / (1.0 - horizon)) as f32,
        }
    }

    /// `None` where the Earth blocks the Sun.
    pub fn at(&self, mu: f32) -> Option<T> {
        if mu < self.horizon || self.row.is_empty() {
            return None;
        }
        let at = ((mu - self.horizon) * self.scale).sqrt() * (self.row.len() - 1) as f32;
        let low = (at as usize).min(self.row.len() - 2);
        Some(self.row[low].between(self.row[low + 1], at - low as f32))
    }
}

/// Cosine of the horizon's zenith angle at radius `r`: −√(r² − 1)/r.
pub(super) fn horizon_cosine(r: f64) -> f64 {
    -((r - 1.0).max(0.0) * (r + 1.0)).sqrt() / r
}

/// Distance along a ray to the upper boundary.
pub(super) fn to_top(r: f64, mu: f64) -> f64 {
    // −rμ + √(r²μ² + (top − r)(top + r)), without cancellation for rising rays.
    let half = r * mu;
    let c = (TOP - r).max(0.0) * (TOP + r);
    let root = (half * half + c).sqrt();
    if half > 0.0 {
        c / (half + root)
    } else {
        root - half
    }
}

/// Distance along a ray to the ground; the ray must meet it.
pub(super) fn to_ground(r: f64, mu: f64) -> f64 {
    let c = (r - 1.0).max(0.0) * (r + 1.0);
    let half = -r * mu;
    c / (half + (half * half - c).max(0.0).sqrt()).max(1e-300)
}

impl TransmittanceTable {
    pub fn compute(air: &AirModel) -> Self {
        let columns = ExtinctionProfile::new(air);
        let texels = super::fill(TRANSMITTANCE, |x, y, _| {
            let r = super::height_radius(y);
            let horizon = horizon_cosine(r);
            columns.transmittance(r, horizon + (1.0 - horizon) * x * x)
        });
        Self { texels }
    }

    /// The row at radius `r`; empty if not `wanted`.
    pub fn row(&self, r: f64, wanted: bool) -> SunRow {
        let row = match wanted {
            true => super::row_at(&self.texels, TRANSMITTANCE, r),
            false => Vec::new(),
        };
        SunRow::new(row, horizon_cosine(r))
    }

    /// Transmittance from radius `r` to the Sun at cosine `mu`; zero where the Earth blocks it.
    pub fn to_sun(&self, r: f64, mu: f64) -> Spectrum {
        self.row(r, true).at(mu as f32).unwrap_or(Spectrum::ZERO)
    }
}

/// Extinction on a fine grid of heights, which turns a transmittance into a sum of lookups.
struct ExtinctionProfile {
    values: Vec<Spectrum>,
}

impl ExtinctionProfile {
    const STEP_M: f64 = 50.0;

    fn new(air: &AirModel) -> Self {
        let count = ((TOP - 1.0) * RADIUS_M / Self::STEP_M) as u32 + 2;
        let height = |n: u32| f64::from(n) * Self::STEP_M / RADIUS_M;
        Self {
            values: (0..count)
                .map(|n| air.medium(1.0 + height(n)).extinction)
                .collect(),
        }
    }

    fn at(&self, r: f64) -> Spectrum {
        let at = ((r - 1.0) * (RADIUS_M / Self::STEP_M)).max(0.0);
        let low = (at as usize).min(self.values.len() - 2);
        let part = (at - low as f64).min(1.0) as f32;
        self.values[low].lerp(self.values[low + 1], part)
    }

    /// Transmittance from radius `r` to the upper boundary at zenith cosine `mu`. The ray must
    /// clear the ground.
    fn transmittance(&self, r: f64, mu: f64) -> Spectrum {
        const STEPS: u32 = 96;
        let length = to_top(r, mu);
        // Steps are dense where the ray is lowest.
        let crowd = (-r * mu / length.max(1e-12)).clamp(0.0, 1.0);
        let (low, high) = (-crowd.sqrt(), (1.0 - crowd).sqrt());
        let place = |n: u32| {
            let x = low + f64::from(n) / f64::from(STEPS) * (high - low);
            length * (crowd + x * x.abs())
        };
        let mut depth = Spectrum::ZERO;
        let mut begin = place(0);
        for n in 0..STEPS {
            let end = place(n + 1);
            let t = 0.5 * (begin + end);
            let radius = (r * r + t * t + 2.0 * r * mu * t).sqrt();
            depth += self.at(radius) * (end - begin) as f32;
            begin = end;
        }
        depth.exp_of_minus()
    }
}
