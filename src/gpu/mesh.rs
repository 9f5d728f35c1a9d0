//! The mesh of the surface on the GPU: the common interface of its four forms.

use super::shader::VertexForm;
use crate::plan::{FramePlan, SurfaceDraw};
use terrella_ground::globe::{BlockGrid, Surface};

/// Sets pipeline and maps for the next draw.
pub(super) type BeginDraw<'a> = dyn FnMut(&mut wgpu::RenderPass<'_>, &SurfaceDraw) + 'a;

/// Properties of a mesh that pipelines depend on.
#[derive(Clone)]
pub(super) struct MeshForm {
    pub vertex: VertexForm,
    pub buffers: &'static [Option<wgpu::VertexBufferLayout<'static>>],
    pub culled: wgpu::Face,
    /// Entries of group 0 in addition to the common ones.
    pub entries: Vec<wgpu::BindGroupLayoutEntry>,
}

impl MeshForm {
    /// The form of a mesh, for blocks with or without tiles.
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

/// One form of the surface's mesh. Like other GPU objects, it is `Send` and `Sync` everywhere except on the web.
pub(super) trait SurfaceMesh: wgpu::WasmNotSendSync {
    /// Its vertex stage, for blocks with or without tiles.
    fn vertex_form(&self, has_tiles: bool) -> VertexForm;

    /// The vertex buffers that the vertex stage reads.
    fn buffers(&self) -> &'static [Option<wgpu::VertexBufferLayout<'static>>];

    /// Which faces of its triangles are culled.
    fn culled(&self) -> wgpu::Face {
        wgpu::Face::Back
    }

    /// Bindings of group 0 in addition to the common ones.
    fn bindings(&self) -> Vec<(wgpu::BindGroupLayoutEntry, wgpu::BindGroupEntry<'_>)> {
        Vec::new()
    }

    /// Draws blocks with these grids from now on. Nothing may be drawn until it is written again.
    fn reset(&mut self, _device: &wgpu::Device, _grids: &[BlockGrid]) {}

    /// Uploads the missing parts of a plan: its blocks, or the output of the terrain surface. Returns the bytes written.
    fn write(&mut self, queue: &wgpu::Queue, plan: &FramePlan, ground: Option<&dyn Surface>)
    -> u64;

    /// Size of the vertices, triangles and elevation data of terrain on the GPU, bytes.
    fn ground_bytes(&self) -> u64 {
        0
    }

    /// Draws the plan that was last written.
    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        begin_draw: &mut BeginDraw<'_>,
    );
}
