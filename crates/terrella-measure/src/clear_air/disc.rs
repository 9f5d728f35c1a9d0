//! How bright the whole Earth is, seen from afar, by phase: geometric albedo, phase integral, spherical albedo.

use super::LightRenderer;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use terrella::frames::Ellipsoid;
use terrella::{EyeView, Sky};
use terrella_play::PlayError;

/// Distance of the eye, metres.
const FAR_M: f64 = 1e9;
/// Height of the picture in diameters of the Earth.
const MARGIN: f64 = 1.06;
/// Sides of the Earth that are averaged, about the equator.
const SIDES: u32 = 6;
/// Phases from full to new.
const PHASES: u32 = 13;

/// The whole Earth's light at a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscPhase {
    /// Angle between Sun and eye at the Earth, radians.
    pub phase_rad: f64,
    /// Light relative to that of a white disc of the Earth's size that faces Sun and eye: the geometric albedo times the phase function.
    pub albedo: [f64; 3],
}

/// The whole Earth's light by phase, over its sides, the Sun over the equator.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscLight {
    /// From full to new, equal steps.
    pub phases: Vec<DiscPhase>,
}

impl DiscLight {
    /// Draws it. The renderer's pictures must be square.
    ///
    /// # Errors
    /// A device that is lost.
    pub fn drawn(renderer: &mut LightRenderer, figure: &Ellipsoid) -> Result<Self, PlayError> {
        let radius = figure.equatorial_radius_m / FAR_M;
        let fov_rad = 2.0 * (MARGIN * radius).atan();
        // Of a disc with the area of the visible ellipse.
        let disc = PI * figure.polar_radius_m / figure.equatorial_radius_m * radius * radius;
        let mut phases = Vec::new();
        for phase in 0..PHASES {
            let phase_rad = PI * f64::from(phase) / f64::from(PHASES - 1);
            let mut albedo = [0.0; 3];
            for side in 0..SIDES {
                let toward = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
                let lon = TAU * f64::from(side) / f64::from(SIDES);
                let eye = toward(lon) * FAR_M;
                let view = EyeView::itrf(eye, -eye, DVec3::Z, fov_rad, 1.0);
                let sky = Sky::new(toward(lon + phase_rad));
                let light = renderer.picture(&view, &sky)?;
                // Pixels are alike in a picture so narrow.
                let pixel = (2.0 * (0.5 * fov_rad).tan()).powi(2) / light.len() as f64;
                for light in light {
                    for (sum, light) in albedo.iter_mut().zip(light) {
                        *sum += light * pixel / disc / f64::from(SIDES);
                    }
                }
            }
            phases.push(DiscPhase { phase_rad, albedo });
        }
        Ok(Self { phases })
    }

    /// Light relative to that of a white disc that faces Sun and eye, both in the same direction.
    pub fn geometric_albedo(&self) -> [f64; 3] {
        self.phases.first().map_or([0.0; 3], |full| full.albedo)
    }

    /// Part of the light that falls on the Earth that it sends back: 2 ∫ albedo(α) sin α dα, by the trapezoidal rule.
    pub fn spherical_albedo(&self) -> [f64; 3] {
        let step = PI / f64::from(PHASES - 1);
        [0, 1, 2].map(|i| {
            let parts = self
                .phases
                .iter()
                .map(|phase| phase.albedo[i] * phase.phase_rad.sin());
            2.0 * step * parts.sum::<f64>()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lambert_sphere_has_its_albedos() {
        // Φ = (sin α + (π − α) cos α)/π, geometric albedo 2/3, spherical albedo 1.
        let phases = (0..PHASES).map(|i| {
            let a = PI * f64::from(i) / f64::from(PHASES - 1);
            let shown = (a.sin() + (PI - a) * a.cos()) / PI;
            DiscPhase {
                phase_rad: a,
                albedo: [2.0 / 3.0 * shown; 3],
            }
        });
        let light = DiscLight {
            phases: phases.collect(),
        };
        assert_eq!(light.geometric_albedo(), [2.0 / 3.0; 3]);
        let found = light.spherical_albedo()[1];
        assert!((found - 1.0).abs() < 0.02, "{found}");
    }
}
