//! The least that a frame could cost: the same samples on the same pixels, and nothing computed.

use terrella::gpu::{FrameTargets, GpuContext};
use terrella::imagery::{LayerImage, TexelFormat};
use terrella::{EarthOptions, EyeView};

pub struct Floor {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
}

/// Four maps sampled trilinearly at about one texel a pixel, the sunlight table and the scattering table, on every
/// pixel whose ray meets the sphere of the ground; nothing elsewhere.
const SHADER: &str = "
struct View { ray: vec4f, right: vec4f, down: vec4f, eye: vec4f }
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var maps: sampler;
@group(0) @binding(2) var day: texture_2d<f32>;
@group(0) @binding(3) var clouds: texture_2d<f32>;
@group(0) @binding(4) var slopes: texture_2d<f32>;
@group(0) @binding(5) var lights: texture_2d<f32>;
@group(0) @binding(6) var sunlight: texture_2d<f32>;
@group(0) @binding(7) var scattering: texture_3d<f32>;
@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}
@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let ray = normalize(view.ray.xyz + at.x * view.right.xyz + at.y * view.down.xyz);
    let miss = cross(view.eye.xyz, ray);
    if dot(miss, miss) > 1.0 { discard; }
    let uv = at.xy / vec2f(4096.0, 2048.0);
    let step = vec2f(1.0 / 4096.0, 0.0);
    let step_down = vec2f(0.0, 1.0 / 2048.0);
    var c = textureSampleGrad(day, maps, uv, step, step_down);
    c += textureSampleGrad(clouds, maps, uv, step, step_down);
    c += textureSampleGrad(slopes, maps, uv, step, step_down);
    c += textureSampleGrad(lights, maps, uv, step, step_down);
    c += textureSampleLevel(sunlight, maps, uv, 0.0);
    c += textureSampleLevel(scattering, maps, vec3f(uv, 0.5), 0.0);
    return c * 0.2;
}";

impl Floor {
    pub fn new(gpu: &GpuContext, options: &EarthOptions, view: &EyeView, size: (u32, u32)) -> Self {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("terrella floor"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("terrella floor"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: FrameTargets::DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: options.samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(FrameTargets::COLOR.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let layers = &options.layers;
        let maps = [
            Some(&layers.day),
            layers.clouds.as_ref(),
            layers.normals.as_ref(),
            layers.night_lights.as_ref(),
        ]
        .map(|image| upload(device, queue, image.expect("all layers")));
        let table = |size: terrella::air::TableSize, dimension| {
            device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some("terrella floor table"),
                    size: wgpu::Extent3d {
                        width: size.x,
                        height: size.y,
                        depth_or_array_layers: size.z,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension,
                    format: wgpu::TextureFormat::Rgba16Float,
                    usage: wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                })
                .create_view(&Default::default())
        };
        let sunlight = table(terrella::air::SUNLIGHT, wgpu::TextureDimension::D2);
        let scattering = table(terrella::air::SCATTERING, wgpu::TextureDimension::D3);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("terrella floor"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: if gpu.is_software() {
                1
            } else {
                options.anisotropy
            },
            ..Default::default()
        });
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella floor"),
            size: 64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        queue.write_buffer(&uniforms, 0, bytemuck::cast_slice(&rays(view, size)));
        let mut entries = vec![
            wgpu::BindGroupEntry {
                binding: 0,
                resource: uniforms.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&sampler),
            },
        ];
        for (binding, texture) in (2..).zip(maps.iter().chain([&sunlight, &scattering])) {
            entries.push(wgpu::BindGroupEntry {
                binding,
                resource: wgpu::BindingResource::TextureView(texture),
            });
        }
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrella floor"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self {
            pipeline,
            bind_group,
        }
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// The pixels' rays and the eye on the unit sphere, four vectors of four.
fn rays(view: &EyeView, size: (u32, u32)) -> [f32; 16] {
    let back = view.view_from_world.inverse();
    let p = &view.clip_from_view;
    let right = back * glam::DVec3::X * (2.0 / (p.x_axis.x * f64::from(size.0)));
    let down = back * glam::DVec3::Y * (-2.0 / (p.y_axis.y * f64::from(size.1)));
    let corner = back * glam::DVec3::new(-1.0 / p.x_axis.x, 1.0 / p.y_axis.y, -1.0);
    let eye = view.eye_world / 6.37e6;
    let mut out = [0.0; 16];
    for (four, v) in out.chunks_exact_mut(4).zip([corner, right, down, eye]) {
        four[..3].copy_from_slice(&v.as_vec3().to_array());
    }
    out
}

fn upload(device: &wgpu::Device, queue: &wgpu::Queue, image: &LayerImage) -> wgpu::TextureView {
    let format = match image.format {
        TexelFormat::Rgba8Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
        TexelFormat::R8Unorm => wgpu::TextureFormat::R8Unorm,
        TexelFormat::Rg8Snorm => wgpu::TextureFormat::Rg8Snorm,
    };
    use wgpu::util::DeviceExt;
    device
        .create_texture_with_data(
            queue,
            &wgpu::TextureDescriptor {
                label: Some("terrella floor map"),
                size: wgpu::Extent3d {
                    width: image.width,
                    height: image.height,
                    depth_or_array_layers: 1,
                },
                mip_level_count: image.levels.len() as u32,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
            wgpu::util::TextureDataOrder::LayerMajor,
            &image.levels.concat(),
        )
        .create_view(&Default::default())
}
