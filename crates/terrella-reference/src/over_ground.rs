//! The sea's light and the clouds', from their definitions.

use super::directional::DirectionalReflectance;
use super::light::{Light, smooth_step, without_air};
use super::shading_point::ShadingPoint;
use glam::DVec3;
use std::f64::consts::PI;
use terrella::SurfaceLight;
use terrella::frames::Ellipsoid;
use terrella_imagery::FLOOR_SEEN_M;

/// Part of the light that falls on clear ocean that comes out of it: π times the remote-sensing reflectance of Case 1 water
/// with 0.1 mg/m³ of chlorophyll a, by Morel and Maritorena 2001, in linear sRGB with the Sun as white.
const WATER_LEAVING: DVec3 = DVec3::new(0.0, 0.0042, 0.0194);
/// The same of turbid shelf water: 3 mg/m³ of chlorophyll a, 3 g/m³ of mineral particles, coloured matter of 0.2 /m at 443 nm, by
/// Lee, Carder and Arnone 2002.
const SHELF_LEAVING: DVec3 = DVec3::new(0.0139, 0.0327, 0.0117);
/// Latitudes between which shelves become turbid, degrees.
const TURBID_FROM_DEG: [f64; 2] = [25.0, 40.0];
/// The floor's reflectance, 0.3 for pale sand, times what of its light leaves the water.
const FLOOR_REFLECTANCE: f64 = 0.16;
/// Down to the floor and up again: twice the attenuation of light in that water, per metre.
const FLOOR_ATTENUATION: DVec3 = DVec3::new(0.68, 0.124, 0.056);
/// Index of refraction of sea water.
const WATER_INDEX: f64 = 1.34;
/// Reflectance of foam: Koepke 1984.
const FOAM_REFLECTANCE: f64 = 0.22;

/// Open water.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sea {
    /// Mean square slope of the waves: Cox and Munk 1954.
    slope_squared: f64,
    /// Part of the light that foam throws back: its cover by Monahan and O'Muircheartaigh 1980.
    foam: f64,
}

impl Sea {
    pub fn new(light: &SurfaceLight) -> Self {
        Self {
            slope_squared: 0.003 + 0.005_12 * light.wind_m_s,
            foam: FOAM_REFLECTANCE * 2.95e-6 * light.wind_m_s.powf(3.52),
        }
    }

    /// Its light: from the water, or from its floor at `depth` (0…1 of the visible part), foam, reflected sky, and sunglint.
    pub fn light(
        &self,
        point: &ShadingPoint,
        sun: DVec3,
        mu: f64,
        light: &Light,
        depth: f64,
    ) -> DVec3 {
        let through = (FLOOR_ATTENUATION * (-FLOOR_SEEN_M * depth)).exp();
        let floor = FLOOR_REFLECTANCE * (1.0 - depth).powi(2);
        let clear = WATER_LEAVING * (DVec3::ONE - through) + through * floor;
        let [from, to] = TURBID_FROM_DEG.map(|deg| deg.to_radians().sin());
        let turbid = smooth_step(from, to, point.up.z.abs()) * smooth_step(0.0, 0.5, 1.0 - depth);
        let leaving = clear.lerp(SHELF_LEAVING, turbid);
        let falls = light.sun * mu.max(0.0) + light.sky;
        let cos_eye = point.to_eye.dot(point.up).max(1e-3);
        // The mean of Fresnel's reflectance over the waves: Bruneton, Neyret and Holzschuch 2010, eq. 18.
        let sigma = (0.5 * self.slope_squared).sqrt();
        let power = 5.0 * (-2.69 * sigma).exp();
        let mirrored =
            0.0211 + 0.9789 * (1.0 - cos_eye).powf(power) / (1.0 + 22.7 * sigma.powf(1.5));
        falls * (leaving + self.foam)
            + light.sky * mirrored
            + light.sun * self.glint(point, sun, mu, cos_eye)
    }

    /// Sunlight that waves mirror into the eye, a white sheet that faces the Sun being 1, by Cox and Munk:
    ///   L/E = ρ(ω) p(β) G / (4 cos θ cos⁴β),  p = exp(−tan²β/σ²)/(πσ²)
    /// where β tilts a wave so that it mirrors the Sun, ρ is Fresnel's reflectance of light that is not polarised, and G is
    /// what waves leave of each other to be seen (Smith 1967).
    fn glint(&self, point: &ShadingPoint, sun: DVec3, mu: f64, cos_eye: f64) -> f64 {
        let half_way = (point.to_eye + sun).normalize_or_zero();
        let cos_squared = half_way.dot(point.up).max(1e-3).powi(2);
        let tan_squared = (1.0 - cos_squared) / cos_squared;
        let slopes = (-tan_squared / self.slope_squared).exp() / (PI * self.slope_squared);
        let seen = 1.0 / (1.0 + self.hidden(cos_eye) + self.hidden(mu.max(1e-3)));
        let mirrored = fresnel(half_way.dot(point.to_eye).clamp(0.0, 1.0));
        PI * mirrored * slopes * seen / (4.0 * cos_eye * cos_squared * cos_squared)
    }

    /// Smith's Λ in the rational form of Walter et al. 2007.
    fn hidden(&self, cos: f64) -> f64 {
        let a = cos / (self.slope_squared * (1.0 - cos * cos).max(1e-6)).sqrt();
        match a >= 1.6 {
            true => 0.0,
            false => (1.0 - a * (1.259 - 0.396 * a)) / (a * (3.535 + 2.181 * a)),
        }
    }
}

/// Fresnel's reflectance at the cosine of the angle of incidence, the mean of both polarisations.
fn fresnel(cos: f64) -> f64 {
    let inside = (1.0 - (1.0 - cos * cos) / (WATER_INDEX * WATER_INDEX)).sqrt();
    let across = (cos - WATER_INDEX * inside) / (cos + WATER_INDEX * inside);
    let along = (inside - WATER_INDEX * cos) / (inside + WATER_INDEX * cos);
    0.5 * (across * across + along * along)
}

/// A cloud's sides catch some light of a Sun at their horizon.
const SIDES: f64 = 0.05;
/// A Sun lower than this casts shadows longer than clouds are far apart.
const LOWEST_SHADOW: f64 = 0.05;

/// Clouds: one layer at a height, lit from above, level. The relief of their tops is left out.
#[derive(Clone, Copy, Debug)]
pub(super) struct CloudLayer {
    /// Height, equatorial radii.
    pub height: f64,
    /// Sine of the Sun's depression at which it sets for them.
    dip: f64,
    /// Whether they cast shadows.
    pub has_shadows: bool,
    /// `None` of Lambertian ones.
    directional: Option<&'static DirectionalReflectance>,
}

impl CloudLayer {
    pub fn new(light: &SurfaceLight) -> Self {
        let height = light.cloud_height_m / Ellipsoid::WGS84.equatorial_radius_m;
        Self {
            height,
            dip: (height * (2.0 + height)).sqrt() / (1.0 + height),
            has_shadows: light.cloud_shadows,
            directional: light
                .directional_reflectance
                .then(DirectionalReflectance::get),
        }
    }

    /// Outward normal below the point where the ray from the ground in a direction leaves the layer. The Earth is a sphere for it.
    pub fn above(&self, up: DVec3, towards: DVec3) -> DVec3 {
        let cos = towards.dot(up).max(0.0);
        let rise = self.height * (2.0 + self.height);
        let way = rise / ((cos * cos + rise).sqrt() + cos);
        (up + towards * way).normalize()
    }

    /// The same towards the Sun, where a shadow comes from.
    pub fn shadow_from(&self, up: DVec3, sun: DVec3) -> DVec3 {
        let flat = sun.reject_from_normalized(up).normalize_or_zero();
        let cos = sun.dot(up).max(LOWEST_SHADOW);
        self.above(up, up * cos + flat * (1.0 - cos * cos).max(0.0).sqrt())
    }

    /// Light on the ground below a layer of this albedo; transmitted light is spread over the sky.
    pub fn below(&self, light: &Light, albedo: f64, mu: f64) -> Light {
        Light {
            sun: light.sun * (1.0 - sunlit_albedo(albedo, mu.max(LOWEST_SHADOW))),
            sky: light.sky * (1.0 - 0.5 * albedo),
            own: light.own,
        }
    }

    /// Sunlight on them without air, for zenith cosine `mu`: the Sun sets later for them.
    pub fn sunlight_without_air(&self, mu: f64) -> DVec3 {
        without_air(mu + self.dip).sun
    }

    /// The part of sunlight at the zenith cosine `mu` that the layer sends to an eye whose cosines to the vertical and to the Sun are
    /// `eye`, as light on a level sheet.
    pub fn reflected(&self, albedo: f64, mu: f64, eye: (f64, f64)) -> f64 {
        let facing = mu.max(SIDES);
        let sunlit = sunlit_albedo(albedo, facing);
        let (eye_mu, cos_phase) = eye;
        facing
            * self.directional.map_or(sunlit, |directional| {
                directional.of_clouds(albedo, sunlit, facing, eye_mu, cos_phase)
            })
    }
}

/// The part of sunlight at this cosine that a layer throws back which throws back `albedo` of diffuse light: delta-Eddington
/// (Joseph, Wiscombe and Weinman 1976) with asymmetry 0.85.
fn sunlit_albedo(albedo: f64, mu: f64) -> f64 {
    let x = 4.0 / 3.0 * albedo / (1.0 - albedo);
    let less = 1.0 - (-1.85 * x / mu.max(SIDES)).exp();
    (albedo + (1.0 - albedo) * (0.5 - 0.75 * mu) * less).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_mirrors_as_fresnel_says() {
        assert!((fresnel(1.0) - (0.34_f64 / 2.34).powi(2)).abs() < 1e-12);
        assert!((fresnel(0.0) - 1.0).abs() < 1e-12);
        // At 60°: 6 %.
        assert!((fresnel(0.5) - 0.0605).abs() < 1e-3, "{}", fresnel(0.5));
    }

    #[test]
    fn clouds_keep_their_energy() {
        for albedo in [0.0, 0.3, 0.8] {
            for mu in [0.05, 0.3, 1.0] {
                let back = sunlit_albedo(albedo, mu);
                assert!((0.0..=1.0).contains(&back), "{albedo} {mu}: {back}");
            }
            // For light from the whole sky it is correct: 2 ∫ ρ(μ) μ dμ.
            let sum: f64 = (0..1000)
                .map(|i| (f64::from(i) + 0.5) / 1000.0)
                .map(|mu| 2.0 * sunlit_albedo(albedo, mu) * mu / 1000.0)
                .sum();
            assert!((sum - albedo).abs() < 0.03, "{albedo}: {sum}");
        }
    }
}
