//! City lights as points on the GPU: `shaders/earth/city_lights.wgsl` draws them.

use crate::plan::CityDraw;
use std::sync::Arc;
use terrella_imagery::{CITY_CELLS, CityLight, CityLights};

const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Unorm8x4];

/// Points at all levels of detail, uploaded per cell when a view first draws some of it.
pub(super) struct CityPoints {
    lights: Arc<CityLights>,
    buffers: Vec<wgpu::Buffer>,
    /// Location of each cell's points.
    cells: Box<[Option<Place>]>,
}

#[derive(Clone, Copy)]
struct Place {
    buffer: usize,
    /// Number of points before them.
    first: u32,
}

impl CityPoints {
    /// One instance per point.
    pub const BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 1] =
        [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<CityLight>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &ATTRIBUTES,
        })];

    /// Four corners per point.
    pub const PRIMITIVE: wgpu::PrimitiveState = wgpu::PrimitiveState {
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        strip_index_format: None,
        front_face: wgpu::FrontFace::Ccw,
        cull_mode: None,
        unclipped_depth: false,
        polygon_mode: wgpu::PolygonMode::Fill,
        conservative: false,
    };

    pub fn new(lights: Arc<CityLights>) -> Self {
        Self {
            lights,
            buffers: Vec::new(),
            cells: vec![None; CITY_CELLS].into(),
        }
    }

    fn place(&self, cell: usize) -> Option<Place> {
        *self.cells.get(cell)?
    }

    /// Whether the cells of all these draws are uploaded.
    pub fn are_ready(&self, draws: &[CityDraw]) -> bool {
        draws.iter().all(|draw| self.place(draw.cell).is_some())
    }

    /// Uploads the missing cells of these draws.
    pub fn make_ready(&mut self, device: &wgpu::Device, draws: &[CityDraw]) {
        self.upload(device, draws.iter().map(|draw| draw.cell));
    }

    /// Uploads all cells.
    pub fn make_all(&mut self, device: &wgpu::Device) {
        self.lights.make_all();
        self.upload(device, 0..CITY_CELLS);
    }

    fn upload(&mut self, device: &wgpu::Device, cells: impl Iterator<Item = usize>) {
        let mut points = Vec::new();
        for cell in cells {
            if let Some(place @ None) = self.cells.get_mut(cell) {
                *place = Some(Place {
                    buffer: self.buffers.len(),
                    first: points.len() as u32,
                });
                points.extend_from_slice(self.lights.points(cell));
            }
        }
        if !points.is_empty() {
            let (label, usage) = ("terrella city lights", wgpu::BufferUsages::VERTEX);
            let bytes = bytemuck::cast_slice(&points);
            self.buffers
                .push(super::filled_buffer(device, label, bytes, usage));
        }
    }

    /// Draws them with the current pipeline.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, draws: &[CityDraw]) {
        let mut bound = None;
        for CityDraw { cell, points } in draws {
            let place = self.place(*cell);
            let Some((place, buffer)) = place.zip(place.and_then(|at| self.buffers.get(at.buffer)))
            else {
                continue;
            };
            if bound != Some(place.buffer) {
                pass.set_vertex_buffer(0, buffer.slice(..));
                bound = Some(place.buffer);
            }
            pass.draw(0..4, place.first + points.start..place.first + points.end);
        }
    }
}
