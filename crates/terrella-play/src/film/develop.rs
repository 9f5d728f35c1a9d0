//! Development of light into an image on the CPU: averaging, exposure, tone curve, encoding.
//!
//! The formulas are those of `shaders/common/displayed.wgsl`; in addition, light of many pixels and times is averaged before.

use super::bloom::scatter;
use super::over_light::covered;
use glam::{DMat3, DVec3, DVec4};
use image::RgbaImage;
use rayon::prelude::*;
use std::borrow::Cow;
use terrella::{Bloom, Grade, Tone};

/// Light of a picture that is gathered from many pixels and instants.
///
/// Sums are of 64 bits: of equal light the mean is that light, to the last bit.
#[derive(Clone, Debug)]
pub struct GatheredLight {
    size: (u32, u32),
    /// N of the N × N pixels that are averaged into one.
    pixels_a_side: u32,
    sums: Vec<DVec4>,
    instants: u32,
}

/// Light of a picture, and how it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPicture {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Red, green, blue and opacity over the background, 0…1; the light is premultiplied.
    pub pixels: Vec<[f32; 4]>,
    /// How it is shown.
    pub look: PictureLook,
    /// Overlay at display white: 8 bits a channel, sRGB, premultiplied. Neither bloom nor grain affect it.
    pub over: Option<RgbaImage>,
}

/// How light is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureLook {
    /// Exposure factor.
    pub factor: f64,
    /// The curve of highlights.
    pub tone: Tone,
    /// Bloom of exposed light before the tone curve.
    pub bloom: Bloom,
    /// White balance before the curve, and grain after it.
    pub grade: Grade,
    /// The number of the frame, by which grain differs.
    pub frame: u32,
}

impl GatheredLight {
    /// Nothing yet, for a picture of this size.
    pub fn new(size: (u32, u32), pixels_a_side: u32) -> Self {
        Self {
            size,
            pixels_a_side,
            sums: vec![DVec4::ZERO; size.0 as usize * size.1 as usize],
            instants: 0,
        }
    }

    /// Adds an instant: N times as wide and high as the picture, rows from the top.
    pub fn add(&mut self, light: &[[f32; 4]]) {
        let (side, width) = (self.pixels_a_side as usize, self.size.0 as usize);
        let rows = light.par_chunks_exact(side * side * width);
        let sums = self.sums.par_chunks_exact_mut(width);
        sums.zip(rows).for_each(|(sums, rows)| {
            for row in rows.chunks_exact(side * width) {
                for (sum, pixels) in sums.iter_mut().zip(row.chunks_exact(side)) {
                    for pixel in pixels {
                        *sum += DVec4::from(pixel.map(f64::from));
                    }
                }
            }
        });
        self.instants += 1;
    }

    /// The mean of the added images.
    pub fn picture(&self, look: PictureLook) -> LightPicture {
        let count = f64::from(self.pixels_a_side).powi(2) * f64::from(self.instants.max(1));
        let pixels = self.sums.par_iter().map(|sum| {
            let mean = *sum / count;
            mean.as_vec4().to_array()
        });
        LightPicture {
            size: self.size,
            pixels: pixels.collect(),
            look,
            over: None,
        }
    }
}

impl LightPicture {
    /// With 8 bits a channel, dithered: as displayed, on black; or with straight `alpha`, for compositing.
    pub fn shown_8(&self, alpha: bool) -> RgbaImage {
        let width = self.size.0.max(1) as usize;
        let mut bytes = vec![0; self.pixels.len() * 4];
        let scattered = self.scattered();
        let developer = self.developer();
        let pixels = scattered.par_iter().zip(bytes.par_chunks_exact_mut(4));
        pixels.enumerate().for_each(|(n, (light, bytes))| {
            let (shown, opacity) = developer.shown(light, alpha);
            let (shown, bare) = covered(self.over.as_ref(), n, shown);
            let noise = dither((n % width) as f32 + 0.5, (n / width) as f32 + 0.5);
            let grained = developer.grained((n % width, n / width), bare);
            let code = |linear: f64| {
                let value = encoded(linear + f64::from(noise) * linear_per_code(linear));
                (grained(value) * 255.0).round() as u8
            };
            bytes.copy_from_slice(&[
                code(shown.x),
                code(shown.y),
                code(shown.z),
                (opacity * 255.0).round() as u8,
            ]);
        });
        let (width, height) = self.size;
        // The number of bytes matches the size.
        RgbaImage::from_raw(width, height, bytes).unwrap_or_default()
    }

    /// With 16 bits a channel, high byte first, without dithering: red, green, blue, and with `alpha` that, straight.
    pub fn shown_16(&self, alpha: bool) -> Vec<u8> {
        let channels = if alpha { 4 } else { 3 };
        let mut bytes = vec![0; self.pixels.len() * channels * 2];
        let scattered = self.scattered();
        let developer = self.developer();
        let width = self.size.0.max(1) as usize;
        let pixels = scattered.par_iter();
        pixels
            .zip(bytes.par_chunks_exact_mut(channels * 2))
            .enumerate()
            .for_each(|(n, (light, bytes))| {
                let (shown, opacity) = developer.shown(light, alpha);
                let (shown, bare) = covered(self.over.as_ref(), n, shown);
                let grained = developer.grained((n % width, n / width), bare);
                let [red, green, blue] = shown.to_array().map(|linear| grained(encoded(linear)));
                let values = [red, green, blue, opacity];
                for (value, bytes) in values.iter().zip(bytes.as_chunks_mut::<2>().0) {
                    *bytes = ((value * 65_535.0).round() as u16).to_be_bytes();
                }
            });
        bytes
    }

    /// The light after the lens, before exposure.
    pub(super) fn scattered(&self) -> Cow<'_, [[f32; 4]]> {
        let mut pixels = Cow::from(&self.pixels);
        let look = &self.look;
        if look.bloom.strength > 0.0 {
            scatter(&look.bloom, self.size, pixels.to_mut(), look.factor);
        }
        pixels
    }

    pub(super) fn developer(&self) -> PixelDeveloper<'_> {
        PixelDeveloper {
            look: &self.look,
            balance: self.look.grade.balance(),
            frame_seed: self.look.grade.grain.frame_seed(self.look.frame),
        }
    }
}

/// Parameters that all pixels share in development.
pub(super) struct PixelDeveloper<'l> {
    look: &'l PictureLook,
    /// The matrix of the white balance.
    balance: Option<DMat3>,
    /// Seed of the frame's grain.
    frame_seed: u32,
}

impl PixelDeveloper<'_> {
    /// Adds the grain of a pixel to encoded values; `bare` is the fraction that no overlay covers, 0…1.
    pub fn grained(&self, (x, y): (usize, usize), bare: f32) -> impl Fn(f64) -> f64 {
        let grain = self.look.grade.grain;
        let is_grained = grain.strength > 0.0;
        let noise = is_grained.then(|| grain.noise((x as u32, y as u32), self.frame_seed));
        move |value| noise.map_or(value, |noise| grain.grained(value, bare * noise))
    }

    /// Exposed light of a pixel, after the white balance.
    pub fn balanced(&self, light: &[f32; 4]) -> DVec3 {
        let [red, green, blue, _] = light.map(f64::from);
        let exposed = DVec3::new(red, green, blue).max(DVec3::ZERO) * self.look.factor;
        self.balance.map_or(exposed, |balance| balance * exposed)
    }

    /// Linear display light of a pixel, 0…1, and its opacity.
    ///
    /// Where light is shown brighter than its opacity has room for (the halo hides little and shines), the opacity is raised to it:
    /// over black, in linear light, the pixel is what it is without alpha.
    fn shown(&self, light: &[f32; 4], alpha: bool) -> (DVec3, f64) {
        let shown = self.look.tone.shown(self.balanced(light));
        let hides = f64::from(light[3]);
        if !alpha {
            return (shown, 1.0);
        }
        let opacity = hides.clamp(0.0, 1.0).max(shown.max_element());
        match opacity > 0.0 {
            true => (shown / opacity, opacity),
            false => (DVec3::ZERO, 0.0),
        }
    }
}

/// sRGB's code of linear light, 0…1 (IEC 61966-2-1).
fn encoded(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    match c <= 0.003_130_8 {
        true => 12.92 * c,
        false => 1.055 * c.powf(1.0 / 2.4) - 0.055,
    }
}

/// The twin of `dither` in shaders/common/displayed.wgsl, for the middle of a pixel.
fn dither(x: f32, y: f32) -> f32 {
    let fract = |value: f32| value - value.floor();
    (fract(52.982_92 * fract(x * 0.067_110_56 + y * 0.005_837_15)) - 0.5) / 255.0
}

/// That of `linear_per_code`.
fn linear_per_code(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    (1.469 * c.sqrt() + 0.806 * c).max(1.0 / 12.92)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINEAR: PictureLook = PictureLook {
        factor: 1.0,
        tone: Tone::Linear,
        bloom: Bloom { strength: 0.0 },
        grade: Grade::NONE,
        frame: 0,
    };

    fn picture(pixels: Vec<[f32; 4]>) -> LightPicture {
        LightPicture {
            size: (pixels.len() as u32, 1),
            pixels,
            look: LINEAR,
            over: None,
        }
    }

    /// An edge across a pixel: the light of the part that is lit, whatever is bright beside it.
    #[test]
    fn pixels_are_the_mean_of_light() {
        let mut gathered = GatheredLight::new((2, 1), 4);
        // 8 × 4: the first three columns lit with light that a screen would cut off.
        let row = [8.0, 8.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0].map(|v: f32| [v, 0.5 * v, 0.0, 1.0]);
        gathered.add(&[row; 4].concat());
        let mean = gathered.picture(LINEAR).pixels;
        assert_eq!(mean, [[6.0, 3.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]]);
        // An instant without light halves it.
        gathered.add(&[[0.0, 0.0, 0.0, 1.0]; 32]);
        assert_eq!(gathered.picture(LINEAR).pixels[0], [3.0, 1.5, 0.0, 1.0]);
    }

    #[test]
    fn the_mean_of_equal_light_is_that_light() {
        let light = [
            [0.1_f32, 1e-7, 12_345.678, 1.0],
            [3.0e-5, 0.7, 1.0 / 3.0, 1.0],
        ];
        for count in [1, 3, 16, 255] {
            let mut gathered = GatheredLight::new((2, 1), 1);
            (0..count).for_each(|_| gathered.add(&light));
            assert_eq!(gathered.picture(LINEAR).pixels, light);
        }
    }

    #[test]
    fn light_is_encoded_as_srgb() {
        let light = [0.0, 0.002, 0.5, 1.0, 7.0].map(|v: f32| [v, v, v, 1.0]);
        let shown = picture(light.to_vec());
        let codes: Vec<_> = shown
            .shown_16(false)
            .as_chunks::<6>()
            .0
            .iter()
            .map(|p| u16::from_be_bytes([p[0], p[1]]))
            .collect();
        // 12.92 · 0.002, and 1.055 · 0.5^(1/2.4) − 0.055 = 0.73536.
        assert_eq!(codes, [0, 1693, 48192, 65535, 65535]);
        let eight = shown.shown_8(false);
        for (x, code) in [(0, 0.0), (1, 6.6), (2, 187.5), (3, 255.0)] {
            let found = f64::from(eight.get_pixel(x, 0)[0]);
            assert!((found - code).abs() <= 1.01, "{x}: {found}");
            assert_eq!(eight.get_pixel(x, 0)[3], 255);
        }
    }

    /// Noise of half a step: the mean over many pixels is the light between two codes.
    #[test]
    fn dithering_keeps_the_mean() {
        let light = LightPicture {
            size: (64, 64),
            pixels: vec![[0.1, 0.1, 0.1, 1.0]; 64 * 64],
            look: LINEAR,
            over: None,
        };
        let shown = light.shown_8(false);
        let mean = shown.pixels().map(|p| f64::from(p[0])).sum::<f64>() / 4096.0;
        assert!((mean - encoded(0.1) * 255.0).abs() < 0.05, "{mean}");
    }

    #[test]
    fn over_black_a_transparent_picture_is_the_opaque_one() {
        let light = [
            [0.5, 0.25, 0.125, 1.0],
            [0.2, 0.1, 0.05, 0.5],
            // Brighter than it hides.
            [0.6, 0.3, 0.0, 0.01],
            [0.0, 0.0, 0.0, 0.0],
        ];
        let shown = picture(light.to_vec());
        for pixel in &light {
            let (opaque, one) = shown.developer().shown(pixel, false);
            let (straight, opacity) = shown.developer().shown(pixel, true);
            assert_eq!(one, 1.0);
            assert!((straight * opacity - opaque).length() < 1e-12);
            assert!(straight.max_element() <= 1.0 && opacity >= f64::from(pixel[3]));
        }
        assert_eq!(shown.developer().shown(&light[3], true), (DVec3::ZERO, 0.0));
        assert_eq!(shown.shown_16(true).len(), 4 * 8);
        assert_eq!(shown.shown_8(true).get_pixel(1, 0)[3], 128);
    }
}
