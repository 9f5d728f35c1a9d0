//! The light that a place of the ground sends to the eye: the light model of the picture, from its definitions.

use super::light::{GroundLight, Light, smooth_step, without_air};
use super::maps::{Decode, FullMaps, linear_from_srgb};
use crate::Shading;
use crate::imagery::tile::MapLayer;
use glam::DVec3;
use std::f64::consts::PI;

/// Reflectance of a cloud.
const CLOUD_ALBEDO: f64 = 0.85;

/// Colour of street lamps and what the brightest are drawn with.
const LAMP_COLOR: DVec3 = DVec3::new(1.0, 0.72, 0.38);
const LAMP_LIGHT: f64 = 0.6;

/// Mean square slope of the waves by Cox and Munk 1954, J. Opt. Soc. Am. 44, 838: 0.003 + 0.00512 W for a wind of
/// W = 7 m/s.
const WAVE_SLOPE_SQUARED: f64 = 0.003 + 0.005_12 * 7.0;

/// Index of refraction of sea water.
const WATER_INDEX: f64 = 1.33;

/// A place on the ground and where it is seen from.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadingPoint {
    /// Outward normal of the ellipsoid, a unit vector in ITRF axes.
    pub up: DVec3,
    /// Towards the eye, a unit vector.
    pub to_eye: DVec3,
}

/// The ground's light model with all that it depends on but the place.
#[derive(Debug)]
pub(super) struct GroundShader {
    pub maps: FullMaps,
    decode: Decode,
    shading: Shading,
    /// `None` without air.
    light: Option<&'static GroundLight>,
}

impl GroundShader {
    pub fn new(maps: FullMaps, shading: Shading, light: Option<&'static GroundLight>) -> Self {
        Self {
            maps,
            decode: Decode::new(),
            shading,
            light,
        }
    }

    /// What the light of [`Self::shade`] is multiplied by: the paper's display values have no exposure.
    pub fn exposure(&self, exposure: f64) -> f64 {
        match self.shading {
            Shading::Sunlit => exposure,
            Shading::Paper => 1.0,
        }
    }

    /// Linear light of a place: with [`Shading::Sunlit`] a white sheet that faces the Sun in space is 1, with
    /// [`Shading::Paper`] 1 is the display's white.
    pub fn shade(&self, point: &ShadingPoint, sun: DVec3) -> DVec3 {
        let up = point.up;
        let across = up.x.hypot(up.y);
        let east = if across > 0.0 {
            DVec3::new(-up.y, up.x, 0.0) / across
        } else {
            DVec3::Y
        };
        let u = 0.5 + up.y.atan2(up.x) / (2.0 * PI);
        let v = 0.5 - up.z.atan2(across) / PI;
        let north = up.cross(east);
        let one = |layer| -> Option<f64> {
            let [value] = self.maps.get(layer)?.at(u, v, &self.decode.unorm);
            Some(value)
        };
        let normal = match self.maps.get(MapLayer::Normals) {
            Some(map) => {
                let [to_east, to_north] = map.at(u, v, &self.decode.snorm);
                (up - east * to_east - north * to_north).normalize()
            }
            None => up,
        };
        let day = |decode| match self.maps.get(MapLayer::Day) {
            Some(map) => DVec3::from_array(map.at(u, v, decode)),
            None => DVec3::ZERO,
        };
        let cover = one(MapLayer::Clouds);
        if self.shading == Shading::Paper {
            return paper(
                day(&self.decode.unorm),
                cover.unwrap_or(0.0),
                normal.dot(sun),
            );
        }
        let mu = up.dot(sun);
        let light = match self.light {
            Some(light) => light.at(mu),
            None => without_air(mu),
        };
        let mut color = day(&self.decode.srgb) * (light.sun * normal.dot(sun).max(0.0) + light.sky);
        if let Some(sea) = one(MapLayer::Water) {
            color += glint(point, sun, mu, &light) * sea;
        }
        if let Some(glow) = one(MapLayer::NightLights) {
            // Lamps go on at dusk, the brightest stand out.
            let on = 1.0 - smooth_step(-0.12, 0.02, mu);
            color += LAMP_COLOR * (LAMP_LIGHT * (glow * on).powi(2));
        }
        if let Some(cover) = cover {
            let cloud = (light.sun * mu.max(0.0) + light.sky) * CLOUD_ALBEDO;
            color = color * (1.0 - cover) + cloud * cover;
        }
        color
    }
}

/// Section 1.2 of the 2011 paper, in display values: ninfo = saturate(n·L + 0.3)·1.1, and
/// out = (1 − (1 − earth)(1 − cloud))·ninfo. Returned as linear light.
fn paper(earth: DVec3, cloud: f64, cos: f64) -> DVec3 {
    let ninfo = (cos + 0.3).clamp(0.0, 1.0) * 1.1;
    let shown = (DVec3::ONE - (DVec3::ONE - earth) * (1.0 - cloud)) * ninfo;
    shown
        .clamp(DVec3::ZERO, DVec3::ONE)
        .to_array()
        .map(linear_from_srgb)
        .into()
}

/// Sunlight mirrored by the sea, by Cox and Munk:
///   L/E = ρ(ω) p(β) / (4 cos θ cos⁴β),  p = exp(−tan²β/σ²)/(πσ²)
/// where β tilts a wave so that it mirrors the Sun into the eye, and ρ is Schlick's approximation of Fresnel's law. cos θ
/// is kept from 0, where waves hide each other, and the glint fades with the last sunlight.
fn glint(point: &ShadingPoint, sun: DVec3, mu: f64, light: &Light) -> DVec3 {
    let half_way = (point.to_eye + sun).normalize_or_zero();
    let cos_squared = half_way.dot(point.up).max(1e-3).powi(2);
    let tan_squared = (1.0 - cos_squared) / cos_squared;
    let slopes = (-tan_squared / WAVE_SLOPE_SQUARED).exp() / (PI * WAVE_SLOPE_SQUARED);
    let head_on = ((WATER_INDEX - 1.0) / (WATER_INDEX + 1.0)).powi(2);
    let miss = 1.0 - half_way.dot(point.to_eye).clamp(0.0, 1.0);
    let fresnel = head_on + (1.0 - head_on) * miss.powi(5);
    let seen_cos = point.to_eye.dot(point.up).max(0.15);
    // A white sheet that faces the Sun is L = E/π.
    let mirrored = PI * fresnel * slopes / (4.0 * seen_cos * cos_squared * cos_squared);
    light.sun * (mirrored * smooth_step(-0.01, 0.05, mu))
}
