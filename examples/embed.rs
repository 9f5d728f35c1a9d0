//! The Earth in somebody else's program: its own device, pass, depth buffer, unit (kilometres) and axes, and a
//! spacecraft of its own that spins in front of the Earth.
//!
//! `cargo run --release --example embed` writes `out/embed.png`; `-- 48` writes as many frames of a turn.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, Mat4, Vec3};
use std::error::Error;
use std::path::Path;
use terrella::frames::{Ellipsoid, Epoch, Geodetic};
use terrella::{
    DepthBuffer, Earth, EarthOptions, Exposure, EyeView, FrameRequest, LayerSelection, Sky, Tone,
    exposure_factor, find_textures, load_layers,
};

const SIZE: (u32, u32) = (960, 540);
/// The host's formats: linear HDR colour, four samples and an ordinary depth buffer, nearer is smaller.
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const SAMPLES: u32 = 4;
/// The host's planes, kilometres.
const NEAR_KM: f64 = 0.001;
const FAR_KM: f64 = 20_000.0;

fn main() -> Result<(), Box<dyn Error>> {
    let frames: u32 = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    draw(frames, Path::new("out"))
}

/// Writes `frames` pictures of a turn into a folder, which is made.
pub fn draw(frames: u32, folder: &Path) -> Result<(), Box<dyn Error>> {
    let (device, queue) = pollster::block_on(open_device())?;
    let host = Host::new(&device);

    // The ten lines that a host needs.
    let layers = load_layers(&find_textures()?, LayerSelection::default())?;
    let mut earth = Earth::new(
        &device,
        &queue,
        &EarthOptions {
            color_format: COLOR,
            samples: SAMPLES,
            depth: DepthBuffer::StandardZ(DEPTH),
            ..EarthOptions::new(layers)
        },
    )?;
    let sky = Sky::at(Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0));

    std::fs::create_dir_all(folder)?;
    for frame in 0..frames {
        let scene = Flight::at(frame, frames);
        let stats = earth.prepare(&queue, FrameRequest::new(&scene.view, &sky, SIZE));
        let sun_world = scene.view.itrf_from_world.matrix3.inverse() * sky.sun_itrf;
        host.write(&queue, &scene, sun_world.normalize());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("host"),
        });
        {
            let mut pass = host.begin_pass(&mut encoder);
            // Opaque things first: the Earth's air lies over those behind it and is hidden by those in front.
            host.draw_spacecraft(&mut pass);
            earth.render(&mut pass);
        }
        queue.submit([encoder.finish()]);
        let path = folder.join(match frames {
            1 => "embed.png".into(),
            _ => format!("embed_{frame:03}.png"),
        });
        host.save(&device, &queue, &path)?;
        println!(
            "{}: {} of 128 blocks, {} triangles",
            path.display(),
            stats.blocks_drawn,
            stats.triangles
        );
    }
    Ok(())
}

/// Where everything is in the host's world: kilometres, the spacecraft at the origin, y away from the Earth.
struct Flight {
    view: EyeView,
    world_from_craft: DMat4,
}

impl Flight {
    fn at(frame: u32, frames: u32) -> Self {
        let turn = std::f64::consts::TAU * f64::from(frame) / f64::from(frames.max(2));
        // The spacecraft's place on the Earth, and the host's axes there: x east, y up, z south.
        let place = Geodetic::from_degrees(28.0, 30.0, 420_000.0);
        let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
        let itrf_from_world = DAffine3::from_mat3_translation(
            DMat3::from_cols(east, up, east.cross(up)) * 1000.0,
            Ellipsoid::WGS84.itrf_from_geodetic(place),
        );
        let eye_world = DVec3::new(0.022, 0.012, 0.03);
        let forward = (DVec3::new(-0.006, -0.002, 0.0) - eye_world).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let world_from_view = DMat3::from_cols(right, right.cross(forward), -forward);
        let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
        let view = EyeView {
            eye_world,
            view_from_world: DQuat::from_mat3(&world_from_view).inverse(),
            clip_from_view: glam::dcamera::rh::proj::directx::perspective(
                0.8, aspect, NEAR_KM, FAR_KM,
            ),
            itrf_from_world,
        };
        let spin = DQuat::from_rotation_y(turn + 0.6) * DQuat::from_rotation_x(0.4);
        Self {
            view,
            world_from_craft: DMat4::from_quat(spin),
        }
    }
}

async fn open_device() -> Result<(wgpu::Device, wgpu::Queue), Box<dyn Error>> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = instance
        .request_adapter(&wgpu::RequestAdapterOptions::default())
        .await?;
    Ok(adapter
        .request_device(&wgpu::DeviceDescriptor::default())
        .await?)
}

/// The host's own drawing: a body with two solar panels.
struct Host {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    uniforms: wgpu::Buffer,
    color: wgpu::Texture,
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    boxes: u32,
}

const CRAFT_SHADER: &str = "
struct Craft { clip_from_craft: mat4x4f, craft_from_sun: vec3f }
@group(0) @binding(0) var<uniform> craft: Craft;
struct Out { @builtin(position) clip: vec4f, @location(0) normal: vec3f, @location(1) color: vec3f }
// Centre, half size and colour of each box, kilometres.
const CENTER = array<vec3f, 3>(vec3f(0.0), vec3f(-0.0085, 0.0, 0.0), vec3f(0.0085, 0.0, 0.0));
const HALF = array<vec3f, 3>(vec3f(0.002, 0.002, 0.003), vec3f(0.006, 0.0001, 0.0025), vec3f(0.006, 0.0001, 0.0025));
const COLOR = array<vec3f, 3>(vec3f(0.75, 0.7, 0.6), vec3f(0.05, 0.09, 0.3), vec3f(0.05, 0.09, 0.3));
@vertex fn vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) part: u32) -> Out {
    // Six faces of two triangles: the face's axis, its side, and the corner on it.
    let face = i / 6u;
    let axis = face / 2u;
    let side = f32(face % 2u) * 2.0 - 1.0;
    var corners = array<vec2f, 6>(vec2f(-1, -1), vec2f(1, -1), vec2f(1, 1), vec2f(-1, -1), vec2f(1, 1), vec2f(-1, 1));
    let corner = corners[i % 6u];
    var p = vec3f(0.0);
    var n = vec3f(0.0);
    p[axis] = side;
    n[axis] = side;
    p[(axis + 1u) % 3u] = corner.x;
    p[(axis + 2u) % 3u] = corner.y;
    var center = CENTER;
    var half_ = HALF;
    var color = COLOR;
    return Out(craft.clip_from_craft * vec4f(center[part] + p * half_[part], 1.0), n, color[part]);
}
@fragment fn fragment(in: Out) -> @location(0) vec4f {
    return vec4f(in.color * (0.06 + 1.2 * max(dot(in.normal, craft.craft_from_sun), 0.0)), 1.0);
}";

impl Host {
    fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("host spacecraft"),
            source: wgpu::ShaderSource::Wgsl(CRAFT_SHADER.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("host spacecraft"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: SAMPLES,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(COLOR.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("host spacecraft"),
            size: 80,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("host spacecraft"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: uniforms.as_entire_binding(),
            }],
        });
        let texture = |format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("host target"),
                size: wgpu::Extent3d {
                    width: SIZE.0,
                    height: SIZE.1,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let target = wgpu::TextureUsages::RENDER_ATTACHMENT;
        Self {
            pipeline,
            bind_group,
            uniforms,
            color: texture(COLOR, 1, target | wgpu::TextureUsages::COPY_SRC),
            samples: texture(COLOR, SAMPLES, target).create_view(&Default::default()),
            depth: texture(DEPTH, SAMPLES, target).create_view(&Default::default()),
            boxes: 3,
        }
    }

    fn write(&self, queue: &wgpu::Queue, flight: &Flight, sun_world: DVec3) {
        let view = &flight.view;
        let view_from_world =
            DMat4::from_quat(view.view_from_world) * DMat4::from_translation(-view.eye_world);
        let clip: Mat4 =
            (view.clip_from_view * view_from_world * flight.world_from_craft).as_mat4();
        let sun: Vec3 = flight
            .world_from_craft
            .inverse()
            .transform_vector3(sun_world)
            .as_vec3();
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&clip));
        queue.write_buffer(&self.uniforms, 64, bytemuck::bytes_of(&sun));
    }

    fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let resolved = self.color.create_view(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host pass"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: Some(&resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    fn draw_spacecraft(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..36, 0..self.boxes);
    }

    /// Reads the light back, which a float target gets, and writes what is shown of it, as sRGB.
    fn save(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        path: &Path,
    ) -> Result<(), Box<dyn Error>> {
        let row = 8 * SIZE.0;
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("host read back"),
            size: u64::from(row * SIZE.1),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.color.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            self.color.size(),
        );
        queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        device.poll(wgpu::PollType::wait_indefinitely())?;
        let mapped = buffer.get_mapped_range(..)?;
        let halves: &[u16] = bytemuck::cast_slice(&mapped);
        let picture = image::RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| {
            let at = 4 * (y * SIZE.0 + x) as usize;
            let light = [0, 1, 2].map(|k| f64::from(half_to_f32(halves[at + k])));
            // The host's own exposure and tone curve; any other will do.
            let exposed = DVec3::from_array(light) * exposure_factor(Exposure::DEFAULT_EV);
            let shown = Tone::default().shown(exposed);
            image::Rgb(shown.to_array().map(|light| encode_srgb(light as f32)))
        });
        picture.save(path)?;
        Ok(())
    }
}

fn half_to_f32(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023));
    if exponent == 0 {
        fraction * 2_f32.powi(-24)
    } else {
        (1.0 + fraction / 1024.0) * 2_f32.powi(exponent - 15)
    }
}

fn encode_srgb(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0 + 0.5) as u8
}
