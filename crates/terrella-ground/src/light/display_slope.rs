//! Slope of display values over light, which determines how visible an error of light is.

use super::srgb::encoded;
use super::tone::{CAMERA_SATURATION, CAMERA_TOE, camera_with_toe};
use super::{Grade, Tone};
use glam::{DVec3, Mat3, Vec3};

/// Slope of sRGB display values, 0…1, over exposed light through a tone curve.
pub struct DisplaySlope {
    /// Largest slope in each exposure step, per channel.
    slopes: Vec<Vec3>,
    /// White balance before the curve, and its largest gain in each channel for an error of all
    /// channels.
    balance: Option<(Mat3, Vec3)>,
}

/// Steps per exposure value.
const STEPS: usize = 16;
/// Exposure values below and above 1. Darker light is in the straight start of the curves, brighter light at
/// their end.
const BELOW: usize = 14;
const ABOVE: usize = 4;
/// Slopes evaluated per step.
const PARTS: usize = 2;

impl DisplaySlope {
    /// The slope of this curve after the white balance of a grade.
    pub fn of(tone: Tone, grade: &Grade) -> Self {
        let shown = |part: usize| {
            let light = (part as f64 / (STEPS * PARTS) as f64 - BELOW as f64).exp2();
            // Per channel, because their curves differ. The camera's also differ between haze and other light.
            let light = DVec3::splat(light);
            let shown = match tone {
                Tone::Camera => {
                    [CAMERA_TOE, DVec3::splat(CAMERA_TOE.x)].map(|toe| camera_with_toe(light, toe))
                }
                _ => [tone.shown(light); 2],
            };
            (light, shown.map(|shown| shown.map(encoded)))
        };
        let slope = |part: usize| {
            let [(a, low), (b, high)] = [shown(part), shown(part + 1)];
            let [first, second] = [0, 1].map(|curve| (high[curve] - low[curve]) / (b - a));
            first.max(second)
        };
        let steps = 0..(BELOW + ABOVE) * STEPS;
        let slopes = steps.map(|step| {
            if let Tone::Measured(response) = tone {
                // Its brightness is already encoded, and linear between samples.
                let light = |step: f64| (step / STEPS as f64 - BELOW as f64).exp2();
                let within = light(step as f64 - 0.5)..=light(step as f64 + 1.5);
                return response.steepest(&within).as_vec3();
            }
            // Includes the neighbours, because a slope between two lights is a mean.
            let parts = (step * PARTS).saturating_sub(1)..=(step + 1) * PARTS;
            let largest = parts.map(slope).fold(DVec3::ZERO, DVec3::max);
            match tone {
                // If all channels rise equally, each shows its own slope.
                Tone::Camera => (CAMERA_SATURATION * largest).as_vec3(),
                _ => largest.as_vec3(),
            }
        });
        Self {
            slopes: slopes.collect(),
            balance: grade
                .balance()
                .map(|matrix| (matrix.as_mat3(), Grade::gains(&matrix).as_vec3())),
        }
    }

    /// Slope at an exposed light, never less than the true slope.
    pub fn at(&self, light: Vec3) -> Vec3 {
        let Some((matrix, gains)) = self.balance else {
            return self.of_balanced(light);
        };
        // Each channel shows errors of all channels, at most multiplied by its gain.
        let slopes = self.of_balanced((matrix * light).max(Vec3::ZERO));
        Vec3::splat((slopes * gains).max_element())
    }

    /// Slope at light after the white balance.
    fn of_balanced(&self, light: Vec3) -> Vec3 {
        let at = |channel: usize| {
            let step = (light[channel].max(1e-9).log2() + BELOW as f32) * STEPS as f32;
            self.slopes[(step.max(0.0) as usize).min(self.slopes.len() - 1)][channel]
        };
        Vec3::new(at(0), at(1), at(2))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Response, WhiteBalance};
    use super::*;

    #[test]
    fn no_channel_rises_more_steeply() {
        let wavy = "wavy\ntype\nI = 0 0.1 0.11 0.8 0.9 1\nB = 0 0.02 0.4 0.45 0.9 1";
        let measured = Response::read(wavy, None).expect("a response");
        for tone in Tone::ALL.into_iter().chain([Tone::Measured(measured)]) {
            let slopes = DisplaySlope::of(tone, &Grade::NONE);
            let mut closest = 0.0_f64;
            for tint in [
                DVec3::ONE,
                DVec3::new(0.25, 0.4, 1.0),
                DVec3::new(1.0, 0.8, 0.4),
            ] {
                for n in 0..1500 {
                    let light = tint * (f64::from(n) * 0.01 - 13.0).exp2();
                    // All channels together, as for errors of the atmosphere.
                    let more = light * 1.0001;
                    let rise = tone.shown(more).map(encoded) - tone.shown(light).map(encoded);
                    for channel in 0..3 {
                        // Saturation may make a channel follow a brighter one.
                        let by = (more - light)[channel];
                        let most = f64::from(slopes.at(light.as_vec3())[channel]) * by;
                        let follows = 1e-4 * light.max_element();
                        assert!(
                            rise[channel].abs() <= most + follows,
                            "{tone:?} {light}: {} and not {most}",
                            rise[channel]
                        );
                        closest = closest.max(rise[channel] / most);
                    }
                }
            }
            assert!(closest > 0.7, "{tone:?}: {closest}");
        }
    }

    /// Errors of any channels, each as large as the slope permits for one code, cause an error of
    /// at most one code.
    #[test]
    fn a_white_balance_makes_errors_no_larger_than_the_slope_says() {
        let grade = Grade {
            white_balance: Some(WhiteBalance {
                temperature_k: 2500.0,
                tint: 30.0,
            }),
            ..Grade::NONE
        };
        let matrix = grade.balance().expect("a balance");
        let slopes = DisplaySlope::of(Tone::Neutral, &grade);
        let shown = |light: DVec3| Tone::Neutral.shown(matrix * light).map(encoded);
        let mut worst = 0.0_f64;
        for n in 0..800 {
            let light = DVec3::new(1.0, 0.8, 0.6) * (f64::from(n) * 0.01 - 8.0).exp2();
            let slope = slopes.at(light.as_vec3()).as_dvec3();
            for signs in 0..8 {
                let sign = |bit: u32| if signs & bit == 0 { 1.0 } else { -1.0 };
                let error = 1e-4 / slope * DVec3::new(sign(1), sign(2), sign(4));
                let off = (shown(light + error) - shown(light)).abs().max_element();
                worst = worst.max(off / 1e-4);
            }
        }
        assert!((0.5..1.05).contains(&worst), "{worst}");
    }
}
