//! Extreme views, each with its expected result: a defined image or a clear error, never a pixel that is not finite.
//!
//! [`cases()`] is the list, [`run()`] draws one case on any device. Images are rendered to half floats, which reveal values that an 8-bit target
//! would clamp.

mod case;
mod cases;

pub use case::{ExtremeCase, Lit, Side};
pub use cases::cases;

use std::time::Duration;
use terrella::internals::gpu::{
    Attachments, FrameTargets, GpuContext, PictureError, color_texture, read_halves, read_texture,
};
use terrella::{Atmosphere, DepthBuffer, Earth, EarthError, EarthOptions, Exposure, FrameRequest};
use terrella_imagery::EarthLayers;

/// A drawn picture in linear light, rows from the top.
pub struct LinearPicture {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// RGBA of each pixel.
    pub pixels: Vec<[f32; 4]>,
}

impl LinearPicture {
    /// Whether any channel of a pixel is visible on black.
    fn is_lit(pixel: &[f32; 4]) -> bool {
        pixel[..3].iter().any(|value| *value > MIN_VISIBLE_LIGHT)
    }

    /// Pixels that can be seen.
    pub fn lit_pixels(&self) -> usize {
        self.pixels.iter().filter(|p| Self::is_lit(p)).count()
    }

    /// Pixels with a channel that is infinite or not a number.
    pub fn nan_pixels(&self) -> usize {
        let is_broken = |pixel: &&[f32; 4]| pixel.iter().any(|value| !value.is_finite());
        self.pixels.iter().filter(is_broken).count()
    }
}

/// Linear light that an sRGB display still distinguishes from black: one step of 255.
const MIN_VISIBLE_LIGHT: f32 = 1.0 / 255.0 / 12.92;

/// Longest wait for one picture.
const MAX_WAIT: Duration = Duration::from_secs(60);

/// Why a case gave no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExtremeError {
    /// The Earth rejected its options.
    #[error(transparent)]
    Earth(#[from] EarthError),
    /// The picture could not be read back.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The device rejected a command.
    #[error("the device cannot draw: {0}")]
    Device(String),
}

/// Result of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseResult {
    pub name: &'static str,
    /// The expected result, as text for the report.
    pub expected: &'static str,
    /// The actual result, as text for the report.
    pub what_was_drawn: String,
    /// Pixels that are not black.
    pub lit_pixels: usize,
    /// Pixels with a channel that is infinite or not a number.
    pub nan_pixels: usize,
    /// The error, where one was answered.
    pub error: Option<String>,
    /// Whether it is the expected one.
    pub passed: bool,
}

/// Draws a case and compares it with its expected result.
pub fn run(case: &ExtremeCase, gpu: &GpuContext, layers: &EarthLayers) -> CaseResult {
    let (picture, error) = match draw(case, gpu, layers) {
        Ok(picture) => (Some(picture), None),
        Err(error) => (None, Some(error.to_string())),
    };
    let (lit, broken, all) = picture.as_ref().map_or((0, 0, 0), |picture| {
        (
            picture.lit_pixels(),
            picture.nan_pixels(),
            picture.pixels.len(),
        )
    });
    let passed = match (&case.lit, &error) {
        (Lit::Rejected(part), Some(error)) => error.contains(part),
        (Lit::Rejected(_), None) | (_, Some(_)) => false,
        (Lit::Nothing, None) => lit == 0 && broken == 0,
        (Lit::Pixels(min, max), None) => (*min..=*max).contains(&lit) && broken == 0,
        (Lit::Share(min, max), None) => {
            let share = lit as f64 / all.max(1) as f64;
            (*min..=*max).contains(&share) && broken == 0
        }
    };
    let what_was_drawn = match (&error, &picture) {
        (Some(error), _) => format!("an error: {error}"),
        (None, Some(picture)) => describe(picture, lit),
        (None, None) => String::new(),
    };
    CaseResult {
        name: case.name,
        expected: case.expected,
        what_was_drawn,
        lit_pixels: lit,
        nan_pixels: broken,
        error,
        passed,
    }
}

/// Content of an image, as text for the report.
fn describe(picture: &LinearPicture, lit: usize) -> String {
    let all = picture.pixels.len();
    let (width, height) = picture.size;
    let size = format!("{width} × {height}");
    if lit == 0 {
        return format!("{size}: black");
    }
    let mut mean = [0.0_f32; 3];
    for pixel in picture.pixels.iter().filter(|p| LinearPicture::is_lit(p)) {
        for (sum, value) in mean.iter_mut().zip(pixel) {
            *sum += value / lit as f32;
        }
    }
    let share = if lit == all {
        "every pixel is lit".to_owned()
    } else {
        format!("{lit} of {all} pixels are lit")
    };
    let [r, g, b] = mean;
    format!("{size}: {share}, on average ({r:.3}, {g:.3}, {b:.3})")
}

/// Draws a case.
///
/// # Errors
/// Errors of the Earth or the device.
pub fn draw(
    case: &ExtremeCase,
    gpu: &GpuContext,
    layers: &EarthLayers,
) -> Result<LinearPicture, ExtremeError> {
    let is_shown = case.exposure != Exposure::default();
    let color = match is_shown {
        true => FrameTargets::COLOR,
        false => wgpu::TextureFormat::Rgba16Float,
    };
    let device = &gpu.device;
    let size = case.size(device.limits().max_texture_dimension_2d);
    let options = EarthOptions {
        color_format: color,
        samples: 1,
        depth: DepthBuffer::ReversedZ(FrameTargets::DEPTH),
        subdivision: case.subdivision,
        exposure: case.exposure,
        atmosphere: if case.has_air {
            Atmosphere::Billboard
        } else {
            Atmosphere::None
        },
        ..EarthOptions::new(layers.clone())
    };
    let mut earth = Earth::new(device, &gpu.queue, &options)?;
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
    let target = color_texture(device, "terrella extreme", size, color, 1, usage);
    let view = target.create_view(&wgpu::TextureViewDescriptor {
        label: Some("terrella extreme"),
        ..Default::default()
    });
    let attachments = Attachments::new(device, size, color, 1);
    earth.prepare(&gpu.queue, FrameRequest::new(&case.view, &case.sky, size));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
        label: Some("terrella extreme"),
    });
    earth.render(&mut attachments.begin_pass(&mut encoder, &view));
    gpu.queue.submit([encoder.finish()]);
    let pixels = match is_shown {
        true => read_codes(gpu, &target),
        false => read_halves(device, &gpu.queue, &target, Some(MAX_WAIT)),
    };
    if let Some(error) = pollster::block_on(scope.pop()) {
        return Err(ExtremeError::Device(error.to_string()));
    }
    Ok(LinearPicture {
        size,
        pixels: pixels?,
    })
}

/// Reads an 8-bit texture (usage `COPY_SRC`) as numbers of 0…1. Waits for the device.
fn read_codes(gpu: &GpuContext, texture: &wgpu::Texture) -> Result<Vec<[f32; 4]>, PictureError> {
    let bytes = read_texture(&gpu.device, &gpu.queue, texture)?;
    let pixels = bytes.as_chunks::<4>().0.iter();
    Ok(pixels
        .map(|pixel| pixel.map(|code| f32::from(code) / 255.0))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lit_and_broken_pixels_are_counted() {
        let picture = LinearPicture {
            size: (4, 1),
            pixels: vec![
                [0.0, 0.0, 0.0, 1.0],
                [0.0, 0.0, 0.1, 1.0],
                [f32::NAN, 0.0, 0.0, 1.0],
                [0.2, f32::INFINITY, 0.0, 1.0],
            ],
        };
        assert_eq!((picture.lit_pixels(), picture.nan_pixels()), (2, 2));
        assert_eq!(describe(&picture, 0), "4 × 1: black");
    }
}
