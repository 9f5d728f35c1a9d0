//! What one view of the surface has of its own on the GPU: its frame's values, its mesh, and what it binds.

use super::lattice::Lattice;
use super::mesh::SurfaceMesh;
use super::pass_kind::PassKind;
use super::relief;
use super::surface_config::SurfaceConfig;
use crate::plan::{FramePlan, FrameUniforms};
use terrella_ground::globe::{BlockGrid, Surface};

pub(crate) struct SurfaceView {
    /// [`FrameUniforms`].
    uniforms: wgpu::Buffer,
    mesh: Box<dyn SurfaceMesh>,
    /// For each side of the air.
    groups: Vec<PassGroups>,
}

/// Group 0 of what the surface is drawn with from one side of the air, by [`PassKind`], as far as that is made.
pub(super) type PassGroups = [Option<wgpu::BindGroup>; PassKind::COUNT];

impl SurfaceView {
    /// A view that is bound to nothing yet: see [`super::SurfaceDrawable::bind_view`].
    pub fn new(device: &wgpu::Device, grids: &[BlockGrid], config: &SurfaceConfig<'_>) -> Self {
        Self {
            uniforms: super::uniform_buffer::<FrameUniforms>(device, "terrella frame"),
            mesh: match &config.ground {
                None => Box::new(Lattice::new(device, grids)),
                Some(form) => relief::mesh(device, form, config),
            },
            groups: Vec::new(),
        }
    }

    /// Draws blocks from now on with these grids, and nothing until it is written again.
    pub fn reset(&mut self, device: &wgpu::Device, grids: &[BlockGrid]) {
        self.mesh.reset(device, grids);
    }

    pub(super) fn mesh(&self) -> &dyn SurfaceMesh {
        self.mesh.as_ref()
    }

    pub(super) fn uniforms(&self) -> &wgpu::Buffer {
        &self.uniforms
    }

    /// What a pass binds of this view.
    pub(super) fn group(&self, side: usize, kind: PassKind) -> Option<&wgpu::BindGroup> {
        self.groups.get(side)?[kind as usize].as_ref()
    }

    /// Is bound to nothing from now on, of so many sides of the air.
    pub(super) fn unbind(&mut self, sides: usize) {
        self.groups = std::iter::repeat_with(PassGroups::default)
            .take(sides)
            .collect();
    }

    pub(super) fn set_group(&mut self, side: usize, kind: PassKind, group: wgpu::BindGroup) {
        if let Some(groups) = self.groups.get_mut(side) {
            groups[kind as usize] = Some(group);
        }
    }

    /// Writes what all drawables of a frame read.
    pub fn write_frame(&self, queue: &wgpu::Queue, uniforms: &FrameUniforms) {
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(uniforms));
    }

    /// Writes what a frame draws: the plan, and of terrain the patches or the grid of its surface, as far as they are
    /// not there. Returns the bytes written.
    pub fn write(
        &mut self,
        queue: &wgpu::Queue,
        plan: &FramePlan,
        ground: Option<&dyn Surface>,
    ) -> u64 {
        self.write_frame(queue, &plan.uniforms);
        let written = size_of::<FrameUniforms>() as u64;
        written + self.mesh.write(queue, plan, ground)
    }

    /// Bytes of the vertices, triangles and heights of terrain that it holds.
    pub fn ground_bytes(&self) -> u64 {
        self.mesh.ground_bytes()
    }
}
