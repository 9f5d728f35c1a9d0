//! The tile of synthetic detail on the GPU: `shaders/earth/shading/detail_tile.wgsl` reads it.

use super::{Binding, GpuLayer};
use terrella_imagery::detail_tile;

/// The tile, and the sampler that repeats it.
pub(super) struct DetailTile {
    tile: GpuLayer,
    sampler: wgpu::Sampler,
}

impl DetailTile {
    pub fn upload(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let label = "terrella detail tile";
        Self {
            tile: GpuLayer::upload(device, queue, label, &detail_tile(), true),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: wgpu::AddressMode::Repeat,
                address_mode_v: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
        }
    }

    /// Size in bytes, mip levels included.
    pub fn bytes(&self) -> u64 {
        self.tile.bytes
    }

    pub fn bindings(&self) -> [Binding<'_>; 2] {
        let [tile, sampler] = Self::entries();
        let bound = |entry: &wgpu::BindGroupLayoutEntry, resource| wgpu::BindGroupEntry {
            binding: entry.binding,
            resource,
        };
        [
            (
                tile,
                bound(&tile, wgpu::BindingResource::TextureView(&self.tile.view)),
            ),
            (
                sampler,
                bound(&sampler, wgpu::BindingResource::Sampler(&self.sampler)),
            ),
        ]
    }

    pub fn entries() -> [wgpu::BindGroupLayoutEntry; 2] {
        [
            super::texture_entry(13, wgpu::TextureViewDimension::D2),
            super::sampler_entry(14),
        ]
    }
}
