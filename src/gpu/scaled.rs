//! A picture that is drawn to a texture of its own before it is shown: at a lower resolution, as light that is developed, or both.

use super::shader::ShaderModule;
use super::{
    Attachments, DepthBuffer, Developer, Development, PassFormat, PassPart, PipelineDescription,
    ShaderError, TargetColor, UndevelopedPicture, UpscaleVariant, color_texture,
};
use terrella_ground::light::Tone;

/// Draws a picture at one size and shows it at another, for [`Quality::scale`](crate::Quality::scale): what a pass needs, the
/// texture that is drawn to in between, and the pass that enlarges it, bilinear in light.
///
/// A host calls [`Self::drawn_size`] for `prepare`, [`Self::begin_pass`] for the pass of all that is drawn, and after it
/// [`Self::finish`]; then come its own things that want every pixel, as text does. Where both sizes are the same there is no
/// texture in between, the pass draws to the target itself and `finish` does nothing. A host with passes and textures of its
/// own needs none of this: it draws its pass at [`Quality::drawn_size`](crate::Quality::drawn_size).
///
/// One that is [developing](Self::developing) always has a texture in between, of light: what is drawn is added up there and developed in
/// `finish`.
pub struct ScaledTarget {
    format: wgpu::TextureFormat,
    size: (u32, u32),
    drawn_size: (u32, u32),
    samples: u32,
    /// By which curve light is developed; `None` where layers do that themselves.
    tone: Option<Tone>,
    attachments: Attachments,
    between: Option<Between>,
}

/// The texture that is drawn to before the picture, and what draws the picture of it.
struct Between {
    view: wgpu::TextureView,
    last: LastPass,
}

/// What draws the picture over all of its target.
enum LastPass {
    Enlarging {
        pipeline: wgpu::RenderPipeline,
        bind_group: wgpu::BindGroup,
    },
    Developing(Developer, UndevelopedPicture),
}

impl ScaledTarget {
    /// Colour format of the pass before development.
    pub const LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

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
        let between = match size == drawn_size {
            true => None,
            false => Some(Between::enlarging(device, format, drawn_size)?),
        };
        Ok(Self {
            format,
            size,
            drawn_size,
            samples,
            tone: None,
            attachments: Attachments::new(device, drawn_size, format, samples),
            between,
        })
    }

    /// The same for layers that are drawn with [`Development::AfterPass`]: the pass has the colour format [`Self::LIGHT`], and `finish` shows
    /// what it drew by a tone curve. The device can draw to that format with so many samples.
    ///
    /// # Errors
    /// A shader file that is at fault.
    pub fn developing(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
        samples: u32,
        tone: Tone,
    ) -> Result<Self, ShaderError> {
        let developer = developer_for(device, format, tone, size != drawn_size)?;
        Ok(Self {
            format,
            size,
            drawn_size,
            samples,
            tone: Some(tone),
            attachments: Attachments::new(device, drawn_size, Self::LIGHT, samples),
            between: Some(Between::developing(device, drawn_size, developer)),
        })
    }

    /// For layers of this pass, shown in `format`: developing where they leave it to be done after the pass.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_pass(
        device: &wgpu::Device,
        pass: &PassFormat,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
    ) -> Result<Self, ShaderError> {
        match pass.development {
            Development::InPass => Self::new(device, format, size, drawn_size, pass.samples),
            Development::AfterPass => {
                Self::developing(device, format, size, drawn_size, pass.samples, pass.tone)
            }
        }
    }

    /// Whether there is a texture that is drawn to before the picture.
    pub fn has_texture(&self) -> bool {
        self.between.is_some()
    }

    /// Colour format of the pass that all is drawn in.
    pub fn drawn_format(&self) -> wgpu::TextureFormat {
        match self.tone {
            Some(_) => Self::LIGHT,
            None => self.format,
        }
    }

    /// Clears passes from now on to space that hides nothing: alpha is how much of what is behind is hidden.
    pub fn make_space_transparent(&mut self) {
        self.attachments.make_space_transparent();
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
        if (size, drawn_size, samples) == (self.size, self.drawn_size, self.samples) {
            return Ok(());
        }
        let is_enlarging = size != drawn_size;
        let between = match self.tone {
            None if !is_enlarging => None,
            None => Some(Between::enlarging(device, self.format, drawn_size)?),
            Some(tone) => {
                let developer = match self.between.take() {
                    Some(between) => between.developer(is_enlarging),
                    None => None,
                };
                let developer = match developer {
                    Some(developer) => developer,
                    None => developer_for(device, self.format, tone, is_enlarging)?,
                };
                Some(Between::developing(device, drawn_size, developer))
            }
        };
        let format = self.drawn_format();
        self.between = between;
        self.attachments = self.attachments.remade(device, drawn_size, format, samples);
        (self.size, self.drawn_size, self.samples) = (size, drawn_size, samples);
        Ok(())
    }

    /// Begins the pass of all that is drawn: black space, depth infinitely far. `target` is what is shown.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        self.begin_part(encoder, target, PassPart::default(), None)
    }

    /// Begins a part of that pass, as [`FrameTargets::begin_part`](super::FrameTargets::begin_part).
    pub fn begin_part<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        part: PassPart,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let between = self.between.as_ref().map(|between| &between.view);
        self.attachments
            .begin_part(encoder, between.unwrap_or(target), part, times)
    }

    /// Draws what that pass drew over all of `target`.
    pub fn finish(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(between) = &self.between else {
            return;
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella picture"),
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
            timestamp_writes: times,
            ..Default::default()
        });
        match &between.last {
            LastPass::Enlarging {
                pipeline,
                bind_group,
            } => {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, bind_group, &[]);
                pass.draw(0..3, 0..1);
            }
            LastPass::Developing(developer, picture) => developer.render(&mut pass, picture),
        }
    }
}

/// A developer of pictures of this format.
fn developer_for(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    tone: Tone,
    is_enlarging: bool,
) -> Result<Developer, ShaderError> {
    let format = PassFormat {
        color: format,
        further: &[],
        samples: 1,
        depth: DepthBuffer::None,
        development: Development::InPass,
        tone,
    };
    Developer::new(device, format, is_enlarging)
}

impl Between {
    /// Its developer, if that enlarges or does not as asked for.
    fn developer(self, is_enlarging: bool) -> Option<Developer> {
        match self.last {
            LastPass::Developing(developer, _) => {
                (developer.is_enlarging() == is_enlarging).then_some(developer)
            }
            LastPass::Enlarging { .. } => None,
        }
    }

    fn developing(device: &wgpu::Device, size: (u32, u32), developer: Developer) -> Self {
        let view = between_view(device, "terrella light", size, ScaledTarget::LIGHT);
        let picture = developer.picture(device, &view);
        Self {
            view,
            last: LastPass::Developing(developer, picture),
        }
    }

    fn enlarging(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> Result<Self, ShaderError> {
        let label = "terrella upscale";
        let view = between_view(device, label, size, format);
        let pass = PassFormat {
            color: format,
            further: &[],
            samples: 1,
            depth: DepthBuffer::None,
            development: Development::InPass,
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
        let sampler = super::linear_sampler(device, label);
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
        let last = LastPass::Enlarging {
            pipeline,
            bind_group,
        };
        Ok(Self { view, last })
    }
}

/// A texture that is drawn to and then read.
fn between_view(
    device: &wgpu::Device,
    label: &str,
    size: (u32, u32),
    format: wgpu::TextureFormat,
) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    super::view(&color_texture(device, label, size, format, 1, usage))
}
