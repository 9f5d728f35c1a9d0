//! Tracks, names and captions over images made of light: they have display colours, and are drawn separately.

use crate::captions::CaptionLayer;
use crate::egui_pass::EguiTarget;
use crate::error::PlayError;
use crate::flight::{Flight, Moment};
use crate::offscreen::{OffscreenRenderer, rgba_image};
use crate::tracks::{TrackDetail, TracksLayer};
use glam::DVec3;
use image::RgbaImage;
use terrella::internals::gpu::{FrameTargets, PassPart};
use terrella::{FrameStats, GpuContext, Tone};

/// The tracks and captions of a scene, over nothing.
pub struct OverLight {
    gpu: GpuContext,
    tracks: Option<TracksLayer>,
    captions: Option<CaptionLayer>,
    targets: FrameTargets,
    /// Where the ground and craft that hide tracks are drawn once more, for their depth.
    hiding: Option<FrameTargets>,
}

impl OverLight {
    /// For pictures of this size and curve, within the device's limits, of what `light` draws; `None` where a flight's scene has neither tracks
    /// nor captions.
    ///
    /// # Errors
    /// An image that cannot be read, a track style out of range.
    pub fn of(
        flight: &Flight,
        light: &OffscreenRenderer,
        size: (u32, u32),
        tone: Tone,
    ) -> Result<Option<Self>, PlayError> {
        let (gpu, format) = (light.gpu(), light.earth().format());
        let captions = CaptionLayer::of(flight, gpu, FrameTargets::COLOR)?;
        let tracks =
            TracksLayer::over_light(flight, gpu, light.earth(), FrameTargets::COLOR, tone)?;
        if tracks.is_none() && captions.is_none() {
            return Ok(None);
        }
        let mut targets = FrameTargets::new(&gpu.device, size, 1);
        targets.make_space_transparent();
        let hiding = tracks
            .is_some()
            .then(|| FrameTargets::with_color(&gpu.device, format.color, size, format.samples));
        Ok(Some(Self {
            gpu: gpu.clone(),
            tracks,
            captions,
            targets,
            hiding,
        }))
    }

    /// Draws them for the instant that `light` has drawn last: sRGB, premultiplied.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw(
        &mut self,
        moment: &Moment,
        stats: &FrameStats,
        light: &OffscreenRenderer,
    ) -> Result<RgbaImage, PlayError> {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let size = self.targets.size();
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella over light"),
        });
        match (&mut self.tracks, &self.hiding) {
            (Some(tracks), Some(hiding)) => {
                tracks.prepare(
                    &self.gpu,
                    moment,
                    size,
                    TrackDetail::Complete,
                    &mut stats.clone(),
                );
                let part = PassPart {
                    is_first: true,
                    is_last: false,
                };
                light.render_surface(&mut hiding.begin_part(&mut encoder, part, None));
                tracks.render(&mut self.targets.begin_pass_behind(&mut encoder, hiding));
                let view = self.targets.picture_view();
                tracks.write_names(&self.gpu, &mut encoder, view, size, size);
            }
            _ => drop(self.targets.begin_pass(&mut encoder)),
        }
        if let Some(captions) = &mut self.captions {
            captions.prepare(moment, stats);
            captions.draw(EguiTarget {
                device,
                queue,
                encoder: &mut encoder,
                view: self.targets.picture_view(),
                size,
            });
        }
        queue.submit([encoder.finish()]);
        let read = self.targets.read_back(device, queue);
        let (width, height) = size;
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
