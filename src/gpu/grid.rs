//! The projected grid on the GPU: a uniform a frame, an atlas of height tiles, and triangles. No vertices: the shader makes
//! them.

use crate::globe::GridDraw;
use crate::globe::projected_grid::{GridUniforms, TILE_SAMPLES};
use wgpu::util::DeviceExt;

/// Slots in a row of the atlas; `SLOTS_IN_ROW` of the shader.
const SLOTS_IN_ROW: u32 = 16;
const BINDINGS: [u32; 2] = [4, 5];

/// What a grid is drawn from.
pub(crate) struct GridMesh {
    uniform: wgpu::Buffer,
    atlas: wgpu::Texture,
    atlas_view: wgpu::TextureView,
    indices: wgpu::Buffer,
    index_count: u32,
    /// The update that each slot of the atlas holds.
    held: Vec<u64>,
    is_drawn: bool,
}

impl GridMesh {
    /// Whether a device of these limits can draw a grid with so many tiles. Textures of single floats, and reading texels in
    /// the vertex stage, are every WebGPU device's.
    pub fn fits(limits: &wgpu::Limits, slots: u32) -> bool {
        let size = atlas_size(slots);
        size.width.max(size.height) <= limits.max_texture_dimension_2d
            && size_of::<GridUniforms>() as u64 <= limits.max_uniform_buffer_binding_size
            && limits.max_bindings_per_bind_group > BINDINGS[1]
    }

    pub fn new(device: &wgpu::Device, grid: &GridDraw<'_>) -> Self {
        let atlas = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("terrella height tiles"),
            size: atlas_size(grid.tiles.slot_count()),
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
            indices: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("terrella grid triangles"),
                contents: bytemuck::cast_slice(triangles),
                usage: wgpu::BufferUsages::INDEX,
            }),
            index_count: triangles.len() as u32,
            held: vec![0; grid.tiles.slot_count() as usize],
            is_drawn: false,
        }
    }

    /// Nothing is drawn until it is written again.
    pub fn clear(&mut self) {
        self.is_drawn = false;
    }

    /// Draw calls of the frame that was written last.
    pub fn draw_calls(&self) -> u32 {
        u32::from(self.is_drawn)
    }

    /// Bytes of triangles and heights held.
    pub fn bytes(&self) -> u64 {
        let size = self.atlas.size();
        self.indices.size() + 4 * u64::from(size.width) * u64::from(size.height)
    }

    /// Writes the frame, and those tiles that are not there. Returns the bytes written.
    pub fn write(&mut self, queue: &wgpu::Queue, grid: &GridDraw<'_>) -> u64 {
        self.is_drawn = grid.frame.is_some();
        let Some(frame) = grid.frame else {
            return 0;
        };
        let mut written = 0;
        let slots = (0..).zip(self.held.iter_mut().zip(grid.tiles.written()));
        for (slot, (held, now)) in slots.filter(|(_, (held, now))| **held != *now) {
            *held = now;
            written += write_slot(queue, &self.atlas, slot, grid.tiles.slot(slot));
        }
        let uniforms = GridUniforms::new(frame, grid.tiles);
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniforms));
        written + size_of::<GridUniforms>() as u64
    }

    /// Its bindings of group 0.
    pub fn layout(&self) -> [wgpu::BindGroupLayoutEntry; 2] {
        let vertex = wgpu::ShaderStages::VERTEX;
        [
            super::uniform_entry(BINDINGS[0], vertex, size_of::<GridUniforms>()),
            wgpu::BindGroupLayoutEntry {
                binding: BINDINGS[1],
                visibility: vertex,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            },
        ]
    }

    /// What is bound there.
    pub fn entries(&self) -> [wgpu::BindGroupEntry<'_>; 2] {
        [
            wgpu::BindGroupEntry {
                binding: BINDINGS[0],
                resource: self.uniform.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: BINDINGS[1],
                resource: wgpu::BindingResource::TextureView(&self.atlas_view),
            },
        ]
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.is_drawn {
            pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..self.index_count, 0, 0..1);
        }
    }
}

fn atlas_size(slots: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: SLOTS_IN_ROW * TILE_SAMPLES,
        height: slots.div_ceil(SLOTS_IN_ROW) * TILE_SAMPLES,
        depth_or_array_layers: 1,
    }
}

fn write_slot(queue: &wgpu::Queue, atlas: &wgpu::Texture, slot: u32, heights: &[f32]) -> u64 {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture: atlas,
            mip_level: 0,
            origin: wgpu::Origin3d {
                x: slot % SLOTS_IN_ROW * TILE_SAMPLES,
                y: slot / SLOTS_IN_ROW * TILE_SAMPLES,
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
