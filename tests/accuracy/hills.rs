//! Ground of a formula: sums of waves over the whole Earth, filtered to any spacing.

use terrella::frames::Ellipsoid;
use terrella_ground::elevation::{Bounds, Elevation, HeightRange};

/// Hills of several sizes.
pub struct Hills {
    /// Height in metres and wave number, about 1/radian, of each size.
    pub waves: &'static [(f64, f64)],
    /// The spacing of samples that shows all of them, radians.
    pub finest_spacing_rad: f64,
}

impl Elevation for Hills {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let p = Ellipsoid::normal(lat_rad, lon_rad);
        let wave = |(height_m, k): &(f64, f64)| {
            let fades = (-(0.5 * k * spacing_rad).powi(2)).exp();
            height_m * fades * (k * p.x).sin() * (k * p.y).cos() * (k * p.z).cos()
        };
        self.waves.iter().map(wave).sum()
    }

    fn range_m(&self, _: &Bounds) -> HeightRange {
        let most: f64 = self.waves.iter().map(|(height_m, _)| height_m).sum();
        HeightRange {
            low_m: -most,
            high_m: most,
        }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        self.finest_spacing_rad
    }
}
