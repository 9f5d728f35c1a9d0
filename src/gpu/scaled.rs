//! A picture drawn at a lower resolution than it is shown in.

use super::shader::ShaderModule;
use super::{
    Attachments, DepthBuffer, PassFormat, PipelineDescription, ShaderError, TargetColor,
    UpscaleVariant, color_texture,
};
use terrella_ground::light::Tone;

/// Draws a picture at one size and shows it at another, for [`Quality::scale`](crate::Quality::scale): what a pass needs, the
/// texture that is drawn to in between, and the pass that enlarges it, bilinear in light.
///
/// A host calls [`Self::drawn_size`] for `prepare`, [`Self::begin_pass`] for the pass of all that is drawn, and after it
/// [`Self::enlarge`]; then come its own things that want every pixel, as text does. Where both sizes are the same there is no
/// texture in between, the pass draws to the target itself and `enlarge` does nothing. A host with passes and textures of its
/// own needs none of this: it draws its pass at [`Quality::drawn_size`](crate::Quality::drawn_size).
pub struct ScaledTarget {
    format: wgpu::TextureFormat,
    size: (u32, u32),
    drawn_size: (u32, u32),
    samples: u32,
    attachments: Attachments,
    smaller: Option<Smaller>,
}

/// The picture before it is enlarged.
struct Smaller {
    view: wgpu::TextureView,
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
}

impl ScaledTarget {
    /// For targets of this format and `size`, drawn at `drawn_size` with `samples` a pixel. Depth is
    /// [`FrameTargets::DEPTH`](super::FrameTargets::DEPTH), reversed.
    ///
    /// Sizes are pixels, not zero, and within the device's limits; the device can draw to the format with so many samples.
    ///
    /// # Errors
    /// A shader file that is at fault.
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
        samples: u32,
    ) -> Result<Self, ShaderError> {
        let smaller = match size == drawn_size {
            true => None,
            false => Some(Smaller::new(device, format, drawn_size)?),
        };
        Ok(Self {
            format,
            size,
            drawn_size,
            samples,
            attachments: Attachments::new(device, drawn_size, format, samples),
            smaller,
        })
    }

    /// Width and height of what is shown, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Width and height of what is drawn, pixels: those for `prepare`.
    pub fn drawn_size(&self) -> (u32, u32) {
        self.drawn_size
    }

    /// Samples a pixel of its passes.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The same with other sizes or samples; what is as it was is not made anew.
    ///
    /// # Errors
    /// As [`Self::new`]; it is then as it was.
    pub fn set(
        &mut self,
        device: &wgpu::Device,
        size: (u32, u32),
        drawn_size: (u32, u32),
        samples: u32,
    ) -> Result<(), ShaderError> {
        if (size, drawn_size, samples) != (self.size, self.drawn_size, self.samples) {
            *self = Self::new(device, self.format, size, drawn_size, samples)?;
        }
        Ok(())
    }

    /// Begins the pass of all that is drawn: black space, depth infinitely far. `target` is what is shown.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        let smaller = self.smaller.as_ref().map(|smaller| &smaller.view);
        self.attachments
            .begin_pass(encoder, smaller.unwrap_or(target))
    }

    /// Draws what that pass drew over all of `target`.
    pub fn enlarge(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView) {
        let Some(smaller) = &self.smaller else {
            return;
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella upscale"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    // Every pixel is drawn over; this spares reading what was there.
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&smaller.pipeline);
        pass.set_bind_group(0, &smaller.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Smaller {
    fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> Result<Self, ShaderError> {
        let label = "terrella upscale";
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = color_texture(device, label, size, format, 1, usage);
        let view = super::view(&texture);
        let pass = PassFormat {
            color: format,
            further: &[],
            samples: 1,
            depth: DepthBuffer::None,
            tone: Tone::default(),
        };
        let features = device.features();
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        let variant = match pass.target_color() {
            TargetColor::Display(_) => UpscaleVariant::LoadedDisplay,
            _ if format.sample_type(None, Some(features)) == Some(filterable) => {
                UpscaleVariant::Sampled
            }
            _ => UpscaleVariant::Loaded,
        };
        let is_sampled = variant == UpscaleVariant::Sampled;
        let shader = ShaderModule::new(device, &variant)?;
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some(label),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
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
        let bound = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let view_bound = bound(0, wgpu::BindingResource::TextureView(&view));
        let mut bindings = vec![(entry(0, texels), view_bound)];
        if is_sampled {
            let filtering = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
            let sampler = bound(1, wgpu::BindingResource::Sampler(&sampler));
            bindings.push((entry(1, filtering), sampler));
        }
        let (layout, bind_group) = super::bind(device, label, bindings);
        let pipeline = PipelineDescription {
            label,
            bind_groups: Some(&[Some(&layout)]),
            module: &shader.module,
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            format: pass,
            writes_depth: false,
            blend: None,
        }
        .create(device);
        Ok(Self {
            view,
            pipeline,
            bind_group,
        })
    }
}
