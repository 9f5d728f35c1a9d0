//! Radiance of an Earth that a graphics adapter draws, as scene-referred light.

use super::PlacedView;
use terrella::internals::gpu::{Attachments, GpuContext, color_texture, read_halves};
use terrella::{Earth, EarthOptions, EyeView, FrameRequest, Sky};
use terrella_imagery::{EarthLayers, ImageryError, LayerImage};
use terrella_play::PlayError;

/// Draws an Earth into a target of half floats.
pub struct LightRenderer {
    gpu: GpuContext,
    earth: Earth,
    picture: wgpu::Texture,
    view: wgpu::TextureView,
    attachments: Attachments,
}

const LABEL: &str = "terrella light";
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Texels in a row of the texture that the middles of pictures are gathered in.
const COLUMNS: u32 = 256;
/// Height of a picture of which the middle is wanted, radians. Narrower ones shake: directions are f32.
const FOV_RAD: f64 = 0.002;

impl LightRenderer {
    /// An Earth with these options except for the target, one sample a pixel. A white sheet that faces the Sun in space is 1.
    ///
    /// # Errors
    /// As [`Earth::new`].
    pub fn new(
        gpu: &GpuContext,
        options: &EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        let options = EarthOptions {
            color_format: FORMAT,
            samples: 1,
            ..options.clone()
        };
        let earth = Earth::new(&gpu.device, &gpu.queue, &options)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let picture = color_texture(&gpu.device, LABEL, size, FORMAT, 1, usage);
        Ok(Self {
            gpu: gpu.clone(),
            earth,
            view: picture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("terrella light"),
                ..Default::default()
            }),
            picture,
            attachments: Attachments::new(&gpu.device, size, FORMAT, 1),
        })
    }

    /// The light of each pixel, row by row: red, green and blue. Waits for the device.
    ///
    /// # Errors
    /// A device that is lost.
    pub fn picture(&mut self, view: &EyeView, sky: &Sky) -> Result<Vec<[f64; 3]>, PlayError> {
        let encoder = self.draw(view, sky);
        self.gpu.queue.submit([encoder.finish()]);
        self.read(&self.picture)
    }

    /// The light along each line of sight: the middle of a small picture. The renderer's pictures should be as small, and odd
    /// in width and height, so that the middle of a pixel is the line. Waits for the device.
    ///
    /// # Errors
    /// A device that is lost.
    pub fn along(&mut self, views: &[PlacedView]) -> Result<Vec<[f64; 3]>, PlayError> {
        let rows = (views.len() as u32).div_ceil(COLUMNS).max(1);
        let usage = wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC;
        let found = color_texture(&self.gpu.device, LABEL, (COLUMNS, rows), FORMAT, 1, usage);
        for (at, view) in (0..).zip(views) {
            let mut encoder = self.draw(&view.eye_view(FOV_RAD), &view.sky());
            let (mut middle, mut to) = (self.picture.as_image_copy(), found.as_image_copy());
            (middle.origin.x, middle.origin.y) =
                (self.picture.width() / 2, self.picture.height() / 2);
            (to.origin.x, to.origin.y) = (at % COLUMNS, at / COLUMNS);
            let texel = wgpu::Extent3d {
                width: 1,
                height: 1,
                depth_or_array_layers: 1,
            };
            encoder.copy_texture_to_texture(middle, to, texel);
            self.gpu.queue.submit([encoder.finish()]);
        }
        let mut light = self.read(&found)?;
        light.truncate(views.len());
        Ok(light)
    }

    fn draw(&mut self, view: &EyeView, sky: &Sky) -> wgpu::CommandEncoder {
        let size = (self.picture.width(), self.picture.height());
        self.earth
            .prepare(&self.gpu.queue, FrameRequest::new(view, sky, size));
        let device = &self.gpu.device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella light"),
        });
        self.earth
            .render(&mut self.attachments.begin_pass(&mut encoder, &self.view));
        encoder
    }

    fn read(&self, texture: &wgpu::Texture) -> Result<Vec<[f64; 3]>, PlayError> {
        let texels = read_halves(&self.gpu.device, &self.gpu.queue, texture, None)?;
        let light = texels
            .iter()
            .map(|[red, green, blue, _]| [*red, *green, *blue].map(f64::from));
        Ok(light.collect())
    }
}

/// Maps of ground of one albedo, which is stored as [`stored_albedo`].
///
/// # Errors
/// None that one texel can have.
pub fn grey_ground(albedo: f64) -> Result<EarthLayers, ImageryError> {
    let value = srgb_byte(albedo);
    Ok(EarthLayers {
        day: LayerImage::from_rgba8(1, 1, vec![value, value, value, 255])?,
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    })
}

/// The albedo that a colour map of eight bits a channel holds in place of this one.
pub fn stored_albedo(albedo: f64) -> f64 {
    let encoded = f64::from(srgb_byte(albedo)) / 255.0;
    match encoded <= 0.04045 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}

/// The nearest byte of the sRGB transfer function (IEC 61966-2-1).
fn srgb_byte(linear: f64) -> u8 {
    let encoded = match linear <= 0.0031308 {
        true => 12.92 * linear,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    };
    (255.0 * encoded.clamp(0.0, 1.0)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn albedos_are_stored_within_a_step() {
        assert_eq!((stored_albedo(0.0), stored_albedo(1.0)), (0.0, 1.0));
        for albedo in [0.01, 0.05, 0.3, 0.8] {
            let stored = stored_albedo(albedo);
            assert!(
                (stored / albedo - 1.0).abs() < 0.3 * f64::powf(albedo, 0.5) + 0.01,
                "{albedo} {stored}"
            );
            assert_eq!(stored_albedo(stored), stored);
        }
    }
}
