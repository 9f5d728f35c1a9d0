//! City lights as points on the GPU: `shaders/earth/city_lights.wgsl` draws them.

use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use terrella_imagery::{CityLight, CityLights};

/// `CityLight` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct CityLightPoint {
    up: [f32; 3],
    light: f32,
    /// Linear RGB, and the spread of its lamps.
    color: [u8; 4],
}

const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Unorm8x4];

/// All points of all finenesses, in one buffer.
pub(super) struct CityPoints(wgpu::Buffer);

impl CityPoints {
    /// A point an instance.
    pub const BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 1] =
        [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<CityLightPoint>() as u64,
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
        let byte = |part: f32| (255.0 * part).round().clamp(0.0, 255.0) as u8;
        let points = lights.points().iter().map(|point| {
            let [r, g, b] = point.color.map(byte);
            CityLightPoint {
                up: point.up.to_array(),
                light: point.light,
                color: [
                    r,
                    g,
                    b,
                    byte(point.radius_m / CityLight::MOST_RADIUS_M as f32),
                ],
            }
        });
        let points: Vec<_> = points.collect();
        let usage = wgpu::BufferUsages::VERTEX;
        let bytes = bytemuck::cast_slice(&points);
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
