//! Airglow, the light that the upper air emits at night: its layers, and its uniforms.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};
use std::f64::consts::PI;
use terrella_ground::air::{LUMINANCE, RADIUS_M};

/// A line or a band of emission.
pub(super) struct Line {
    wavelength_nm: f64,
    /// CIE 1931 2° colour-matching functions at this wavelength.
    xyz: [f64; 3],
    /// Column emission of the layer, seen from directly below.
    rayleighs: f64,
}

pub(super) const fn line(wavelength_nm: f64, xyz: [f64; 3], rayleighs: f64) -> Line {
    Line {
        wavelength_nm,
        xyz,
        rayleighs,
    }
}

impl Line {
    /// The same line with another column emission.
    pub(super) const fn of_rayleighs(&self, rayleighs: f64) -> Self {
        line(self.wavelength_nm, self.xyz, rayleighs)
    }

    /// The same line with a multiple of its column emission.
    pub(super) const fn times(&self, factor: f64) -> Self {
        self.of_rayleighs(factor * self.rayleighs)
    }
}

/// Atomic oxygen, ¹S to ¹D: 250 R on a usual night (Leinert et al. 1998, Astron. Astrophys. Suppl. 127, 1).
pub(super) const GREEN_LINE: Line = line(557.7, [0.5566, 0.9978, 0.0046], 250.0);
/// Sodium's doublet, 50 R (Leinert et al. 1998), and the visible Meinel bands of OH, 8–2, 9–3 and 6–1. The bands' emission is uncertain by a factor
/// of two: it is that of Khomich, Semenov and Shefov 2008 (Airglow as an Indicator of Upper Atmospheric Structure and Dynamics), rounded.
const SODIUM_AND_HYDROXYL: [Line; 4] = [
    line(589.3, [1.0196, 0.7653, 0.0011], 50.0),
    line(588.6, [1.0134, 0.7738, 0.0012], 25.0),
    line(626.0, [0.7309, 0.3098, 0.0001], 60.0),
    line(654.0, [0.2317, 0.0867, 0.0], 100.0),
];
/// Atomic oxygen, ¹D to ³P: 60 R at 630.0 nm (Leinert et al. 1998) and a third of that at 636.4 nm, which has the same upper state.
pub(super) const RED_LINE: Line = line(630.0, [0.6424, 0.2650, 0.0], 60.0);
const OXYGEN_RED: [Line; 2] = [RED_LINE, line(636.4, [0.5156, 0.2052, 0.0], 20.0)];

/// Radiances of the layers seen from directly below, linear sRGB, relative to a white sheet that faces the Sun in space.
pub(crate) const GREEN_LIGHT: DVec3 = shown(&[GREEN_LINE]);
pub(crate) const LOW_LIGHT: DVec3 = shown(&SODIUM_AND_HYDROXYL);
pub(crate) const RED_LIGHT: DVec3 = shown(&OXYGEN_RED);

/// Heights of the layers' centres, metres: sodium at 90 km and OH at 87 km combined into one layer; green oxygen; red oxygen.
const HEIGHTS_M: [f64; 3] = [88e3, 98e3, 250e3];
/// Full widths at half maximum, metres. Sodium and OH: Baker and Stair 1988 (Phys. Scr. 37, 611) have 8.6 km for OH alone.
const WIDTHS_M: [f64; 3] = [10e3, 9e3, 70e3];
/// Full width at half maximum of a Gaussian, standard deviations.
const WIDTH_PER_SIGMA: f64 = 2.354_82;

/// Heights of the layers' centres, equatorial radii.
pub(crate) const LAYER_HEIGHTS: DVec3 = DVec3::new(
    HEIGHTS_M[0] / RADIUS_M,
    HEIGHTS_M[1] / RADIUS_M,
    HEIGHTS_M[2] / RADIUS_M,
);
/// Standard deviations of their vertical profiles, equatorial radii.
pub(crate) const LAYER_SIGMAS: DVec3 = DVec3::new(
    WIDTHS_M[0] / WIDTH_PER_SIGMA / RADIUS_M,
    WIDTHS_M[1] / WIDTH_PER_SIGMA / RADIUS_M,
    WIDTHS_M[2] / WIDTH_PER_SIGMA / RADIUS_M,
);
/// Height of the top of airglow and aurora, equatorial radii.
pub(crate) const GLOW_TOP: f64 = 400e3 / RADIUS_M;
/// Height of the base of airglow and aurora, metres.
pub(crate) const GLOW_BASE_M: f64 = 75e3;

/// Sine of the Sun's elevation below which the glow is fully visible, −12°.
pub(crate) const GLOW_NIGHT_SIN: f64 = -0.207_912;
/// Sine of the Sun's elevation above which twilight outshines it, −6°.
pub(crate) const GLOW_DAY_SIN: f64 = -0.104_528_463;

/// Luminance of the airglow seen from directly below, relative to a white sheet that faces the Sun in space: of its lines at 557.7, 589.3, 630.0
/// and 636.4 nm and of three bands of OH. More than half of it is the green line of atomic oxygen at 557.7 nm: 250 R, that is 250e10/4π photons of
/// 3.56e-19 J for each m², second and steradian, 4.8e-5 cd/m².
pub const AIRGLOW_LUMINANCE: f64 =
    luminance(GREEN_LIGHT) + luminance(LOW_LIGHT) + luminance(RED_LIGHT);

const fn luminance(light: DVec3) -> f64 {
    LUMINANCE.x * light.x + LUMINANCE.y * light.y + LUMINANCE.z * light.z
}

/// Radiance of lines seen from directly below, linear sRGB, relative to a white sheet that faces the Sun in space.
pub(super) const fn shown(lines: &[Line]) -> DVec3 {
    // Planck's constant times the speed of light, J m.
    const PHOTON_J_M: f64 = 1.986_446e-25;
    // Illuminance of the Sun above the air, lx, and the luminous efficacy of ȳ = 1, lm/W.
    const SUN_LX: f64 = 133_100.0;
    const LM_PER_W: f64 = 683.0;
    let (mut x, mut y, mut z) = (0.0, 0.0, 0.0);
    let mut n = 0;
    while n < lines.len() {
        let line = &lines[n];
        // 4π I = 1e10 photons for each rayleigh, m² and second.
        let photons = 1e10 * line.rayleighs / (4.0 * PI);
        let watts = photons * PHOTON_J_M / (1e-9 * line.wavelength_nm);
        let part = LM_PER_W * watts / (SUN_LX / PI);
        x += part * line.xyz[0];
        y += part * line.xyz[1];
        z += part * line.xyz[2];
        n += 1;
    }
    // XYZ to linear sRGB, IEC 61966-2-1. A pure line is out of gamut: negative values are clamped to zero, and the luminance is kept.
    let r = at_least_none(3.2406 * x - 1.5372 * y - 0.4986 * z);
    let g = at_least_none(-0.9689 * x + 1.8758 * y + 0.0415 * z);
    let b = at_least_none(0.0557 * x - 0.2040 * y + 1.0570 * z);
    let scale = y / luminance(DVec3::new(r, g, b));
    DVec3::new(scale * r, scale * g, scale * b)
}

const fn at_least_none(value: f64) -> f64 {
    if value > 0.0 { value } else { 0.0 }
}

/// The fractions of the layers' columns below an eye at this height, equatorial radii.
pub(crate) fn beneath(eye_height: f64) -> DVec3 {
    // Logistic approximation of the normal distribution, accurate to 0.01.
    let sigmas = (DVec3::splat(eye_height) - LAYER_HEIGHTS) / LAYER_SIGMAS;
    1.0 / (1.0 + (-1.702 * sigmas).exp())
}

/// `GlowUniforms` of `shaders/glow.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GlowUniforms {
    /// The ray through the image's upper left corner, to the plane one metre in front of the eye; the billboard's axes in scaled space.
    pub corner: Vec3,
    /// Depth at which it is drawn.
    pub depth: f32,
    /// Increment to the upper right corner.
    pub across: Vec3,
    /// Brightness of the night relative to the true one.
    pub gain: f32,
    /// Increment to the lower left corner.
    pub down: Vec3,
    /// L² − 1 of the eye's distance L from the centre in scaled space, without cancellation.
    pub above: f32,
    /// The fractions of the airglow's layers below the eye.
    pub beneath: Vec3,
    /// Pads the row.
    pub padding_b: f32,
    /// Bounds of the glow on screen: least x and y, greatest x and y, −1…1.
    pub bounds: Vec4,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_green_line_has_the_luminance_of_its_photons() {
        // 250 R are 2e11 photons/(m² s sr) of 3.56e-19 J, 683 lm/W; the sheet has 4.24e4 cd/m².
        let wanted = 250e10 / (4.0 * PI) * 3.562e-19 * 683.0 * 0.9978 / 42_367.0;
        let [low, green, red] = [LOW_LIGHT, GREEN_LIGHT, RED_LIGHT];
        assert!((luminance(green) / wanted - 1.0).abs() < 2e-3);
        assert!(green.y > 4.0 * green.x && green.z == 0.0, "{green}");
        // Sodium and OH are orange, red oxygen is red and faint: the eye hardly sees 630 nm.
        assert!(low.x > 1.5 * low.y && low.y > 0.0 && low.z == 0.0, "{low}");
        assert!(red.y == 0.0 && red.z == 0.0, "{red}");
        let parts = [low, red].map(|light| luminance(light) / luminance(green));
        assert!((0.2..0.4).contains(&parts[0]), "{parts:?}");
        assert!((0.03..0.1).contains(&parts[1]), "{parts:?}");
    }

    #[test]
    fn an_eye_has_beneath_it_what_is_lower_than_it() {
        assert!(beneath(0.0).max_element() < 1e-5);
        assert!((beneath(LAYER_HEIGHTS.y).y - 0.5).abs() < 1e-9);
        assert!(beneath(GLOW_TOP).min_element() > 0.999);
    }
}
