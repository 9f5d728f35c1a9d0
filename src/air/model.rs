//! What the air is made of: density, scattering and absorption against height.

use glam::DVec3;

/// One kind of scatterer with an exponential profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Species {
    /// Scattering coefficient at sea level for red, green and blue, 1/m.
    pub scattering_per_m: DVec3,
    /// Extinction (scattering and absorption) at sea level, 1/m.
    pub extinction_per_m: DVec3,
    /// Scale height, metres.
    pub scale_height_m: f64,
}

/// A whole atmosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirModel {
    /// Thickness above the surface, metres.
    pub thickness_m: f64,
    /// Radius of the surface, metres.
    pub radius_m: f64,
    /// Molecules (Rayleigh scattering).
    pub molecules: Species,
    /// Aerosol (Mie scattering).
    pub aerosol: Species,
    /// Asymmetry g of the aerosol's phase function.
    pub aerosol_asymmetry: f64,
    /// Ozone absorption at its densest, 1/m; a tent about `ozone_center_m` of half width `ozone_half_width_m`.
    pub ozone_absorption_per_m: DVec3,
    /// Height of the ozone layer's middle, metres.
    pub ozone_center_m: f64,
    /// Half width of the ozone layer, metres.
    pub ozone_half_width_m: f64,
    /// Mean reflectance of the ground under the air, for multiple scattering.
    pub ground_albedo: f64,
}

/// The Earth's air, at the dominant wavelengths of the sRGB primaries: 611, 549 and 464 nm.
///
/// Molecules: 13.558e-6 /m at 550 nm (Bruneton and Neyret 2008) by the λ⁻⁴ law. Ozone: 1.881e-6 /m at 550 nm
/// (Bruneton 2017) by the ratio of the cross sections of Serdyuchenko et al. 2014. Aerosol: Bruneton and Neyret 2008.
/// The usual 680, 550 and 440 nm, taken as red, green and blue, would tint the limb violet.
pub const EARTH_AIR: AirModel = AirModel {
    thickness_m: 100_000.0,
    radius_m: 6_378_137.0,
    molecules: Species {
        scattering_per_m: DVec3::new(8.90e-6, 13.66e-6, 26.77e-6),
        extinction_per_m: DVec3::new(8.90e-6, 13.66e-6, 26.77e-6),
        scale_height_m: 8_000.0,
    },
    aerosol: Species {
        scattering_per_m: DVec3::splat(3.996e-6),
        extinction_per_m: DVec3::splat(4.44e-6),
        scale_height_m: 1_200.0,
    },
    aerosol_asymmetry: 0.8,
    ozone_absorption_per_m: DVec3::new(2.28e-6, 1.86e-6, 0.225e-6),
    ozone_center_m: 25_000.0,
    ozone_half_width_m: 15_000.0,
    ground_albedo: 0.3,
};

/// Coefficients at one height, per equatorial radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Medium {
    pub molecules: DVec3,
    pub aerosol: DVec3,
    pub extinction: DVec3,
}

impl AirModel {
    /// Upper boundary in scaled space, 1 + H/a.
    pub fn top(&self) -> f64 {
        1.0 + self.thickness_m / self.radius_m
    }

    /// Part of the molecules of a column that lies below a height, metres, 0…1.
    pub fn part_below(&self, height_m: f64) -> f64 {
        -(-height_m.max(0.0) / self.molecules.scale_height_m).exp_m1()
    }

    /// The air at radius `r` of scaled space.
    pub(super) fn medium(&self, r: f64) -> Medium {
        let h = ((r - 1.0) * self.radius_m).max(0.0);
        let molecules = (-h / self.molecules.scale_height_m).exp();
        let aerosol = (-h / self.aerosol.scale_height_m).exp();
        let ozone = (1.0 - (h - self.ozone_center_m).abs() / self.ozone_half_width_m).max(0.0);
        Medium {
            molecules: self.molecules.scattering_per_m * (molecules * self.radius_m),
            aerosol: self.aerosol.scattering_per_m * (aerosol * self.radius_m),
            extinction: (self.molecules.extinction_per_m * molecules
                + self.aerosol.extinction_per_m * aerosol
                + self.ozone_absorption_per_m * ozone)
                * self.radius_m,
        }
    }

    /// Rayleigh phase function, 1/sr: 3/(16π)(1 + cos²).
    pub fn molecule_phase(cos: f64) -> f64 {
        3.0 / (16.0 * std::f64::consts::PI) * (1.0 + cos * cos)
    }

    /// Cornette–Shanks phase function with asymmetry g, 1/sr.
    pub fn aerosol_phase(&self, cos: f64) -> f64 {
        let g = self.aerosol_asymmetry;
        let k = 3.0 / (8.0 * std::f64::consts::PI) * (1.0 - g * g) / (2.0 + g * g);
        k * (1.0 + cos * cos) / (1.0 + g * g - 2.0 * g * cos).max(1e-9).powf(1.5)
    }
}
