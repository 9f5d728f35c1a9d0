//! The drawable of the air: one square that faces the eye.

use super::shader::ShaderModule;
use super::{
    AirDepth, AirPlan, AirUniforms, AirVariant, DepthBuffer, GpuLayer, PassFormat,
    PipelineDescription, ShaderError,
};
use crate::air::{self, AirTables, EARTH_AIR};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec4};

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct AirVertex {
    clip: [f32; 4],
    ray: [f32; 3],
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x3];

pub(crate) struct AirDrawable {
    outside: Variant,
    inside: Variant,
    frame: wgpu::Buffer,
    vertices: wgpu::Buffer,
    eye_is_inside: bool,
    depth_rounding: f32,
    /// What the surface reads of it.
    pub sunlight: GpuLayer,
    pub texture_bytes: u64,
    /// Of both variants.
    pub shader_bytes: u64,
}

struct Variant {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    shader_bytes: u64,
}

impl AirDrawable {
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: PassFormat,
    ) -> Result<Self, ShaderError> {
        let tables = AirTables::earth();
        let upload = |label, size, texels: &[Vec4]| {
            GpuLayer::upload_table(device, queue, label, size, texels)
        };
        let scattering = upload("terrella scattering", air::SCATTERING, &tables.scattering);
        let transmittance = upload(
            "terrella transmittance",
            air::TRANSMITTANCE,
            &tables.transmittance,
        );
        let multiple = upload(
            "terrella multiple scattering",
            air::MULTIPLE,
            &tables.multiple,
        );
        let sunlight = upload("terrella sunlight", air::SUNLIGHT, &tables.sunlight);
        let texture_bytes =
            scattering.bytes + transmittance.bytes + multiple.bytes + sunlight.bytes;
        // OpenGL's clip space is −1…1: the vertex stage's depths, but not those that a fragment writes, are shifted to it
        // and back, and lose all below 2⁻²³. Twice that keeps the ground from coming before the air on it.
        let shifts_depth = device.adapter_info().backend == wgpu::Backend::Gl;
        let depth_rounding = if shifts_depth { 2.4e-7 } else { 0.0 };
        let frame = super::uniform_buffer::<AirUniforms>(device, "terrella air frame");
        let vertices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella air square"),
            size: 4 * size_of::<AirVertex>() as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let d3 = wgpu::TextureViewDimension::D3;
        let d2 = wgpu::TextureViewDimension::D2;
        let variant = |inside: bool, textures: &[(u32, wgpu::TextureViewDimension, &GpuLayer)]| {
            Variant::new(device, format, &frame, inside, textures)
        };
        let outside = variant(false, &[(2, d3, &scattering)])?;
        let inside = variant(true, &[(3, d2, &transmittance), (4, d2, &multiple)])?;
        Ok(Self {
            shader_bytes: outside.shader_bytes + inside.shader_bytes,
            outside,
            inside,
            frame,
            vertices,
            eye_is_inside: false,
            depth_rounding,
            sunlight,
            texture_bytes,
        })
    }

    /// Writes this frame's square. Returns the bytes written.
    pub fn write(&mut self, queue: &wgpu::Queue, plan: &AirPlan) -> u64 {
        let AirPlan {
            square,
            sun_scaled,
            exposure,
        } = plan;
        let air_top = EARTH_AIR.top();
        self.eye_is_inside = square.eye_distance < air_top;
        let sun = DVec3::from_array(square.axes.map(|axis| axis.dot(*sun_scaled)))
            .normalize_or(DVec3::NEG_Z);
        let frame = AirUniforms {
            clip_from_billboard: square.clip_from_billboard.as_mat4(),
            sun: sun.as_vec3(),
            eye_distance: square.eye_distance as f32,
            top: air_top as f32,
            eye_height: (square.eye_distance - 1.0) as f32,
            exposure: *exposure,
            depth_rounding: self.depth_rounding,
        };
        let mut corners = [AirVertex::default(); 4];
        for (corner, (clip, ray)) in corners.iter_mut().zip(square.clip.iter().zip(&square.ray)) {
            *corner = AirVertex {
                clip: clip.as_vec4().to_array(),
                ray: ray.as_vec3().to_array(),
            };
        }
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        queue.write_buffer(&self.vertices, 0, bytemuck::bytes_of(&corners));
        (size_of::<AirUniforms>() + size_of_val(&corners)) as u64
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        let variant = if self.eye_is_inside {
            &self.inside
        } else {
            &self.outside
        };
        pass.set_pipeline(&variant.pipeline);
        pass.set_bind_group(0, &variant.bind_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.draw(0..4, 0..1);
    }
}

impl Variant {
    fn new(
        device: &wgpu::Device,
        format: PassFormat,
        frame: &wgpu::Buffer,
        inside: bool,
        textures: &[(u32, wgpu::TextureViewDimension, &GpuLayer)],
    ) -> Result<Self, ShaderError> {
        let variant = AirVariant {
            is_inside: inside,
            depth: match format.depth {
                DepthBuffer::None => AirDepth::None,
                DepthBuffer::ReversedZ(_) => AirDepth::ReversedZ,
                DepthBuffer::StandardZ(_) => AirDepth::StandardZ,
            },
            target: format.target_color(),
        };
        let shader = ShaderModule::new(device, &variant)?;
        let sampler = super::surface::table_sampler(device);
        let mut layout = vec![
            super::uniform_entry(0, wgpu::ShaderStages::FRAGMENT, size_of::<AirUniforms>()),
            super::sampler_entry(1),
        ];
        let mut entries = vec![
            wgpu::BindGroupEntry {
                binding: 0,
                resource: frame.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&sampler),
            },
        ];
        for (binding, dimension, layer) in textures {
            layout.push(super::texture_entry(*binding, *dimension));
            entries.push(wgpu::BindGroupEntry {
                binding: *binding,
                resource: wgpu::BindingResource::TextureView(&layer.view),
            });
        }
        let label = if inside {
            "terrella air inside"
        } else {
            "terrella air outside"
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &layout,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &layout,
            entries: &entries,
        });
        let pipeline = PipelineDescription {
            label,
            bind_groups: Some(&[Some(&layout)]),
            module: &shader.module,
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<AirVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &VERTEX_ATTRIBUTES,
            })],
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..Default::default()
            },
            format,
            writes_depth: false,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        }
        .create(device);
        Ok(Self {
            pipeline,
            bind_group,
            shader_bytes: shader.bytes,
        })
    }
}
