//! The tiles of synthetic detail on the GPU: `shaders/earth/shading/detail_tiles.wgsl` and `land_detail.wgsl` read them.

use super::{Binding, GpuLayer};
use terrella_imagery::detail_tiles;

/// The tiles of clouds and of land, and the sampler that repeats them.
pub(super) struct DetailTiles {
    clouds: GpuLayer,
    land: GpuLayer,
    sampler: wgpu::Sampler,
}

impl DetailTiles {
    pub fn upload(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let label = "terrella detail tiles";
        let [clouds, land] =
            detail_tiles().map(|tile| GpuLayer::upload(device, queue, label, &tile, true));
        Self {
            clouds,
            land,
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
        self.clouds.bytes + self.land.bytes
    }

    pub fn bindings(&self) -> [Binding<'_>; 3] {
        let [clouds, sampler, land] = Self::entries();
        let bound = |entry: wgpu::BindGroupLayoutEntry, resource| {
            let binding = entry.binding;
            (entry, wgpu::BindGroupEntry { binding, resource })
        };
        [
            bound(
                clouds,
                wgpu::BindingResource::TextureView(&self.clouds.view),
            ),
            bound(sampler, wgpu::BindingResource::Sampler(&self.sampler)),
            bound(land, wgpu::BindingResource::TextureView(&self.land.view)),
        ]
    }

    pub fn entries() -> [wgpu::BindGroupLayoutEntry; 3] {
        let tile = |binding| super::texture_entry(binding, wgpu::TextureViewDimension::D2);
        [tile(13), super::sampler_entry(14), tile(15)]
    }
}
