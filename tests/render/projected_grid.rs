//! The projected grid's shader, as the adapter runs it, against the same grid in f64.

use crate::common::gpu;
use glam::{DVec3, Vec3};
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::gpu::{EarthOutput, EarthVariant, ShaderVariant, VertexForm};
use terrella_ground::elevation::{Bounds, Elevation, HeightRange};
use terrella_ground::globe::GroundView;
use terrella_ground::globe::projected_grid::{
    GridFrame, GridOptions, GridUniforms, HeightTiles, ProjectedGrid, TILE_SAMPLES, eye_place,
};

const ENTRY: &str = "
struct Found { at: vec4f, place: vec4f, normal: vec4f }
@group(0) @binding(7) var<storage, read_write> found: array<Found>;

@compute @workgroup_size(64)
fn run_grid(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= grid.samples.x * grid.samples.y { return; }
    let point = grid_point(id.x);
    found[id.x].at = vec4f(point.from_eye_m, point.height_m);
    found[id.x].place = vec4f(point.north_rad, point.east_rad, point.spacing_rad, 0.0);
    found[id.x].normal = vec4f(point.normal, 0.0);
}
";

/// Two long waves, smooth at every level of the pyramid.
struct Hills;

impl Elevation for Hills {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let n = Ellipsoid::normal(lat_rad, lon_rad);
        let wave = |k: f64, v: DVec3| {
            let half = k * spacing_rad;
            let left = if half < 1e-3 { 1.0 } else { half.sin() / half };
            left * (k * n.dot(v.normalize())).sin()
        };
        300.0
            + 200.0 * wave(400.0, DVec3::new(1.0, 0.3, 0.2))
            + 100.0 * wave(900.0, DVec3::new(0.1, -0.3, 1.0))
    }

    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: 0.0,
            high_m: 600.0,
        }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        1e-6
    }
}

/// A vertex as the shader made it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Found {
    from_eye_m: [f32; 3],
    height_m: f32,
    north_rad: f32,
    east_rad: f32,
    spacing_rad: f32,
    zero: f32,
    normal: [f32; 4],
}

fn on_the_adapter(frame: &GridFrame, tiles: &HeightTiles, edit: (&str, &str)) -> Vec<Found> {
    let (device, queue) = (&gpu().device, &gpu().queue);
    let label = Some("terrella projected grid");
    let variant = EarthVariant {
        form: VertexForm::ProjectedGrid { tiles: false },
        output: EarthOutput::Geolocation,
        parts: false,
    };
    let text = variant.source().unwrap().text;
    assert!(text.contains(edit.0), "{} is not in the shader", edit.0);
    let text = if edit.0.is_empty() {
        text
    } else {
        text.replace(edit.0, edit.1)
    } + ENTRY;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label,
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: None,
        module: &module,
        entry_point: Some("run_grid"),
        compilation_options: Default::default(),
        cache: None,
    });
    let count = (frame.samples.0 * frame.samples.1) as usize;
    let buffer = |size: usize, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label,
            size: size as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    use wgpu::BufferUsages as Usage;
    let bytes = count * size_of::<Found>();
    let uniform = buffer(size_of::<GridUniforms>(), Usage::UNIFORM | Usage::COPY_DST);
    let found = buffer(bytes, Usage::STORAGE | Usage::COPY_SRC);
    let copy = buffer(bytes, Usage::MAP_READ | Usage::COPY_DST);
    queue.write_buffer(
        &uniform,
        0,
        bytemuck::bytes_of(&GridUniforms::new(frame, tiles)),
    );
    let rows = tiles.slot_count().div_ceil(16);
    let atlas = device.create_texture(&wgpu::TextureDescriptor {
        label,
        size: wgpu::Extent3d {
            width: 16 * TILE_SAMPLES,
            height: rows * TILE_SAMPLES,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for slot in tiles.changed() {
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &atlas,
                mip_level: 0,
                origin: wgpu::Origin3d {
                    x: slot % 16 * TILE_SAMPLES,
                    y: slot / 16 * TILE_SAMPLES,
                    z: 0,
                },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(tiles.slot(*slot)),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * TILE_SAMPLES),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: TILE_SAMPLES,
                height: TILE_SAMPLES,
                depth_or_array_layers: 1,
            },
        );
    }
    let view = atlas.create_view(&wgpu::TextureViewDescriptor::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 4,
                resource: uniform.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 5,
                resource: wgpu::BindingResource::TextureView(&view),
            },
            wgpu::BindGroupEntry {
                binding: 7,
                resource: found.as_entire_binding(),
            },
        ],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((count as u32).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&found, 0, &copy, 0, bytes as u64);
    queue.submit([encoder.finish()]);
    copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let mapped = copy.get_mapped_range(..).unwrap();
    bytemuck::cast_slice(&mapped).to_vec()
}

fn view(lat: f64, lon: f64, height_m: f64, pitch: f64) -> GroundView {
    let place = Geodetic::from_degrees(lat, lon, 0.0);
    let ground_m = Hills.height_m(place.lat_rad, place.lon_rad, 0.0);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
    let north = up.cross(east);
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic {
        height_m: ground_m + height_m,
        ..place
    });
    let (sin, cos) = pitch.to_radians().sin_cos();
    let ahead = (north + east).normalize();
    let fov = 40.0_f64.to_radians();
    let eye_view = EyeView::itrf(
        eye,
        ahead * sin - up * cos,
        ahead * cos + up * sin,
        fov,
        16.0 / 9.0,
    );
    let (eye_itrf_m, clip_from_eye) = eye_view.to_itrf();
    GroundView {
        eye_itrf_m,
        clip_from_eye,
        pixel_rad: fov / 720.0,
        tolerance_px: 1.0,
    }
}

/// By how much the shader's vertices are off, pixels.
#[derive(Debug, Default)]
struct Off {
    /// From where their own latitude, longitude and height are in f64, besides an ulp of the height. The angles come from
    /// the adapter's atan2, whose 2e-5 are most of this; positions are made without it.
    own: f64,
    /// That ulp, for the nearest vertex.
    ulp: f64,
    /// From the same vertex in f64, as the eye sees it: of 99 in 100, and at most.
    nearly: f64,
    most: f64,
    /// Difference of their elevations from those of the same tiles at the same places in f64, in addition to two ulps.
    height: f64,
    /// Vertices behind the base's limb or on it.
    behind: u32,
}

impl Off {
    fn is_little(&self) -> bool {
        self.own < 0.03 && self.nearly < 0.05 && self.most < 0.1 && self.height < 0.03
    }
}

/// Draws a view with the shader, after `edit` of its text, and compares.
fn compare(view: &GroundView, edit: (&str, &str)) -> Off {
    let mut grid = ProjectedGrid::new(&GridOptions::default());
    let frame = grid.aim(view, &Hills).expect("ground in the picture");
    let mut tiles = HeightTiles::new(512);
    let counts = tiles.update(&frame, &Hills, u32::MAX);
    assert_eq!(counts.missing, 0, "{counts:?}");
    let found = on_the_adapter(&frame, &tiles, edit);
    let (lat_eye, lon_eye) = eye_place(&frame.caster);
    let mut off = Off::default();
    let mut apart = Vec::new();
    for (index, point) in found.iter().enumerate() {
        let at = Vec3::from(point.from_eye_m).as_dvec3();
        assert!(at.is_finite(), "{point:?}");
        let place = Geodetic {
            lat_rad: lat_eye + f64::from(point.north_rad),
            lon_rad: lon_eye + f64::from(point.east_rad),
            height_m: f64::from(point.height_m),
        };
        let exact = Ellipsoid::WGS84.itrf_from_geodetic(place) - view.eye_itrf_m;
        let metres_to_px = 1.0 / (exact.length() * view.pixel_rad);
        let ulp_m = f64::from(point.height_m.abs().max(1.0)) * f64::from(f32::EPSILON);
        off.own = off
            .own
            .max((at.distance(exact) - ulp_m).max(0.0) * metres_to_px);
        off.ulp = off.ulp.max(ulp_m * metres_to_px);
        let spacing = f64::from(point.spacing_rad);
        let reported = tiles.height_m(place.lat_rad, place.lon_rad, spacing);
        let apart_m = ((reported - place.height_m).abs() - 2.0 * ulp_m).max(0.0);
        off.height = off.height.max(apart_m * metres_to_px);
        let (columns, _) = frame.samples;
        let sample = frame.sample(index as u32 % columns, index as u32 / columns);
        let normal = (sample.place / frame.caster.radii_m).normalize();
        let lat = normal.z.atan2(normal.truncate().length());
        let lon = normal.y.atan2(normal.x);
        let height_m = tiles.height_m(lat, lon, sample.spacing_rad);
        let twin = sample.place * frame.caster.radii_m + normal * height_m - view.eye_itrf_m;
        let turn = twin.cross(at).length().atan2(twin.dot(at));
        apart.push(turn / view.pixel_rad);
        off.behind += u32::from(sample.place.dot(frame.caster.up) <= frame.caster.sin_limb);
    }
    apart.sort_by(f64::total_cmp);
    off.nearly = apart[apart.len() * 99 / 100];
    off.most = apart[apart.len() - 1];
    off
}

const AS_IT_IS: (&str, &str) = ("", "");

#[test]
fn the_shader_s_vertices_are_those_of_f64() {
    println!(
        "height m, pitch | px: own place, height's ulp | from f64 (99 %, most) | height | behind the limb"
    );
    let mut wrong = Vec::new();
    for (lat, lon) in [(47.0, 11.0), (-89.9999, 40.0), (0.0, -180.0)] {
        for (height_m, pitch) in [
            (1.0, 80.0),
            (500.0, 60.0),
            (2e3, 88.0),
            (1e4, 0.0),
            (4e5, 0.0),
            (4e5, 75.0),
            (3.6e7, 0.0),
            (1e9, 0.0),
        ] {
            let off = compare(&view(lat, lon, height_m, pitch), AS_IT_IS);
            println!(
                "{height_m:>11} {pitch:>3} | {:>8.5} {:>8.5} | {:>8.5} {:>8.5} | {:>8.5} | {:>5}",
                off.own, off.ulp, off.nearly, off.most, off.height, off.behind
            );
            if !off.is_little() {
                wrong.push(format!("{lat}° {height_m} m, {pitch}°: {off:?}"));
            }
        }
    }
    assert_eq!(wrong, [""; 0]);
}

#[test]
fn forms_that_cancel_are_found_out() {
    // Not the root: what is wrong with it moves a vertex along its own ray, to another place of the ground that is as good.
    for edit in [
        // 1 − cos θ as it is written.
        ("sine * sine / (1.0 + cosine)", "1.0 - cosine"),
        // The difference of latitude's cosines as a difference.
        (
            "let d_along = stretch * offset.z;",
            "let d_along = stretch * (grid.eye_up.z + offset.z) - eye_along;",
        ),
    ] {
        let off = compare(&view(47.0, 11.0, 500.0, 60.0), edit);
        println!("{} for {}: {off:?}", edit.1, edit.0);
        assert!(!off.is_little(), "{edit:?}");
    }
}
