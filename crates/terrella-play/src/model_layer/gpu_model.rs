//! A model on the GPU: its triangles, and its materials with their pictures.

use super::layouts::ModelLayouts;
use super::pipelines::ModelVariant;
use super::textures::{Texels, upload};
use super::uniforms::{ModelMaterial, ModelVertex};
use glam::Vec3;
use std::collections::HashMap;
use std::ops::Range;
use terrella::GpuContext;
use terrella_model::{Material, Model, ModelImage, TextureUse, Wrap};

/// A model's buffers and bind groups.
pub struct GpuModel {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    parts: Vec<GpuPart>,
    triangles: u32,
}

/// Triangles that are drawn together.
pub struct GpuPart {
    material: wgpu::BindGroup,
    /// What they are drawn with, one after the other.
    pub variants: Vec<ModelVariant>,
    /// The joint that they turn with.
    pub joint: Option<usize>,
    /// Middle of their vertices, metres of the model as its file places it.
    pub middle_m: Vec3,
    indices: Range<u32>,
}

impl GpuPart {
    /// Whether it is laid over what is behind it.
    pub fn is_blended(&self) -> bool {
        self.variants.iter().any(|variant| variant.blended)
    }
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
                variants: ModelVariant::of(material),
                joint: part.joint,
                middle_m: middle_m(model, &part.indices),
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
        let draws = self.parts.iter().map(|part| part.variants.len() as u32);
        (self.triangles, draws.sum())
    }

    /// Its parts, in the order of the file.
    pub fn parts(&self) -> &[GpuPart] {
        &self.parts
    }

    /// Sets its buffers.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

impl GpuPart {
    /// Draws it with each of its pipelines; the buffers of its model and the bind group of its joint are set.
    pub fn render<'p>(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: impl Fn(ModelVariant) -> Option<&'p wgpu::RenderPipeline>,
    ) {
        pass.set_bind_group(1, &self.material, &[]);
        for pipeline in self.variants.iter().filter_map(|one| pipeline(*one)) {
            pass.set_pipeline(pipeline);
            pass.draw_indexed(self.indices.clone(), 0, 0..1);
        }
    }
}

/// The mean of the places of some indices.
fn middle_m(model: &Model, indices: &Range<u32>) -> Vec3 {
    let range = indices.start as usize..indices.end as usize;
    let own = model.indices.get(range).unwrap_or_default();
    let places = own
        .iter()
        .filter_map(|index| model.vertices.get(*index as usize));
    let sum: Vec3 = places.map(|vertex| vertex.position_m).sum();
    sum / own.len().max(1) as f32
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
        let normal = material.normal_texture;
        let slots = [
            (material.base_color_texture, Texels::Color),
            (material.metallic_roughness_texture, Texels::Linear),
            (material.emissive_texture, Texels::Color),
        ];
        let normals = normal.map(|texture| (Some(texture), Texels::Linear));
        let slots: Vec<_> = slots
            .into_iter()
            .chain(normals)
            .map(|(texture, texels)| self.texture(texture, texels))
            .collect();
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
            layout: layouts.material(normal.is_some()),
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
