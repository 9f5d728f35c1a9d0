//! The least that a frame could cost: the same samples on the same pixels, and nothing computed.

use crate::gpu::{FrameTargets, GpuContext, GpuLayer, PassFormat, PipelineDescription};
use crate::imagery::NEIGHBOURHOODS;
use crate::imagery::tile::MapLayer;
use crate::{Atmosphere, EarthOptions, EyeView, Shading, air};
use glam::DVec2;
use std::f64::consts::TAU;
use std::fmt::Write;

/// A pass over the part of the screen where the ground can be, which takes as many texture samples on each pixel of the
/// ground as the Earth's shaders do, from textures of the same sizes and formats. It counts one sample for each map, one more
/// of the clouds where they throw shadows, two of the sunlight table, one more of it for clouds, and one of each other table of the air, of those that the
/// Earth is drawn with.
///
/// Maps are read trilinearly at about one texel a pixel. Tiles are not: an Earth of a pack has the floor of its coarsest
/// whole maps.
pub struct Floor {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    view: wgpu::Buffer,
    /// Part of the target that can show ground: x, y, width, height.
    part: [u32; 4],
}

/// Bytes of the shader's `View`: four vectors of four.
const VIEW_BYTES: u64 = 64;
/// The first binding of a texture.
const FIRST_TEXTURE: u32 = 2;

impl Floor {
    /// Makes the pass for an Earth with these options, `samples` a pixel being those of the targets.
    pub fn new(gpu: &GpuContext, options: &EarthOptions) -> Self {
        let device = &gpu.device;
        let textures = Textures::of(gpu, options);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("terrella floor"),
            source: wgpu::ShaderSource::Wgsl(textures.shader().into()),
        });
        let pipeline = PipelineDescription {
            label: "terrella floor",
            bind_groups: None,
            module: &module,
            buffers: &[],
            primitive: Default::default(),
            format: PassFormat {
                color: FrameTargets::COLOR,
                further: &[],
                samples: options.samples,
                depth: FrameTargets::REVERSED_DEPTH,
                tone: Default::default(),
            },
            writes_depth: true,
            blend: None,
        }
        .create(device);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("terrella floor"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: match gpu.is_software() {
                true => 1,
                false => options.anisotropy,
            },
            ..Default::default()
        });
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella floor"),
            size: VIEW_BYTES,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut entries = vec![
            wgpu::BindGroupEntry {
                binding: 0,
                resource: view.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&sampler),
            },
        ];
        for (binding, texture) in (FIRST_TEXTURE..).zip(&textures.views) {
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
            view,
            part: [0; 4],
        }
    }

    /// Writes where the eye is. The ground is a sphere for it.
    pub fn prepare(&mut self, queue: &wgpu::Queue, view: &EyeView, size: (u32, u32)) {
        self.part = ground_part(view, size);
        queue.write_buffer(&self.view, 0, bytemuck::cast_slice(&rays(view, size)));
    }

    /// Draws the floor into a pass.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        let [x, y, width, height] = self.part;
        if width == 0 || height == 0 {
            return;
        }
        pass.set_scissor_rect(x, y, width, height);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Textures that the floor samples.
struct Textures {
    views: Vec<wgpu::TextureView>,
    /// How many of them are maps; tables follow.
    maps: usize,
    /// How often each is sampled.
    samples: Vec<u32>,
    /// How many tables have three dimensions: the last ones.
    volumes: usize,
}

impl Textures {
    fn of(gpu: &GpuContext, options: &EarthOptions) -> Self {
        let (mut views, mut samples) = (Vec::new(), Vec::new());
        for layer in MapLayer::ALL {
            let Some(image) = options.layers.get(layer) else {
                continue;
            };
            let label = "terrella floor map";
            views.push(GpuLayer::upload(&gpu.device, &gpu.queue, label, image, false).view);
            let has_shadow = layer == MapLayer::Clouds
                && options.light.cloud_shadows
                && options.shading == Shading::Sunlit;
            samples.push(if has_shadow { 2 } else { 1 });
        }
        let maps = views.len();
        let has_air = options.atmosphere != Atmosphere::None;
        let two = wgpu::TextureDimension::D2;
        if has_air && options.shading == Shading::Sunlit {
            views.push(table(gpu, air::SUNLIGHT_AND_CLOUDS, two));
            samples.push(2 + u32::from(options.layers.clouds.is_some()));
        }
        if has_air {
            let albedo = air::TableSize {
                x: NEIGHBOURHOODS + 2,
                y: NEIGHBOURHOODS / 2,
                z: 1,
            };
            let flat = [albedo, air::THROUGH, air::BOUNCE];
            views.extend(flat.map(|size| table(gpu, size, two)));
            views.push(table(gpu, air::SCATTERING, wgpu::TextureDimension::D3));
            samples.extend([1; 4]);
        }
        Self {
            views,
            maps,
            samples,
            volumes: if has_air { 1 } else { 0 },
        }
    }

    fn shader(&self) -> String {
        let mut text = HEAD.to_owned();
        let mut samples = String::new();
        for n in 0..self.views.len() {
            let is_volume = n + self.volumes >= self.views.len();
            let kind = if is_volume { "3d" } else { "2d" };
            let binding = n + FIRST_TEXTURE as usize;
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "@group(0) @binding({binding}) var t{n}: texture_{kind}<f32>;"
            );
            let _ = match (n < self.maps, is_volume) {
                (true, _) => (0..self.samples[n]).try_for_each(|shift| {
                    writeln!(
                        samples,
                        "    c += textureSampleGrad(t{n}, maps, uv + 0.01 * {shift}.0, dx, dy);"
                    )
                }),
                (_, true) => writeln!(
                    samples,
                    "    c += textureSampleLevel(t{n}, maps, vec3f(uv, 0.5), 0.0);"
                ),
                (_, false) => (1..=self.samples[n]).try_for_each(|sample| {
                    let shift = 0.1 * f64::from(sample);
                    writeln!(
                        samples,
                        "    c += textureSampleLevel(t{n}, maps, uv + {shift:?}, 0.0);"
                    )
                }),
            };
        }
        text + BODY.0 + &samples + BODY.1
    }
}

const HEAD: &str = "struct View { ray: vec4f, right: vec4f, down: vec4f, eye: vec4f }
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var maps: sampler;
";
const BODY: (&str, &str) = (
    "@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}
@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let ray = normalize(view.ray.xyz + at.x * view.right.xyz + at.y * view.down.xyz);
    let miss = cross(view.eye.xyz, ray);
    if dot(miss, miss) > 1.0 || dot(view.eye.xyz, ray) > 0.0 { discard; }
    let uv = at.xy / vec2f(4096.0, 2048.0);
    let dx = vec2f(1.0 / 4096.0, 0.0);
    let dy = vec2f(0.0, 1.0 / 2048.0);
    var c = vec4f(0.0);
",
    "    return c * 0.2;
}
",
);

/// The rectangle that the limb of the sphere fills on screen; the whole target where part of the limb is behind the eye or
/// the eye below the ground.
fn ground_part(view: &EyeView, size: (u32, u32)) -> [u32; 4] {
    const PLACES: u32 = 64;
    let (eye_itrf_m, clip_from_eye) = view.to_itrf();
    let whole = [0, 0, size.0, size.1];
    let distance = eye_itrf_m.length() / EARTH_RADIUS_M;
    if distance <= 1.0 {
        return whole;
    }
    let toward = eye_itrf_m.normalize();
    let (a, b) = toward.any_orthonormal_pair();
    let (near, wide) = (1.0 / distance, (1.0 - 1.0 / (distance * distance)).sqrt());
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for n in 0..PLACES {
        let (sin, cos) = (TAU * f64::from(n) / f64::from(PLACES)).sin_cos();
        // A little more than the circle, so that its polygon holds the circle.
        let limb = toward * near + (a * cos + b * sin) * (wide * 1.005);
        let clip = clip_from_eye * (limb * EARTH_RADIUS_M - eye_itrf_m).extend(1.0);
        if clip.w <= 0.0 {
            return whole;
        }
        let at = DVec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        (low, high) = (low.min(at), high.max(at));
    }
    let edge = |part: f64, side: u32| (part * f64::from(side)).clamp(0.0, f64::from(side));
    let (x, y) = (edge(low.x, size.0).floor(), edge(low.y, size.1).floor());
    let (right, bottom) = (edge(high.x, size.0).ceil(), edge(high.y, size.1).ceil());
    [x as u32, y as u32, (right - x) as u32, (bottom - y) as u32]
}

/// The pixels' rays and the eye on the unit sphere, four vectors of four.
fn rays(view: &EyeView, size: (u32, u32)) -> [f32; 16] {
    let rays = view.pixel_rays(size.into());
    let eye = view.itrf_from_world.transform_point3(view.eye_world) / EARTH_RADIUS_M;
    let mut out = [0.0; 16];
    let vectors = [rays.corner, rays.right, rays.down, eye];
    for (four, v) in out.chunks_exact_mut(4).zip(vectors) {
        four[..3].copy_from_slice(&v.as_vec3().to_array());
    }
    out
}

/// Mean radius, metres.
const EARTH_RADIUS_M: f64 = 6.371e6;

fn table(
    gpu: &GpuContext,
    size: air::TableSize,
    dimension: wgpu::TextureDimension,
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
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
    });
    texture.create_view(&Default::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::{Ellipsoid, Geodetic};
    use glam::DVec3;

    #[test]
    fn the_part_holds_the_disc_and_not_much_more() {
        let part = |height_m: f64, forward: DVec3| {
            let eye =
                Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(0.0, 0.0, height_m));
            ground_part(&EyeView::itrf(eye, forward, DVec3::Z, 0.8, 2.0), (400, 200))
        };
        // From 20 000 km the disc is 2 asin(6371/26 378) = 28° of 45.8° high.
        let [x, y, width, height] = part(2e7, -DVec3::X);
        assert!(
            (118..=123).contains(&height) && width.abs_diff(height) <= 1,
            "{width} {height}"
        );
        assert!(x.abs_diff(200 - width / 2) <= 1 && y.abs_diff(100 - height / 2) <= 1);
        // Near the ground, and with the limb behind, it is everything; nothing where the Earth is out of the picture.
        assert_eq!(part(4e5, -DVec3::X), [0, 0, 400, 200]);
        assert_eq!(part(4e5, DVec3::Y), [0, 0, 400, 200]);
        let aside = (DVec3::Y - 0.3 * DVec3::X).normalize();
        assert_eq!(part(4e8, aside)[2], 0);
    }

    #[test]
    fn the_middle_ray_of_a_nadir_view_meets_the_centre() {
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(0.0, 30.0, 1e6));
        let view = EyeView::itrf(eye, -eye.normalize(), DVec3::Z, 0.8, 2.0);
        let four = rays(&view, (200, 100));
        let v = |n: usize| {
            DVec3::new(
                four[4 * n].into(),
                four[4 * n + 1].into(),
                four[4 * n + 2].into(),
            )
        };
        let middle = v(0) + 100.0 * v(1) + 50.0 * v(2);
        assert!(middle.normalize().dot(-v(3).normalize()) > 1.0 - 1e-9);
        // A pixel is square, and the corner's ray is half a field of view above.
        assert!((v(1).length() / v(2).length() - 1.0).abs() < 1e-6);
        assert!(((v(0) + 100.0 * v(1)).angle_between(middle) - 0.4).abs() < 1e-6);
    }
}
