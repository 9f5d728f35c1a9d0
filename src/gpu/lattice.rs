//! The lattice of a block on the GPU: eye-relative vertices, per-block values, and indices.

use super::mesh::{BeginDraw, SurfaceMesh};
use super::shader::VertexForm;
use crate::plan::{FramePlan, LISTED_INDICES};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockGrid, BlockRow, Surface};

/// Per-block values, one instance a block.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct BlockInstance {
    center_lon: Vec2,
    center_lat: Vec2,
    center_uv: Vec2,
    /// Index of the block whose tiles are drawn, or [`crate::plan::WHOLE_MAP`].
    pub block: u32,
}

impl BlockInstance {
    pub fn of_block(block: Block) -> Self {
        let uv = block.center_uv().as_vec2().to_array();
        Self::new(
            block.center_lon_rad(),
            block.center_lat_rad(),
            uv,
            block.index(),
        )
    }

    /// Around any place; `block` selects the tiles.
    pub fn new(lon_rad: f64, lat_rad: f64, uv: [f32; 2], block: u32) -> Self {
        let cos_sin = |angle: f64| Vec2::new(angle.cos() as f32, angle.sin() as f32);
        Self {
            center_lon: cos_sin(lon_rad),
            center_lat: cos_sin(lat_rad),
            center_uv: uv.into(),
            block,
        }
    }
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Uint32];

/// The vertex buffers of `shaders/earth/vertex/block_lattice.wgsl`.
const BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Vec3>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &VERTEX_ATTRIBUTES,
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<BlockInstance>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &INSTANCE_ATTRIBUTES,
    }),
];

/// Buffers for all blocks, of one or more grids.
pub(super) struct Lattice {
    vertices: wgpu::Buffer,
    instances: wgpu::Buffer,
    cells: Vec<Cells>,
    /// [`FramePlan::cells`].
    listed: wgpu::Buffer,
}

/// The triangles of a grid's blocks.
struct Cells {
    indices: wgpu::Buffer,
    /// Size of a block's vertices, bytes.
    block_bytes: u64,
}

impl Lattice {
    pub fn new(device: &wgpu::Device, grids: &[BlockGrid]) -> Self {
        let instances: Vec<_> = Block::all().map(BlockInstance::of_block).collect();
        let instances = super::filled_buffer(
            device,
            "terrella blocks",
            bytemuck::cast_slice(&instances),
            wgpu::BufferUsages::VERTEX,
        );
        let vertices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella block vertices"),
            size: (most_vertices(grids) * size_of::<Vec3>()) as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            vertices,
            instances,
            cells: grids.iter().map(|grid| Cells::new(device, grid)).collect(),
            listed: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("terrella listed cells"),
                size: (LISTED_INDICES * size_of::<u16>()) as u64,
                usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }
}

impl SurfaceMesh for Lattice {
    fn vertex_form(&self, tiles: bool) -> VertexForm {
        VertexForm::BlockLattice { tiles }
    }

    fn buffers(&self) -> &'static [Option<wgpu::VertexBufferLayout<'static>>] {
        &BUFFERS
    }

    fn reset(&mut self, device: &wgpu::Device, grids: &[BlockGrid]) {
        *self = Self::new(device, grids);
    }

    fn write(&mut self, queue: &wgpu::Queue, plan: &FramePlan, _: Option<&dyn Surface>) -> u64 {
        let vertices: &[u8] = bytemuck::cast_slice(&plan.vertices);
        let listed: &[u8] = bytemuck::cast_slice(&plan.cells);
        for (buffer, bytes) in [(&self.vertices, vertices), (&self.listed, listed)] {
            if !bytes.is_empty() {
                queue.write_buffer(buffer, 0, bytes);
            }
        }
        (vertices.len() + listed.len()) as u64
    }

    /// Draws the plan's blocks at the plan's subdivision. Their vertices must have been uploaded in the same order.
    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        begin_draw: &mut BeginDraw<'_>,
    ) {
        let Some(cells) = self.cells.get(plan.mesh) else {
            return;
        };
        pass.set_vertex_buffer(1, self.instances.slice(..));
        let mut bound = None;
        for draw in &plan.draws {
            begin_draw(pass, draw);
            if bound != Some(draw.is_listed) {
                bound = Some(draw.is_listed);
                let indices = match draw.is_listed {
                    true => &self.listed,
                    false => &cells.indices,
                };
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint16);
            }
            // An offset instead of a base vertex, which WebGL2 does not have.
            let begin = draw.patch * cells.block_bytes;
            pass.set_vertex_buffer(0, self.vertices.slice(begin..));
            pass.draw_indexed(draw.indices.clone(), 0, draw.drawn_as..draw.drawn_as + 1);
        }
    }
}

/// Vertices of all blocks together, for the finest grid.
fn most_vertices(grids: &[BlockGrid]) -> usize {
    let per_block = grids.iter().map(BlockGrid::vertices_per_block).max();
    (BLOCK_COUNT * per_block.unwrap_or(0)) as usize
}

impl Cells {
    fn new(device: &wgpu::Device, grid: &BlockGrid) -> Self {
        let lists =
            [BlockRow::North, BlockRow::Middle, BlockRow::South].map(|kind| grid.indices(kind));
        let mut list = lists.concat();
        // Buffer sizes are multiples of four bytes.
        list.resize(list.len().next_multiple_of(2), 0);
        Self {
            indices: super::filled_buffer(
                device,
                "terrella block indices",
                bytemuck::cast_slice(&list),
                wgpu::BufferUsages::INDEX,
            ),
            block_bytes: u64::from(grid.vertices_per_block()) * size_of::<Vec3>() as u64,
        }
    }
}
