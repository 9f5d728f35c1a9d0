//! Draws the layout of egui over a finished image.

use egui_wgpu::{Renderer, ScreenDescriptor as Screen};

/// The picture that egui draws over, and how commands are recorded.
pub struct EguiTarget<'c> {
    /// The device of all other fields.
    pub device: &'c wgpu::Device,
    pub queue: &'c wgpu::Queue,
    /// Encoder of the pass.
    pub encoder: &'c mut wgpu::CommandEncoder,
    /// The picture.
    pub view: &'c wgpu::TextureView,
    /// Width and height, pixels.
    pub size: (u32, u32),
}

/// Draws egui's output. Answers the commands that must be submitted before the encoder's.
pub fn draw(
    renderer: &mut Renderer,
    context: &egui::Context,
    mut output: egui::FullOutput,
    target: EguiTarget<'_>,
) -> Vec<wgpu::CommandBuffer> {
    let EguiTarget {
        device,
        queue,
        encoder,
        view,
        size,
    } = target;
    for (id, deltas) in output.textures_delta.set.drain() {
        for delta in deltas {
            renderer.update_texture(device, queue, id, &delta);
        }
    }
    let pixels_per_point = output.pixels_per_point;
    let triangles = context.tessellate(std::mem::take(&mut output.shapes), pixels_per_point);
    let screen = Screen {
        size_in_pixels: size.into(),
        pixels_per_point,
    };
    let commands = renderer.update_buffers(device, queue, encoder, &triangles, &screen);
    let mut pass = encoder
        .begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella panel"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
        .forget_lifetime();
    renderer.render(&mut pass, &triangles, &screen);
    drop(pass);
    for id in output.textures_delta.free.drain() {
        renderer.free_texture(&id);
    }
    commands
}
