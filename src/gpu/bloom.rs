//! Bloom: light that a lens scatters around bright objects, as ever coarser images of the light, blended back into it.

use super::full_pass::FullPass;
use super::{BloomVariant, DepthBuffer, Development, PassFormat, ShaderError, color_texture};
use terrella_ground::light::Bloom;

/// Format of the light.
pub(super) const LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Applies a [`Bloom`] to the light of an image, in place, before it is developed.
///
/// Each level is half as large as the one before. On the way back each is blended with the next coarser one, so that light taken from a pixel
/// arrives at others: none is lost except over the edges of the image.
pub struct BloomPass {
    bloom: Bloom,
    coarser: FullPass,
    coarser_light: FullPass,
    finer: FullPass,
    levels: Vec<Level>,
    light: wgpu::TextureView,
}

/// An image of half the size of the level before.
struct Level {
    view: wgpu::TextureView,
    /// Reads the level before.
    from: wgpu::BindGroup,
    /// Reads this level.
    to: wgpu::BindGroup,
    /// Fraction of the level before that is replaced by this one.
    share: f64,
}

impl BloomPass {
    /// For light of [`ScaledTarget::LIGHT`](super::ScaledTarget::LIGHT), rendered at this size, pixels. The texture can be rendered to and read by
    /// shaders. `None` if the lens scatters nothing.
    ///
    /// # Errors
    /// An invalid shader file.
    pub fn new(
        device: &wgpu::Device,
        bloom: &Bloom,
        light: &wgpu::TextureView,
        size: (u32, u32),
    ) -> Result<Option<Self>, ShaderError> {
        if bloom.strength <= 0.0 {
            return Ok(None);
        }
        let mut pass = Self {
            bloom: *bloom,
            coarser: pass(device, BloomVariant::Coarser)?,
            coarser_light: pass(device, BloomVariant::CoarserLight)?,
            finer: pass(device, BloomVariant::Finer)?,
            levels: Vec::new(),
            light: light.clone(),
        };
        pass.set_light(device, light, size);
        Ok(Some(pass))
    }

    /// Applies bloom to another texture of light from now on.
    pub fn set_light(
        &mut self,
        device: &wgpu::Device,
        light: &wgpu::TextureView,
        size: (u32, u32),
    ) {
        self.light = light.clone();
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let mut levels: Vec<Level> = Vec::new();
        let mut size = size;
        for share in self.bloom.shares(size) {
            size = (size.0.div_ceil(2), size.1.div_ceil(2));
            let texture = color_texture(device, "terrella bloom", size, LIGHT, 1, usage);
            let view = super::view(&texture);
            levels.push(Level {
                from: match levels.last() {
                    None => self.coarser_light.bind(device, light),
                    Some(before) => self.coarser.bind(device, &before.view),
                },
                to: self.finer.bind(device, &view),
                view,
                share,
            });
        }
        self.levels = levels;
    }

    /// Whether there is a pass: an image of a few pixels is too small for one.
    pub(super) fn has_levels(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Records the passes over the light that has been drawn. `begins` receives the time at which the first pass begins.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut begins: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut draw = |pass: &FullPass, source, target, share: Option<f64>| {
            let load = match share {
                Some(_) => wgpu::LoadOp::Load,
                // Every pixel is overwritten; clearing avoids a load.
                None => wgpu::LoadOp::Clear(wgpu::Color::BLACK),
            };
            let mut drawn = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("terrella bloom"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load,
                        store: wgpu::StoreOp::Store,
                    },
                })],
                timestamp_writes: begins.take(),
                ..Default::default()
            });
            if let Some(part) = share {
                let (r, g, b) = (part, part, part);
                drawn.set_blend_constant(wgpu::Color { r, g, b, a: part });
            }
            pass.render(&mut drawn, source);
        };
        for (index, level) in self.levels.iter().enumerate() {
            let pass = match index {
                0 => &self.coarser_light,
                _ => &self.coarser,
            };
            draw(pass, &level.from, &level.view, None);
        }
        for (index, level) in self.levels.iter().enumerate().rev() {
            let target = match index {
                0 => &self.light,
                _ => &self.levels[index - 1].view,
            };
            draw(&self.finer, &level.to, target, Some(level.share));
        }
    }
}

fn pass(device: &wgpu::Device, variant: BloomVariant) -> Result<FullPass, ShaderError> {
    let format = PassFormat {
        color: LIGHT,
        further: &[],
        samples: 1,
        depth: DepthBuffer::None,
        development: Development::AfterPass,
        tone: Default::default(),
        bloom: Bloom::default(),
        grade: Default::default(),
    };
    let mixed = wgpu::BlendState {
        color: wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        },
        // Keeps the alpha channel, the opacity over the background.
        alpha: wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        },
    };
    let blend = (variant == BloomVariant::Finer).then_some(mixed);
    // Texels of the light itself are read one by one.
    let is_sampled = variant != BloomVariant::CoarserLight;
    FullPass::new(
        device,
        "terrella bloom",
        &variant,
        format,
        blend,
        is_sampled,
    )
}
