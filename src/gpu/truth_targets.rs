//! The targets of ground truth, and reading them back.

use super::read_back::{PictureError, read_lines};
use super::shader::{TRUTH_LAND, TRUTH_SUNLIT};
use super::targets::{FrameTargets, color_texture};
use super::{SurfaceOutput, view};
use std::ops::Range;
use terrella_ground::half::float_of_half;

/// Content of a pixel of the targets [`SurfaceOutput::TRUTH`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TruthTexel {
    /// First target, four 32-bit floats. Texture coordinates of the position relative to the centre of its block, u east and v south, 1 being the
    /// whole map; its distance from the eye and its elevation above the ellipsoid, metres. The elevation of the smooth ellipsoid is 0.
    pub place: [f32; 4],
    /// Second target, 32 bits unsigned; 0 if no ground is visible. The low eight bits are the block's index + 1 (row by row from the north-west, 16
    /// to a row, 8 rows). Above them are [`Self::LAND`] and [`Self::SUNLIT`].
    pub marks: u32,
    /// Third target, four 16-bit floats. Slope of the drawn ground to the east and to the north; the land fraction of the pixel, 1 for an Earth
    /// without a map of open water; the cloud cover in front of it, 0 for an Earth without clouds.
    pub ground: [f32; 4],
}

impl TruthTexel {
    /// Flag in [`Self::marks`]: at least half of the pixel is land.
    pub const LAND: u32 = TRUTH_LAND;
    /// Flag in [`Self::marks`]: the centre of the Sun's disc is above the ellipsoid's horizon.
    pub const SUNLIT: u32 = TRUTH_SUNLIT;

    /// Whether ground is visible.
    pub fn is_ground(&self) -> bool {
        self.marks != 0
    }
}

/// Textures for a pass of [`SurfaceOutput::Truth`], with a reversed-Z depth buffer, for programs without their own.
pub struct TruthTargets {
    textures: [wgpu::Texture; 3],
    views: [wgpu::TextureView; 3],
    depth: wgpu::TextureView,
}

impl TruthTargets {
    /// Size of a pixel in all its textures, bytes.
    pub const PIXEL_BYTES: u64 = 32;

    /// Makes the textures. `size` is within the device's limits and not zero.
    pub fn new(device: &wgpu::Device, size: (u32, u32)) -> Self {
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let label = "terrella truth";
        let textures = SurfaceOutput::TRUTH.map(|format| {
            let usage = attachment | wgpu::TextureUsages::COPY_SRC;
            color_texture(device, label, size, format, 1, usage)
        });
        let depth = color_texture(device, label, size, FrameTargets::DEPTH, 1, attachment);
        Self {
            views: textures.each_ref().map(view),
            textures,
            depth: view(&depth),
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.textures[0].width(), self.textures[0].height())
    }

    /// Begins a pass that clears everything to 0: no ground, infinitely far.
    pub fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let attachments = self.views.each_ref().map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella truth"),
            color_attachments: &attachments,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Reads some rows back, from the top down. Waits for the device.
    pub fn read(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        lines: Range<u32>,
    ) -> Result<Vec<TruthTexel>, PictureError> {
        let lines = lines.start.min(self.size().1)..lines.end.min(self.size().1);
        let read = |n: usize, bytes| read_lines(device, queue, &self.textures[n], bytes, &lines);
        let (place, marks, ground) = (read(0, 16)?, read(1, 4)?, read(2, 8)?);
        let places = place.as_chunks::<4>().0.as_chunks::<4>().0.iter();
        let marks = marks.as_chunks::<4>().0.iter();
        let grounds = ground.as_chunks::<2>().0.as_chunks::<4>().0.iter();
        Ok(places
            .zip(marks)
            .zip(grounds)
            .map(|((place, marks), ground)| TruthTexel {
                place: place.map(f32::from_le_bytes),
                marks: u32::from_le_bytes(*marks),
                ground: ground.map(|half| float_of_half(u16::from_le_bytes(half))),
            })
            .collect())
    }
}
