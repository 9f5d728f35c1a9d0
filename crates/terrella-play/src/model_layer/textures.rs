//! Pictures of models on the GPU, with their mip levels.

use terrella::GpuContext;
use terrella_imagery::srgb::{LINEAR_FROM_SRGB, SrgbEncoder};
use terrella_model::ModelImage;

/// Meaning of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Texels {
    /// Colour, encoded as sRGB.
    Color,
    /// Numbers.
    Linear,
}

impl Texels {
    fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Self::Linear => wgpu::TextureFormat::Rgba8Unorm,
        }
    }
}

/// Uploads a picture with all its levels, without those that are larger than the adapter takes.
pub fn upload(gpu: &GpuContext, image: &ModelImage, texels: Texels) -> wgpu::TextureView {
    let most = gpu.device.limits().max_texture_dimension_2d;
    let mut levels = vec![Level {
        width: image.size.0,
        height: image.size.1,
        rgba: image.rgba.clone(),
    }];
    while let Some(level) = levels.last()
        && level.width.max(level.height) > 1
    {
        let half = level.half(texels);
        if level.width.max(level.height) > most {
            levels.pop();
        }
        levels.push(half);
    }
    let (width, height) = levels.first().map_or((1, 1), |one| (one.width, one.height));
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("terrella model picture"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: texels.format(),
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, level) in (0..).zip(&levels) {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            &level.rgba,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.width),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: level.width,
                height: level.height,
                depth_or_array_layers: 1,
            },
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("terrella model picture"),
        ..Default::default()
    })
}

struct Level {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Level {
    /// The level of half the size, rounded down as textures have it: means of two by two texels, of colours in linear light.
    fn half(&self, texels: Texels) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let encoder = SrgbEncoder::new();
        let value = |x: u32, y: u32, channel: usize| {
            let at = (y.min(self.height - 1) * self.width + x.min(self.width - 1)) as usize;
            let code = self.rgba.get(at * 4 + channel).copied().unwrap_or_default();
            match texels == Texels::Color && channel < 3 {
                true => LINEAR_FROM_SRGB
                    .get(usize::from(code))
                    .copied()
                    .unwrap_or_default(),
                false => f32::from(code) / 255.0,
            }
        };
        let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            for channel in 0..4 {
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
                let sum = corners.map(|(dx, dy)| value(2 * x + dx, 2 * y + dy, channel));
                let mean = sum.iter().sum::<f32>() / 4.0;
                rgba.push(match texels == Texels::Color && channel < 3 {
                    true => encoder.code(mean),
                    false => (mean * 255.0).round() as u8,
                });
            }
        }
        Self {
            width,
            height,
            rgba,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_means_of_light_for_colours_and_of_numbers_else() {
        let level = Level {
            width: 2,
            height: 1,
            rgba: vec![0, 0, 0, 0, 255, 255, 255, 255],
        };
        // Half the light is sRGB code 188 (IEC 61966-2-1: 1.055 · 0.5^(1/2.4) − 0.055 = 0.7354).
        assert_eq!(level.half(Texels::Color).rgba, [188, 188, 188, 128]);
        assert_eq!(level.half(Texels::Linear).rgba, [128; 4]);
    }
}
