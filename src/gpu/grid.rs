//! The projected grid on the GPU: one uniform per frame, an atlas of elevation tiles, and triangles. There is no vertex buffer: the shader computes
//! the vertices.

use super::mesh::{BeginDraw, SurfaceMesh};
use super::shader::{ATLAS_COLUMNS, VertexForm};
use crate::plan::{DeviceLimits, FramePlan};
use terrella_ground::globe::projected_grid::{GridUniforms, TILE_SAMPLES};
use terrella_ground::globe::{DrawKind, GridDraw, Surface};

const BINDINGS: [u32; 2] = [4, 5];

/// Resources of a grid.
pub(crate) struct GridMesh {
    uniform: wgpu::Buffer,
    atlas: wgpu::Texture,
    atlas_view: wgpu::TextureView,
    indices: wgpu::Buffer,
    /// Update number of the tile in each slot of the atlas.
    held: Vec<u64>,
}

impl GridMesh {
    /// Whether a device with these limits can draw a grid with so many tiles. Every WebGPU device has single-float textures and reads texels in the
    /// vertex stage.
    pub fn fits(limits: &DeviceLimits, slots: u32) -> bool {
        let size = atlas_size(slots);
        size.width.max(size.height) <= limits.texture_side
            && size_of::<GridUniforms>() as u64 <= limits.uniform_bytes
            && limits.bindings > BINDINGS[1]
    }

    pub fn new(device: &wgpu::Device, grid: &GridDraw<'_>) -> Self {
        let atlas = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("terrella height tiles"),
            size: atlas_size(grid.written.len() as u32),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let triangles = &grid.indices.triangles;
        Self {
            uniform: super::uniform_buffer::<GridUniforms>(device, "terrella grid"),
            atlas_view: super::view(&atlas),
            atlas,
            indices: super::filled_buffer(
                device,
                "terrella grid triangles",
                bytemuck::cast_slice(triangles),
                wgpu::BufferUsages::INDEX,
            ),
            held: vec![0; grid.written.len()],
        }
    }
}

impl SurfaceMesh for GridMesh {
    fn vertex_form(&self, tiles: bool) -> VertexForm {
        VertexForm::ProjectedGrid { tiles }
    }

    fn buffers(&self) -> &'static [Option<wgpu::VertexBufferLayout<'static>>] {
        &[]
    }

    /// Uploads the uniforms of the grid's frame, and the missing elevation tiles.
    fn write(&mut self, queue: &wgpu::Queue, _: &FramePlan, ground: Option<&dyn Surface>) -> u64 {
        let Some(surface) = ground else {
            return 0;
        };
        let DrawKind::Grid(grid) = surface.draw_kind() else {
            return 0;
        };
        let Some(uniforms) = grid.uniforms else {
            return 0;
        };
        let mut written = 0;
        let slots = (0..).zip(self.held.iter_mut().zip(grid.written));
        for (slot, (held, now)) in slots.filter(|(_, (held, now))| **held != **now) {
            *held = *now;
            written += write_slot(queue, &self.atlas, slot, grid.slot(slot));
        }
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(uniforms));
        written + size_of::<GridUniforms>() as u64
    }

    fn bindings(&self) -> Vec<(wgpu::BindGroupLayoutEntry, wgpu::BindGroupEntry<'_>)> {
        let vertex = wgpu::ShaderStages::VERTEX;
        let [uniforms, heights] = BINDINGS;
        vec![
            (
                super::uniform_entry(uniforms, vertex, size_of::<GridUniforms>()),
                wgpu::BindGroupEntry {
                    binding: uniforms,
                    resource: self.uniform.as_entire_binding(),
                },
            ),
            (
                wgpu::BindGroupLayoutEntry {
                    binding: heights,
                    visibility: vertex,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: false },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupEntry {
                    binding: heights,
                    resource: wgpu::BindingResource::TextureView(&self.atlas_view),
                },
            ),
        ]
    }

    fn ground_bytes(&self) -> u64 {
        let size = self.atlas.size();
        self.indices.size() + 4 * u64::from(size.width) * u64::from(size.height)
    }

    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        begin_draw: &mut BeginDraw<'_>,
    ) {
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for draw in &plan.draws {
            begin_draw(pass, draw);
            pass.draw_indexed(draw.indices.clone(), 0, draw.drawn_as..draw.drawn_as + 1);
        }
    }
}

fn atlas_size(slots: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: ATLAS_COLUMNS * TILE_SAMPLES,
        height: slots.div_ceil(ATLAS_COLUMNS) * TILE_SAMPLES,
        depth_or_array_layers: 1,
    }
}

fn write_slot(queue: &wgpu::Queue, atlas: &wgpu::Texture, slot: u32, heights: &[f32]) -> u64 {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture: atlas,
            mip_level: 0,
            origin: wgpu::Origin3d {
                x: slot % ATLAS_COLUMNS * TILE_SAMPLES,
                y: slot / ATLAS_COLUMNS * TILE_SAMPLES,
                z: 0,
            },
            aspect: wgpu::TextureAspect::All,
        },
        bytemuck::cast_slice(heights),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * TILE_SAMPLES),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width: TILE_SAMPLES,
            height: TILE_SAMPLES,
            depth_or_array_layers: 1,
        },
    );
    size_of_val(heights) as u64
}
