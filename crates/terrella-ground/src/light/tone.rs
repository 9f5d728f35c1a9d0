//! Tone curves: from exposed light to display light, 0…1. `shaders/common/displayed.wgsl` has the same curves.

use super::agx::{agx, light_by_agx};
use super::response::Response;
use crate::air::LUMINANCE;
use glam::DVec3;

/// Start of the neutral curve's compression, and the rate at which brighter highlights lose colour.
pub const NEUTRAL_START: f64 = 0.76;
pub const NEUTRAL_DESATURATION: f64 = 0.15;

/// Input scale of the filmic curve; its coefficients a…e of x(ax + b)/(x(cx + d) + e).
pub const FILMIC_SCALE: f64 = 0.6;
pub const FILMIC: [f64; 5] = [2.51, 0.03, 2.43, 0.59, 0.14];

/// Toe of the camera curve per channel: light x becomes x(x + least·toe)/(x + toe), so the darkest light is multiplied by `least`. Blue
/// has the largest toe, because atmospheric haze is mostly blue. Light that is not blue has the toe of red in all channels, so that
/// lamps, aurora and sunsets keep their colour.
pub const CAMERA_TOE: DVec3 = DVec3::new(0.02, 0.035, 0.07);
pub const CAMERA_TOE_LEAST: f64 = 0.1;
/// Light is all haze where blue is at least as bright as m, the brighter of red and green, and no haze where (m − b)/(m + b) exceeds this.
pub const CAMERA_HAZE: f64 = 0.5;
/// Contrast of the camera curve: x then becomes x(√x + straight), so that night light is not lost.
pub const CAMERA_STRAIGHT: f64 = 0.04;
/// Shoulder of the camera curve: white·x/(x + this); half of white is reached at 0.42 before
/// contrast.
pub const CAMERA_HALF_RAISED: f64 = 0.272_190_815_4;
pub const CAMERA_WHITE: f64 = 1.1;
/// Factor by which it moves colours away from grey afterwards.
pub const CAMERA_SATURATION: f64 = 1.08;

/// Limit of light: its square stays finite, and every curve is at its end.
const BRIGHTEST: f64 = 1e9;

/// Tone curve for an 8-bit target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Tone {
    /// A camera curve, for images to look at. Its toe removes atmospheric haze from the darks. It has contrast around a middle grey
    /// of 0.3, and a shoulder that is white at 1.9. It works per channel as film does, so that highlights go to white.
    #[default]
    Camera,
    /// The highlights of the Khronos PBR Neutral tone mapper (2024), for colours measured in an image. Light up to 0.76 is
    /// unchanged. Brighter light is compressed by its brightest channel, so hue is kept, and fades to white far beyond. The
    /// mapper's toe is omitted: it subtracts 4 %, the gloss of a varnish that the Earth does not have.
    Neutral,
    /// Unchanged light, clipped at 1 per channel.
    Linear,
    /// Contrast of a film, per channel: Narkowicz's fit (2016) of the ACES curve, with his scale of 0.6. Hues of highlights
    /// change.
    Filmic,
    /// AgX, as in Blender, three.js and Filament: 16.5 stops, and bright colours that fade to white.
    Agx,
    /// A measured response of a film or camera, per channel. For light that is developed after the pass.
    #[cfg_attr(feature = "serde", serde(skip))]
    Measured(Response),
}

impl Tone {
    /// All curves that need no file.
    pub const ALL: [Self; 5] = [
        Self::Camera,
        Self::Neutral,
        Self::Linear,
        Self::Filmic,
        Self::Agx,
    ];

    /// Display light, 0…1 per channel, of exposed light, which must not be negative.
    pub fn shown(self, light: DVec3) -> DVec3 {
        let light = light.clamp(DVec3::ZERO, DVec3::splat(BRIGHTEST));
        let shown = match self {
            Self::Camera => camera(light),
            Self::Neutral => neutral(light),
            Self::Linear => light,
            Self::Filmic => {
                let [a, b, c, d, e] = FILMIC;
                let x = light * FILMIC_SCALE;
                x * (a * x + b) / (x * (c * x + d) + e)
            }
            Self::Agx => agx(light),
            Self::Measured(response) => response.shown(light),
        };
        shown.clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// Exposed light that is displayed as this display light, 0…1 per channel. A line of a chosen colour needs it to keep that colour in an
    /// image developed later. For a colour that the curve never shows, light of a similar one.
    pub fn light_shown_as(self, shown: DVec3) -> DVec3 {
        let shown = shown.clamp(DVec3::ZERO, DVec3::ONE);
        match self {
            Self::Camera => {
                let grey = DVec3::splat(shown.dot(LUMINANCE));
                light_by_camera(grey + (shown - grey) / CAMERA_SATURATION)
            }
            Self::Neutral => light_by_neutral(shown),
            Self::Linear => shown,
            Self::Filmic => shown.map(|y| {
                let [a, b, c, d, e] = FILMIC;
                // (a − yc)x² + (b − yd)x − ye = 0, with a positive first coefficient.
                positive_root(a - y * c, b - y * d, y * e) / FILMIC_SCALE
            }),
            Self::Agx => light_by_agx(shown),
            Self::Measured(response) => response.light_shown_as(shown),
        }
    }

    /// The response of a measured curve.
    pub fn response(self) -> Option<Response> {
        match self {
            Self::Measured(response) => Some(response),
            _ => None,
        }
    }
}

/// The positive x of ax² + bx = c, a > 0 and c ≥ 0, without a difference of similar numbers.
fn positive_root(a: f64, b: f64, c: f64) -> f64 {
    let root = (b * b + 4.0 * a * c).sqrt();
    match b > 0.0 {
        true => 2.0 * c / (b + root),
        false => (root - b) / (2.0 * a),
    }
}

/// Light that the camera curve displays as this, before its saturation.
fn light_by_camera(curved: DVec3) -> DVec3 {
    let light = |haze: f64| {
        let toe = camera_toe(haze);
        DVec3::from_array(std::array::from_fn(|channel| {
            channel_by_camera(curved[channel], toe[channel])
        }))
    };
    // Most colours are one or the other.
    for extreme in [0.0, 1.0] {
        let light = light(extreme);
        if haze(light) == extreme {
            return light;
        }
    }
    // More haze needs more blue light, which is more haze, but by less: bisection finds the only haze that agrees with its light.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        match haze(light(middle)) > middle {
            true => low = middle,
            false => high = middle,
        }
    }
    light(0.5 * (low + high))
}

/// Light of one channel that the camera curve displays as this with a toe, before its saturation.
fn channel_by_camera(shown: f64, toe: f64) -> f64 {
    let shown = shown.clamp(0.0, 1.0);
    let raised = CAMERA_HALF_RAISED * shown / (CAMERA_WHITE - shown);
    // s³ + straight·s² = raised by Newton from above, where the left side is convex.
    let mut root = raised.cbrt();
    for _ in 0..8 {
        let slope = root * (3.0 * root + 2.0 * CAMERA_STRAIGHT);
        if slope > 0.0 {
            root -= (root * root * (root + CAMERA_STRAIGHT) - raised) / slope;
        }
    }
    let cleared = root * root;
    positive_root(1.0, CAMERA_TOE_LEAST * toe - cleared, cleared * toe)
}

fn light_by_neutral(shown: DVec3) -> DVec3 {
    let shown_peak = shown.max_element();
    if shown_peak <= NEUTRAL_START {
        return shown;
    }
    let room = 1.0 - NEUTRAL_START;
    // No light reaches white itself; a third of a code below it is reachable.
    let shown_peak = shown_peak.min(1.0 - 1.0 / 768.0);
    let peak = room * room / (1.0 - shown_peak) - room + NEUTRAL_START;
    let white = 1.0 - 1.0 / (NEUTRAL_DESATURATION * (peak - shown_peak) + 1.0);
    let colored = (shown.min(DVec3::splat(shown_peak)) - white * shown_peak) / (1.0 - white);
    colored.max(DVec3::ZERO) * (peak / shown_peak)
}

/// How much of a colour is that of haze, 0 to 1.
fn haze(light: DVec3) -> f64 {
    let (other, blue) = (light.x.max(light.y), light.z);
    let lack = (other - blue) / (blue + other).max(f64::MIN_POSITIVE);
    let along = (1.0 - lack / CAMERA_HAZE).clamp(0.0, 1.0);
    along * along * (3.0 - 2.0 * along)
}

fn camera_toe(haze: f64) -> DVec3 {
    DVec3::splat(CAMERA_TOE.x).lerp(CAMERA_TOE, haze)
}

fn camera(light: DVec3) -> DVec3 {
    camera_with_toe(light, camera_toe(haze(light)))
}

/// The camera curve with one toe for all colours.
pub(super) fn camera_with_toe(light: DVec3, toe: DVec3) -> DVec3 {
    let cleared = light * (light + CAMERA_TOE_LEAST * toe) / (light + toe);
    let raised = cleared * (cleared.powf(0.5) + CAMERA_STRAIGHT);
    let shown = CAMERA_WHITE * raised / (raised + CAMERA_HALF_RAISED);
    let grey = DVec3::splat(shown.dot(LUMINANCE));
    grey + CAMERA_SATURATION * (shown - grey)
}

fn neutral(light: DVec3) -> DVec3 {
    let peak = light.max_element();
    if peak <= NEUTRAL_START {
        return light;
    }
    let room = 1.0 - NEUTRAL_START;
    let shown_peak = 1.0 - room * room / (peak + room - NEUTRAL_START);
    let white = 1.0 - 1.0 / (NEUTRAL_DESATURATION * (peak - shown_peak) + 1.0);
    (light * (shown_peak / peak)).lerp(DVec3::splat(shown_peak), white)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hue angle, radians, on the HSV hexagon.
    fn hue(color: DVec3) -> f64 {
        let across = 3.0_f64.sqrt() * (color.y - color.z);
        across.atan2(2.0 * color.x - color.y - color.z)
    }

    #[test]
    fn more_light_is_never_shown_darker() {
        let tint = DVec3::new(1.0, 0.7, 0.3);
        for tone in Tone::ALL {
            let mut before = DVec3::ZERO;
            for step in 0..=4000 {
                let light = tint * (f64::from(step) * 0.01 - 20.0).exp2();
                let shown = tone.shown(light);
                // In AgX a bright channel falls slightly while the others reach white.
                let room = if tone == Tone::Agx { 0.006 } else { 1e-12 };
                assert!(
                    shown.cmpge(before - room).all(),
                    "{tone:?} {light}: {shown}, {before}"
                );
                assert!(shown.cmple(DVec3::ONE).all() && shown.is_finite());
                before = shown;
            }
            assert_eq!(tone.shown(DVec3::ZERO), DVec3::ZERO);
            assert!(tone.shown(DVec3::splat(1e300)).is_finite(), "{tone:?}");
        }
    }

    #[test]
    fn the_camera_shows_space_black_clouds_white_and_grey_grey() {
        let code = |light: DVec3| Tone::Camera.shown(light).powf(1.0 / 2.2) * 255.0;
        // The clear sea under the atmosphere, and a thick cloud, at the default exposure.
        let sea = code(DVec3::new(0.03, 0.06, 0.13) * 2.0_f64.sqrt());
        assert!(sea.x < 55.0 && sea.y < 85.0 && sea.z < 130.0, "{sea}");
        let cloud = code(DVec3::splat(0.72 * 2.0_f64.sqrt()));
        assert!(cloud.min_element() > 225.0, "{cloud}");
        // Grey light is slightly yellow in the darks, where haze is removed, and grey from the middle on.
        let middle = code(DVec3::splat(0.5));
        assert!(
            middle.max_element() - middle.min_element() < 14.0,
            "{middle}"
        );
        assert_eq!(Tone::Camera.shown(DVec3::splat(4.0)), DVec3::ONE);
    }

    /// A town lit by warm white lamps, dim enough for the toe: the curve takes a third of its blue, where the toe of haze takes two thirds.
    #[test]
    fn the_camera_takes_haze_out_of_blue_light_and_no_colour_out_of_lamps() {
        let lamps = DVec3::new(0.10, 0.07, 0.04);
        let blue = |shown: DVec3| shown.z / shown.x;
        let kept = blue(Tone::Camera.shown(lamps));
        let as_haze = blue(camera_with_toe(lamps, CAMERA_TOE));
        assert!(kept > 2.0 * as_haze, "{kept} {as_haze}");
        let hazy = DVec3::new(0.03, 0.05, 0.10);
        let off = Tone::Camera.shown(hazy) - camera_with_toe(hazy, CAMERA_TOE);
        assert!(off.abs().max_element() < 1e-12, "{off}");
    }

    /// Bluer light has a larger toe, but is still shown bluer, so that each colour is shown by one light.
    #[test]
    fn the_camera_shows_more_blue_with_more_blue() {
        for level in 0..200 {
            let other = (f64::from(level) * 0.06 - 12.0).exp2();
            let mut before = -1.0;
            for step in 0..400 {
                let blue = other * (f64::from(step) * 0.01 - 2.0).exp2();
                let shown = Tone::Camera.shown(DVec3::new(other, other, blue)).z;
                assert!(shown >= before, "{other} {blue}: {shown}, {before}");
                before = shown;
            }
        }
    }

    /// The darkest channel stays the darkest. No colour turns into its opposite, and none leaves the hue sector between its
    /// two neighbours.
    #[test]
    fn the_camera_keeps_the_order_of_channels_in_the_light() {
        for tint in [
            DVec3::new(1.0, 0.6, 0.3),
            DVec3::new(0.3, 0.8, 0.6),
            DVec3::new(0.25, 0.4, 1.0),
        ] {
            for light in [0.3, 1.0, 1.5] {
                let shown = Tone::Camera.shown(tint * light);
                assert_eq!(shown.max_position(), tint.max_position(), "{tint} {light}");
                assert!(
                    (hue(shown) - hue(tint)).abs() < 0.35,
                    "{tint} {light}: {shown}"
                );
            }
        }
    }

    #[test]
    fn light_is_shown_as_the_colour_that_it_was_asked_for() {
        let codes = [0.0, 1.0, 7.0, 40.0, 128.0, 200.0, 254.0, 255.0];
        let linear = |code: f64| (code / 255.0).powf(2.2);
        let code = |linear: DVec3| linear.powf(1.0 / 2.2) * 255.0;
        for tone in Tone::ALL {
            for red in codes {
                for green in codes {
                    let wanted = DVec3::new(linear(red), linear(green), linear(90.0));
                    let light = tone.light_shown_as(wanted);
                    assert!(light.is_finite() && light.cmpge(DVec3::ZERO).all());
                    let got = code(tone.shown(light));
                    // Highlights of the neutral curve fade, so it shows no bright pure colour. AgX
                    // shows no pure colours.
                    let is_shown = match tone {
                        Tone::Neutral => red.max(green) < 220.0,
                        Tone::Agx => [red, green].iter().all(|code| *code == 128.0),
                        _ => true,
                    };
                    let off = (got - DVec3::new(red, green, 90.0)).abs().max_element();
                    assert!(!is_shown || off < 0.4, "{tone:?} {red} {green}: {got}");
                }
            }
        }
    }

    /// Light, and the value that three.js displays for it.
    const AGX_BY_THREE_JS: [([f64; 3], [f64; 3]); 6] = [
        ([0.18, 0.18, 0.18], [0.2145486, 0.2145024, 0.2144992]),
        ([1.0, 1.0, 1.0], [0.5902294, 0.5901361, 0.5901023]),
        ([0.02, 0.05, 0.12], [0.0204572, 0.0706529, 0.1600676]),
        ([4.0, 1.0, 0.2], [0.9380806, 0.6228427, 0.4209468]),
        ([0.001, 0.001, 0.001], [0.0001058, 0.0001057, 0.0001057]),
        ([30.0, 30.0, 60.0], [0.9969783, 0.9968787, 0.996779]),
    ];

    /// Compares with the formula of three.js, evaluated in Python with its shader's constants in the same order.
    #[test]
    fn agx_shows_what_three_js_shows() {
        for (light, shown) in AGX_BY_THREE_JS {
            let off = Tone::Agx.shown(DVec3::from(light)) - DVec3::from(shown);
            assert!(off.abs().max_element() < 2e-6, "{light:?}: {off}");
        }
    }

    #[test]
    fn the_neutral_curve_keeps_hue() {
        let tint = DVec3::new(0.2, 0.5, 1.0);
        for light in [0.1, 0.7, 0.77, 1.0, 3.0, 20.0, 1000.0] {
            let shown = Tone::Neutral.shown(tint * light);
            assert!((hue(shown) - hue(tint)).abs() < 1e-9, "{light}: {shown}");
        }
        // The clipped curve changes it; otherwise this test could not fail.
        let clipped = Tone::Linear.shown(tint * 3.0);
        assert!((hue(clipped) - hue(tint)).abs() > 0.1);
    }

    #[test]
    fn the_neutral_curve_is_smooth_where_it_begins() {
        let at = |light: f64| Tone::Neutral.shown(DVec3::splat(light)).x;
        let slope = |light: f64| (at(light + 1e-6) - at(light)) / 1e-6;
        assert_eq!(at(0.5), 0.5);
        assert!((slope(NEUTRAL_START + 1e-9) - 1.0).abs() < 1e-3);
    }
}
