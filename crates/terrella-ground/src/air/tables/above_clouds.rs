//! The atmosphere above a cloud layer. Only this part affects the light of clouds.

use super::interpolation::{InterpolationBound, LitFromOutside};
use super::{AirOptions, Builder, Outside, RAYS, SUNLIGHT};
use crate::air::model::AirModel;
use glam::{Vec3, Vec4};
use std::sync::OnceLock;

/// Cloud height of the tables that ship with the crate, metres.
pub(super) const SHIPPED_M: f64 = 6_000.0;

/// Tables of [`AirTables`](super::AirTables) with the cloud layer in place of the ground. An opaque cloud is a Lambertian sheet
/// there.
pub struct AirAboveClouds {
    /// Light scattered into a ray over a black layer, for [`RAYS`] rays that meet the layer.
    pub scattering: Vec<Vec4>,
    /// Light from the layer that the atmosphere scatters into a ray.
    pub bounce: Vec<Vec4>,
    /// Transmittance of a ray.
    pub through: Vec<Vec4>,
    /// Sunlight on the layer and irradiance of the sky.
    pub sunlight: Vec<Vec4>,
    /// Fraction of the layer's light that the atmosphere returns to the layer, RGB.
    pub sky_albedo: Vec3,
    pub(super) interpolation: OnceLock<InterpolationBound>,
}

impl AirAboveClouds {
    /// Computes the tables; uses all cores.
    pub fn compute(options: &AirOptions, height_m: f64) -> Self {
        let builder = Builder::new(AirModel::above(options, height_m));
        let Outside {
            scattering,
            bounce,
            through,
        } = builder.outside(RAYS);
        Self {
            scattering,
            bounce,
            through,
            sunlight: builder.sunlight(),
            sky_albedo: builder.sources.sky_albedo.rgb(),
            interpolation: OnceLock::new(),
        }
    }

    /// Irradiance of the sky on the layer, as a row of
    /// [`AirTables::sunlight`](super::AirTables::sunlight).
    pub fn sky(&self) -> &[Vec4] {
        &self.sunlight[SUNLIGHT.x as usize..]
    }

    /// Where the light of clouds may be interpolated; computed on first use.
    pub fn interpolation(&self) -> &InterpolationBound {
        self.interpolation
            .get_or_init(|| InterpolationBound::new(&self.lit_from_outside()))
    }

    fn lit_from_outside(&self) -> LitFromOutside<'_> {
        LitFromOutside {
            rays: RAYS,
            scattering: &self.scattering,
            bounce: &self.bounce,
            through: &self.through,
            sunlight: &self.sunlight,
            sky_albedo: self.sky_albedo,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::tables::{AirTables, SCATTERING};
    use std::f32::consts::PI;

    /// Light of a thick cloud under a Sun abeam at one zenith cosine, seen at another zenith
    /// cosine.
    fn cloud(aerosol_optical_depth: f64, mu: f64, mu_s: f64) -> Vec3 {
        let options = AirOptions {
            aerosol_optical_depth,
        };
        let tables = AirAboveClouds::shared(&options, SHIPPED_M);
        let lit = tables.lit_from_outside();
        lit.at(mu as f32, mu_s as f32, 0.5 * PI).seen(0.7)
    }

    /// The aerosol is below the clouds. When clouds were dimmed by all of the air, the error was 26 %.
    #[test]
    fn haze_below_clouds_does_not_dim_them() {
        for zenith_deg in [0.0, 30.0, 60.0, 75.0_f64] {
            for sun_deg in [20.0, 60.0_f64] {
                let [clear, hazy] = [0.0, 0.5].map(|depth| {
                    cloud(
                        depth,
                        zenith_deg.to_radians().cos(),
                        sun_deg.to_radians().cos(),
                    )
                });
                let change = (hazy / clear - Vec3::ONE).abs().max_element();
                assert!(change < 0.03, "{zenith_deg} {sun_deg}: {clear} {hazy}");
            }
        }
    }

    /// Light of a grey Lambertian layer at 6 km from an independent program. The file says how it was
    /// computed.
    const RADIATIVE_TRANSFER: &str =
        include_str!("../../../../../tests/data/air/lambert_layer_6_km.csv");

    #[test]
    fn a_layer_is_as_bright_as_radiative_transfer_says() {
        let options = AirOptions {
            aerosol_optical_depth: 0.0,
        };
        let tables = AirAboveClouds::shared(&options, SHIPPED_M);
        let rows = RADIATIVE_TRANSFER.lines().skip(5);
        let rows: Vec<[f32; 7]> = rows
            .map(|row| {
                let mut numbers = row.split(',').map(|n| n.parse().expect("a number"));
                std::array::from_fn(|_| numbers.next().expect("seven"))
            })
            .collect();
        assert_eq!(rows.len(), 63);
        let mut worst = 0.0_f32;
        for [sun_deg, albedo, view_deg, azimuth_deg, red, green, blue] in rows {
            let (mu, mu_s) = (view_deg.to_radians().cos(), sun_deg.to_radians().cos());
            let lit = tables.lit_from_outside();
            let found = lit.over(albedo, (mu, mu_s, azimuth_deg.to_radians()));
            let right = Vec3::new(red, green, blue);
            let off = ((found - right) / right.max_element()).abs().max_element();
            worst = worst.max(off);
            assert!(
                off < 0.015,
                "{sun_deg} {albedo} {view_deg} {azimuth_deg}: {found} for {right}"
            );
        }
        println!("worst {worst}");
    }

    #[test]
    fn at_the_ground_the_air_above_is_all_air() {
        let options = AirOptions::default();
        let (all, above) = (
            AirTables::shared(&options),
            AirAboveClouds::compute(&options, 0.0),
        );
        let rows = |texels: &[Vec4]| -> Vec<Vec4> {
            texels
                .chunks(SCATTERING.x as usize)
                .flat_map(|row| row[..RAYS as usize].to_vec())
                .collect()
        };
        for (whole, part) in [
            (&all.scattering, &above.scattering),
            (&all.bounce, &above.bounce),
            (&all.through, &above.through),
        ] {
            let whole = rows(whole);
            assert_eq!(whole.len(), part.len());
            for (a, b) in whole.iter().zip(part) {
                assert!((*a - *b).abs().max_element() < 1e-3, "{a} {b}");
            }
        }
    }
}
