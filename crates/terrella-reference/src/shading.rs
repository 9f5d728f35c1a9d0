//! The light that a place of the ground sends to the eye: the light model of the picture, from its definitions.

use super::clouds_from_below::CloudSeenFromBelow;
use super::directional::DirectionalReflectance;
use super::light::{ByZenith, EarthAir, Light, smooth_step, without_air};
use super::maps::{Decode, FullMaps, linear_from_srgb};
use super::over_ground::{CloudLayer, Sea};
use super::shading_point::ShadingPoint;
use super::surroundings::Surroundings;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;
use terrella::internals::earth::CITY_RADIANCE;
use terrella::{Shading, SurfaceLight, Tone};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{CLOUD_ALBEDO, SLOPE_EXAGGERATION};

/// Colour of street lamps.
const LAMP_COLOR: DVec3 = DVec3::new(1.0, 0.72, 0.38);
/// Sine of the Sun's height at which all of them are on: 6° below the horizon.
const LAMPS_FULL: f64 = -0.104_528_463;

/// Of the air above clouds.
#[derive(Debug)]
struct AirAboveClouds {
    /// The Sun's light there, which it leaves later than the ground.
    sun: ByZenith,
    air: Arc<EarthAir>,
}

/// Effect of the air in front of a point on its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct AirFactors {
    pub ground: Light,
    /// `None` without air.
    pub clouds: Option<CloudFactors>,
    /// Whether clouds are between the eye and the ground.
    pub sees_clouds: bool,
}

impl AirFactors {
    /// Nothing.
    pub const NONE: Self = Self {
        ground: Light::WHOLE,
        clouds: None,
        sees_clouds: true,
    };
}

/// Effect of the air in front of a cloud on its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct CloudFactors {
    pub factors: Light,
    /// Light that the air before it adds, less what the air before the ground adds.
    pub more: DVec3,
}

/// The ground's light model with all that it depends on but the place.
#[derive(Debug)]
pub(super) struct GroundShader {
    pub maps: FullMaps,
    decode: Decode,
    shading: Shading,
    surface: SurfaceLight,
    sea: Sea,
    clouds: CloudLayer,
    /// `None` without air.
    air: Option<Arc<EarthAir>>,
    /// Of clouds, only where there are some and air.
    above_clouds: Option<AirAboveClouds>,
    /// Only where there is air for it to light.
    surroundings: Option<Surroundings>,
}

impl GroundShader {
    pub fn new(
        maps: FullMaps,
        shading: Shading,
        surface: SurfaceLight,
        aerosol_optical_depth: Option<f64>,
    ) -> Self {
        let air = aerosol_optical_depth.map(EarthAir::of);
        let decode = Decode::new();
        let surroundings = air
            .is_some()
            .then(|| Surroundings::new(&maps, &decode, CLOUD_ALBEDO));
        let clouds = CloudLayer::new(&surface);
        let has_clouds = shading == Shading::Sunlit && maps.get(MapLayer::Clouds).is_some();
        let with_clouds = aerosol_optical_depth.filter(|_| has_clouds);
        let above_clouds = with_clouds.map(|depth| AirAboveClouds {
            sun: EarthAir::of(depth).sun_at(clouds.height),
            air: EarthAir::above(surface.cloud_height_m, depth),
        });
        Self {
            maps,
            decode,
            shading,
            sea: Sea::new(&surface),
            clouds,
            surface,
            air,
            above_clouds,
            surroundings,
        }
    }

    /// The air over it.
    pub fn air(&self) -> Option<&EarthAir> {
        self.air.as_deref()
    }

    /// The air above the clouds, where there are some, and their height, equatorial radii.
    pub fn above_clouds(&self) -> Option<(&EarthAir, f64)> {
        let above = self.above_clouds.as_ref()?;
        Some((&above.air, self.clouds.height))
    }

    /// Reflectance of the ground about a place, whose outward normal is `up`.
    pub fn albedo_about(&self, up: DVec3) -> DVec3 {
        let (u, v) = map_coordinates(up);
        self.surroundings
            .as_ref()
            .map_or(DVec3::ZERO, |around| around.all.at(u, v))
    }

    /// Exposure factor of the light of [`Self::shade`]: the paper's display values have none.
    pub fn exposure(&self, exposure: f64) -> f64 {
        match self.shading {
            Shading::Sunlit => exposure,
            Shading::Paper => 1.0,
        }
    }

    /// Display light, 0…1: light through the tone curve, which the paper has not.
    pub fn shown(&self, light: DVec3, tone: Tone) -> DVec3 {
        match self.shading {
            Shading::Sunlit => tone.shown(light),
            Shading::Paper => light.clamp(DVec3::ZERO, DVec3::ONE),
        }
    }

    /// Linear light of a place that comes to the eye: with [`Shading::Sunlit`] a white sheet that faces the Sun in space is
    /// 1, with [`Shading::Paper`] 1 is the display's white.
    pub fn shade(&self, point: &ShadingPoint, sun: DVec3, air: &AirFactors) -> DVec3 {
        let factors = &air.ground;
        let up = point.up;
        let across = up.x.hypot(up.y);
        let east = if across > 0.0 {
            DVec3::new(-up.y, up.x, 0.0) / across
        } else {
            DVec3::Y
        };
        let (u, v) = map_coordinates(up);
        let north = up.cross(east);
        let one = |layer| -> Option<f64> {
            let [value] = self.maps.get(layer)?.at(u, v, &self.decode.unorm);
            Some(value)
        };
        // Terrain has its own slopes.
        let slope = point.slope.or_else(|| {
            let map = self.maps.get(MapLayer::Normals)?;
            let gain = self.surface.relief_exaggeration / SLOPE_EXAGGERATION;
            Some(DVec2::from_array(map.at(u, v, &self.decode.snorm)) * gain)
        });
        let normal = slope.map_or(up, |slope| {
            (up - east * slope.x - north * slope.y).normalize()
        });
        let day = |decode| match self.maps.get(MapLayer::Day) {
            Some(map) => DVec3::from_array(map.at(u, v, decode)),
            None => DVec3::ZERO,
        };
        if self.shading == Shading::Paper {
            let shown = paper(
                day(&self.decode.unorm),
                one(MapLayer::Clouds).unwrap_or(0.0),
                normal.dot(sun),
            );
            return shown * factors.own;
        }
        let mu = up.dot(sun);
        let before = |mu| match &self.air {
            Some(air) => air.at(mu),
            None => without_air(mu),
        };
        let above = before(mu).times(factors);
        let shadow = self.clouds.shadow_from(up, sun);
        let light = match self.cloud_albedo(shadow) {
            Some(albedo) if self.clouds.has_shadows => self.clouds.below(&above, albedo, mu),
            _ => above,
        };
        let to_sun = point.to_eye.dot(sun);
        let opposition = match self.surface.directional_reflectance {
            true => DirectionalReflectance::get().of_opposition(to_sun, mu),
            false => 1.0,
        };
        let falls = normal.dot(sun).max(0.0) * opposition;
        let mut color = day(&self.decode.srgb) * (light.sun * falls + light.sky);
        // The coast line is where the map is one half.
        if one(MapLayer::Water).is_some_and(|water| water > 0.5) {
            let depth = self.maps.get(MapLayer::Day).map_or(1.0, |map| {
                let [_, _, _, depth] = map.at(u, v, &self.decode.unorm);
                depth
            });
            color = self.sea.light(point, sun, mu, &light, depth);
        }
        if let Some(glow) = one(MapLayer::NightLights) {
            // City lights switch on at dusk.
            let on = 1.0 - smooth_step(LAMPS_FULL, 0.0, mu);
            let brightest = CITY_RADIANCE * self.surface.night_gain;
            // The map is a picture; its fourth power spans what radiometers find between hamlets and cities.
            color += light.own * LAMP_COLOR * (brightest * on * glow.powi(4));
        }
        let over = self.clouds.above(up, point.to_eye);
        if air.sees_clouds
            && let Some((light, albedo)) =
                self.clouds_from_above(over, point.to_eye, sun, air.clouds.as_ref())
        {
            color = light + color * (1.0 - albedo);
        }
        color
    }

    /// Light to the eye of the clouds with this outward normal, seen from above through this air, and their reflectance for diffuse light.
    pub fn clouds_from_above(
        &self,
        up: DVec3,
        to_eye: DVec3,
        sun: DVec3,
        air: Option<&CloudFactors>,
    ) -> Option<(DVec3, f64)> {
        let albedo = self.cloud_albedo(up)?;
        let mu = up.dot(sun);
        let cosines = (up.dot(to_eye), to_eye.dot(sun));
        let reflected = self.clouds.reflected(albedo, mu, cosines);
        let light = match (&self.above_clouds, air) {
            (Some(clouds), Some(before)) => {
                let sunlight = clouds.sun.at(mu) * before.factors.sun;
                let skylight = clouds.air.at(mu).sky * before.factors.sky;
                sunlight * reflected + albedo * (skylight + before.more)
            }
            _ => self.clouds.sunlight_without_air(mu) * reflected,
        };
        Some((light, albedo))
    }

    /// Height of the clouds, equatorial radii; `None` without.
    pub fn cloud_height(&self) -> Option<f64> {
        let map = self.maps.get(MapLayer::Clouds);
        map.filter(|_| self.shading == Shading::Sunlit)
            .map(|_| self.clouds.height)
    }

    /// Clouds with this outward normal as an eye below them sees them along a ray; `None` of a clear sky.
    pub fn clouds_from_below(
        &self,
        up: DVec3,
        ray: DVec3,
        sun: DVec3,
    ) -> Option<CloudSeenFromBelow> {
        let albedo = self.cloud_albedo(up).filter(|albedo| *albedo > 0.0)?;
        let mu = up.dot(sun);
        let light = match &self.above_clouds {
            Some(clouds) => Light {
                sun: clouds.sun.at(mu),
                sky: clouds.air.at(mu).sky,
                ..Light::WHOLE
            },
            None => Light {
                sun: self.clouds.sunlight_without_air(mu),
                sky: DVec3::ZERO,
                ..Light::WHOLE
            },
        };
        let (u, v) = map_coordinates(up);
        let around = self.surroundings.as_ref();
        let ground = around.map_or(DVec3::ZERO, |around| around.ground.at(u, v));
        let cosines = (up.dot(ray), mu, ray.dot(sun));
        Some(CloudSeenFromBelow::new(albedo, cosines, &light, ground))
    }

    /// Reflectance of clouds at a point for diffuse light, 0…1.
    fn cloud_albedo(&self, up: DVec3) -> Option<f64> {
        let (u, v) = map_coordinates(up);
        let [cover] = self
            .maps
            .get(MapLayer::Clouds)?
            .at(u, v, &self.decode.unorm);
        Some(CLOUD_ALBEDO * cover)
    }
}

/// Where a map shows the place with this outward normal: from 180° W and from the north pole, 0…1.
fn map_coordinates(up: DVec3) -> (f64, f64) {
    let across = up.x.hypot(up.y);
    let u = 0.5 + up.y.atan2(up.x) / (2.0 * PI);
    (u, 0.5 - up.z.atan2(across) / PI)
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
