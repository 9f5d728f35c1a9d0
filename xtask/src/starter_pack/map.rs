//! Maps as planes of `f32`, and operations on them.
//!
//! Texels are computed with +, −, ×, ÷ and rounding only, which give the same bits on every machine. Sine and power functions come from the system
//! and may differ in the last bit, which could change a rounding.

use anyhow::{Context, Result, ensure};
use std::path::Path;

/// An equirectangular map: north row first, left edge at 180° W, channels interleaved, display values 0…255.
pub struct Map {
    pub width: usize,
    pub height: usize,
    pub channels: usize,
    pub values: Vec<f32>,
}

impl Map {
    /// Reads an 8-bit image as `channels` (1 or 3) planes.
    pub fn read(path: &Path, channels: usize) -> Result<Self> {
        let picture = open(path)?;
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        ensure!(
            width == 2 * height,
            "{} is {width} x {height}, not a map of the whole Earth",
            path.display()
        );
        let bytes = match (channels, picture) {
            (1, image::DynamicImage::ImageLuma8(grey)) => grey.into_raw(),
            (3, image::DynamicImage::ImageRgb8(colour)) => colour.into_raw(),
            // An image without transparent texels.
            (3, colour @ image::DynamicImage::ImageRgba8(_)) => colour.into_rgb8().into_raw(),
            (_, other) => anyhow::bail!("{} holds {:?} texels", path.display(), other.color()),
        };
        Ok(Self {
            width,
            height,
            channels,
            values: bytes.into_iter().map(f32::from).collect(),
        })
    }

    /// The values rounded to bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.values
            .iter()
            .map(|value| (value.clamp(0.0, 255.0) + 0.5) as u8)
            .collect()
    }

    /// Values of one row.
    pub fn row_mut(&mut self, y: usize) -> &mut [f32] {
        let len = self.width * self.channels;
        &mut self.values[y * len..(y + 1) * len]
    }

    /// Half the size; each texel is the mean of four.
    pub fn halved(&self) -> Self {
        let (width, height, channels) = (self.width / 2, self.height / 2, self.channels);
        let mut values = Vec::with_capacity(width * height * channels);
        for y in 0..height {
            for x in 0..width {
                for channel in 0..channels {
                    let at = |dx: usize, dy: usize| {
                        let texel = (2 * y + dy) * self.width + 2 * x + dx;
                        self.values[texel * channels + channel]
                    };
                    values.push((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) * 0.25);
                }
            }
        }
        Self {
            width,
            height,
            channels,
            values,
        }
    }

    /// The map at another size, by the Catmull–Rom cubic, widened by the ratio when it shrinks; periodic in longitude.
    pub fn resampled(&self, width: usize, height: usize) -> Self {
        let channels = self.channels;
        let columns: Vec<_> = (0..width)
            .map(|x| cubic_taps(x, width, self.width))
            .collect();
        let mut narrow = Vec::with_capacity(width * self.height * channels);
        for row in self.values.chunks_exact(self.width * channels) {
            for (first, weights) in &columns {
                for channel in 0..channels {
                    let sum = weights.iter().enumerate().map(|(n, weight)| {
                        let x = (first + n as isize).rem_euclid(self.width as isize) as usize;
                        weight * row[x * channels + channel]
                    });
                    narrow.push(sum.sum::<f32>());
                }
            }
        }
        let len = width * channels;
        let mut values = Vec::with_capacity(len * height);
        for y in 0..height {
            let (first, weights) = cubic_taps(y, height, self.height);
            let mut out = vec![0.0f32; len];
            for (n, weight) in weights.iter().enumerate() {
                let y = (first + n as isize).clamp(0, self.height as isize - 1) as usize;
                for (out, value) in out.iter_mut().zip(&narrow[y * len..(y + 1) * len]) {
                    *out += weight * value;
                }
            }
            values.extend(out.into_iter().map(|value| value.clamp(0.0, 255.0)));
        }
        Self {
            width,
            height,
            channels,
            values,
        }
    }

    /// Removes the step between a column and the one west of it, where the map's source was cut and each side processed separately. Column 0 is the
    /// seam between the left and the right edge.
    ///
    /// The part of the step that the slopes of the neighbouring columns do not explain is split between both sides and fades out over `reach`
    /// columns. It is smoothed along the cut, so that fine detail leaves no streaks.
    pub fn mend_step(&mut self, column: usize, reach: usize) {
        const SMOOTHING_ROWS: isize = 3;
        let (width, height, channels) = (self.width, self.height, self.channels);
        // Columns to the east of the cut, and to the west, both counted from it.
        let east = |k: usize| (column + k) % width;
        let west = |k: usize| (column + width - 1 - k) % width;
        for channel in 0..channels {
            let at = |x: usize, y: usize| self.values[(y * width + x) * channels + channel];
            let steps: Vec<f32> = (0..height)
                .map(|y| {
                    let step = at(east(0), y) - at(west(0), y);
                    let slopes = at(west(0), y) - at(west(1), y) + at(east(1), y) - at(east(0), y);
                    step - 0.5 * slopes
                })
                .collect();
            for y in 0..height {
                let near = (-SMOOTHING_ROWS..=SMOOTHING_ROWS).map(|dy| {
                    let y = (y as isize + dy).clamp(0, height as isize - 1) as usize;
                    let weight = (SMOOTHING_ROWS + 1 - dy.abs()) as f32;
                    (weight, weight * steps[y])
                });
                let (weights, sum) = near.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
                let step = sum / weights;
                for k in 0..reach {
                    let rest = 1.0 - k as f32 / reach as f32;
                    let change = 0.5 * step * rest * rest;
                    self.values[(y * width + east(k)) * channels + channel] -= change;
                    self.values[(y * width + west(k)) * channels + channel] += change;
                }
            }
        }
    }
}

/// Opens an image, with its path in every error.
pub fn open(path: &Path) -> Result<image::DynamicImage> {
    let reader = image::ImageReader::open(path).with_context(|| path.display().to_string())?;
    let picture = reader.with_guessed_format()?.decode();
    picture.with_context(|| path.display().to_string())
}

/// First source texel and weights for a target texel when `source` texels become `target`; widened when the size shrinks.
pub fn cubic_taps(index: usize, target: usize, source: usize) -> (isize, Vec<f32>) {
    let ratio = (source as f64 / target as f64).max(1.0);
    let centre = (index as f64 + 0.5) * source as f64 / target as f64;
    let first = (centre - 2.0 * ratio - 0.5).ceil() as isize;
    let last = (centre + 2.0 * ratio - 0.5).floor() as isize;
    let weights: Vec<f64> = (first..=last)
        .map(|n| {
            let d = ((n as f64 + 0.5 - centre) / ratio).abs();
            if d < 1.0 {
                1.0 + d * d * (1.5 * d - 2.5)
            } else if d < 2.0 {
                2.0 + d * (d * (2.5 - 0.5 * d) - 4.0)
            } else {
                0.0
            }
        })
        .collect();
    let sum: f64 = weights.iter().sum();
    (first, weights.iter().map(|w| (w / sum) as f32).collect())
}

/// 0 below `from`, 1 above `to`, smooth in between; `from` may be the larger one.
pub fn smooth_step(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Map {
        let values = (0..width * height)
            .map(|n| value(n % width, n / width))
            .collect();
        Map {
            width,
            height,
            channels: 1,
            values,
        }
    }

    #[test]
    fn resampling_keeps_place_and_constants() {
        let flat = map(54, 27, |_, _| 77.0).resampled(40, 20);
        assert!(flat.values.iter().all(|value| (value - 77.0).abs() < 1e-3));
        // A ramp from north to south keeps its values.
        let ramp = map(54, 27, |_, y| (y as f32 + 0.5) * 200.0 / 27.0).resampled(40, 20);
        for y in 3..17 {
            // A widened cubic with normalized weights is off by up to 0.022 source texels of 7.4.
            let expected = (y as f32 + 0.5) * 10.0;
            assert!((ramp.values[y * 40 + 5] - expected).abs() < 0.18);
        }
    }

    #[test]
    fn halving_averages_four() {
        let half = map(4, 2, |x, y| (10 * x + y) as f32).halved();
        assert_eq!(half.values, [5.5, 25.5]);
    }

    #[test]
    fn a_step_at_the_seam_goes_and_the_rest_stays() {
        let mut stepped = map(200, 100, |x, _| if x < 100 { 120.0 } else { 100.0 });
        stepped.mend_step(0, 20);
        let row = &stepped.values[50 * 200..51 * 200];
        assert!((row[0] - row[199]).abs() < 1e-3);
        assert!((row[0] - row[1]).abs() < 1.1, "let off gently");
        assert_eq!((row[20], row[179]), (120.0, 100.0));
        assert_eq!((row[99], row[100]), (120.0, 100.0));
        stepped.mend_step(100, 20);
        let row = &stepped.values[50 * 200..51 * 200];
        assert!((row[99] - row[100]).abs() < 1e-3);
        // A slope that continues over the seam is not a step.
        let mut sloped = map(200, 100, |x, _| ((x + 100) % 200) as f32);
        let before = sloped.values.clone();
        sloped.mend_step(0, 20);
        let change = before.iter().zip(&sloped.values);
        assert!(change.into_iter().all(|(a, b)| (a - b).abs() < 1e-3));
    }
}
