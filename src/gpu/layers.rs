//! Maps as textures.

use super::map_upload::MapUpload;
use terrella_ground::half::half_bits;
use terrella_imagery::LayerImage;

/// One map on the GPU.
#[derive(Clone, Debug)]
pub struct GpuLayer {
    pub view: wgpu::TextureView,
    /// Bytes held, mip levels included.
    pub bytes: u64,
}

impl GpuLayer {
    /// Uploads all mip levels, and waits if too much data is pending on the device. With `display_values` a colour map is read as stored instead of
    /// as linear light.
    pub fn upload(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        label: &str,
        image: &LayerImage,
        display_values: bool,
    ) -> Self {
        let mut upload = MapUpload::new(device, queue, label, image, display_values);
        image.rows_to(&mut upload);
        Self::of_upload(upload)
    }

    /// A map after all its rows have been uploaded.
    pub(super) fn of_upload(upload: MapUpload) -> Self {
        let (texture, bytes) = upload.finish();
        Self {
            view: super::view(&texture),
            bytes,
        }
    }

    /// A texture that is rendered to and then read.
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
