//! Light that a lens scatters about what is bright: ever coarser pictures of the light, mixed back into it.

use super::full_pass::FullPass;
use super::{BloomVariant, DepthBuffer, Development, PassFormat, ShaderError, color_texture};
use terrella_ground::light::Bloom;

/// What light is that a lens scatters.
pub(super) const LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Scatters the light of a picture as a [`Bloom`] does, in place: before it is developed.
///
/// Each level is half as large as the one before. On the way back each is blended with the next coarser one, so that all light that is
/// taken from a pixel arrives at others: no light is lost but over the picture's edges.
pub struct BloomPass {
    coarser: FullPass,
    coarser_light: FullPass,
    finer: FullPass,
    levels: Vec<Level>,
    /// The part of its own light that each picture gives up for the next level's; the light itself is the first.
    shares: Vec<f64>,
    light: wgpu::TextureView,
}

/// A picture of half the size of the one before.
struct Level {
    view: wgpu::TextureView,
    /// The one before, to be read.
    from: wgpu::BindGroup,
    /// This one, to be read.
    to: wgpu::BindGroup,
}

impl BloomPass {
    /// For light of [`ScaledTarget::LIGHT`](super::ScaledTarget::LIGHT) that is drawn at this size, pixels; the texture can be drawn to and be read by shaders. `None`
    /// where the lens scatters nothing, or the picture is too small for that.
    ///
    /// # Errors
    /// A shader file that is at fault.
    pub fn new(
        device: &wgpu::Device,
        bloom: &Bloom,
        light: &wgpu::TextureView,
        size: (u32, u32),
    ) -> Result<Option<Self>, ShaderError> {
        let shares = bloom.shares(size);
        if shares.is_empty() {
            return Ok(None);
        }
        let coarser = pass(device, BloomVariant::Coarser)?;
        let coarser_light = pass(device, BloomVariant::CoarserLight)?;
        let finer = pass(device, BloomVariant::Finer)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let mut levels: Vec<Level> = Vec::with_capacity(shares.len());
        let (mut width, mut height) = size;
        for _ in &shares {
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
            let format = LIGHT;
            let texture =
                color_texture(device, "terrella bloom", (width, height), format, 1, usage);
            let view = super::view(&texture);
            levels.push(Level {
                from: match levels.last() {
                    None => coarser_light.bind(device, light),
                    Some(before) => coarser.bind(device, &before.view),
                },
                to: finer.bind(device, &view),
                view,
            });
        }
        Ok(Some(Self {
            coarser,
            coarser_light,
            finer,
            levels,
            shares,
            light: light.clone(),
        }))
    }

    /// Scatters the light that has been drawn. `begins` is the time at which its first pass begins.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut begins: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut draw = |pass: &FullPass, source, target, share: Option<f64>| {
            let load = match share {
                Some(_) => wgpu::LoadOp::Load,
                // Every pixel is drawn over; this spares reading what was there.
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
            draw(&self.finer, &level.to, target, Some(self.shares[index]));
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
    };
    let mixed = wgpu::BlendState {
        color: wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        },
        // How much of what is behind is hidden stays.
        alpha: wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        },
    };
    let blend = (variant == BloomVariant::Finer).then_some(mixed);
    // Of light itself texels are read one by one.
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
