//! `surface_point` of the shader, as the adapter runs it, against its copy that the formulas are measured with.

use crate::common::gpu;
use glam::{DVec3, Mat4, Vec3};
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::gpu::{EarthOutput, EarthVariant, ShaderVariant, VertexForm};
use terrella::internals::plan::FrameUniforms;
use terrella_measure::numeric::{PixelRay, Placed, place};

const ENTRY: &str = "
@group(0) @binding(7) var<storage, read_write> found: array<vec4f>;

@compute @workgroup_size(1)
fn run_place() {
    let at = 3u * u32(frame.exposure);
    var in: Varying;
    in.clip = vec4f(0.0);
    in.center_lon = frame.clip_from_eye[0].xy;
    in.center_lat = frame.clip_from_eye[0].zw;
    let out = surface_point(in);
    found[at] = vec4f(out.up, 0.0);
    found[at + 1u] = vec4f(out.east, 0.0);
    found[at + 2u] = vec4f(out.uv, 0.0, 0.0);
}
";

/// Results of the shader, one for each pixel.
fn on_the_adapter(pixels: &[PixelRay]) -> Vec<Placed> {
    let (device, queue) = (&gpu().device, &gpu().queue);
    let text = EarthVariant {
        form: VertexForm::BlockLattice { tiles: false },
        output: EarthOutput::Geolocation,
        parts: false,
    }
    .source()
    .unwrap()
    .text
        + ENTRY;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("terrella place"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("terrella place"),
        layout: None,
        module: &module,
        entry_point: Some("run_place"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |size: usize, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella place"),
            size: size as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    use wgpu::BufferUsages as Usage;
    let bytes = 48 * pixels.len();
    let frame = buffer(size_of::<FrameUniforms>(), Usage::UNIFORM | Usage::COPY_DST);
    let found = buffer(bytes, Usage::STORAGE | Usage::COPY_SRC);
    let copy = buffer(bytes, Usage::MAP_READ | Usage::COPY_DST);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("terrella place"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[(0, &frame), (7, &found)].map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        }),
    });
    for (index, pixel) in pixels.iter().enumerate() {
        let input = pixel.shader_input();
        let center = [
            input.center_lon.x,
            input.center_lon.y,
            input.center_lat.x,
            input.center_lat.y,
        ];
        let mut clip_from_eye = Mat4::ZERO;
        clip_from_eye.x_axis = center.into();
        let values = FrameUniforms {
            clip_from_eye,
            eye_scaled: input.eye_scaled,
            above: input.above,
            sun_itrf: Vec3::X,
            radius_m: 6_378_137.0,
            corner_ray: input.ray,
            polar_stretch: input.polar_stretch,
            pixel_right: Vec3::ZERO,
            exposure: index as f32,
            pixel_down: Vec3::ZERO,
            moon_light: 0.0,
            moon_itrf: Vec3::X,
            clouds_before: 1.0,
            shadow: bytemuck::Zeroable::zeroed(),
            lamp_light: 0.0,
            clouds_at_limb: 0.0,
            clouds_reach: 0.0,
            clouds_around: 0.0,
        };
        queue.write_buffer(&frame, 0, bytemuck::bytes_of(&values));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
        queue.submit([encoder.finish()]);
    }
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(&found, 0, &copy, 0, bytes as u64);
    queue.submit([encoder.finish()]);
    copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let mapped = copy.get_mapped_range(..).unwrap();
    let values: &[[f32; 4]] = bytemuck::cast_slice(&mapped);
    values
        .chunks_exact(3)
        .map(|rows| Placed {
            up: Vec3::new(rows[0][0], rows[0][1], rows[0][2]),
            east: Vec3::new(rows[1][0], rows[1][1], rows[1][2]),
            uv: glam::Vec2::new(rows[2][0], rows[2][1]),
        })
        .collect()
}

#[test]
fn the_measured_copy_of_place_is_the_shaders() {
    let mut pixels = Vec::new();
    for height_m in [100.0, 4e5, 3.6e7] {
        for (lat, lon) in [
            (0.0, 0.0),
            (51.0, -180.0),
            (89.999, 33.0),
            (-22.5, 179.9999),
            (-90.0, 0.0),
        ] {
            let eye =
                Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat, lon, height_m));
            let reach = (0.3 * height_m / 1e5).min(20.0);
            for (north, east) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-0.7, 0.6)] {
                let lat = (lat + north * reach).clamp(-90.0, 90.0);
                let place =
                    Geodetic::from_degrees(lat, (lon + east * reach).clamp(-180.0, 180.0), 0.0);
                pixels.push(PixelRay::toward(eye, place));
            }
        }
    }
    let found = on_the_adapter(&pixels);
    let mut worst = 0.0_f64;
    for (pixel, shader) in pixels.iter().zip(&found) {
        let copy = place(&pixel.shader_input());
        // Six roundings of a unit vector; u counts in ground distance, so that at a pole it may differ as it likes.
        let up = copy.up.distance(shader.up);
        let along = f64::from(copy.up.truncate().length());
        let du = f64::from(copy.uv.x - shader.uv.x) * std::f64::consts::TAU * along;
        let dv = f64::from(copy.uv.y - shader.uv.y) * std::f64::consts::PI;
        let off = f64::from(up).max(DVec3::new(du, dv, 0.0).length());
        assert!(off < 4e-7, "{pixel:?}: {copy:?}, on the adapter {shader:?}");
        worst = worst.max(off);
    }
    println!(
        "{} pixels: {:.3} m on the ground at most",
        pixels.len(),
        worst * 6_378_137.0
    );
}
