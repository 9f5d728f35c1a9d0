//! The colour of a track, as its target stores it.

use crate::gpu::PassFormat;
use terrella_ground::half::half_bits;

/// Number of opacity steps for which colours are stored.
const STEPS: usize = 32;

/// A display colour at all opacities that a track fades through.
#[derive(Clone)]
pub(super) struct Ink {
    opaque: [[u16; 4]; 2],
    /// By opacity, from 1/32; empty if the target stores display colours, which fade correctly.
    faded: Vec<InkColors>,
}

/// Stored colours of a fully and of a half covered pixel, not premultiplied: red, green and blue, half floats.
type InkColors = [[u16; 3]; 2];

impl Ink {
    /// This display colour in passes of this format; set `fades` if opacities other than 1 are needed.
    pub fn new(format: &PassFormat, srgb: [u8; 3], fades: bool) -> Self {
        let stored = |opacity: f64| {
            let whole = format.stored_color(srgb, opacity).map(half_bits);
            let half = format.stored_color(srgb, 0.5 * opacity);
            [whole, half.map(|value| half_bits(0.5 * value))]
        };
        let steps = match fades && format.is_developed_later() {
            true => STEPS,
            false => 0,
        };
        let faded = (1..=steps).map(|step| stored(step as f64 / STEPS as f64));
        Self {
            opaque: with_opacity(stored(1.0), 1.0),
            faded: faded.collect(),
        }
    }

    /// The colour at full opacity, as from [`Self::at`].
    pub fn opaque(&self) -> [[u16; 4]; 2] {
        self.opaque
    }

    /// The colour at an opacity of 0…1, with that opacity, and that of a half covered pixel.
    pub fn at(&self, opacity: f64) -> [[u16; 4]; 2] {
        let step = ((opacity * STEPS as f64).round() as usize).clamp(1, STEPS);
        let opaque = self.opaque.map(|[red, green, blue, _]| [red, green, blue]);
        let colors = self.faded.get(step - 1).unwrap_or(&opaque);
        with_opacity(*colors, opacity)
    }
}

fn with_opacity(colors: InkColors, opacity: f64) -> [[u16; 4]; 2] {
    let opacity = half_bits(opacity as f32);
    colors.map(|[red, green, blue]| [red, green, blue, opacity])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{Development, FrameTargets, ScaledTarget};
    use glam::DVec3;
    use terrella_ground::half::float_of_half;
    use terrella_ground::light::{Tone, WhiteBalance};

    fn format(color: wgpu::TextureFormat) -> PassFormat {
        PassFormat {
            color,
            further: &[],
            samples: 1,
            depth: FrameTargets::REVERSED_DEPTH,
            development: Development::AfterPass,
            tone: Tone::Camera,
            bloom: Default::default(),
            grade: Default::default(),
        }
    }

    #[test]
    fn a_white_balance_leaves_the_colours_of_lines() {
        let balance = WhiteBalance {
            temperature_k: 3200.0,
            tint: 20.0,
        };
        let mut balanced = format(ScaledTarget::LIGHT);
        balanced.grade.white_balance = Some(balance);
        let light = |format: &PassFormat| {
            let [red, green, blue, _] = Ink::new(format, [244, 114, 160], true).at(1.0)[0];
            DVec3::from_array([red, green, blue].map(float_of_half).map(f64::from))
        };
        let plain = Tone::Camera.shown(light(&format(ScaledTarget::LIGHT)));
        let shown = Tone::Camera.shown(balance.matrix() * light(&balanced));
        assert!(
            (shown - plain).abs().max_element() < 2e-3,
            "{shown} {plain}"
        );
        let unbalanced = Tone::Camera.shown(light(&balanced));
        assert!((unbalanced - plain).abs().max_element() > 0.05);
    }

    /// Over black space, a faded line has the hue of a full one, despite the contrast of the tone curve.
    #[test]
    fn faded_light_is_developed_to_the_faded_colour() {
        let ink = Ink::new(&format(ScaledTarget::LIGHT), [244, 114, 160], true);
        let shown = |opacity: f64| {
            ink.at(opacity).map(|color| {
                let [red, green, blue, opacity] = color.map(float_of_half).map(f64::from);
                Tone::Camera.shown(opacity * DVec3::new(red, green, blue))
            })
        };
        let [full, _] = shown(1.0);
        for opacity in [0.125, 0.5, 0.75, 1.0] {
            let [whole, half] = shown(opacity);
            for (got, wanted) in [(whole, opacity * full), (half, 0.5 * opacity * full)] {
                let off = (got - wanted).abs().max_element();
                assert!(off < 2e-3, "{opacity}: {got} for {wanted}");
            }
        }
    }

    #[test]
    fn display_values_are_stored_as_they_are() {
        let display = Ink::new(&format(wgpu::TextureFormat::Rgba8Unorm), [0, 51, 255], true);
        let [stored, half] = display.at(0.5).map(|color| color.map(float_of_half));
        assert!((half[2] - 0.5).abs() < 2e-4, "{half:?}");
        for (got, wanted) in stored.into_iter().zip([0.0, 0.2, 1.0, 0.5]) {
            assert!((got - wanted).abs() < 2e-4, "{stored:?}");
        }
    }
}
