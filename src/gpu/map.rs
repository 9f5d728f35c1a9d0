//! Maps on the GPU that hosts hold: uploaded on any thread, the host's own textures, or two blended maps.

use super::shader::{MapFadeVariant, ShaderModule};
use super::{DepthBuffer, GpuLayer, PassFormat, PipelineDescription, ShaderError};
use std::sync::Arc;
use terrella_ground::globe::Shading;
use terrella_ground::light::Tone;
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{ImageryError, LayerImage, MapAlbedo, MapGroundKinds, MapSummary};

/// Why a texture cannot serve as a map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The texture lacks a required property.
    #[error("this texture cannot be the {layer} map: {what}")]
    Unfit {
        layer: &'static str,
        /// The property, and what is required.
        what: String,
    },
    /// A map's texels do not fit its description.
    #[error(transparent)]
    Image(#[from] ImageryError),
    /// The Earth was made without this map.
    #[error(
        "the Earth was made without the {0} map, so its shaders read none; provide one when you create it"
    )]
    NotDrawn(&'static str),
    /// The map is drawn with tiles.
    #[error(
        "the {0} map is drawn with the tiles of a pack; give the Earth one without tiles of it, or another pack"
    )]
    Tiled(&'static str),
    /// City lights are drawn as points.
    #[error(
        "city lights are drawn as points in place of their map; make the Earth without EarthOptions::city_lights to draw another map of them"
    )]
    AsPoints,
    /// The shader file is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The device rejected it.
    #[error("the device rejected the map: {0}")]
    Rejected(String),
}

/// Rejects a map that is too large for the device.
pub(crate) fn check_size(
    device: &wgpu::Device,
    layer: MapLayer,
    image: &LayerImage,
) -> Result<(), MapError> {
    let limit = device.limits().max_texture_dimension_2d;
    let (width, height) = (image.width, image.height);
    if width.max(height) <= limit {
        return Ok(());
    }
    let what = format!("it is {width} × {height}; this device takes {limit} texels a side");
    Err(unfit(layer, what))
}

/// A whole map on the GPU, for [`Earth::set_map`](crate::Earth::set_map). Clones share the texture.
///
/// The map covers the whole Earth in plate carrée: its left edge is 180° W, its upper edge the north pole.
#[derive(Clone, Debug)]
pub struct GpuMap {
    layer: MapLayer,
    pub(crate) held: GpuLayer,
    /// Its contribution to the light of the air; unknown for a texture.
    pub(crate) albedo: Option<Arc<MapAlbedo>>,
    /// Where it has land or sea; unknown for a texture.
    pub(crate) kinds: Option<Arc<MapGroundKinds>>,
    /// The shading that its texels were uploaded for; `None` for a texture.
    pub(crate) shading: Option<Shading>,
    /// The device that they were uploaded to; `None` for a texture.
    pub(crate) device: Option<wgpu::Device>,
}

impl GpuMap {
    /// Uploads a map, mip levels included. It may be called on any thread, so that no frame waits for it; the last texels go to the GPU with the
    /// queue's next submission. A large map is submitted in parts, and the call waits for them, so that few copies are in memory at once. `shading`
    /// is the Earth's: the paper's reads colours as stored.
    ///
    /// # Errors
    /// An image whose texels do not fit its description, or that is too large for the device.
    pub fn upload(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layer: MapLayer,
        image: &LayerImage,
        shading: Shading,
    ) -> Result<Self, MapError> {
        image.check()?;
        check_size(device, layer, image)?;
        let held = GpuLayer::upload(device, queue, &label(layer), image, is_stored(shading));
        let summary = MapSummary::of(layer, image);
        Ok(Self::of_summary(layer, held, summary, (device, shading)))
    }

    /// A map whose texels were uploaded to a device for a shading.
    pub(super) fn of_summary(
        layer: MapLayer,
        held: GpuLayer,
        summary: MapSummary,
        (device, shading): (&wgpu::Device, Shading),
    ) -> Self {
        Self {
            layer,
            held,
            albedo: summary.albedo.map(Arc::new),
            kinds: summary.kinds.map(Arc::new),
            shading: Some(shading),
            device: Some(device.clone()),
        }
    }

    /// The whole map with all its mip levels.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.held.view
    }

    /// A texture that the host holds, writes and renders to. Its content at the time of the submission is drawn.
    ///
    /// It needs two dimensions, one layer, one sample, the usage `TEXTURE_BINDING`, and a filterable format. Of a colour map (day) red, green and
    /// blue are read, linear if the format is sRGB; of clouds, night lights and water red, 0…1; of normals red and green, the slopes to east and
    /// north, exaggerated four times. Without mip levels it flickers from far away.
    ///
    /// # Errors
    /// A texture that lacks one of these properties.
    pub fn from_texture(layer: MapLayer, texture: &wgpu::Texture) -> Result<Self, MapError> {
        let size = texture.size();
        let format = texture.format();
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        let is_flat = texture.dimension() == wgpu::TextureDimension::D2;
        let what = if !is_flat || size.depth_or_array_layers != 1 {
            "it is not one layer of two dimensions".to_owned()
        } else if texture.sample_count() != 1 {
            format!("it has {} samples and must have 1", texture.sample_count())
        } else if !texture
            .usage()
            .contains(wgpu::TextureUsages::TEXTURE_BINDING)
        {
            "its usage lacks TEXTURE_BINDING".to_owned()
        } else if format.sample_type(None, None) != Some(filterable) {
            format!("its format {format:?} is not filtered by every device")
        } else {
            let unit = u64::from(format.block_copy_size(None).unwrap_or(0));
            let (across, down) = format.block_dimensions();
            let level_bytes = |level: u32| {
                let side =
                    |length: u32, unit: u32| u64::from((length >> level).max(1).div_ceil(unit));
                side(size.width, across) * side(size.height, down) * unit
            };
            return Ok(Self {
                layer,
                held: GpuLayer {
                    view: super::view(texture),
                    bytes: (0..texture.mip_level_count()).map(level_bytes).sum(),
                },
                albedo: None,
                kinds: None,
                shading: None,
                device: None,
            });
        };
        Err(unfit(layer, what))
    }

    /// A map that is already in use.
    pub(crate) fn of_layer(layer: MapLayer, held: GpuLayer) -> Self {
        Self {
            layer,
            held,
            albedo: None,
            kinds: None,
            shading: None,
            device: None,
        }
    }

    pub fn layer(&self) -> MapLayer {
        self.layer
    }

    /// Width and height, texels.
    pub fn size(&self) -> (u32, u32) {
        let texture = self.held.view.texture();
        (texture.width(), texture.height())
    }

    /// Bytes of its texels, mip levels included.
    pub fn bytes(&self) -> u64 {
        self.held.bytes
    }
}

/// The label of a map's texture.
pub(super) fn label(layer: MapLayer) -> String {
    format!("terrella {}", layer.name())
}

/// Whether colours are read as stored instead of as linear light.
pub(super) fn is_stored(shading: Shading) -> bool {
    shading == Shading::Paper
}

pub(super) fn unfit(layer: MapLayer, what: String) -> MapError {
    MapError::Unfit {
        layer: layer.name(),
        what,
    }
}

/// A map that fades into another: clouds of one hour into those of the next, one month into the next.
///
/// It has its own texture, which the Earth is drawn with, and renders the blend of two maps into it.
pub struct MapFade {
    map: GpuMap,
    levels: Vec<wgpu::TextureView>,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    weight: wgpu::Buffer,
}

const LABEL: &str = "terrella map fade";

impl MapFade {
    /// Creates the texture, of this size: for colours (day), or clouds, night lights and water.
    ///
    /// # Errors
    /// The map of slopes, whose format cannot be rendered to, or a size that the device rejects.
    pub fn new(
        device: &wgpu::Device,
        layer: MapLayer,
        (width, height): (u32, u32),
    ) -> Result<Self, MapError> {
        let format = match layer {
            MapLayer::Day => wgpu::TextureFormat::Rgba8UnormSrgb,
            MapLayer::Clouds | MapLayer::NightLights | MapLayer::Water => {
                wgpu::TextureFormat::R8Unorm
            }
            MapLayer::Normals => {
                let what = "slopes are stored in a format that is not drawn to; set them at once";
                return Err(unfit(layer, what.to_owned()));
            }
        };
        let limit = device.limits().max_texture_dimension_2d;
        if width.min(height) == 0 || width.max(height) > limit {
            let what =
                format!("{width} × {height} texels; this device takes 1 to {limit} texels a side");
            return Err(unfit(layer, what));
        }
        let count = width.max(height).ilog2() + 1;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(LABEL),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: count,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let levels = (0..count).map(|level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some(LABEL),
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        });
        let levels = levels.collect();
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let map = |binding| super::texture_entry(binding, wgpu::TextureViewDimension::D2);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(LABEL),
            entries: &[
                map(0),
                map(1),
                super::sampler_entry(2),
                super::uniform_entry(3, fragment, size_of::<[f32; 4]>()),
            ],
        });
        let shader = ShaderModule::new(device, &MapFadeVariant)?;
        let pipeline = PipelineDescription {
            label: LABEL,
            bind_groups: Some(&[Some(&layout)]),
            module: &shader.module,
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            format: PassFormat {
                color: format,
                further: &[],
                samples: 1,
                depth: DepthBuffer::None,
                development: Default::default(),
                tone: Tone::default(),
                bloom: Default::default(),
                grade: Default::default(),
            },
            writes_depth: false,
            blend: None,
        }
        .create(device);
        Ok(Self {
            map: GpuMap::from_texture(layer, &texture)?,
            levels,
            pipeline,
            layout,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(LABEL),
                address_mode_u: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
            weight: super::uniform_buffer::<[f32; 4]>(device, LABEL),
        })
    }

    /// The map that is rendered to: set it on the Earth once.
    pub fn map(&self) -> &GpuMap {
        &self.map
    }

    /// The same map with the blended contribution of both maps to the light of the air: set it on the Earth from time to time during a fade.
    pub fn map_between(&self, (from, to): (&GpuMap, &GpuMap), weight: f32) -> GpuMap {
        let albedo = from.albedo.as_ref().zip(to.albedo.as_ref());
        let weight = if weight > 0.0 { weight.min(1.0) } else { 0.0 };
        let albedo = albedo.map(|(from, to)| Arc::new(MapAlbedo::between(from, to, weight)));
        GpuMap {
            albedo,
            ..self.map.clone()
        }
    }

    /// Renders the blend of two maps: `weight` 0 is `from`, 1 is `to`; NaN counts as 0. Call it once for each submission of `encoder`. It costs
    /// about as much as reading both maps once.
    pub fn draw(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        (from, to): (&GpuMap, &GpuMap),
        weight: f32,
    ) {
        let weight = if weight > 0.0 { weight.min(1.0) } else { 0.0 };
        let uniform = [weight, 0.0, 0.0, 0.0];
        queue.write_buffer(&self.weight, 0, bytemuck::bytes_of(&uniform));
        let bound = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &self.layout,
            entries: &[
                bound(0, wgpu::BindingResource::TextureView(&from.held.view)),
                bound(1, wgpu::BindingResource::TextureView(&to.held.view)),
                bound(2, wgpu::BindingResource::Sampler(&self.sampler)),
                bound(3, self.weight.as_entire_binding()),
            ],
        });
        for level in &self.levels {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(LABEL),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: level,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        // Every texel is overwritten; clearing avoids a load.
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
