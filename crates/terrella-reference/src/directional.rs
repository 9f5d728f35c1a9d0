//! Light that land and clouds reflect more to some sides than to others, by integration over the eye's directions.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Strength and width of Hapke's opposition effect (1986): B and h of B/(1 + tan(α/2)/h).
const STRENGTH: f64 = 3.2;
const WIDTH: f64 = 0.25;
/// Asymmetry of the scattering by droplets.
const ASYMMETRY: f64 = 0.85;
/// Lowest cosine to the vertical of an eye that sees clouds: the layer is not as flat as a sheet.
const LEAST_EYE: f64 = 0.03;
/// Cosines of the Sun that means are tabulated at, from 0 to 1; of the eye, and azimuths between both, that they are taken over.
const SUNS: usize = 65;
const EYES: usize = 64;
const AZIMUTHS: usize = 64;

/// Means over the eye's directions, for cosines of the Sun in even steps.
#[derive(Debug)]
pub(super) struct DirectionalReflectance {
    /// Of the opposition effect, weighted by the eye's cosine as light from a sheet is.
    opposition: Vec<f64>,
    /// Of the droplets' phase function over azimuths, by the eye's cosine.
    phase: Vec<Vec<f64>>,
}

impl DirectionalReflectance {
    pub fn get() -> &'static Self {
        static MEANS: OnceLock<DirectionalReflectance> = OnceLock::new();
        MEANS.get_or_init(Self::integrate)
    }

    fn integrate() -> Self {
        let suns = (0..SUNS).map(|i| i as f64 / (SUNS - 1) as f64);
        let (opposition, phase) = suns
            .map(|mu| {
                let means = |f: fn(f64) -> f64| -> Vec<f64> {
                    eyes().map(|eye| mean_over_azimuths(mu, eye, f)).collect()
                };
                let surges = means(surge);
                (weighted(|i, eye| surges[i] * eye), means(scattering))
            })
            .unzip();
        Self { opposition, phase }
    }

    /// Radiance relative to a Lambertian surface, at this cosine between eye and Sun, for the Sun at the cosine `mu`.
    pub fn of_opposition(&self, cos_phase: f64, mu: f64) -> f64 {
        let (i, part) = self.sun(mu);
        let mean = self.opposition[i] * (1.0 - part) + self.opposition[i + 1] * part;
        (1.0 + STRENGTH * surge(cos_phase)) / (1.0 + STRENGTH * mean)
    }

    /// Reflectance of clouds that throw back `albedo` of diffuse light and `sunlit` of sunlight at the cosine `mu`, for an eye at the
    /// cosine `eye` to the vertical.
    pub fn of_clouds(&self, albedo: f64, sunlit: f64, mu: f64, eye: f64, cos_phase: f64) -> f64 {
        let depth = 4.0 / 3.0 * albedo / ((1.0 - albedo) * (1.0 - ASYMMETRY));
        let depth = depth * (1.0 - ASYMMETRY * ASYMMETRY);
        let once = |eye: f64, phase: f64| {
            phase / (4.0 * (eye + mu)) * (1.0 - (-depth * (1.0 / eye + 1.0 / mu)).exp())
        };
        let (sun, part) = self.sun(mu);
        let all = weighted(|i, eye| {
            let phase = self.phase[sun][i] * (1.0 - part) + self.phase[sun + 1][i] * part;
            once(eye, phase) * eye
        });
        let seen = once(eye.max(LEAST_EYE), scattering(cos_phase));
        seen + (sunlit - all).max(0.0) * self.of_opposition(cos_phase, mu)
    }

    /// The entry below a cosine of the Sun, and the fraction of the way to the next one.
    fn sun(&self, mu: f64) -> (usize, f64) {
        let at = mu.clamp(0.0, 1.0) * (SUNS - 1) as f64;
        let below = (at as usize).min(SUNS - 2);
        (below, at - below as f64)
    }
}

fn eyes() -> impl Iterator<Item = f64> {
    (0..EYES).map(|i| (i as f64 + 0.5) / EYES as f64)
}

/// Twice the integral over the eye's cosines: 1 of the cosine itself.
fn weighted(f: impl Fn(usize, f64) -> f64) -> f64 {
    let sum: f64 = eyes().enumerate().map(|(i, eye)| f(i, eye)).sum();
    2.0 * sum / EYES as f64
}

/// Of a function of the cosine of the phase angle.
fn mean_over_azimuths(mu: f64, eye: f64, f: impl Fn(f64) -> f64) -> f64 {
    let across = ((1.0 - mu * mu) * (1.0 - eye * eye)).sqrt();
    let azimuths = (0..AZIMUTHS).map(|i| PI * (i as f64 + 0.5) / AZIMUTHS as f64);
    azimuths
        .map(|azimuth| f(mu * eye + across * azimuth.cos()))
        .sum::<f64>()
        / AZIMUTHS as f64
}

fn surge(cos_phase: f64) -> f64 {
    let half = 0.5 * cos_phase.clamp(-1.0, 1.0).acos();
    1.0 / (1.0 + half.tan() / WIDTH)
}

/// Henyey and Greenstein's phase function of the asymmetry g/(1 + g), by the cosine of the phase angle.
fn scattering(cos_phase: f64) -> f64 {
    let g = ASYMMETRY / (1.0 + ASYMMETRY);
    (1.0 - g * g) / (1.0 + g * g + 2.0 * g * cos_phase).powf(1.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over all directions land and clouds reflect as much as a Lambertian surface.
    #[test]
    fn no_light_is_lost_or_won() {
        let light = DirectionalReflectance::get();
        for mu in [0.06, 0.21, 0.5, 0.93] {
            let over_all = |f: &dyn Fn(f64, f64) -> f64| {
                weighted(|_, eye| mean_over_azimuths(mu, eye, |cos| f(eye, cos)) * eye)
            };
            let land = over_all(&|_, cos| light.of_opposition(cos, mu));
            assert!((land - 1.0).abs() < 1e-3, "{mu}: {land}");
            for (albedo, sunlit) in [(0.05, 0.4), (0.3, 0.55), (0.7, 0.8)] {
                let clouds = over_all(&|eye, cos| light.of_clouds(albedo, sunlit, mu, eye, cos));
                assert!((clouds - sunlit).abs() < 0.01, "{mu}, {albedo}: {clouds}");
            }
        }
    }

    #[test]
    fn clouds_are_brightest_towards_a_low_sun_and_land_away_from_it() {
        let light = DirectionalReflectance::get();
        let cloud = |cos| light.of_clouds(0.3, 0.6, 0.2, 0.2, cos);
        assert!(cloud(-0.92) > 2.0 * cloud(0.0), "{}", cloud(-0.92));
        let land = |cos| light.of_opposition(cos, 0.7);
        assert!(land(1.0) > 1.5 * land(0.5) && land(0.5) > land(-0.5));
    }
}
