//! A model on the GPU: its triangles, and its materials with their pictures.

use super::textures::{Texels, upload};
use super::uniforms::{ModelMaterial, ModelVertex};
use std::collections::HashMap;
use std::ops::Range;
use terrella::GpuContext;
use terrella_model::{Material, Model, ModelImage, TextureUse, Wrap};

/// Bind group layouts of the model shader: spacecraft and material.
pub struct ModelLayouts {
    pub frame: wgpu::BindGroupLayout,
    pub material: wgpu::BindGroupLayout,
}

impl ModelLayouts {
    pub fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries,
            })
        };
        Self {
            frame: layout(
                "terrella model craft",
                &[entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, uniform)],
            ),
            material: layout(
                "terrella model material",
                &[
                    entry(0, fragment, uniform),
                    entry(1, fragment, texture),
                    entry(2, fragment, sampler),
                    entry(3, fragment, texture),
                    entry(4, fragment, sampler),
                    entry(5, fragment, texture),
                    entry(6, fragment, sampler),
                ],
            ),
        }
    }
}

/// A model's buffers and bind groups.
pub struct GpuModel {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    parts: Vec<GpuPart>,
    triangles: u32,
}

struct GpuPart {
    material: wgpu::BindGroup,
    is_double_sided: bool,
    indices: Range<u32>,
}

/// Pictures and samplers that are made once.
struct Pictures<'m> {
    gpu: &'m GpuContext,
    images: &'m [ModelImage],
    views: HashMap<(Option<usize>, Texels), wgpu::TextureView>,
    samplers: HashMap<[Wrap; 2], wgpu::Sampler>,
}

impl GpuModel {
    pub fn new(gpu: &GpuContext, layouts: &ModelLayouts, model: &Model) -> Self {
        let vertices: Vec<_> = model.vertices.iter().map(ModelVertex::from).collect();
        let mut pictures = Pictures {
            gpu,
            images: &model.images,
            views: HashMap::new(),
            samplers: HashMap::new(),
        };
        let parts = model.parts.iter().map(|part| {
            let default = Material::default();
            let material = model.materials.get(part.material).unwrap_or(&default);
            GpuPart {
                material: pictures.bind(layouts, material),
                is_double_sided: material.double_sided,
                indices: part.indices.clone(),
            }
        });
        Self {
            parts: parts.collect(),
            vertices: buffer(
                gpu,
                "terrella model vertices",
                bytemuck::cast_slice(&vertices),
                wgpu::BufferUsages::VERTEX,
            ),
            indices: buffer(
                gpu,
                "terrella model indices",
                bytemuck::cast_slice(&model.indices),
                wgpu::BufferUsages::INDEX,
            ),
            triangles: model.indices.len() as u32 / 3,
        }
    }

    /// Triangles and draw calls.
    pub fn counts(&self) -> (u32, u32) {
        (self.triangles, self.parts.len() as u32)
    }

    /// Draws it with `one_sided` and `two_sided`; the bind group of the craft is set.
    pub fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        [one_sided, two_sided]: &[wgpu::RenderPipeline; 2],
    ) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for part in &self.parts {
            pass.set_pipeline(match part.is_double_sided {
                true => two_sided,
                false => one_sided,
            });
            pass.set_bind_group(1, &part.material, &[]);
            pass.draw_indexed(part.indices.clone(), 0, 0..1);
        }
    }
}

impl Pictures<'_> {
    fn bind(&mut self, layouts: &ModelLayouts, material: &Material) -> wgpu::BindGroup {
        let gpu = self.gpu;
        let numbers = buffer(
            gpu,
            "terrella model material",
            bytemuck::bytes_of(&ModelMaterial::from(material)),
            wgpu::BufferUsages::UNIFORM,
        );
        let slots = [
            (material.base_color_texture, Texels::Color),
            (material.metallic_roughness_texture, Texels::Linear),
            (material.emissive_texture, Texels::Color),
        ];
        let slots = slots.map(|(texture, texels)| self.texture(texture, texels));
        let mut entries = vec![wgpu::BindGroupEntry {
            binding: 0,
            resource: numbers.as_entire_binding(),
        }];
        for (slot, (view, sampler)) in (0..).zip(&slots) {
            entries.push(wgpu::BindGroupEntry {
                binding: 2 * slot + 1,
                resource: wgpu::BindingResource::TextureView(view),
            });
            entries.push(wgpu::BindGroupEntry {
                binding: 2 * slot + 2,
                resource: wgpu::BindingResource::Sampler(sampler),
            });
        }
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrella model material"),
            layout: &layouts.material,
            entries: &entries,
        })
    }

    /// A texture with its sampler; white if a material has none.
    fn texture(
        &mut self,
        texture: Option<TextureUse>,
        texels: Texels,
    ) -> (wgpu::TextureView, wgpu::Sampler) {
        let wrap = texture.map_or([Wrap::Repeat; 2], |texture| texture.wrap);
        let image = texture.map(|texture| texture.image);
        let gpu = self.gpu;
        let picture = image.and_then(|image| self.images.get(image));
        let view = self.views.entry((image, texels)).or_insert_with(|| {
            let white = ModelImage {
                size: (1, 1),
                rgba: vec![255; 4],
            };
            upload(gpu, picture.unwrap_or(&white), texels)
        });
        let sampler = self.samplers.entry(wrap).or_insert_with(|| {
            let [across, down] = wrap.map(|wrap| match wrap {
                Wrap::Repeat => wgpu::AddressMode::Repeat,
                Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
                Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
            });
            gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("terrella model picture"),
                address_mode_u: across,
                address_mode_v: down,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            })
        });
        (view.clone(), sampler.clone())
    }
}

/// A buffer that holds these bytes.
pub fn buffer(
    gpu: &GpuContext,
    label: &'static str,
    bytes: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let made = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&made, 0, bytes);
    made
}
