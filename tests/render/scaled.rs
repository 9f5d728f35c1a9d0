//! Pictures that are drawn smaller than they are shown.

use crate::common::{self, Rig, map, tilted};
use glam::DVec3;
use terrella::frames::Geodetic;
use terrella::{
    Bloom, EarthOptions, EyeView, FrameRequest, FrameTargets, Quality, ScaledTarget, Sky, Tone,
};

const SIZE: (u32, u32) = (192, 108);

/// Draws white on the second column of pixels.
const WHITE_COLUMN: &str = "
@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}
@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return vec4f(vec3f(select(0.0, 1.0, u32(at.x) == 1u)), 1.0);
}";

fn hills(lat: f64, lon: f64) -> [u8; 3] {
    let wave = |angle: f64| (120.0 + 80.0 * angle.sin()).round() as u8;
    [wave(3.0 * lat), wave(2.5 * lon), wave(2.0 * (lat + lon))]
}

fn view() -> EyeView {
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    let place = Geodetic::from_degrees(20.0, 30.0, 1.5e6);
    tilted(place, 60.0, -45.0, 60.0, aspect)
}

/// Over the ground in view.
fn sun() -> DVec3 {
    DVec3::new(0.7, 0.6, 0.35).normalize()
}

/// The same view through a [`ScaledTarget`], as a host draws it.
fn scaled(options: &EarthOptions, scale: f64) -> image::RgbaImage {
    let gpu = common::gpu();
    let mut rig = Rig::with_color(options, SIZE);
    let quality = Quality {
        scale,
        ..*rig.earth.quality()
    };
    let (format, samples) = (options.color_format, options.samples);
    rig.earth
        .set_quality(&gpu.queue, &quality)
        .expect("a sound quality");
    let drawn_size = quality.drawn_size(SIZE);
    let target = ScaledTarget::new(&gpu.device, format, SIZE, drawn_size, samples);
    let target = target.expect("good shaders");
    assert_eq!((target.size(), target.drawn_size()), (SIZE, drawn_size));
    let shown = FrameTargets::with_color(&gpu.device, format, SIZE, 1);
    rig.earth.prepare(
        &gpu.queue,
        FrameRequest::new(&view(), &Sky::new(sun()), drawn_size),
    );
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    rig.earth
        .render(&mut target.begin_pass(&mut encoder, shown.picture_view()));
    target.finish(&mut encoder, shown.picture_view(), None);
    gpu.queue.submit([encoder.finish()]);
    let texels = shown.read_back(&gpu.device, &gpu.queue).expect("a picture");
    image::RgbaImage::from_raw(SIZE.0, SIZE.1, texels).expect("of that size")
}

/// Mean absolute difference of two pictures, levels of 8 bits.
fn apart(a: &image::RgbaImage, b: &image::RgbaImage) -> f64 {
    let sum: u64 = a
        .as_raw()
        .iter()
        .zip(b.as_raw())
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    sum as f64 / a.as_raw().len() as f64
}

#[test]
fn a_smaller_picture_is_enlarged_to_the_same_view() {
    for format in [
        wgpu::TextureFormat::Rgba8UnormSrgb,
        wgpu::TextureFormat::Rgba8Unorm,
    ] {
        for samples in [1, 4] {
            let mut options = EarthOptions::new(common::day_only(map(256, hills)));
            (options.color_format, options.samples) = (format, samples);
            let mut rig = Rig::with_color(&options, SIZE);
            let (full, ..) = rig.draw_complete(&view(), sun());
            // At full scale there is no intermediate texture: byte for byte the same.
            assert!(scaled(&options, 1.0) == full, "{format:?} {samples}");
            let apart = [0.85, 0.5, 0.25].map(|scale| apart(&scaled(&options, scale), &full));
            println!("{format:?} {samples}: {apart:?}");
            assert!(
                0.0 < apart[0] && apart[0] < apart[1] && apart[1] < apart[2] && apart[2] < 12.0,
                "{format:?} {samples}: {apart:?}"
            );
            // Mirrored or moved by some pixels it would be far off.
            let mirrored = image::imageops::flip_horizontal(&full);
            assert!(self::apart(&mirrored, &full) > 3.0 * apart[1]);
        }
    }
}

/// A target whose size and scale change draws as one that is made for them.
#[test]
fn a_target_with_bloom_follows_other_sizes() {
    let gpu = common::gpu();
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let bloom = Bloom { strength: 0.5 };
    let (tone, column) = (Tone::Linear, white_column(ScaledTarget::LIGHT));
    let made = |size, drawn_size| {
        ScaledTarget::developing(&gpu.device, format, size, drawn_size, 1, tone, bloom)
            .expect("shaders")
    };
    let drawn = |target: &ScaledTarget| {
        let shown = FrameTargets::with_color(&gpu.device, format, target.size(), 1);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = target.begin_pass(&mut encoder, shown.picture_view());
        pass.set_pipeline(&column);
        pass.draw(0..3, 0..1);
        drop(pass);
        target.finish(&mut encoder, shown.picture_view(), None);
        gpu.queue.submit([encoder.finish()]);
        shown.read_back(&gpu.device, &gpu.queue).expect("a picture")
    };
    let mut target = made((16, 9), (16, 9));
    for (size, drawn_size) in [
        ((40, 24), (40, 24)),
        ((40, 24), (20, 12)),
        ((1, 1), (1, 1)),
        ((33, 17), (17, 9)),
        ((64, 36), (64, 36)),
    ] {
        target
            .set(&gpu.device, size, drawn_size, 1)
            .expect("shaders");
        assert!(
            drawn(&target) == drawn(&made(size, drawn_size)),
            "{size:?} {drawn_size:?}"
        );
    }
    // And the lens is still before it.
    let none = ScaledTarget::developing(
        &gpu.device,
        format,
        (64, 36),
        (64, 36),
        1,
        tone,
        Bloom::default(),
    );
    assert!(drawn(&target) != drawn(&none.expect("shaders")));
}

/// Between black and white there is half the light, and not half the code, also in formats without hardware encoding.
#[test]
fn a_picture_is_enlarged_in_light() {
    let gpu = common::gpu();
    for format in [
        wgpu::TextureFormat::Rgba8UnormSrgb,
        wgpu::TextureFormat::Rgba8Unorm,
    ] {
        let shown = FrameTargets::with_color(&gpu.device, format, (9, 4), 1);
        let target = ScaledTarget::new(&gpu.device, format, (9, 4), (3, 2), 1).expect("shaders");
        let column = white_column(format);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = target.begin_pass(&mut encoder, shown.picture_view());
        pass.set_pipeline(&column);
        pass.draw(0..3, 0..1);
        drop(pass);
        target.finish(&mut encoder, shown.picture_view(), None);
        gpu.queue.submit([encoder.finish()]);
        let texels = shown.read_back(&gpu.device, &gpu.queue).expect("a picture");
        for row in texels.chunks(9 * 4) {
            let row: Vec<u8> = row.as_chunks::<4>().0.iter().map(|p| p[0]).collect();
            // A third and two thirds of white's light, in sRGB.
            let expected = [0, 0, 156, 214, 255, 214, 156, 0, 0_u8];
            let off = row.iter().zip(expected).map(|(a, b)| a.abs_diff(b));
            assert!(off.max() <= Some(1), "{format:?}: {row:?}");
        }
    }
}

fn white_column(format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let device = &common::gpu().device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(WHITE_COLUMN.into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
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
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
