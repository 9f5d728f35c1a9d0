//! GPU state of one view of the surface: frame uniforms, mesh and bind groups.

use super::lattice::Lattice;
use super::mesh::SurfaceMesh;
use super::pass_kind::PassKind;
use super::relief;
use super::situation::Situation;
use super::surface_config::SurfaceConfig;
use crate::plan::{DetailScales, FramePlan, FrameUniforms};
use terrella_ground::globe::{BlockGrid, Surface};

pub(crate) struct SurfaceView {
    /// [`FrameUniforms`].
    uniforms: wgpu::Buffer,
    mesh: Box<dyn SurfaceMesh>,
    /// By side of the air and by [`DetailScales`].
    groups: Vec<[PassGroups; DetailScales::ALL.len()]>,
}

/// Group 0 in one situation, by [`PassKind`], for the passes created so far.
pub(super) type PassGroups = [Option<wgpu::BindGroup>; PassKind::COUNT];

impl SurfaceView {
    /// A view that is not bound yet: see [`super::SurfaceDrawable::bind_view`].
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

    /// Draws blocks with these grids from now on. Nothing is drawn until it is written again.
    pub fn reset(&mut self, device: &wgpu::Device, grids: &[BlockGrid]) {
        self.mesh.reset(device, grids);
    }

    pub(super) fn mesh(&self) -> &dyn SurfaceMesh {
        self.mesh.as_ref()
    }

    pub(super) fn uniforms(&self) -> &wgpu::Buffer {
        &self.uniforms
    }

    /// The bind group of a pass.
    pub(super) fn group(&self, at: Situation, kind: PassKind) -> Option<&wgpu::BindGroup> {
        self.groups.get(at.side)?[at.scales as usize][kind as usize].as_ref()
    }

    /// Removes all bind groups, for this number of sides of the air.
    pub(super) fn unbind(&mut self, sides: usize) {
        self.groups = std::iter::repeat_with(Default::default)
            .take(sides)
            .collect();
    }

    pub(super) fn set_group(&mut self, at: Situation, kind: PassKind, group: wgpu::BindGroup) {
        if let Some(groups) = self.groups.get_mut(at.side) {
            groups[at.scales as usize][kind as usize] = Some(group);
        }
    }

    /// Uploads the frame uniforms for all drawables.
    pub fn write_frame(&self, queue: &wgpu::Queue, uniforms: &FrameUniforms) {
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(uniforms));
    }

    /// Uploads a frame: the plan, and the missing patches or grid tiles of a terrain surface. Returns the bytes written.
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

    /// Size of the vertices, triangles and elevation data of terrain on the GPU, bytes.
    pub fn ground_bytes(&self) -> u64 {
        self.mesh.ground_bytes()
    }
}
