//! High dynamic range output: highlights above white paper, and the codes of PQ and HLG.

use super::tone::Tone;
use glam::{DMat3, DVec3};
use std::ops::RangeInclusive;

/// Exposed light up to which the image follows its tone curve. The camera curve, extended along its slope from there, shows light of 1 at
/// reference white. That is a thick cloud at the default exposure.
const KNEE: f64 = 0.5;
/// Step of light for the slope there, as a fraction of the knee.
const SLOPE_STEP: f64 = 1e-3;
/// Limit of light; brighter light counts as this.
const BRIGHTEST: f64 = 1e9;

/// From BT.709's primaries to BT.2020's: ITU-R BT.2087-0, with the digits that follow from its primaries and
/// white.
const BT2020_FROM_BT709: DMat3 = DMat3::from_cols_array(&[
    0.627_403_895_934_699,
    0.069_097_289_358_232,
    0.016_391_438_875_15,
    0.329_283_038_377_884,
    0.919_540_395_075_459,
    0.088_013_307_877_226,
    0.043_313_065_687_417,
    0.011_362_315_566_309,
    0.895_595_253_247_624,
]);
/// Luminance of BT.2020's primaries.
const BT2020_LUMINANCE: DVec3 = DVec3::new(0.2627, 0.6780, 0.0593);

/// Encoding of display light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HdrTransfer {
    /// Perceptual quantisation, SMPTE ST 2084 and ITU-R BT.2100: codes are luminances up to 10 000 cd/m².
    Pq,
    /// Hybrid log-gamma, ITU-R BT.2100: codes are fractions of the display's range.
    Hlg,
}

/// A high dynamic range image. It follows the tone curve up to its middle, and extends brighter light to a peak luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hdr {
    /// Encoding of the codes.
    pub transfer: HdrTransfer,
    /// Luminance that the brightest light approaches, cd/m².
    pub peak_cd_m2: f64,
}

impl Hdr {
    /// Luminance of a tone curve's white, cd/m²: the reference white of ITU-R BT.2408. Captions use it too.
    pub const REFERENCE_WHITE_CD_M2: f64 = 203.0;
    /// Range of [`Self::peak_cd_m2`] for PQ.
    pub const PEAKS_CD_M2: RangeInclusive<f64> = 400.0..=10_000.0;
    /// Default peak, and the fixed peak of HLG, whose system gamma of 1.2 assumes it (ITU-R BT.2100, Table 5), cd/m².
    pub const USUAL_PEAK_CD_M2: f64 = 1000.0;

    /// Display light of exposed light, which must not be negative: BT.709's primaries, 1 at reference white.
    ///
    /// Where the brightest channel m is at most k = 0.5, it follows the tone curve. Beyond, each channel continues from its value y at k, for light
    /// of the same colour. It follows its slope s there: y + (P − y)·t/(1 + t), t = s(m − k)/(P − y), with the peak P. Bright colours fade to white,
    /// as on film.
    pub fn shown(&self, tone: Tone, light: DVec3) -> DVec3 {
        let light = light.clamp(DVec3::ZERO, DVec3::splat(BRIGHTEST));
        let brightest = light.max_element();
        if brightest <= KNEE {
            return tone.shown(light);
        }
        let at_knee = light * (KNEE / brightest);
        let shown = tone.shown(at_knee);
        let below = tone.shown(at_knee * (1.0 - SLOPE_STEP));
        let slope = (shown - below).max(DVec3::ZERO) / (SLOPE_STEP * KNEE);
        let room = self.peak_cd_m2 / Self::REFERENCE_WHITE_CD_M2 - shown;
        let rise = slope * (brightest - KNEE) / room;
        shown + room * rise / (1.0 + rise)
    }

    /// Luminance of each of BT.2020's primaries for display light, in cd/m² of a white at that
    /// level.
    pub fn luminances_cd_m2(&self, shown: DVec3) -> DVec3 {
        BT2020_FROM_BT709 * shown * Self::REFERENCE_WHITE_CD_M2
    }

    /// Codes of these luminances, 0…1.
    pub fn encoded(&self, luminances_cd_m2: DVec3) -> DVec3 {
        let luminances_cd_m2 = luminances_cd_m2.max(DVec3::ZERO);
        match self.transfer {
            HdrTransfer::Pq => luminances_cd_m2.map(pq),
            HdrTransfer::Hlg => {
                let display = luminances_cd_m2 / Self::USUAL_PEAK_CD_M2;
                let luminance = display.dot(BT2020_LUMINANCE);
                // The inverse of F_D = α Y_S^(γ − 1) E, with γ = 1.2.
                let scene = match luminance > 0.0 {
                    true => display * luminance.powf(-0.2 / 1.2),
                    false => DVec3::ZERO,
                };
                scene.map(hlg)
            }
        }
    }
}

/// The inverse EOTF of SMPTE ST 2084.
fn pq(luminance_cd_m2: f64) -> f64 {
    const M1: f64 = 2610.0 / 16_384.0;
    const M2: f64 = 2523.0 / 4096.0 * 128.0;
    const C1: f64 = 3424.0 / 4096.0;
    const C2: f64 = 2413.0 / 4096.0 * 32.0;
    const C3: f64 = 2392.0 / 4096.0 * 32.0;
    let y = (luminance_cd_m2 / 10_000.0).min(1.0).powf(M1);
    // N = ((c1 + c2 L^m1)/(1 + c3 L^m1))^m2.
    ((C1 + C2 * y) / (1.0 + C3 * y)).powf(M2)
}

/// The OETF of hybrid log-gamma.
fn hlg(scene: f64) -> f64 {
    const A: f64 = 0.178_832_77;
    const B: f64 = 1.0 - 4.0 * A;
    // ½ − a ln(4a).
    const C: f64 = 0.559_910_729_529_562;
    let scene = scene.clamp(0.0, 1.0);
    match scene <= 1.0 / 12.0 {
        true => (3.0 * scene).sqrt(),
        false => A * (12.0 * scene - B).ln() + C,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn to(transfer: HdrTransfer, peak_cd_m2: f64) -> Hdr {
        Hdr {
            transfer,
            peak_cd_m2,
        }
    }

    const PQ: Hdr = to(HdrTransfer::Pq, Hdr::USUAL_PEAK_CD_M2);
    const HLG: Hdr = to(HdrTransfer::Hlg, Hdr::USUAL_PEAK_CD_M2);

    /// Signal levels of ITU-R BT.2408-7, Tables 1 and 2, in parts of the scale: PQ's are published to a percent, HLG's white is 75 %.
    #[test]
    fn greys_have_the_published_signals() {
        let code = |hdr: &Hdr, luminance: f64| hdr.encoded(DVec3::splat(luminance)).y;
        for (luminance, signal) in [(26.0, 0.38), (203.0, 0.58), (1000.0, 0.75), (10_000.0, 1.0)] {
            let off = code(&PQ, luminance) - signal;
            assert!(off.abs() < 0.005, "{luminance}: {off}");
        }
        for (luminance, signal) in [(26.0, 0.38), (203.0, 0.75), (1000.0, 1.0)] {
            let off = code(&HLG, luminance) - signal;
            assert!(off.abs() < 0.005, "{luminance}: {off}");
        }
        assert_eq!(HLG.encoded(DVec3::ZERO), DVec3::ZERO);
    }

    type Colour = ([f64; 3], [f64; 3], [f64; 3], [f64; 3]);
    const COLOURS: [Colour; 5] = [
        (
            [1.0, 1.0, 1.0],
            [203.000, 203.000, 203.000],
            [0.580689, 0.580689, 0.580689],
            [0.749877, 0.749877, 0.749877],
        ),
        (
            [0.2, 0.5, 0.9],
            [66.808, 98.215, 173.224],
            [0.468177, 0.506271, 0.564174],
            [0.541742, 0.627820, 0.743773],
        ),
        (
            [3.5, 1.2, 0.1],
            [526.863, 273.324, 51.267],
            [0.682234, 0.611986, 0.442663],
            [0.916222, 0.792299, 0.430486],
        ),
        (
            [0.001, 0.02, 0.004],
            [1.499, 3.757, 1.088],
            [0.171592, 0.228132, 0.154283],
            [0.108817, 0.172239, 0.092689],
        ),
        (
            [0.0, 0.0, 2.0],
            [17.585, 4.613, 363.612],
            [0.345980, 0.242194, 0.642363],
            [0.308235, 0.157872, 0.921984],
        ),
    ];

    /// Display light and luminances of colour-science 0.4.7: `RGB_to_RGB(…, "ITU-R BT.709", "ITU-R BT.2020")` times 203, and codes by
    /// `eotf_inverse_ST2084` and `eotf_inverse_BT2100_HLG`.
    #[test]
    fn colours_are_those_of_another_program() {
        for (shown, luminances, pq, hlg) in COLOURS {
            let found = PQ.luminances_cd_m2(DVec3::from(shown));
            let off = found - DVec3::from(luminances);
            assert!(off.abs().max_element() < 2e-3, "{shown:?}: {off}");
            for (hdr, codes) in [(PQ, pq), (HLG, hlg)] {
                let off = hdr.encoded(found) - DVec3::from(codes);
                assert!(off.abs().max_element() < 2e-5, "{hdr:?} {shown:?}: {off}");
            }
        }
    }

    #[test]
    fn highlights_rise_without_a_step_to_the_peak() {
        for tone in Tone::ALL {
            for peak in [400.0, 1000.0, 10_000.0] {
                let hdr = to(HdrTransfer::Pq, peak);
                for tint in [DVec3::ONE, DVec3::new(1.0, 0.6, 0.3)] {
                    let mut before = DVec3::ZERO;
                    for step in 0..=4000 {
                        let light = tint * (f64::from(step) * 0.01 - 20.0).exp2();
                        let shown = hdr.shown(tone, light);
                        // In AgX a bright channel falls slightly while the others reach white.
                        let room = if tone == Tone::Agx { 0.006 } else { 1e-12 };
                        assert!(shown.cmpge(before - room).all(), "{tone:?} {light}");
                        // A step of a hundredth of an octave causes no jump.
                        let rise = (shown - before).max_element();
                        assert!(rise < 0.02 * shown.max_element() + 1e-4, "{tone:?} {light}");
                        before = shown;
                    }
                    let brightest = before.max_element() * Hdr::REFERENCE_WHITE_CD_M2;
                    assert!(
                        (0.999 * peak..=peak).contains(&brightest),
                        "{tone:?} {brightest}"
                    );
                }
                // Up to the knee it is the standard image.
                let dim = DVec3::new(0.5, 0.31, 0.02);
                assert_eq!(hdr.shown(tone, dim), tone.shown(dim));
                assert!(hdr.shown(tone, DVec3::splat(f64::MAX)).is_finite());
            }
        }
    }

    #[test]
    fn a_thick_cloud_of_the_camera_is_at_reference_white() {
        let cloud = PQ.shown(Tone::Camera, DVec3::ONE);
        assert!((cloud - 1.0).abs().max_element() < 0.04, "{cloud}");
    }
}
