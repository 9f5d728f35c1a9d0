//! An image that is rendered to an intermediate texture before it is shown: at a lower resolution, as light to be developed, or both.

use super::bloom::BloomPass;
use super::develop::{developing_pass, set_frame};
use super::full_pass::FullPass;
use super::{
    Attachments, DepthBuffer, Development, PassFormat, PassPart, ShaderError, TargetColor,
    UpscaleVariant, color_texture,
};
use terrella_ground::light::{Bloom, Grade, Tone};

/// Renders an image at one size and shows it at another, for [`Quality::scale`](crate::Quality::scale): the attachments of the pass, the
/// intermediate texture, and the pass that enlarges it, bilinearly in linear light.
///
/// A host passes [`Self::drawn_size`] to `prepare`, draws everything in the pass of [`Self::begin_pass`], and then calls [`Self::finish`]. After
/// that it draws its own overlays that need full resolution, such as text. If both sizes are equal, there is no intermediate texture: the pass
/// draws to the target itself and `finish` does nothing. A host with its own passes and textures does not need this type: it renders at
/// [`Quality::drawn_size`](crate::Quality::drawn_size).
///
/// A target that is [developing](Self::developing) always has an intermediate texture: light is accumulated there and developed in `finish`.
pub struct ScaledTarget {
    format: wgpu::TextureFormat,
    size: (u32, u32),
    drawn_size: (u32, u32),
    samples: u32,
    /// How light is developed; `None` if layers are developed in the pass.
    look: Option<Look>,
    attachments: Attachments,
    between: Option<Between>,
}

/// How light is developed.
#[derive(Clone, Copy)]
struct Look {
    tone: Tone,
    bloom: Bloom,
    grade: Grade,
}

/// The intermediate texture, and the pass that draws the image from it.
struct Between {
    view: wgpu::TextureView,
    bloom: Option<BloomPass>,
    last: FullPass,
    bound: wgpu::BindGroup,
}

impl ScaledTarget {
    /// Colour format of the pass before development.
    pub const LIGHT: wgpu::TextureFormat = super::bloom::LIGHT;

    /// For targets of this format and `size`, rendered at `drawn_size` with `samples` a pixel. Depth is
    /// [`FrameTargets::DEPTH`](super::FrameTargets::DEPTH), reversed.
    ///
    /// Sizes are in pixels, not zero, and within the device's limits. The device must support the format with this sample count.
    ///
    /// # Errors
    /// An invalid shader file.
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
        samples: u32,
    ) -> Result<Self, ShaderError> {
        Self::with_look(device, format, size, drawn_size, samples, None)
    }

    /// As [`Self::new`], for layers that are drawn with [`Development::AfterPass`]: the pass has the colour format [`Self::LIGHT`], and `finish`
    /// applies bloom and tone curve. The device must support that format with this sample count.
    ///
    /// # Errors
    /// An invalid shader file.
    pub fn developing(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
        samples: u32,
        tone: Tone,
        bloom: Bloom,
    ) -> Result<Self, ShaderError> {
        let look = Look {
            tone,
            bloom,
            grade: Grade::NONE,
        };
        Self::with_look(device, format, size, drawn_size, samples, Some(look))
    }

    fn with_look(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        drawn_size: (u32, u32),
        samples: u32,
        look: Option<Look>,
    ) -> Result<Self, ShaderError> {
        let drawn_format = drawn_format(format, look.as_ref());
        let last = last_pass(device, format, look.as_ref(), size != drawn_size)?;
        let bloom = look.map(|look| look.bloom).unwrap_or_default();
        let between = last.map(|last| Between::new(device, drawn_format, drawn_size, last, &bloom));
        Ok(Self {
            format,
            size,
            drawn_size,
            samples,
            look,
            attachments: Attachments::new(device, drawn_size, drawn_format, samples),
            between: between.transpose()?,
        })
    }

    /// For layers of this pass, shown in `format`. It is developing if they are developed after the pass.
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
                let look = Look {
                    tone: pass.tone,
                    bloom: pass.bloom,
                    grade: pass.grade,
                };
                Self::with_look(device, format, size, drawn_size, pass.samples, Some(look))
            }
        }
    }

    /// Whether there is an intermediate texture.
    pub fn has_texture(&self) -> bool {
        self.between.is_some()
    }

    /// Colour format of the pass that everything is drawn in.
    pub fn drawn_format(&self) -> wgpu::TextureFormat {
        drawn_format(self.format, self.look.as_ref())
    }

    /// Clears passes to transparent space from now on: alpha is the opacity over the background.
    pub fn make_space_transparent(&mut self) {
        self.attachments.make_space_transparent();
    }

    /// Width and height of the shown image, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Width and height of the rendered image, pixels: those for `prepare`.
    pub fn drawn_size(&self) -> (u32, u32) {
        self.drawn_size
    }

    /// Samples a pixel of its passes.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Changes sizes or sample count. Unchanged parts are not created again.
    ///
    /// # Errors
    /// As [`Self::new`]. It is then unchanged.
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
        let format = self.drawn_format();
        let is_enlarging = size != drawn_size;
        let is_other = is_enlarging != (self.size != self.drawn_size);
        let last = match is_other {
            true => last_pass(device, self.format, self.look.as_ref(), is_enlarging)?,
            false => None,
        };
        match &mut self.between {
            Some(between) if !is_other || last.is_some() => {
                between.set(device, format, drawn_size, last);
            }
            _ => {
                let bloom = self.look.map(|look| look.bloom).unwrap_or_default();
                let made = |last| Between::new(device, format, drawn_size, last, &bloom);
                self.between = last.map(made).transpose()?;
            }
        }
        self.attachments = self.attachments.remade(device, drawn_size, format, samples);
        (self.size, self.drawn_size, self.samples) = (size, drawn_size, samples);
        Ok(())
    }

    /// Begins the pass that everything is drawn in: black space, depth infinitely far. `target` is the shown image.
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

    /// Selects the film grain of a frame for [`Self::finish`] from now on. No effect without grain.
    pub fn set_frame(&self, queue: &wgpu::Queue, frame: u32) {
        if let (Some(between), Some(look)) = (&self.between, &self.look) {
            set_frame(&between.last, queue, &look.grade, frame);
        }
    }

    /// Draws the rendered image over the whole of `target`.
    pub fn finish(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(between) = &self.between else {
            return;
        };
        let mut times = times;
        if let Some(bloom) = between.bloom.as_ref().filter(|bloom| bloom.has_levels()) {
            bloom.record(encoder, begin_of(&mut times));
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    // Every pixel is overwritten; clearing avoids a load.
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            timestamp_writes: times,
            ..Default::default()
        });
        between.last.render(&mut pass, &between.bound);
    }
}

impl Between {
    fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        last: FullPass,
        bloom: &Bloom,
    ) -> Result<Self, ShaderError> {
        let view = drawn_view(device, format, size);
        let bloom = match format {
            ScaledTarget::LIGHT => BloomPass::new(device, bloom, &view, size)?,
            _ => None,
        };
        Ok(Self {
            bound: last.bind(device, &view),
            view,
            bloom,
            last,
        })
    }

    /// Creates a texture of this size, and replaces the last pass if one is given. The passes of the lens stay.
    fn set(
        &mut self,
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        last: Option<FullPass>,
    ) {
        if let Some(last) = last {
            self.last = last;
        }
        self.view = drawn_view(device, format, size);
        self.bound = self.last.bind(device, &self.view);
        if let Some(bloom) = &mut self.bloom {
            bloom.set_light(device, &self.view, size);
        }
    }
}

/// The intermediate texture.
fn drawn_view(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    size: (u32, u32),
) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    super::view(&color_texture(
        device,
        "terrella drawn",
        size,
        format,
        1,
        usage,
    ))
}

/// Colour format of the pass that everything is drawn in, for a shown image of this format.
fn drawn_format(format: wgpu::TextureFormat, look: Option<&Look>) -> wgpu::TextureFormat {
    match look {
        Some(_) => ScaledTarget::LIGHT,
        None => format,
    }
}

/// The pass that turns the intermediate texture into the image; `None` if the image is rendered directly.
fn last_pass(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    look: Option<&Look>,
    is_enlarging: bool,
) -> Result<Option<FullPass>, ShaderError> {
    let pass = PassFormat {
        color: format,
        further: &[],
        samples: 1,
        depth: DepthBuffer::None,
        development: Development::InPass,
        tone: look.map(|look| look.tone).unwrap_or_default(),
        bloom: Bloom::default(),
        grade: look.map(|look| look.grade).unwrap_or_default(),
    };
    if look.is_some() {
        return developing_pass(device, pass, is_enlarging).map(Some);
    }
    if !is_enlarging {
        return Ok(None);
    }
    let filterable = wgpu::TextureSampleType::Float { filterable: true };
    let variant = match pass.target_color() {
        TargetColor::Display(_) => UpscaleVariant::LoadedDisplay,
        _ if format.sample_type(None, Some(device.features())) == Some(filterable) => {
            UpscaleVariant::Sampled
        }
        _ => UpscaleVariant::Loaded,
    };
    let is_sampled = variant == UpscaleVariant::Sampled;
    FullPass::new(device, "terrella upscale", &variant, pass, None, is_sampled).map(Some)
}

/// Moves the timestamp at the beginning of a pass to an earlier pass.
fn begin_of<'q>(
    times: &mut Option<wgpu::RenderPassTimestampWrites<'q>>,
) -> Option<wgpu::RenderPassTimestampWrites<'q>> {
    let times = times.as_mut()?;
    Some(wgpu::RenderPassTimestampWrites {
        query_set: times.query_set,
        beginning_of_pass_write_index: times.beginning_of_pass_write_index.take(),
        end_of_pass_write_index: None,
    })
}
