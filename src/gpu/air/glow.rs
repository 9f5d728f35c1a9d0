//! The drawable of airglow and aurora: a rectangle around the upper air, added to what is behind it.

use super::super::shader::ShaderModule;
use super::super::{GlowVariant, PassFormat, PipelineDescription, ShaderError};
use super::{AirTextures, Binding};
use crate::plan::{AirPlan, AirSide, AuroraUniforms, GlowUniforms, SurfaceLight};

/// Pipelines and buffers of airglow and aurora.
pub(super) struct Glow {
    uniforms: wgpu::Buffer,
    /// Uniforms of the aurora; `None` if it is not drawn.
    aurora: Option<wgpu::Buffer>,
    /// For the eye outside the lower air, and inside.
    sides: [Side; 2],
}

struct Side {
    variant: GlowVariant,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
    pipeline: Option<wgpu::RenderPipeline>,
}

const LABEL: &str = "terrella glow";

impl Glow {
    /// `None` if neither is drawn; creates no pipeline yet.
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        textures: &AirTextures,
        light: &SurfaceLight,
    ) -> Option<Self> {
        light.glow_gain()?;
        let uniforms = crate::gpu::uniform_buffer::<GlowUniforms>(device, LABEL);
        let aurora = light.kp.map(|_| aurora_buffer(device));
        let sides = AirSide::ALL.map(|side| {
            let bindings = bindings(&uniforms, aurora.as_ref(), textures, side);
            let (layout, bind_group) = crate::gpu::bind(device, LABEL, bindings);
            Side {
                variant: GlowVariant {
                    side,
                    airglow: light.airglow,
                    aurora: aurora.is_some(),
                    target: format.target_color(),
                },
                layout,
                bind_group,
                pipeline: None,
            }
        });
        Some(Self {
            uniforms,
            aurora,
            sides,
        })
    }

    /// The same glow for another view, with that view's textures.
    pub fn for_another_view(&self, device: &wgpu::Device, textures: &AirTextures) -> Self {
        let uniforms = crate::gpu::uniform_buffer::<GlowUniforms>(device, LABEL);
        let aurora = self.aurora.as_ref().map(|_| aurora_buffer(device));
        let sides = self.sides.each_ref().map(|of| {
            let bindings = bindings(&uniforms, aurora.as_ref(), textures, of.variant.side);
            Side {
                variant: of.variant,
                layout: of.layout.clone(),
                bind_group: crate::gpu::bind_to(device, LABEL, &of.layout, bindings),
                pipeline: of.pipeline.clone(),
            }
        });
        Self {
            uniforms,
            aurora,
            sides,
        }
    }

    /// The variants of its shader.
    pub fn variants(&self) -> impl Iterator<Item = GlowVariant> + '_ {
        self.sides.iter().map(|side| side.variant)
    }

    /// Whether the pipeline for this side exists.
    pub fn is_ready(&self, side: AirSide) -> bool {
        self.sides[side as usize].pipeline.is_some()
    }

    /// Creates the pipeline for this side if it does not exist.
    pub fn make(
        &mut self,
        device: &wgpu::Device,
        format: PassFormat,
        side: AirSide,
    ) -> Result<(), ShaderError> {
        let side = &mut self.sides[side as usize];
        if side.pipeline.is_some() {
            return Ok(());
        }
        let shader = ShaderModule::new(device, &side.variant)?;
        let pipeline = PipelineDescription {
            label: LABEL,
            bind_groups: Some(&[Some(&side.layout)]),
            module: &shader.module,
            buffers: &[],
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..Default::default()
            },
            format,
            writes_depth: false,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        };
        side.pipeline = Some(pipeline.create(device));
        Ok(())
    }

    /// Uploads the uniforms of this frame. Returns the bytes written.
    pub fn write(&self, queue: &wgpu::Queue, plan: &AirPlan) -> usize {
        let mut bytes = 0;
        if let Some(uniforms) = &plan.glow {
            queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(uniforms));
            bytes += size_of::<GlowUniforms>();
        }
        if let Some((buffer, uniforms)) = self.aurora.as_ref().zip(plan.aurora.as_ref()) {
            queue.write_buffer(buffer, 0, bytemuck::bytes_of(uniforms));
            bytes += size_of::<AuroraUniforms>();
        }
        bytes
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, side: AirSide) {
        let side = &self.sides[side as usize];
        if let Some(pipeline) = &side.pipeline {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &side.bind_group, &[]);
            pass.draw(0..4, 0..1);
        }
    }
}

fn aurora_buffer(device: &wgpu::Device) -> wgpu::Buffer {
    crate::gpu::uniform_buffer::<AuroraUniforms>(device, "terrella aurora")
}

/// Group 0.
fn bindings<'a>(
    uniforms: &'a wgpu::Buffer,
    aurora: Option<&'a wgpu::Buffer>,
    textures: &'a AirTextures,
    side: AirSide,
) -> Vec<Binding<'a>> {
    let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let own = |binding, buffer: &'a wgpu::Buffer, size| {
        let entry = wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        };
        (crate::gpu::uniform_entry(binding, stages, size), entry)
    };
    let mut bindings = vec![own(0, uniforms, size_of::<GlowUniforms>())];
    bindings.extend(aurora.map(|buffer| own(3, buffer, size_of::<AuroraUniforms>())));
    bindings.extend(textures.bindings(side));
    bindings
}
