//! The sky view for an eye in the air: a small image of the air in each direction, from which ground, sky and tracks are then drawn.

use super::textures::{AirTextures, VIEW_TARGETS};
use crate::gpu::shader::ShaderModule;
use crate::gpu::{AirViewVariant, ShaderError};
use crate::plan::AirUniforms;

const LABEL: &str = "terrella view of the air";

pub(super) struct AirView {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
    /// Height of the eye, and cosines of the zenith angles of the Sun and, if it lights the air, of the Moon, when the view was last drawn. It
    /// depends on nothing else.
    drawn: Option<[f32; 3]>,
    moonlight: bool,
}

impl AirView {
    pub fn new(
        device: &wgpu::Device,
        textures: &AirTextures,
        moonlight: bool,
    ) -> Result<Self, ShaderError> {
        let shader = ShaderModule::new(device, &AirViewVariant { moonlight })?;
        let (layout, bind_group) = crate::gpu::bind(device, LABEL, textures.march_bindings());
        let label = Some(LABEL);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let target = Some(wgpu::ColorTargetState::from(
            wgpu::TextureFormat::Rgba16Float,
        ));
        let targets: [_; VIEW_TARGETS] = std::array::from_fn(|_| target.clone());
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label,
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &shader.module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader.module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        Ok(Self {
            pipeline,
            layout,
            bind_group,
            drawn: None,
            moonlight,
        })
    }

    /// The same for another view, with that view's textures.
    pub fn for_another_view(&self, device: &wgpu::Device, textures: &AirTextures) -> Self {
        let bindings = textures.march_bindings();
        Self {
            pipeline: self.pipeline.clone(),
            layout: self.layout.clone(),
            bind_group: crate::gpu::bind_to(device, LABEL, &self.layout, bindings),
            drawn: None,
            moonlight: self.moonlight,
        }
    }

    /// Draws the sky view for an eye whose uniforms are uploaded, unless it is up to date.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        textures: &AirTextures,
        eye: &AirUniforms,
    ) {
        let eye_moon = if self.moonlight { eye.eye_moon } else { 0.0 };
        let place = [eye.eye_height, eye.eye_sun, eye_moon];
        if self.drawn == Some(place) {
            return;
        }
        self.drawn = Some(place);
        let label = Some(LABEL);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        let attachments = textures.view_targets().each_ref().map(|target| {
            Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label,
            color_attachments: &attachments,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        queue.submit([encoder.finish()]);
    }
}
