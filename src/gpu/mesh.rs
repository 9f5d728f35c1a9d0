//! The mesh of the surface on the GPU: what the four forms of it have in common.

use super::shader::VertexForm;
use crate::plan::{FramePlan, SurfaceDraw};
use terrella_ground::globe::{BlockGrid, Surface};

/// Sets pipeline and maps for the next draw.
pub(super) type BeginDraw<'a> = dyn FnMut(&mut wgpu::RenderPass<'_>, &SurfaceDraw) + 'a;

/// What pipelines know of a mesh.
#[derive(Clone)]
pub(super) struct MeshForm {
    pub vertex: VertexForm,
    pub buffers: &'static [Option<wgpu::VertexBufferLayout<'static>>],
    pub culled: wgpu::Face,
    /// Of group 0, besides what all bind.
    pub entries: Vec<wgpu::BindGroupLayoutEntry>,
}

impl MeshForm {
    /// That of a mesh, where blocks have tiles or have none.
    pub fn of(mesh: &(impl SurfaceMesh + ?Sized), has_tiles: bool) -> Self {
        Self {
            vertex: mesh.vertex_form(has_tiles),
            buffers: mesh.buffers(),
            culled: mesh.culled(),
            entries: mesh
                .bindings()
                .into_iter()
                .map(|(entry, _)| entry)
                .collect(),
        }
    }
}

/// One form of the surface's mesh. As GPU objects are, it is `Send` and `Sync` everywhere but on the web.
pub(super) trait SurfaceMesh: wgpu::WasmNotSendSync {
    /// The vertex stage that it is drawn with, where blocks have tiles or have none.
    fn vertex_form(&self, has_tiles: bool) -> VertexForm;

    /// The vertex buffers that this stage reads.
    fn buffers(&self) -> &'static [Option<wgpu::VertexBufferLayout<'static>>];

    /// The sides of its triangles that are not drawn.
    fn culled(&self) -> wgpu::Face {
        wgpu::Face::Back
    }

    /// What it binds of group 0 besides what all do.
    fn bindings(&self) -> Vec<(wgpu::BindGroupLayoutEntry, wgpu::BindGroupEntry<'_>)> {
        Vec::new()
    }

    /// Draws blocks from now on with these grids. Nothing may be drawn until it is written again.
    fn reset(&mut self, _device: &wgpu::Device, _grids: &[BlockGrid]) {}

    /// Writes what a plan draws as far as it is not there: its blocks, or what the surface of terrain made. Returns the
    /// bytes written.
    fn write(&mut self, queue: &wgpu::Queue, plan: &FramePlan, ground: Option<&dyn Surface>)
    -> u64;

    /// Bytes of the vertices, triangles and heights of terrain that it holds.
    fn ground_bytes(&self) -> u64 {
        0
    }

    /// Draws the plan that was written last.
    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        begin_draw: &mut BeginDraw<'_>,
    );
}
