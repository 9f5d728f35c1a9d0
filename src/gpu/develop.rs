//! The development of a picture: exposed light becomes what is shown of it, once, when all layers have added theirs.

use super::shader::ShaderModule;
use super::{DevelopVariant, PassFormat, PipelineDescription, ShaderError};

/// Draws what is shown of exposed light over all of a target: the last pass of a picture whose layers are drawn with
/// [`Development::AfterPass`](super::Development::AfterPass).
///
/// [`ScaledTarget::developing`](super::ScaledTarget::developing) has one, with the texture that is drawn to before it. A host that has such a
/// texture of its own, and passes over its light, calls this in any pass of its own that has drawn nothing yet.
pub struct Developer {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// Where targets are larger than the light.
    sampler: Option<wgpu::Sampler>,
}

/// Exposed light that a [`Developer`] reads.
pub struct UndevelopedPicture(wgpu::BindGroup);

const LABEL: &str = "terrella development";

impl Developer {
    /// For passes of this format, whose colour is of 8 bits a channel, and its tone curve. `is_enlarging` where targets are larger than the light
    /// that is read, which is then enlarged, bilinear.
    ///
    /// # Errors
    /// A shader file that is at fault.
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        is_enlarging: bool,
    ) -> Result<Self, ShaderError> {
        let variant = DevelopVariant {
            target: format.target_color(),
            sampled: is_enlarging,
        };
        let shader = ShaderModule::new(device, &variant)?;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let light = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float {
                filterable: is_enlarging,
            },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let mut entries = vec![entry(0, light)];
        if is_enlarging {
            let filtering = wgpu::SamplerBindingType::Filtering;
            entries.push(entry(1, wgpu::BindingType::Sampler(filtering)));
        }
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(LABEL),
            entries: &entries,
        });
        let pipeline = PipelineDescription {
            label: LABEL,
            bind_groups: Some(&[Some(&layout)]),
            module: &shader.module,
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            format,
            writes_depth: false,
            blend: None,
        };
        Ok(Self {
            pipeline: pipeline.create(device),
            layout,
            sampler: is_enlarging.then(|| super::linear_sampler(device, LABEL)),
        })
    }

    /// Whether targets are larger than the light.
    pub fn is_enlarging(&self) -> bool {
        self.sampler.is_some()
    }

    /// Exposed light to be developed: a float texture without samples, which shaders can read.
    pub fn picture(&self, device: &wgpu::Device, light: &wgpu::TextureView) -> UndevelopedPicture {
        let view = wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(light),
        };
        let sampler = self.sampler.as_ref().map(|sampler| wgpu::BindGroupEntry {
            binding: 1,
            resource: wgpu::BindingResource::Sampler(sampler),
        });
        let entries = Vec::from_iter(std::iter::once(view).chain(sampler));
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &self.layout,
            entries: &entries,
        });
        UndevelopedPicture(bind_group)
    }

    /// Draws what is shown of the light over all of the pass's target. Its alpha stays.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, picture: &UndevelopedPicture) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &picture.0, &[]);
        pass.draw(0..3, 0..1);
    }
}
