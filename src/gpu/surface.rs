//! The drawable of the surface: blocks of a lattice, one indexed draw each.

use super::maps::Maps;
use super::tiles::{BlockTiles, PLACEMENTS_BYTES, TileTextures};
use super::{Frame, GpuLayer, PassFormat, ShaderError, ShaderVariant};
use crate::globe::{BLOCK_COUNT, Block, BlockGrid, BlockRow, Shading};
use crate::imagery::EarthLayers;
use crate::imagery::stream::{Pool, Upload};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};
use wgpu::util::DeviceExt;

/// Per-block values, one instance a block.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct BlockInstance {
    center_lon: Vec2,
    center_lat: Vec2,
    center_uv: Vec2,
    block: u32,
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Uint32];

pub(crate) struct SurfaceDrawable {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    maps: Maps,
    imagery: Imagery,
    frame: wgpu::Buffer,
    vertices: wgpu::Buffer,
    instances: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Ranges of the index buffer for north, middle and south blocks.
    ranges: [std::ops::Range<u32>; 3],
    vertices_per_block: u32,
    /// Eye-relative vertices of the blocks to draw; kept to allocate nothing in steady state.
    staging: Vec<Vec3>,
    /// The blocks whose vertices are on the GPU.
    drawn: Vec<Block>,
    pub texture_bytes: u64,
    pub shader_bytes: u64,
    pub variant: ShaderVariant,
}

/// What blocks are drawn with.
enum Imagery {
    /// All with the whole maps.
    Whole(wgpu::BindGroup),
    /// Each with tiles of its own.
    Tiles(TileTextures),
}

/// What the surface needs besides the maps.
pub(crate) struct SurfaceParts<'a> {
    pub layers: &'a EarthLayers,
    /// Pools of tiles, if blocks are drawn with tiles.
    pub pools: Option<&'a [Pool]>,
    pub shading: Shading,
    pub anisotropy: u16,
    pub format: PassFormat,
    /// The air's sunlight table, if there is air and the shading uses it.
    pub sunlight: Option<&'a GpuLayer>,
}

impl SurfaceDrawable {
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        grid: &BlockGrid,
        parts: &SurfaceParts<'_>,
    ) -> Result<Self, ShaderError> {
        let SurfaceParts {
            layers,
            shading,
            format,
            ..
        } = parts;
        let paper = *shading == Shading::Paper;
        let variant = ShaderVariant::new(
            super::EARTH_SHADER,
            &[
                ("paper", paper),
                ("clouds", layers.clouds.is_some()),
                ("normals", layers.normals.is_some()),
                ("night_lights", layers.night_lights.is_some()),
                // The paper's shading has no glint.
                ("water", !paper && layers.water.is_some()),
                ("tiles", parts.pools.is_some()),
                ("air", parts.sunlight.is_some()),
                ("encode", !paper && format.stores_display_values()),
                ("decode", paper && !format.stores_display_values()),
            ],
        );
        let (module, shader_bytes) = variant.module(device)?;
        let frame = super::uniform_buffer::<Frame>(device, "terrella frame");
        let maps = Maps::upload(device, queue, layers, paper, parts.anisotropy);
        let imagery = match parts.pools {
            Some(pools) => Imagery::Tiles(TileTextures::new(device, &maps, pools, paper)),
            None => Imagery::Whole(maps.bind(device, "terrella whole maps", Default::default())),
        };
        let tile_bytes = match &imagery {
            Imagery::Tiles(tiles) => tiles.bytes,
            Imagery::Whole(_) => 0,
        };
        let texture_bytes = maps.bytes() + tile_bytes;
        let table_sampler = table_sampler(device);

        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let mut layout = vec![super::uniform_entry(0, both, size_of::<Frame>())];
        let mut entries = vec![wgpu::BindGroupEntry {
            binding: 0,
            resource: frame.as_entire_binding(),
        }];
        if let Some(sunlight) = parts.sunlight {
            layout.push(super::texture_entry(1, wgpu::TextureViewDimension::D2));
            layout.push(super::sampler_entry(2));
            entries.push(wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::TextureView(&sunlight.view),
            });
            entries.push(wgpu::BindGroupEntry {
                binding: 2,
                resource: wgpu::BindingResource::Sampler(&table_sampler),
            });
        }
        if let Imagery::Tiles(tiles) = &imagery {
            let fragment = wgpu::ShaderStages::FRAGMENT;
            layout.push(super::uniform_entry(3, fragment, PLACEMENTS_BYTES));
            entries.push(wgpu::BindGroupEntry {
                binding: 3,
                resource: tiles.placements().as_entire_binding(),
            });
        }
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrella earth"),
            entries: &layout,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrella earth"),
            layout: &layout,
            entries: &entries,
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("terrella earth"),
            bind_group_layouts: &[Some(&layout), Some(maps.layout())],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("terrella earth"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[
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
                ],
            },
            primitive: wgpu::PrimitiveState {
                front_face: wgpu::FrontFace::Ccw,
                cull_mode: Some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: format.depth_stencil(true),
            multisample: format.multisample(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: format.color,
                    blend: None,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });

        let instances: Vec<BlockInstance> = Block::all()
            .map(|block| {
                let cos_sin = |angle: f64| Vec2::new(angle.cos() as f32, angle.sin() as f32);
                BlockInstance {
                    center_lon: cos_sin(block.center_lon_rad()),
                    center_lat: cos_sin(block.center_lat_rad()),
                    center_uv: block.center_uv().as_vec2(),
                    block: block.index(),
                }
            })
            .collect();
        let instances = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("terrella blocks"),
            contents: bytemuck::cast_slice(&instances),
            usage: wgpu::BufferUsages::VERTEX,
        });
        let lists =
            [BlockRow::North, BlockRow::Middle, BlockRow::South].map(|kind| grid.indices(kind));
        let mut start = 0;
        let ranges = [0, 1, 2].map(|kind: usize| {
            let range = start..start + lists[kind].len() as u32;
            start = range.end;
            range
        });
        let mut list = lists.concat();
        // Buffer sizes are multiples of four bytes.
        list.resize(list.len().next_multiple_of(2), 0);
        let indices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("terrella block indices"),
            contents: bytemuck::cast_slice(&list),
            usage: wgpu::BufferUsages::INDEX,
        });
        let vertices_per_block = grid.vertices_per_block();
        let most = (BLOCK_COUNT * vertices_per_block) as usize;
        let vertices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella block vertices"),
            size: (most * size_of::<Vec3>()) as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Ok(Self {
            pipeline,
            bind_group,
            maps,
            imagery,
            frame,
            vertices,
            instances,
            indices,
            ranges,
            vertices_per_block,
            staging: Vec::with_capacity(most),
            drawn: Vec::with_capacity(BLOCK_COUNT as usize),
            texture_bytes,
            shader_bytes,
            variant,
        })
    }

    /// The list that the caller fills with the blocks to draw.
    pub fn drawn_mut(&mut self) -> &mut Vec<Block> {
        &mut self.drawn
    }

    /// The blocks that are drawn.
    pub fn drawn(&self) -> &[Block] {
        &self.drawn
    }

    /// Subtracts the eye from every vertex of the drawn blocks, in f64.
    pub fn stage(&mut self, grid: &BlockGrid, eye_itrf_m: DVec3) {
        self.staging.clear();
        for block in &self.drawn {
            for row in 0..=grid.subdivision() {
                self.staging.extend(
                    grid.vertex_row(*block, row)
                        .iter()
                        .map(|v| (*v - eye_itrf_m).as_vec3()),
                );
            }
        }
    }

    /// The vertices as the GPU gets them: eye-relative ITRF metres, (n + 1)² a block in the order of [`Self::drawn`].
    pub fn staged(&self) -> &[Vec3] {
        &self.staging
    }

    /// Has a drawn block use these tiles; where there are none, whole maps are drawn and nothing is done.
    pub fn choose(&mut self, device: &wgpu::Device, block: Block, chosen: BlockTiles) {
        if let Imagery::Tiles(tiles) = &mut self.imagery {
            tiles.choose(device, &self.maps, block, chosen);
        }
    }

    /// Writes a part of a tile.
    pub fn write_tile(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        if let Imagery::Tiles(tiles) = &self.imagery {
            tiles.write(queue, part);
        }
    }

    /// Writes what was staged. Returns the bytes written.
    pub fn write(&mut self, queue: &wgpu::Queue, frame: &Frame) -> u64 {
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        let vertices: &[u8] = bytemuck::cast_slice(&self.staging);
        if !vertices.is_empty() {
            queue.write_buffer(&self.vertices, 0, vertices);
        }
        let placements = match &mut self.imagery {
            Imagery::Tiles(tiles) => tiles.flush(queue),
            Imagery::Whole(_) => 0,
        };
        (size_of::<Frame>() + vertices.len()) as u64 + placements
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.drawn.is_empty() {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        if let Imagery::Whole(maps) = &self.imagery {
            pass.set_bind_group(1, maps, &[]);
        }
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        for (place, block) in (0u32..).zip(&self.drawn) {
            let range = match block.kind() {
                BlockRow::North => &self.ranges[0],
                BlockRow::Middle => &self.ranges[1],
                BlockRow::South => &self.ranges[2],
            };
            if let Imagery::Tiles(tiles) = &self.imagery {
                pass.set_bind_group(1, tiles.bind_group(*block), &[]);
            }
            let base = (place * self.vertices_per_block) as i32;
            pass.draw_indexed(range.clone(), base, block.index()..block.index() + 1);
        }
    }
}

/// Linear, clamped: for tables that end on texel centres.
pub(super) fn table_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("terrella tables"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}
