//! Terrain, light and air of an Earth.

use super::{EarthError, GroundOptions, SurfaceLight};
use terrella_ground::air::AirOptions;

/// Terrain, light and air of an Earth: what [`Earth::change_maker`](crate::Earth::change_maker) changes while it is drawn, besides maps and
/// quality. The same fields of [`EarthOptions`](crate::EarthOptions) explain them.
#[derive(Clone, Debug, Default)]
pub struct Appearance {
    /// Terrain; `None` is the smooth ellipsoid.
    pub ground: Option<GroundOptions>,
    /// Options of the light on the surface.
    pub light: SurfaceLight,
    /// Contents of the atmosphere.
    pub air: AirOptions,
}

impl Appearance {
    /// Whether its numbers are in their ranges.
    pub(super) fn check(&self) -> Result<(), EarthError> {
        if let Some((name, value, range)) = self.light.out_of_range() {
            let (low, high) = range.into_inner();
            return Err(EarthError::SurfaceLight {
                name,
                value,
                low,
                high,
            });
        }
        let haze = self.air.aerosol_optical_depth;
        if (0.0..=AirOptions::MAX_AEROSOL).contains(&haze) {
            Ok(())
        } else {
            Err(EarthError::Aerosol(haze))
        }
    }

    /// Whether the terrain is the same: the same surface over the same elevation data.
    pub(super) fn has_ground_of(&self, other: &Self) -> bool {
        match (&self.ground, &other.ground) {
            (None, None) => true,
            (Some(ground), Some(other)) => ground.is_same(other),
            _ => false,
        }
    }

    /// Whether the textures of the air are the same.
    pub(super) fn has_air_textures_of(&self, other: &Self) -> bool {
        self.air == other.air
            && self.light.cloud_height_m == other.light.cloud_height_m
            && self.light.moonlight == other.light.moonlight
    }
}
