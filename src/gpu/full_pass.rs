//! A pass that draws one texture over a whole target.

use super::shader::ShaderModule;
use super::{PassFormat, PipelineDescription, ShaderError, ShaderVariant};

/// The pipeline of such a pass, and the binding of its texture: alone, or with a filtering sampler.
pub(super) struct FullPass {
    label: &'static str,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sampler: Option<wgpu::Sampler>,
    /// Uniforms of the pass, with their bindings.
    uniforms: Vec<(u32, wgpu::Buffer)>,
}

impl FullPass {
    /// For passes of this format. The variant reads the texture at binding 0 of group 0 and, if `is_sampled`, the sampler at 1. `blend` combines
    /// the output with the target; `None` replaces it.
    ///
    /// # Errors
    /// An invalid shader file.
    pub fn new(
        device: &wgpu::Device,
        label: &'static str,
        variant: &impl ShaderVariant,
        format: PassFormat,
        blend: Option<wgpu::BlendState>,
        is_sampled: bool,
    ) -> Result<Self, ShaderError> {
        let none = Vec::new();
        Self::with_uniforms(device, label, variant, format, blend, is_sampled, none)
    }

    /// As [`Self::new`], for a variant that also reads these uniforms, at these bindings.
    ///
    /// # Errors
    /// An invalid shader file.
    pub fn with_uniforms(
        device: &wgpu::Device,
        label: &'static str,
        variant: &impl ShaderVariant,
        format: PassFormat,
        blend: Option<wgpu::BlendState>,
        is_sampled: bool,
        uniforms: Vec<(u32, wgpu::Buffer)>,
    ) -> Result<Self, ShaderError> {
        let shader = ShaderModule::new(device, variant)?;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texels = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float {
                filterable: is_sampled,
            },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let mut entries = vec![entry(0, texels)];
        if is_sampled {
            let filtering = wgpu::SamplerBindingType::Filtering;
            entries.push(entry(1, wgpu::BindingType::Sampler(filtering)));
        }
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        entries.extend(uniforms.iter().map(|(binding, _)| entry(*binding, uniform)));
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        });
        let pipeline = PipelineDescription {
            label,
            bind_groups: Some(&[Some(&layout)]),
            module: &shader.module,
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            format,
            writes_depth: false,
            blend,
        };
        let sampler = is_sampled.then(|| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            })
        });
        Ok(Self {
            label,
            pipeline: pipeline.create(device),
            layout,
            sampler,
            uniforms,
        })
    }

    /// The uniform at a binding.
    pub fn uniform(&self, binding: u32) -> Option<&wgpu::Buffer> {
        let mut uniforms = self.uniforms.iter();
        uniforms.find_map(|(at, buffer)| (*at == binding).then_some(buffer))
    }

    /// Binds a source texture.
    pub fn bind(&self, device: &wgpu::Device, view: &wgpu::TextureView) -> wgpu::BindGroup {
        let bound = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let mut entries = vec![bound(0, wgpu::BindingResource::TextureView(view))];
        if let Some(sampler) = &self.sampler {
            entries.push(bound(1, wgpu::BindingResource::Sampler(sampler)));
        }
        let uniforms = self.uniforms.iter();
        entries
            .extend(uniforms.map(|(binding, buffer)| bound(*binding, buffer.as_entire_binding())));
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Draws the texture over the pass's whole target.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, texture: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, texture, &[]);
        pass.draw(0..3, 0..1);
    }
}
