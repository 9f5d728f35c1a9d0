//! Maps for the surface's fragment shader: whole maps, and the bind groups of whole maps and tiles.

use super::{GpuLayer, UploadedMaps};
use std::f64::consts::PI;
use terrella_imagery::EarthLayers;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};

/// Whole maps on the GPU and what is needed to bind them. Each map has its own sampler: a whole map repeats around the Earth, a tile ends at its
/// border.
pub(crate) struct Maps {
    whole: [Option<GpuLayer>; MAP_LAYERS],
    /// The whole maps as arrays, if they are bound as such.
    arrays: [Option<wgpu::TextureView>; MAP_LAYERS],
    arrangement: MapArrangement,
}

/// Which maps are bound, and how they are filtered.
#[derive(Clone)]
pub(super) struct MapArrangement {
    shown: [bool; MAP_LAYERS],
    layout: wgpu::BindGroupLayout,
    repeat: wgpu::Sampler,
    clamp: wgpu::Sampler,
    /// Whether maps are bound as array textures, of one or more layers.
    are_arrays: bool,
}

/// Offset from the binding of a map's texture to that of its sampler.
const SAMPLERS: u32 = MAP_LAYERS as u32;

impl Maps {
    /// Uses the maps that are already uploaded, and uploads the others. With `display_values` colours are read as stored instead of as linear
    /// light.
    pub fn upload(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        (layers, uploaded): (&EarthLayers, &UploadedMaps),
        display_values: bool,
        shown: [bool; MAP_LAYERS],
        anisotropy: u16,
        are_arrays: bool,
    ) -> Self {
        let whole = MapLayer::ALL.map(|layer| {
            let image = layers.get(layer)?;
            if !image.has_texels() {
                return uploaded.get(layer).map(|map| map.held.clone());
            }
            let label = format!("terrella {}", layer.name());
            Some(GpuLayer::upload(
                device,
                queue,
                &label,
                image,
                display_values,
            ))
        });
        let there = whole.each_ref().map(Option::is_some);
        let mut maps = Self {
            whole,
            arrays: Default::default(),
            arrangement: MapArrangement::new(device, there, shown, anisotropy, are_arrays),
        };
        maps.view_arrays();
        maps
    }

    /// Makes the views of whole maps as arrays.
    fn view_arrays(&mut self) {
        for (array, whole) in self.arrays.iter_mut().zip(&self.whole) {
            let whole = whole.as_ref().filter(|_| self.arrangement.are_arrays);
            *array = whole.map(|whole| array_view(whole.view.texture()));
        }
    }

    /// Uses this arrangement from now on. Earlier bind groups no longer fit.
    pub fn arrange(&mut self, arrangement: MapArrangement) {
        self.arrangement = arrangement;
        self.view_arrays();
    }

    pub fn there(&self) -> [bool; MAP_LAYERS] {
        self.whole.each_ref().map(Option::is_some)
    }

    /// Replaces a whole map, and returns the previous one. Earlier bind groups still hold that.
    pub fn replace(&mut self, layer: MapLayer, map: GpuLayer) -> GpuLayer {
        let place = &mut self.whole[layer.index()];
        let before = place.replace(map.clone()).unwrap_or(map);
        self.view_arrays();
        before
    }

    /// Bytes of the whole maps, mip levels included.
    pub fn bytes(&self) -> u64 {
        self.whole.iter().flatten().map(|layer| layer.bytes).sum()
    }

    /// Largest texel of the maps with synthetic detail, from north to south, equatorial radii. Tiles have smaller ones.
    pub fn largest_texel(&self) -> f64 {
        let detailed = [MapLayer::Day, MapLayer::Clouds].map(|layer| &self.whole[layer.index()]);
        let rows = detailed.into_iter().flatten();
        let rows = rows.map(|map| map.view.texture().height());
        rows.min()
            .map_or(f64::INFINITY, |rows| PI / f64::from(rows))
    }

    /// A bind group of whole maps only.
    pub fn bind_whole(&self, device: &wgpu::Device) -> wgpu::BindGroup {
        self.bind(device, "terrella whole maps", Default::default())
    }

    /// A bind group with these tiles, and the whole map in place of a missing one.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        label: &str,
        tiles: [Option<&wgpu::TextureView>; MAP_LAYERS],
    ) -> wgpu::BindGroup {
        let mut entries = Vec::with_capacity(2 * MAP_LAYERS);
        let MapArrangement { repeat, clamp, .. } = &self.arrangement;
        let shown = self.whole.iter().zip(self.arrangement.shown);
        let shown = (0..).zip(shown).zip(tiles.into_iter().zip(&self.arrays));
        for ((binding, (whole, shown)), (tile, array)) in shown {
            let Some(whole) = whole.as_ref().filter(|_| shown) else {
                continue;
            };
            let (view, sampler) = match tile {
                Some(tile) => (tile, clamp),
                None => (array.as_ref().unwrap_or(&whole.view), repeat),
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
            layout: &self.arrangement.layout,
            entries: &entries,
        })
    }
}

/// A view of a texture as an array, even with one layer.
pub(super) fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("terrella map as an array"),
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

impl MapArrangement {
    /// The maps that exist (`there`) and are drawn (`shown`).
    pub fn new(
        device: &wgpu::Device,
        there: [bool; MAP_LAYERS],
        shown: [bool; MAP_LAYERS],
        anisotropy: u16,
        are_arrays: bool,
    ) -> Self {
        let sampler = |label, address_mode_u| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u,
                // No repetition over the poles.
                address_mode_v: wgpu::AddressMode::ClampToEdge,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                anisotropy_clamp: anisotropy,
                ..Default::default()
            })
        };
        let shown = std::array::from_fn(|n| there[n] && shown[n]);
        let entries: Vec<_> = (0..)
            .zip(shown)
            .filter(|(_, shown)| *shown)
            .flat_map(|(binding, _)| {
                let dimension = match are_arrays {
                    true => wgpu::TextureViewDimension::D2Array,
                    false => wgpu::TextureViewDimension::D2,
                };
                [
                    super::texture_entry(binding, dimension),
                    super::sampler_entry(binding + SAMPLERS),
                ]
            })
            .collect();
        Self {
            shown,
            layout: device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("terrella maps"),
                entries: &entries,
            }),
            repeat: sampler("terrella whole maps", wgpu::AddressMode::Repeat),
            clamp: sampler("terrella tiles", wgpu::AddressMode::ClampToEdge),
            are_arrays,
        }
    }

    /// Whether a map exists and is drawn.
    pub fn has(&self, layer: MapLayer) -> bool {
        self.shown[layer.index()]
    }

    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }
}
