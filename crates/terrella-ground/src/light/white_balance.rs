//! White balance: light of a colour temperature appears white.

use glam::{DMat3, DVec2, DVec3};
use std::ops::RangeInclusive;

/// The light that appears white: a black body, offset from the Planckian locus by the tint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhiteBalance {
    /// Correlated colour temperature of the light that appears white, kelvins. Below 6500 an image becomes bluer, above redder.
    pub temperature_k: f64,
    /// Offset of that light from the black body towards green. 1 is a distance of 1/3000 from the Planckian locus in the CIE 1960 UCS diagram.
    /// Positive numbers make an image more magenta, negative ones greener.
    pub tint: f64,
}

/// Distance in the CIE 1960 UCS diagram for a tint of 1, as in the DNG SDK.
const DISTANCE_PER_TINT: f64 = 1.0 / 3000.0;

/// Chromaticities x, y of D65 and of the primaries of sRGB (IEC 61966-2-1).
const D65: DVec2 = DVec2::new(0.3127, 0.3290);
const PRIMARIES: [DVec2; 3] = [
    DVec2::new(0.64, 0.33),
    DVec2::new(0.30, 0.60),
    DVec2::new(0.15, 0.06),
];

/// Cone responses from XYZ: Bradford (Lam 1985), by columns.
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

impl WhiteBalance {
    /// Range of [`Self::temperature_k`].
    pub const TEMPERATURES_K: RangeInclusive<f64> = 2000.0..=12_000.0;
    /// Range of [`Self::tint`].
    pub const TINTS: RangeInclusive<f64> = -150.0..=150.0;

    /// Matrix from linear light of sRGB's primaries before the balance to that after it. It is von Kries adaptation from the chosen white to D65
    /// in Bradford's cone responses.
    pub fn matrix(&self) -> DMat3 {
        let xyz_from_rgb = xyz_from_rgb();
        let [from, to] = [self.white(), D65].map(|white| BRADFORD * xyz(white));
        let adapted = BRADFORD.inverse() * DMat3::from_diagonal(to / from) * BRADFORD;
        xyz_from_rgb.inverse() * adapted * xyz_from_rgb
    }

    /// Chromaticity x, y of the light that appears white.
    pub fn white(&self) -> DVec2 {
        const STEP_K: f64 = 1.0;
        let at = |offset_k: f64| planckian_uv(self.temperature_k + offset_k);
        // Towards higher temperatures u and v fall; green is above the locus.
        let along = (at(STEP_K) - at(-STEP_K)).normalize();
        let greener = DVec2::new(along.y, -along.x);
        let uv = at(0.0) + self.tint * DISTANCE_PER_TINT * greener;
        let scale = 2.0 * uv.x - 8.0 * uv.y + 4.0;
        DVec2::new(3.0 * uv.x, 2.0 * uv.y) / scale
    }
}

/// Chromaticity of a black body in the CIE 1960 UCS diagram, 1000 to 15 000 K, within 1e-4: Krystek 1985, "An algorithm to calculate correlated
/// colour temperature", Color Res. Appl. 10, 38.
fn planckian_uv(temperature_k: f64) -> DVec2 {
    let t = temperature_k;
    DVec2::new(
        (0.860_117_757 + t * (1.541_182_54e-4 + 1.286_412_12e-7 * t))
            / (1.0 + t * (8.424_202_35e-4 + 7.081_451_63e-7 * t)),
        (0.317_398_726 + t * (4.228_062_45e-5 + 4.204_816_91e-8 * t))
            / (1.0 + t * (-2.897_418_16e-5 + 1.614_560_53e-7 * t)),
    )
}

/// XYZ of a chromaticity with Y = 1.
fn xyz(chromaticity: DVec2) -> DVec3 {
    let DVec2 { x, y } = chromaticity;
    DVec3::new(x, y, 1.0 - x - y) / y
}

/// XYZ from linear light of sRGB's primaries; white is D65 with Y = 1.
fn xyz_from_rgb() -> DMat3 {
    let [red, green, blue] = PRIMARIES.map(xyz);
    let primaries = DMat3::from_cols(red, green, blue);
    let levels = primaries.inverse() * xyz(D65);
    primaries * DMat3::from_diagonal(levels)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values of colour-science 0.4.7: `CCT_to_uv` by Krystek 1985 for tint 0, `matrix_chromatic_adaptation_VonKries` with
    /// Bradford, sRGB's matrices from its primaries. The last numbers are the result for light of 1, 0.5 and 0.25.
    const BY_COLOUR: &[(f64, [f64; 2], [f64; 3])] = &[
        (
            2000.0,
            [0.526649294, 0.413311742],
            [0.105422, 0.700880, 2.575279],
        ),
        (
            3200.0,
            [0.423448663, 0.399169784],
            [0.597076, 0.575871, 0.737042],
        ),
        (
            5000.0,
            [0.345040701, 0.351299155],
            [0.864207, 0.523725, 0.335541],
        ),
        (
            6504.0,
            [0.313472022, 0.323463318],
            [0.971322, 0.508911, 0.239958],
        ),
        (
            9000.0,
            [0.286979240, 0.295808178],
            [1.065581, 0.499638, 0.174762],
        ),
        (
            12000.0,
            [0.271754484, 0.277706031],
            [1.121734, 0.496390, 0.141493],
        ),
    ];

    #[test]
    fn colours_are_those_of_an_independent_program() {
        let light = DVec3::new(1.0, 0.5, 0.25);
        for (temperature_k, white, shown) in BY_COLOUR {
            let balance = WhiteBalance {
                temperature_k: *temperature_k,
                tint: 0.0,
            };
            let off = balance.white() - DVec2::from(*white);
            assert!(off.abs().max_element() < 1e-7, "{temperature_k}: {off}");
            let off = balance.matrix() * light - DVec3::from(*shown);
            assert!(off.abs().max_element() < 1e-4, "{temperature_k}: {off}");
        }
        assert!(BY_COLOUR.len() > 3);
    }

    #[test]
    fn the_chosen_light_is_shown_white() {
        for temperature_k in [2000.0, 3200.0, 5000.0, 6504.0, 9000.0, 12_000.0] {
            for tint in [-150.0, 0.0, 40.0, 150.0] {
                let balance = WhiteBalance {
                    temperature_k,
                    tint,
                };
                let light = xyz_from_rgb().inverse() * xyz(balance.white());
                let shown = balance.matrix() * light;
                assert!((shown - DVec3::ONE).abs().max_element() < 1e-9, "{shown}");
            }
        }
    }

    #[test]
    fn lower_temperatures_make_a_picture_bluer_and_green_light_makes_it_more_magenta() {
        let shown = |temperature_k, tint| {
            let balance = WhiteBalance {
                temperature_k,
                tint,
            };
            balance.matrix() * DVec3::ONE
        };
        let (warm, cold) = (shown(3200.0, 0.0), shown(10_000.0, 0.0));
        assert!(warm.z > 1.5 && warm.x < 0.8, "{warm}");
        assert!(cold.z < 0.9 && cold.x > 1.05, "{cold}");
        // D65 is 0.003 above the locus, which is a tint of 9.6.
        let near = shown(6504.0, 9.6);
        assert!((near - DVec3::ONE).abs().max_element() < 5e-3, "{near}");
        let magenta = shown(6504.0, 60.0);
        assert!(magenta.y < magenta.x && magenta.y < magenta.z, "{magenta}");
    }
}
