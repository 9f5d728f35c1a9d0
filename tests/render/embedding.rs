//! The Earth in a host's pass: the host's formats, depth, viewport, unit and axes.

use crate::common::{Rig, day_only, down, gpu, map, tilted};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use image::RgbaImage;
use terrella::frames::Geodetic;
use terrella::internals::gpu::{FrameTargets, GpuContext, GpuTimer, PassPart};
use terrella::{
    Atmosphere, DepthBuffer, Earth, EarthOptions, EyeView, FrameRequest, Shading, Sky, Viewport,
};
use terrella_imagery::EarthLayers;

const SIZE: (u32, u32) = (160, 120);

fn layers() -> EarthLayers {
    let day = map(512, |lat, lon| {
        [
            (lat + 90.0) as u8,
            (lon.abs() / 2.0) as u8,
            if (lat + lon).rem_euclid(20.0) < 10.0 {
                200
            } else {
                60
            },
        ]
    });
    day_only(day)
}

fn view() -> EyeView {
    tilted(
        Geodetic::from_degrees(30.0, 40.0, 2e6),
        120.0,
        -55.0,
        60.0,
        f64::from(SIZE.0) / f64::from(SIZE.1),
    )
}

const SUN: DVec3 = DVec3::new(0.5, 0.7, 0.51);

/// A host with its own targets and a full-screen sheet at one depth.
struct Host {
    options: EarthOptions,
    size: (u32, u32),
    color: wgpu::Texture,
}

impl Host {
    fn new(options: EarthOptions, size: (u32, u32)) -> Self {
        let color = texture(options.color_format, size, 1);
        Self {
            options,
            size,
            color,
        }
    }

    /// Draws a red sheet at `sheet` (a depth), then the Earth; reads the bytes back, four a pixel.
    fn draw(&self, view: &EyeView, target: Viewport, sheet: Option<f32>) -> RgbaImage {
        let gpu = gpu();
        let mut earth = Earth::new(&gpu.device, &gpu.queue, &self.options).expect("sound options");
        earth.prepare(
            &gpu.queue,
            FrameRequest::new(view, &Sky::new(SUN.normalize()), target),
        );
        let samples = self.options.samples;
        let multisampled = (samples > 1).then(|| {
            texture(self.options.color_format, self.size, samples).create_view(&Default::default())
        });
        let (depth, clear) = match self.options.depth {
            DepthBuffer::None => (None, 0.0),
            DepthBuffer::ReversedZ(format) => (Some(texture(format, self.size, samples)), 0.0),
            DepthBuffer::StandardZ(format) => (Some(texture(format, self.size, samples)), 1.0),
        };
        let depth = depth.map(|texture| texture.create_view(&Default::default()));
        let resolved = self.color.create_view(&Default::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("host"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: multisampled.as_ref().unwrap_or(&resolved),
                    depth_slice: None,
                    resolve_target: multisampled.as_ref().map(|_| &resolved),
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: depth.as_ref().map(|view| {
                    wgpu::RenderPassDepthStencilAttachment {
                        view,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(clear),
                            store: wgpu::StoreOp::Store,
                        }),
                        stencil_ops: None,
                    }
                }),
                ..Default::default()
            });
            let (x, y) = target.origin;
            pass.set_viewport(x, y, target.size.0 as f32, target.size.1 as f32, 0.0, 1.0);
            if let Some(at) = sheet {
                pass.set_pipeline(&self.sheet(at));
                pass.draw(0..3, 0..1);
            }
            earth.render(&mut pass);
        }
        gpu.queue.submit([encoder.finish()]);
        self.read()
    }

    fn sheet(&self, at: f32) -> wgpu::RenderPipeline {
        let device = &gpu().device;
        let source = format!(
            "@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {{
                return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, {at:?}, 1.0); }}
             @fragment fn fragment() -> @location(0) vec4f {{ return vec4f(1.0, 0.0, 0.0, 1.0); }}"
        );
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("sheet"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let (format, compare) = match self.options.depth {
            DepthBuffer::ReversedZ(format) => (format, wgpu::CompareFunction::GreaterEqual),
            DepthBuffer::StandardZ(format) => (format, wgpu::CompareFunction::LessEqual),
            DepthBuffer::None => panic!("a sheet needs depth"),
        };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("sheet"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: self.options.samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                targets: &[Some(self.options.color_format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn read(&self) -> RgbaImage {
        let gpu = gpu();
        let row = (4 * self.size.0).next_multiple_of(256);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("host"),
            size: u64::from(row * self.size.1),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
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
        gpu.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .unwrap();
        let bytes = buffer.get_mapped_range(..).unwrap();
        let swap = matches!(
            self.options.color_format,
            wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb
        );
        RgbaImage::from_fn(self.size.0, self.size.1, |x, y| {
            let at = (y * row + 4 * x) as usize;
            let p = &bytes[at..at + 4];
            if swap {
                [p[2], p[1], p[0], p[3]]
            } else {
                [p[0], p[1], p[2], p[3]]
            }
            .into()
        })
    }
}

fn texture(format: wgpu::TextureFormat, size: (u32, u32), sample_count: u32) -> wgpu::Texture {
    gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: Some("host"),
        size: wgpu::Extent3d {
            width: size.0,
            height: size.1,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | if sample_count == 1 && !format.is_depth_stencil_format() {
                wgpu::TextureUsages::COPY_SRC
            } else {
                wgpu::TextureUsages::empty()
            },
        view_formats: &[],
    })
}

/// Largest and mean difference of two pictures of one size.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (u8, f64) {
    assert_eq!(a.dimensions(), b.dimensions());
    let all = a.iter().zip(b.iter()).map(|(a, b)| a.abs_diff(*b));
    (
        all.clone().max().unwrap_or(0),
        all.map(f64::from).sum::<f64>() / a.len() as f64,
    )
}

#[test]
fn any_color_format_and_depth_gives_the_same_picture() {
    let mut options = EarthOptions::new(layers());
    options.atmosphere = Atmosphere::None;
    for shading in [Shading::Sunlit, Shading::Paper] {
        options.shading = shading;
        let expected = Rig::new(&options, SIZE).draw(&view(), SUN.normalize()).0;
        use wgpu::TextureFormat as F;
        for color_format in [F::Rgba8Unorm, F::Bgra8Unorm, F::Bgra8UnormSrgb] {
            for depth in [
                DepthBuffer::None,
                DepthBuffer::ReversedZ(F::Depth32Float),
                DepthBuffer::ReversedZ(F::Depth24Plus),
            ] {
                let host = Host::new(
                    EarthOptions {
                        color_format,
                        depth,
                        ..options.clone()
                    },
                    SIZE,
                );
                let picture = host.draw(&view(), SIZE.into(), None);
                let (worst, mean) = difference(&expected, &picture);
                assert!(
                    worst <= 1 && mean < 0.3,
                    "{color_format:?} {depth:?} {shading:?}: {worst}, {mean}"
                );
            }
        }
        // An ordinary depth buffer, with the host's own projection.
        let standard = EyeView {
            clip_from_view: glam::dcamera::rh::proj::directx::perspective(
                60_f64.to_radians(),
                4.0 / 3.0,
                100.0,
                1e9,
            ),
            ..view()
        };
        let depth = DepthBuffer::StandardZ(F::Depth32Float);
        let host = Host::new(
            EarthOptions {
                color_format: F::Rgba8UnormSrgb,
                depth,
                samples: 1,
                ..options.clone()
            },
            SIZE,
        );
        assert!(
            difference(&expected, &host.draw(&standard, SIZE.into(), None)).0 <= 1,
            "{shading:?}, standard depth"
        );
    }
}

#[test]
fn four_samples_smooth_the_limb_and_nothing_else() {
    let mut options = EarthOptions::new(layers());
    options.atmosphere = Atmosphere::None;
    let one = Rig::new(&options, SIZE).draw(&view(), SUN.normalize()).0;
    options.samples = 4;
    let four = Rig::new(&options, SIZE).draw(&view(), SUN.normalize()).0;
    let changed = one
        .pixels()
        .zip(four.pixels())
        .filter(|(a, b)| a != b)
        .count();
    assert!(
        changed > 20 && changed < (SIZE.0 * 6) as usize,
        "{changed} pixels differ"
    );
}

#[test]
fn the_hosts_world_may_have_any_origin_axes_and_unit() {
    let options = EarthOptions::new(layers());
    let mut rig = Rig::new(&options, SIZE);
    let plain = view();
    let expected = rig.draw(&plain, SUN.normalize()).0;
    // Kilometres, turned, and the origin a million kilometres away.
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
    let itrf_from_world = DAffine3::from_mat3_translation(
        DMat3::from_quat(turn) * 1000.0,
        DVec3::new(3e8, -8e8, 5e8),
    );
    let moved = EyeView {
        eye_world: itrf_from_world.inverse().transform_point3(plain.eye_world),
        view_from_world: plain.view_from_world * turn,
        clip_from_view: terrella::internals::earth::infinite_reversed_z(
            60_f64.to_radians(),
            4.0 / 3.0,
            1e-4,
        ),
        itrf_from_world,
    };
    let (worst, mean) = difference(&expected, &rig.draw(&moved, SUN.normalize()).0);
    // Rounding of the far origin moves the eye by a tenth of a micrometre; a pixel on an edge may flip.
    assert!(mean < 0.02, "{worst}, {mean}");
}

#[test]
fn a_viewport_and_an_off_centre_projection_draw_their_part() {
    let options = EarthOptions {
        color_format: wgpu::TextureFormat::Rgba8UnormSrgb,
        ..EarthOptions::new(layers())
    };
    let whole = Host::new(options.clone(), SIZE).draw(&view(), SIZE.into(), None);
    // The same picture in the middle of a larger target.
    let host = Host::new(options.clone(), (300, 200));
    let inset = host.draw(
        &view(),
        Viewport {
            origin: (70.0, 33.0),
            size: SIZE,
        },
        None,
    );
    let cut = image::imageops::crop_imm(&inset, 70, 33, SIZE.0, SIZE.1).to_image();
    // Other pixels of the target are dithered otherwise.
    let (worst, mean) = difference(&whole, &cut);
    assert!(worst <= 2 && mean < 0.25, "{worst}, {mean}");
    // The right half alone, by an off-centre projection: x_clip' = 2·x_clip − w_clip.
    let halve = DMat4::from_cols_array_2d(&[
        [2.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0, 1.0],
    ]);
    let right = EyeView {
        clip_from_view: halve * view().clip_from_view,
        ..view()
    };
    let half =
        Host::new(options, (SIZE.0 / 2, SIZE.1)).draw(&right, (SIZE.0 / 2, SIZE.1).into(), None);
    let cut = image::imageops::crop_imm(&whole, SIZE.0 / 2, 0, SIZE.0 / 2, SIZE.1).to_image();
    let (worst, mean) = difference(&cut, &half);
    assert!(mean < 0.25, "{worst}, {mean}");
}

#[test]
fn what_is_nearer_hides_the_earth_and_what_is_farther_is_hidden() {
    let mut options = EarthOptions {
        color_format: wgpu::TextureFormat::Rgba8UnormSrgb,
        ..EarthOptions::new(layers())
    };
    for (depth, depth_of) in [
        (
            DepthBuffer::ReversedZ(wgpu::TextureFormat::Depth32Float),
            (|z: f64| EyeView::NEAR_M / z) as fn(f64) -> f64,
        ),
        (
            DepthBuffer::StandardZ(wgpu::TextureFormat::Depth32Float),
            |z: f64| (1e9 / (1e9 - 100.0)) * (1.0 - 100.0 / z),
        ),
    ] {
        options.depth = depth;
        let place = Geodetic::from_degrees(0.0, 45.0, 2e7);
        let mut view = down(place, 50.0, 4.0 / 3.0);
        if matches!(depth, DepthBuffer::StandardZ(_)) {
            view.clip_from_view = glam::dcamera::rh::proj::directx::perspective(
                50_f64.to_radians(),
                4.0 / 3.0,
                100.0,
                1e9,
            );
        }
        let host = Host::new(options.clone(), SIZE);
        let red = [255, 0, 0, 255];
        // 1 000 km away: before everything.
        let front = host.draw(&view, SIZE.into(), Some(depth_of(1e6) as f32));
        assert!(
            front.pixels().all(|p| p.0 == red),
            "{depth:?}: something in front of the nearer sheet"
        );
        // 100 000 km away: behind everything. Space stays red, the ground does not, the halo covers it.
        let behind = host.draw(&view, SIZE.into(), Some(depth_of(1e8) as f32));
        assert_eq!(behind.get_pixel(2, 2).0, red, "{depth:?}");
        let center = behind.get_pixel(SIZE.0 / 2, SIZE.1 / 2).0;
        assert!(center[1] > 20 || center[2] > 20, "{depth:?}: {center:?}");
        let tinted = behind
            .pixels()
            .filter(|p| p.0[0] > 150 && p.0[2] > 10 && p.0[2] < 250)
            .count();
        assert!(tinted > 5, "{depth:?}: no halo over the farther sheet");
    }
}

/// A host that measures surface and air apart, in two passes, gets the picture of one pass.
#[test]
fn two_timed_passes_draw_the_same_picture_as_one() {
    let name = gpu().adapter.get_info().name;
    let opened = pollster::block_on(GpuContext::open_with(Some(&name), GpuTimer::FEATURES));
    let gpu = opened.expect("the adapter opens again");
    let Some(timer) = GpuTimer::new(&gpu.device, &gpu.queue) else {
        eprintln!("SKIPPED: {name} has no timestamp queries");
        return;
    };
    for samples in [1, 4] {
        let options = EarthOptions {
            samples,
            ..EarthOptions::new(layers())
        };
        let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
        let targets = FrameTargets::new(&gpu.device, SIZE, samples);
        let view = view();
        let sky = Sky::new(DVec3::X);
        earth.prepare(&gpu.queue, FrameRequest::new(&view, &sky, SIZE));
        let submit = |draw: &dyn Fn(&mut wgpu::CommandEncoder)| {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            draw(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
            let picture = targets.read_back(&gpu.device, &gpu.queue);
            picture.expect("a picture")
        };
        let one = submit(&|encoder| earth.render(&mut targets.begin_pass(encoder)));
        let two = submit(&|encoder| {
            for n in 0..2 {
                let part = PassPart {
                    is_first: n == 0,
                    is_last: n == 1,
                };
                let mut pass = targets.begin_part(encoder, part, Some(timer.writes(n)));
                if n == 0 {
                    earth.render_surface(&mut pass);
                } else {
                    earth.render_air(&mut pass);
                }
            }
            timer.resolve(encoder, 2);
        });
        assert!(one == two, "{samples} samples");
        assert!(
            one.chunks_exact(4).any(|pixel| pixel[2] > 60),
            "something is drawn"
        );
        let times = timer.read(&gpu.device, 2).expect("times");
        assert_eq!(times.len(), 2);
        assert!(
            times.iter().all(|time| (0.0..60e3).contains(time)),
            "{times:?}"
        );
        assert!(times.iter().sum::<f64>() > 0.0, "{times:?}");
    }
}

#[test]
fn anisotropy_outside_its_range_is_rejected() {
    let gpu = gpu();
    for (anisotropy, is_sound) in [(0, false), (1, true), (16, true), (17, false)] {
        let options = EarthOptions {
            anisotropy,
            ..EarthOptions::new(layers())
        };
        let made = Earth::new(&gpu.device, &gpu.queue, &options);
        let error = made.err().map(|error| error.to_string());
        let expected = format!("anisotropy is {anisotropy}; it must be from 1 to 16");
        assert_eq!(error, (!is_sound).then_some(expected));
    }
}
