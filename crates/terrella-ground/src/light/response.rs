//! Measured camera responses: brightness of a film or detector as a function of irradiance.

use super::srgb::{encoded, linear_from_encoded};
use glam::DVec3;
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::ops::RangeInclusive;
use std::sync::{Mutex, PoisonError};

/// A measured camera response, with which [`Tone::Measured`](super::Tone::Measured) displays light.
///
/// Exposed light of 1 is irradiance 1 of the measurement, the least that saturates it. At the default exposure of 0.5 EV, that is light of 0.71 times
/// a white sheet facing the Sun in space. Brightness is a pixel value, encoded as sRGB. Each channel has its own curve, or all share one. Greys stay
/// grey if all channels share a curve. The hue of bright colours moves towards that of their largest channels until all are white, as on film.
///
/// This is a copyable handle. Equal responses are stored once, for the lifetime of the program: 16 KiB each.
#[derive(Clone, Copy)]
pub struct Response(&'static ResponseTable);

/// Samples of a response.
struct ResponseTable {
    /// Index among all responses of the program.
    index: usize,
    name: String,
    /// Brightness of red, green and blue, 0…1, at irradiances evenly spaced over 0…1. The fourth number is unused.
    samples: Vec<[f32; 4]>,
}

/// All responses of the program.
static RESPONSES: Mutex<Vec<&'static ResponseTable>> = Mutex::new(Vec::new());

impl Response {
    /// Samples of each channel, as in the files of CAVE.
    pub const SAMPLES: usize = 1024;

    /// Creates a response from curves for red, green and blue: brightness at [`Self::SAMPLES`] irradiances
    /// evenly spaced over 0…1.
    pub(super) fn of_curves(name: &str, [red, green, blue]: [&[f32]; 3]) -> Self {
        let channels = red.iter().zip(green).zip(blue);
        let samples = channels.map(|((red, green), blue)| [*red, *green, *blue, 0.0]);
        let samples: Vec<_> = samples.collect();
        let mut all = RESPONSES.lock().unwrap_or_else(PoisonError::into_inner);
        let known = all.iter();
        let mut known = known.filter(|table| table.name == name && table.samples == samples);
        if let Some(table) = known.next() {
            return Self(table);
        }
        let table: &'static ResponseTable = Box::leak(Box::new(ResponseTable {
            index: all.len(),
            name: name.to_owned(),
            samples,
        }));
        all.push(table);
        Self(table)
    }

    /// Name in the file.
    pub fn name(self) -> &'static str {
        &self.0.name
    }

    /// Brightness of red, green and blue, 0…1, at irradiances evenly spaced over 0…1. These are the shader's texels. The fourth number is
    /// unused.
    pub fn samples(self) -> &'static [[f32; 4]] {
        &self.0.samples
    }

    /// Brightness of exposed light per channel, 0…1, as encoded pixel values: linear between samples.
    pub fn brightness(self, light: DVec3) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|channel| {
            let at = light[channel].clamp(0.0, 1.0) * LAST as f64;
            let low = (at as usize).min(LAST - 1);
            let [a, b] = [low, low + 1].map(|sample| self.sample(sample, channel));
            a + (b - a) * (at - low as f64)
        }))
    }

    /// The same as linear display light, 0…1.
    pub(super) fn shown(self, light: DVec3) -> DVec3 {
        self.brightness(light).map(linear_from_encoded)
    }

    /// The least light displayed as this linear display light. If none is, the light displayed as the nearest value.
    pub(super) fn light_shown_as(self, shown: DVec3) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|channel| {
            let wanted = encoded(shown[channel]);
            let samples = self.samples();
            let high = samples.partition_point(|sample| f64::from(sample[channel]) < wanted);
            let (high, low) = (high.min(LAST), high.saturating_sub(1).min(LAST));
            let [a, b] = [low, high].map(|sample| self.sample(sample, channel));
            let part = match b > a {
                true => ((wanted - a) / (b - a)).clamp(0.0, 1.0),
                false => 0.0,
            };
            (low as f64 + part * (high - low) as f64) / LAST as f64
        }))
    }

    /// Largest slope of brightness over light, for light within this range in each channel.
    pub(super) fn steepest(self, light: &RangeInclusive<f64>) -> DVec3 {
        let sample = |light: f64| (light.clamp(0.0, 1.0) * LAST as f64) as usize;
        if *light.start() >= 1.0 {
            return DVec3::ZERO;
        }
        let segments = sample(*light.start())..=sample(*light.end()).min(LAST - 1);
        segments.fold(DVec3::ZERO, |steepest, low| {
            let rise = |channel| self.sample(low + 1, channel) - self.sample(low, channel);
            steepest.max(LAST as f64 * DVec3::from_array(std::array::from_fn(rise)))
        })
    }

    fn sample(self, sample: usize, channel: usize) -> f64 {
        f64::from(self.0.samples[sample][channel])
    }
}

/// Index of the last sample.
const LAST: usize = Response::SAMPLES - 1;

impl std::fmt::Debug for Response {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Response").field(&self.0.name).finish()
    }
}

impl PartialEq for Response {
    fn eq(&self, other: &Self) -> bool {
        self.0.index == other.0.index
    }
}

impl Eq for Response {}

impl PartialOrd for Response {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Response {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.index.cmp(&other.0.index)
    }
}

impl Hash for Response {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.index.hash(state);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Tone;
    use super::*;

    /// A response of this curve in all channels.
    fn response(name: &str, curve: impl Fn(f64) -> f64) -> Response {
        let samples = (0..=LAST).map(|n| curve(n as f64 / LAST as f64) as f32);
        let samples: Vec<_> = samples.collect();
        Response::of_curves(name, [&samples, &samples, &samples])
    }

    fn s_curve(x: f64) -> f64 {
        x * x * (3.0 - 2.0 * x)
    }

    #[test]
    fn brightness_is_the_encoded_value_of_a_pixel() {
        let gamma = response("gamma", |x| x.powf(1.0 / 2.2));
        for light in [0.0, 0.004, 0.18, 0.5, 0.999, 1.0] {
            let shown = Tone::Measured(gamma).shown(DVec3::splat(light));
            // sRGB's own formula, written out.
            let code = match shown.x <= 0.003_130_8 {
                true => 12.92 * shown.x,
                false => 1.055 * shown.x.powf(1.0 / 2.4) - 0.055,
            };
            let wanted = light.powf(1.0 / 2.2);
            assert!((code - wanted).abs() < 1e-3, "{light}: {code}, {wanted}");
        }
        // Irradiance of 1 and above saturates.
        assert_eq!(gamma.brightness(DVec3::splat(7.0)), DVec3::ONE);
        assert_eq!(gamma.brightness(DVec3::splat(-1.0)), DVec3::ZERO);
    }

    #[test]
    fn equal_responses_are_stored_once() {
        let (a, b) = (response("s", s_curve), response("s", s_curve));
        assert!(std::ptr::eq(a.samples(), b.samples()));
        assert_eq!(a, b);
        assert_ne!(a, response("other name", s_curve));
        assert_ne!(a, response("s", |x| x));
    }

    #[test]
    fn light_is_found_again_from_what_is_shown() {
        // A curve that is flat at both ends.
        let flat = response("flat", |x| ((x - 0.1) / 0.8).clamp(0.0, 1.0));
        for response in [flat, response("s", s_curve)] {
            let tone = Tone::Measured(response);
            for code in 0..=255 {
                let shown = DVec3::splat(linear_from_encoded(f64::from(code) / 255.0));
                let light = tone.light_shown_as(shown);
                let again = encoded(tone.shown(light).x) * 255.0;
                assert!((again - f64::from(code)).abs() < 1e-3, "{code}: {again}");
            }
        }
        assert!(flat.light_shown_as(DVec3::ZERO).x < 0.101);
    }

    /// Greys stay grey, the order of channels is kept, and a bright colour's hue moves towards white by its largest
    /// channels.
    #[test]
    fn hue_is_kept_in_order_and_not_in_angle() {
        let tone = Tone::Measured(response("s", s_curve));
        let grey = tone.shown(DVec3::splat(0.3));
        assert!(grey.x == grey.y && grey.y == grey.z);
        for light in [0.1, 0.5, 1.0, 3.0] {
            let shown = tone.shown(light * DVec3::new(1.0, 0.6, 0.2));
            assert!(shown.x >= shown.y && shown.y >= shown.z, "{light}: {shown}");
        }
        let ratio = |light: f64| {
            let shown = tone.shown(light * DVec3::new(1.0, 0.6, 0.2));
            shown.y / shown.x
        };
        assert!(ratio(1.6) > ratio(0.5) + 0.3, "yellower where it is bright");
    }

    #[test]
    fn channels_have_their_own_curves() {
        let linear: Vec<_> = (0..=LAST).map(|n| n as f32 / LAST as f32).collect();
        let (dark, full) = (vec![0.0; LAST + 1], vec![1.0; LAST + 1]);
        let response = Response::of_curves("three", [&linear, &dark, &full]);
        let brightness = response.brightness(DVec3::splat(0.5));
        assert!((brightness - DVec3::new(0.5, 0.0, 1.0)).length() < 1e-6);
    }
}
