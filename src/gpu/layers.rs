//! Maps as textures.

use terrella_ground::half::half_bits;
use terrella_imagery::{LayerImage, TexelFormat};

/// One map on the GPU.
#[derive(Clone, Debug)]
pub struct GpuLayer {
    pub view: wgpu::TextureView,
    /// Bytes held, mip levels included.
    pub bytes: u64,
}

impl GpuLayer {
    /// Uploads all levels. With `display_values` a colour map is read as it is stored, not as linear light.
    pub fn upload(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        label: &str,
        image: &LayerImage,
        display_values: bool,
    ) -> Self {
        let format = match image.format {
            TexelFormat::Rgba8Srgb if display_values => wgpu::TextureFormat::Rgba8Unorm,
            TexelFormat::Rgba8Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
            TexelFormat::R8Unorm => wgpu::TextureFormat::R8Unorm,
            TexelFormat::Rg8Snorm => wgpu::TextureFormat::Rg8Snorm,
        };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: image.width,
                height: image.height,
                depth_or_array_layers: 1,
            },
            mip_level_count: image.levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let mut bytes = 0;
        for (level, texels) in image.levels.iter().enumerate() {
            let (width, height) = (
                (image.width >> level).max(1),
                (image.height >> level).max(1),
            );
            queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &texture,
                    mip_level: level as u32,
                    origin: wgpu::Origin3d::ZERO,
                    aspect: wgpu::TextureAspect::All,
                },
                texels,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(width * image.format.texel_bytes() as u32),
                    rows_per_image: Some(height),
                },
                wgpu::Extent3d {
                    width,
                    height,
                    depth_or_array_layers: 1,
                },
            );
            bytes += texels.len() as u64;
        }
        Self {
            view: super::view(&texture),
            bytes,
        }
    }

    /// A texture that is drawn to and then read.
    pub fn target(
        device: &wgpu::Device,
        label: &str,
        format: wgpu::TextureFormat,
        (width, height): (u32, u32),
    ) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = super::color_texture(device, label, (width, height), format, 1, usage);
        let texel = format.block_copy_size(None).unwrap_or(0);
        Self {
            view: super::view(&texture),
            bytes: u64::from(width * height * texel),
        }
    }

    /// Uploads a table of the air as half floats.
    pub fn upload_table(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        label: &str,
        size: terrella_ground::air::TableSize,
        texels: &[glam::Vec4],
    ) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: size.z,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: if size.z > 1 {
                wgpu::TextureDimension::D3
            } else {
                wgpu::TextureDimension::D2
            },
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let table = Self {
            view: super::view(&texture),
            bytes: 8 * size.texels() as u64,
        };
        table.write_table(queue, texels);
        table
    }

    /// Replaces a table.
    pub fn write_table(&self, queue: &wgpu::Queue, texels: &[glam::Vec4]) {
        let numbers = texels.iter().flat_map(|t| t.to_array());
        let halves: Vec<u16> = numbers.map(half_bits).collect();
        let texture = self.view.texture();
        queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&halves),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(texture.width() * 8),
                rows_per_image: Some(texture.height()),
            },
            texture.size(),
        );
    }
}
