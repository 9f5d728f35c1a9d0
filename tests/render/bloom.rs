//! Bloom: no light is lost, and it has the expected distribution.

use crate::common;
use terrella::internals::gpu::{color_texture, read_halves};
use terrella::{Bloom, BloomPass, ScaledTarget};
use terrella_ground::half::half_bits;

/// The red of a picture of black with the light of some pixels, after it is scattered.
fn scattered(strength: f64, size: (u32, u32), lights: &[((u32, u32), f32)]) -> Vec<f64> {
    let gpu = common::gpu();
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_DST
        | wgpu::TextureUsages::COPY_SRC;
    let format = ScaledTarget::LIGHT;
    let texture = color_texture(&gpu.device, "light", size, format, 1, usage);
    let mut texels = vec![0_u16; 4 * (size.0 * size.1) as usize];
    for &((x, y), light) in lights {
        texels[4 * (y * size.0 + x) as usize] = half_bits(light);
    }
    gpu.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * size.0),
            rows_per_image: None,
        },
        texture.size(),
    );
    let view = texture.create_view(&Default::default());
    let bloom = Bloom { strength };
    let pass = BloomPass::new(&gpu.device, &bloom, &view, size).expect("shaders");
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    if let Some(pass) = pass {
        pass.record(&mut encoder, None);
    }
    gpu.queue.submit([encoder.finish()]);
    let read = read_halves(&gpu.device, &gpu.queue, &texture, None).expect("read");
    read.iter().map(|pixel| f64::from(pixel[0])).collect()
}

/// Sums within these radii around a place, pixels.
fn within(light: &[f64], size: (u32, u32), place: (u32, u32), radii: &[f64]) -> Vec<f64> {
    let distance = |index: usize| {
        let (x, y) = (index as u32 % size.0, index as u32 / size.0);
        let across = f64::from(x) - f64::from(place.0);
        across.hypot(f64::from(y) - f64::from(place.1))
    };
    let sum = |radius: &f64| {
        let pixels = light.iter().enumerate();
        let near = pixels.filter(|(index, _)| distance(*index) <= *radius);
        near.map(|(_, light)| light).sum()
    };
    radii.iter().map(sum).collect()
}

#[test]
fn no_light_is_lost_whatever_the_size_and_the_place() {
    for size in [(320, 180), (321, 183), (250, 250), (513, 301)] {
        for offset in [(0, 0), (1, 0), (3, 5), (7, 2)] {
            let place = (size.0 / 2 + offset.0, size.1 / 2 + offset.1);
            let light = scattered(0.2, size, &[(place, 60.0)]);
            let sum: f64 = light.iter().sum();
            // Light beyond the edges is that of the widest levels there, and some of it returns.
            assert!(
                (sum / 60.0 - 1.0).abs() < 0.005,
                "{size:?} {place:?}: {sum}"
            );
        }
    }
}

#[test]
fn a_lens_scatters_as_much_as_it_says_and_as_far_at_every_size() {
    let (small, large) = ((320, 180), (640, 360));
    let strength = 0.1;
    let sums = [(small, 1.0), (large, 2.0)].map(|(size, scale): ((u32, u32), f64)| {
        let place = (size.0 / 2, size.1 / 2);
        // As much light of a source that is as large.
        let side = scale as u32;
        let lights: Vec<_> = (0..side * side)
            .map(|n| ((place.0 + n % side, place.1 + n / side), 60.0))
            .collect();
        let light = scattered(strength, size, &lights);
        let all: f64 = 60.0 * scale * scale;
        let radii = [4.0, 8.0, 16.0, 32.0].map(|radius| radius * scale);
        within(&light, size, place, &radii)
            .iter()
            .map(|sum| 1.0 - sum / all)
            .collect::<Vec<_>>()
    });
    for (small, large) in sums[0].iter().zip(&sums[1]) {
        assert!((small / large - 1.0).abs() < 0.12, "{sums:?}");
    }
    // ∫ of r^−1.5 over the radii beyond, of that over all: a thousandth to a quarter of the side and half an octave more.
    let side = f64::from(small.1);
    let beyond = |radius: f64| {
        let part = |radius: f64| radius.powf(-0.5) - (0.25 * 2_f64.sqrt()).powf(-0.5);
        strength * part(radius / side) / part(1.0 / 1024.0)
    };
    for (radius, sum) in [4.0, 8.0, 16.0].iter().zip(&sums[0]) {
        let wanted = beyond(*radius);
        assert!(
            (sum / wanted - 1.0).abs() < 0.35,
            "{radius} px: {sum}, {wanted}"
        );
    }
}

#[test]
fn even_light_stays_as_it_is_and_alpha_too() {
    let size = (64, 36);
    let lights: Vec<_> = (0..size.0 * size.1)
        .map(|n| ((n % size.0, n / size.0), 0.5))
        .collect();
    let light = scattered(0.3, size, &lights);
    assert!(light.iter().all(|light| (light - 0.5).abs() < 1e-3));
}

#[test]
fn the_sun_is_left_to_its_glare() {
    let size = (160, 90);
    let bright = scattered(0.1, size, &[((80, 45), 30_000.0)]);
    let cut = scattered(0.1, size, &[((80, 45), 64.0)]);
    let at = (45 * size.0 + 90) as usize;
    assert!(
        bright[at] > 0.0 && (bright[at] / cut[at] - 1.0).abs() < 1e-3,
        "{} {}",
        bright[at],
        cut[at]
    );
}

#[test]
fn a_lens_without_scatter_draws_nothing() {
    let light = scattered(0.0, (64, 36), &[((30, 20), 1.0)]);
    assert!(light.iter().filter(|light| **light != 0.0).count() == 1);
}

/// A dark patch of a tenth of the height in a white picture gets the veil of a real lens, below 0.5 %: by default, and at 0.05.
#[test]
fn a_veil_is_as_thin_as_that_of_real_lenses() {
    for size in [(320, 180), (640, 360)] {
        let half = size.1 / 20;
        let is_dark =
            |x: u32, y: u32| x.abs_diff(size.0 / 2) <= half && y.abs_diff(size.1 / 2) <= half;
        let lights: Vec<_> = (0..size.0 * size.1)
            .map(|n| (n % size.0, n / size.0))
            .filter(|(x, y)| !is_dark(*x, *y))
            .map(|place| (place, 1.0))
            .collect();
        let veil = |strength: f64| {
            let light = scattered(strength, size, &lights);
            light[(size.1 / 2 * size.0 + size.0 / 2) as usize]
        };
        let [usual, more] = [0.03, 0.05].map(veil);
        println!("{size:?}: {usual:.5} {more:.5} of the white");
        assert!(
            usual > 1e-4 && usual < more && more < 0.005,
            "{usual} {more}"
        );
    }
}
