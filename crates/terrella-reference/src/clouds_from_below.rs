//! Clouds as an eye below their layer sees them.

use super::light::Light;
use glam::DVec3;

/// A place of the layer, without the air before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct CloudSeenFromBelow {
    /// Light that it sends to the eye.
    pub light: DVec3,
    /// Fraction of the light from behind that is transmitted directly.
    pub through: f64,
}

/// Asymmetry of the scattering by droplets.
const ASYMMETRY: f64 = 0.85;
/// Lowest cosines to the vertical of the eye's ray and of the sunlight: the layer is not as flat as a sheet.
const LEAST_EYE: f64 = 0.03;
const LEAST_SUN: f64 = 0.05;
/// Sines of the Sun's height between which it comes to light the upper side instead of the underside.
const UNDERSIDE: (f64, f64) = (-0.03, 0.06);

impl CloudSeenFromBelow {
    /// Of a layer that reflects the fraction `albedo` of diffuse light, 0…1, in this light of Sun and sky. `cosines` are those of the eye's ray and
    /// of the Sun to the vertical, and between them; `about` is the albedo of the ground below.
    pub fn new(albedo: f64, cosines: (f64, f64, f64), light: &Light, about: DVec3) -> Self {
        let (of_eye, of_sun, between) = cosines;
        // Optical depth by the two-stream approximation, and its delta-Eddington scaling.
        let depth = 4.0 / 3.0 * albedo / ((1.0 - albedo) * (1.0 - ASYMMETRY));
        let scaled = depth * (1.0 - ASYMMETRY * ASYMMETRY);
        let through = (-scaled / of_eye.max(LEAST_EYE)).exp();
        let mu = of_sun.max(LEAST_SUN);
        let direct = (-scaled / mu).exp();
        let back = (albedo + (1.0 - albedo) * (0.5 - 0.75 * mu) * (1.0 - direct)).max(0.0);
        let down = (1.0 - back - direct).max(0.0);
        let g = ASYMMETRY / (1.0 + ASYMMETRY);
        let forward = (1.0 - g * g) / (1.0 + g * g - 2.0 * g * between).powf(1.5);
        let scattered_once = (-scaled).exp();
        let spread = 1.0 + (forward - 1.0) * scattered_once;
        let upper = {
            let x = ((of_sun - UNDERSIDE.0) / (UNDERSIDE.1 - UNDERSIDE.0)).clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x)
        };
        let of_sun = upper * down * mu * spread + (1.0 - upper) * back * LEAST_SUN;
        let of_sky = (1.0 - albedo - through).max(0.0);
        let on_ground = light.sun * ((1.0 - back) * mu * upper) + light.sky;
        let of_ground = albedo * about / (DVec3::ONE - about * albedo) * on_ground;
        Self {
            light: light.sun * of_sun + light.sky * of_sky + of_ground,
            through,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(albedo: f64, of_sun: f64, between: f64) -> CloudSeenFromBelow {
        let light = Light {
            sun: DVec3::ONE,
            sky: DVec3::ZERO,
            own: DVec3::ZERO,
        };
        CloudSeenFromBelow::new(albedo, (0.8, of_sun, between), &light, DVec3::ZERO)
    }

    #[test]
    fn thick_clouds_are_dark_and_hide_the_sky() {
        let (thin, thick) = (seen(0.05, 0.7, 0.0), seen(0.75, 0.7, 0.0));
        assert!(thin.through > 0.7 && thick.through < 1e-3);
        // Light that is not reflected is transmitted: for a thick layer 15 to 25 % with a high Sun.
        assert!((0.1..0.2).contains(&thick.light.x), "{}", thick.light.x);
        assert!(seen(0.3, 0.7, 0.0).light.x > thick.light.x);
    }

    #[test]
    fn thin_clouds_are_bright_about_the_sun_and_thick_ones_alike_everywhere() {
        let contrast = |albedo| seen(albedo, 0.7, 1.0).light.x / seen(albedo, 0.7, -0.3).light.x;
        assert!(contrast(0.05) > 5.0, "{}", contrast(0.05));
        assert!((contrast(0.75) - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_sun_at_the_horizon_lights_the_underside() {
        let [low, set] = [0.02, -0.03].map(|mu| seen(0.7, mu, 0.9).light.x);
        assert!(low > 0.0 && set > 0.02, "{low} {set}");
    }
}
