//! Brightness of the Moon's disc.

use crate::earth::moonlight_of_phase;
use std::f64::consts::PI;

/// Normal albedo for a map value of 1: the disc's mean is then 0.12, the Moon's geometric albedo.
const MAP_ALBEDO: f64 = 0.2461;
/// Geometric albedo of the Earth: the fraction of sunlight that a fully lit Earth reflects back (Robinson 2025).
const EARTH_GEOMETRIC_ALBEDO: f64 = 0.242;

/// Reflectance law of the Moon's surface at a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MoonLaw {
    /// Factor of its map.
    pub albedo: f64,
    /// Weight of Lambert's law, 1 − L (McEwen 1996).
    pub lambert: f64,
}

impl MoonLaw {
    /// For the angle at the Moon between Sun and eye, radians. The light of the whole disc follows Allen's magnitudes.
    pub fn at_phase(phase_rad: f64) -> Self {
        let degrees = phase_rad.to_degrees();
        let seeliger = 1.0 - degrees * (0.019 - degrees * (2.42e-4 - 1.46e-6 * degrees));
        let lambert = 1.0 - seeliger.clamp(0.0, 1.0);
        let wanted = moonlight_of_phase(phase_rad) / moonlight_of_phase(0.0);
        // For a very thin crescent the sum has no light to divide by.
        let drawn = disc_mean(phase_rad, lambert).max(1e-9);
        Self {
            albedo: MAP_ALBEDO * (wanted / drawn).min(1.0),
            lambert,
        }
    }
}

/// Mean reflectance of a uniform sphere's disc, by the law in `shaders/celestial/moon.wgsl`.
fn disc_mean(phase_rad: f64, lambert: f64) -> f64 {
    const N: i32 = 48;
    let (sin, cos) = phase_rad.sin_cos();
    let (mut sum, mut places) = (0.0, 0);
    for row in 0..N {
        for column in 0..N {
            let at = |n: i32| (2.0 * f64::from(n) + 1.0) / f64::from(N) - 1.0;
            let (x, y) = (at(column), at(row));
            let mu2 = 1.0 - x * x - y * y;
            if mu2 <= 0.0 {
                continue;
            }
            let mu = mu2.sqrt();
            let lit = (x * sin + mu * cos).max(0.0);
            sum += (1.0 - lambert) * 2.0 * lit / (mu + lit).max(1e-4) + lambert * lit;
            places += 1;
        }
    }
    sum / f64::from(places)
}

/// Earthshine on the Moon as a fraction of sunlight, for the angle at the Earth between Sun and Moon, and the Earth's radius over the Moon's
/// distance. The Earth's phases are those of a Lambertian sphere.
pub(super) fn earthshine(angle_rad: f64, radius_over_distance: f64) -> f64 {
    let phase = (angle_rad.sin() + (PI - angle_rad) * angle_rad.cos()) / PI;
    EARTH_GEOMETRIC_ALBEDO * phase * radius_over_distance * radius_over_distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_go_with_the_whole_moons_light() {
        // A uniform disc at full phase has the same brightness everywhere: the law's mean is 1.
        let full = MoonLaw::at_phase(0.0);
        assert!(
            (full.albedo - MAP_ALBEDO).abs() < 1e-3 && full.lambert == 0.0,
            "{full:?}"
        );
        for degrees in [20.0_f64, 60.0, 90.0, 120.0] {
            let phase = degrees.to_radians();
            let law = MoonLaw::at_phase(phase);
            let light = law.albedo / MAP_ALBEDO * disc_mean(phase, law.lambert);
            let allen = moonlight_of_phase(phase) / moonlight_of_phase(0.0);
            assert!(
                (light / allen - 1.0).abs() < 1e-9,
                "{degrees}: {light} for {allen}"
            );
        }
        let new = MoonLaw::at_phase(PI);
        assert!(new.albedo.is_finite() && new.albedo <= MAP_ALBEDO);
    }

    #[test]
    fn a_full_earth_is_27_times_a_full_moon() {
        // Full Moon on the Earth, full Earth on the Moon: as albedo times size, 0.242/0.12 · (6371/1737)².
        let ratio = earthshine(0.0, 6371.0 / 384_400.0) / (0.12 * (1737.4_f64 / 384_400.0).powi(2));
        assert!((26.0..28.0).contains(&ratio), "{ratio}");
        assert!(earthshine(PI, 0.016) < 1e-12);
    }
}
