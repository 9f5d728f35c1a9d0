//! The maps of the surface's fragment shader: whole maps, and the bind groups that hold them or tiles of them.

use super::GpuLayer;
use crate::imagery::EarthLayers;
use crate::imagery::tile::{MAP_LAYERS, MapLayer};

/// Whole maps on the GPU and what is needed to bind them, each map with its own sampler: around the Earth a whole map
/// repeats, a tile ends at its border.
pub(crate) struct Maps {
    layout: wgpu::BindGroupLayout,
    whole: [Option<GpuLayer>; MAP_LAYERS],
    repeat: wgpu::Sampler,
    clamp: wgpu::Sampler,
}

/// Binding of a map's sampler less that of its texture.
const SAMPLERS: u32 = MAP_LAYERS as u32;

impl Maps {
    /// Uploads the whole maps. With `display_values` colours are read as they are stored, not as linear light.
    pub fn upload(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layers: &EarthLayers,
        display_values: bool,
        anisotropy: u16,
    ) -> Self {
        let whole = MapLayer::ALL.map(|layer| {
            let image = layers.get(layer)?;
            let label = format!("terrella {}", layer.name());
            Some(GpuLayer::upload(
                device,
                queue,
                &label,
                image,
                display_values,
            ))
        });
        let sampler = |label, address_mode_u| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u,
                // Not over the poles.
                address_mode_v: wgpu::AddressMode::ClampToEdge,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                anisotropy_clamp: anisotropy,
                ..Default::default()
            })
        };
        let entries: Vec<_> = (0..)
            .zip(&whole)
            .filter(|(_, layer)| layer.is_some())
            .flat_map(|(binding, _)| {
                [
                    super::texture_entry(binding, wgpu::TextureViewDimension::D2),
                    super::sampler_entry(binding + SAMPLERS),
                ]
            })
            .collect();
        Self {
            layout: device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("terrella maps"),
                entries: &entries,
            }),
            whole,
            repeat: sampler("terrella whole maps", wgpu::AddressMode::Repeat),
            clamp: sampler("terrella tiles", wgpu::AddressMode::ClampToEdge),
        }
    }

    /// Layout of the bind groups.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Bytes of the whole maps, mip levels included.
    pub fn bytes(&self) -> u64 {
        self.whole.iter().flatten().map(|layer| layer.bytes).sum()
    }

    /// A bind group with these tiles, and the whole map where there is none.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        label: &str,
        tiles: [Option<&wgpu::TextureView>; MAP_LAYERS],
    ) -> wgpu::BindGroup {
        let mut entries = Vec::with_capacity(2 * MAP_LAYERS);
        for ((binding, whole), tile) in (0..).zip(&self.whole).zip(tiles) {
            let Some(whole) = whole else { continue };
            let (view, sampler) = match tile {
                Some(tile) => (tile, &self.clamp),
                None => (&whole.view, &self.repeat),
            };
            entries.push(wgpu::BindGroupEntry {
                binding,
                resource: wgpu::BindingResource::TextureView(view),
            });
            entries.push(wgpu::BindGroupEntry {
                binding: binding + SAMPLERS,
                resource: wgpu::BindingResource::Sampler(sampler),
            });
        }
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &self.layout,
            entries: &entries,
        })
    }
}
