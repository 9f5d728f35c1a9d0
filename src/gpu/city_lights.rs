//! City lights as points on the GPU: `shaders/earth/city_lights.wgsl` draws them.

use std::ops::Range;
use terrella_imagery::{CityLight, CityLights};

const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Unorm8x4];

/// All points of all finenesses, in one buffer.
pub(super) struct CityPoints(wgpu::Buffer);

impl CityPoints {
    /// A point an instance.
    pub const BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 1] =
        [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<CityLight>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &ATTRIBUTES,
        })];

    /// Four corners each.
    pub const PRIMITIVE: wgpu::PrimitiveState = wgpu::PrimitiveState {
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        strip_index_format: None,
        front_face: wgpu::FrontFace::Ccw,
        cull_mode: None,
        unclipped_depth: false,
        polygon_mode: wgpu::PolygonMode::Fill,
        conservative: false,
    };

    pub fn upload(device: &wgpu::Device, lights: &CityLights) -> Self {
        let usage = wgpu::BufferUsages::VERTEX;
        let bytes = bytemuck::cast_slice(lights.points());
        let label = "terrella city lights";
        Self(super::filled_buffer(device, label, bytes, usage))
    }

    /// Draws these with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, ranges: &[Range<u32>]) {
        pass.set_vertex_buffer(0, self.0.slice(..));
        for range in ranges {
            pass.draw(0..4, range.clone());
        }
    }
}
