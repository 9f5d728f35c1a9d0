//! Render pipelines: the common part is code here, the differences are values.

use super::PassFormat;

/// A pipeline whose shader has the entry points `vertex` and `fragment` and writes all colour targets of the pass.
pub struct PipelineDescription<'a> {
    /// Begins with `terrella`.
    pub label: &'a str,
    /// Layouts of its bind groups; `None` derives them from the shader.
    pub bind_groups: Option<&'a [Option<&'a wgpu::BindGroupLayout>]>,
    pub module: &'a wgpu::ShaderModule,
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub primitive: wgpu::PrimitiveState,
    /// Format of the pass that it draws in.
    pub format: PassFormat,
    /// Whether it writes depth. It always tests depth.
    pub writes_depth: bool,
    /// Blending with the content of the first target; `None` replaces it.
    pub blend: Option<wgpu::BlendState>,
}

impl PipelineDescription<'_> {
    /// Makes the pipeline.
    pub fn create(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let layout = self.bind_groups.map(|bind_group_layouts| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(self.label),
                bind_group_layouts,
                immediate_size: 0,
            })
        });
        let target = |format, blend| {
            Some(wgpu::ColorTargetState {
                format,
                blend,
                write_mask: wgpu::ColorWrites::ALL,
            })
        };
        let mut targets = vec![target(self.format.color, self.blend)];
        targets.extend(
            self.format
                .further
                .iter()
                .map(|format| target(*format, None)),
        );
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: layout.as_ref(),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: self.buffers,
            },
            primitive: self.primitive,
            depth_stencil: self.format.depth_stencil(self.writes_depth),
            multisample: self.format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
