//! Captions that stand over pictures made of light: they have display colours, and are drawn apart.

use crate::captions::CaptionLayer;
use crate::egui_pass::EguiTarget;
use crate::error::PlayError;
use crate::flight::{Flight, Moment};
use crate::offscreen::rgba_image;
use glam::DVec3;
use image::RgbaImage;
use terrella::internals::gpu::FrameTargets;
use terrella::{FrameStats, GpuContext};

/// The captions of a scene, over nothing.
pub struct OverLight {
    gpu: GpuContext,
    captions: CaptionLayer,
    targets: FrameTargets,
}

impl OverLight {
    /// For pictures of this size, within the device's limits; `None` where a flight's scene has no captions.
    ///
    /// # Errors
    /// An image that cannot be read.
    pub fn of(
        flight: &Flight,
        gpu: &GpuContext,
        size: (u32, u32),
    ) -> Result<Option<Self>, PlayError> {
        let captions = CaptionLayer::of(flight, gpu, FrameTargets::COLOR)?;
        Ok(captions.map(|captions| {
            let mut targets = FrameTargets::new(&gpu.device, size, 1);
            targets.make_space_transparent();
            Self {
                gpu: gpu.clone(),
                captions,
                targets,
            }
        }))
    }

    /// Draws them for an instant: sRGB, premultiplied.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw(&mut self, moment: &Moment, stats: &FrameStats) -> Result<RgbaImage, PlayError> {
        self.captions.prepare(moment, stats);
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella captions"),
        });
        drop(self.targets.begin_pass(&mut encoder));
        self.captions.draw(EguiTarget {
            device,
            queue,
            encoder: &mut encoder,
            view: self.targets.picture_view(),
            size: self.targets.size(),
        });
        queue.submit([encoder.finish()]);
        let read = self.targets.read_back(device, queue);
        let (width, height) = self.targets.size();
        Ok(rgba_image(width, height, self.gpu.checked(read)?)?)
    }
}

/// Linear display light of a pixel, by its number, with what stands over it, and the part that nothing stands over.
pub fn covered(over: Option<&RgbaImage>, pixel: usize, shown: DVec3) -> (DVec3, f32) {
    let texel = over.and_then(|over| over.as_raw().as_chunks::<4>().0.get(pixel));
    match texel {
        None | Some([_, _, _, 0]) => (shown, 1.0),
        Some(texel) => {
            let [red, green, blue, alpha] = texel.map(|code| f64::from(code) / 255.0);
            let over = DVec3::from_array([red, green, blue].map(linear));
            (over + (1.0 - alpha) * shown, (1.0 - alpha) as f32)
        }
    }
}

/// Linear light of sRGB's code, 0…1 (IEC 61966-2-1).
fn linear(code: f64) -> f64 {
    match code <= 0.040_45 {
        true => code / 12.92,
        false => ((code + 0.055) / 1.055).powf(2.4),
    }
}
