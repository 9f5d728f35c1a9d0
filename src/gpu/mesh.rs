//! The mesh of the surface on the GPU: what the four forms of it have in common.

use super::shader::VertexForm;
use crate::plan::FramePlan;
use terrella_ground::globe::{Block, BlockGrid, BlockSet, Surface};

/// Draw calls and triangles of a frame's meshes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawCosts {
    pub draw_calls: u32,
    pub triangles: u32,
    /// Bytes of vertices, triangles and heights held.
    pub bytes: u64,
}

/// Makes the maps of the next draw those of a block, or whole maps.
pub(super) type BindMaps<'a> = dyn FnMut(&mut wgpu::RenderPass<'_>, Option<Block>) + 'a;

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

/// One form of the surface's mesh.
pub(super) trait SurfaceMesh {
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

    /// Draws nothing until it is written again; blocks from then on with these grids.
    fn reset(&mut self, device: &wgpu::Device, grids: &[BlockGrid]);

    /// Writes what a frame draws as far as it is not there: the plan's blocks, or what the surface of a ground with relief made.
    /// `tiled` are the blocks that have tiles, where triangles may lie in several. Returns the bytes written.
    fn write(
        &mut self,
        queue: &wgpu::Queue,
        plan: &FramePlan,
        ground: Option<&dyn Surface>,
        tiled: Option<BlockSet>,
    ) -> u64;

    /// What the frame that was written last costs, of ground with relief; `None` of blocks.
    fn ground_costs(&self) -> Option<DrawCosts>;

    /// Draws what was written last.
    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        bind_maps: &mut BindMaps<'_>,
    );
}
