//! The drawable of satellite tracks: lines, marks, fills and polygons as plain values. `crate::tracks` computes them from satellites.

use super::shader::ShaderModule;
use super::{AirTextures, Binding, PassFormat};
use super::{PipelineDescription, ShaderError, TrackKind, TracksVariant};
use crate::plan::{AirSide, FrameUniforms};
use bytemuck::{Pod, Zeroable};

/// `TrackUniforms` of `shaders/tracks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct TrackUniforms {
    /// The eye, its rays and its projection; its light and air are not read.
    pub frame: FrameUniforms,
    /// Width and height of the viewport, pixels.
    pub size_px: [f32; 2],
    /// Upper boundary of the air, scaled space.
    pub air_top: f32,
    /// Fills the struct to its size.
    pub padding: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct LinePoint {
    /// Position relative to the eye, ITRF metres.
    pub from_eye_m: [f32; 3],
    /// [`FROM_PREVIOUS`](super::TRACK_FROM_PREVIOUS) if a segment connects it with the point before, [`ON_GROUND`](super::TRACK_ON_GROUND) if it is
    /// on the ground, [`UNCASED`](super::TRACK_UNCASED) if that segment has no dark outline.
    pub flags: u32,
    /// Colour as the target stores it and opacity, half floats, not premultiplied: for a fully covered pixel, and for a half covered one.
    pub colors: [[u16; 4]; 2],
    /// Half the width of the segment that ends in it, pixels.
    pub half_width_px: f32,
}

/// A dot, or with [`ON_GROUND`](super::TRACK_ON_GROUND) a ring.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Mark {
    /// Position relative to the eye, ITRF metres.
    pub from_eye_m: [f32; 3],
    /// [`ON_GROUND`](super::TRACK_ON_GROUND) or 0.
    pub flags: u32,
    /// Colour as the target stores it and opacity, half floats, not premultiplied: for a fully covered pixel, and for a half covered one.
    pub colors: [[u16; 4]; 2],
    /// Radius, pixels.
    pub radius_px: f32,
}

/// The ground inside a cone or a pyramid and visible from its apex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Fill {
    /// Bounds on screen: least x and y, greatest x and y, −1…1.
    pub bounds: [f32; 4],
    /// Position of the satellite, scaled space.
    pub apex: [f32; 3],
    /// Depth of its nearest point.
    pub depth: f32,
    /// The boresight, unit, ITRF axes.
    pub axis: [f32; 3],
    /// Tangent of the half angle; for a pyramid, between the axis and the faces across `side`.
    pub tangent: f32,
    /// The axis along which the second half angle of a pyramid is measured, unit.
    pub side: [f32; 3],
    /// Tangent of the second half angle; 0 for a cone.
    pub side_tangent: f32,
    /// Colour as the target stores it and opacity, half floats, not premultiplied.
    pub color: [u16; 4],
}

/// A triangle of a polygon.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Triangle {
    /// The first corner relative to the eye, ITRF metres.
    pub a_m: [f32; 3],
    /// Bit i: the edge opposite to corner i is an edge of the polygon, which is antialiased. Bit 3 + i: corner i lies on a polygon edge of another
    /// triangle.
    pub edges: u32,
    /// The other corners, as the first.
    pub b_m: [f32; 3],
    pub c_m: [f32; 3],
    /// Colour as the target stores it and opacity, half floats, not premultiplied: for a fully covered pixel, and for a half covered one.
    pub colors: [[u16; 4]; 2],
}

const LINE_BEFORE: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const LINE_A: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![1 => Float32x3, 2 => Uint32, 3 => Float16x4, 10 => Float16x4];
const LINE_B: [wgpu::VertexAttribute; 5] = wgpu::vertex_attr_array![4 => Float32x3, 5 => Uint32, 6 => Float16x4, 11 => Float16x4, 7 => Float32];
const LINE_AFTER: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![8 => Float32x3, 9 => Uint32];
const MARK: [wgpu::VertexAttribute; 5] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float16x4, 4 => Float16x4, 3 => Float32];
const FILL: [wgpu::VertexAttribute; 8] = wgpu::vertex_attr_array![
    0 => Float32x4, 1 => Float32x3, 2 => Float32, 3 => Float32x3, 4 => Float32, 6 => Float32x3, 7 => Float32, 5 => Float16x4
];
const TRIANGLE: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Uint32, 2 => Float32x3, 3 => Float32x3, 4 => Float16x4, 5 => Float16x4
];

/// Which kinds of elements are drawn; pipelines are created only for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TrackKinds {
    pub lines: bool,
    /// Lines on the ground with short segments.
    pub ground_lines: bool,
    pub marks: bool,
    pub fills: bool,
    pub polygons: bool,
}

/// Elements of a frame.
pub(crate) struct DrawnTracks<'d> {
    pub points: &'d mut Vec<LinePoint>,
    /// How many points, the first ones, are of lines on the ground with short segments.
    pub ground_points: usize,
    pub marks: &'d [Mark],
    pub fills: &'d [Fill],
    pub triangles: &'d [Triangle],
}

/// Pipelines and buffers.
pub(crate) struct TracksDrawable {
    lines: Option<Batch>,
    /// Pipelines of lines on the ground, with air.
    ground_lines: Vec<wgpu::RenderPipeline>,
    /// How many of the segments, the first ones, these draw.
    ground_segments: u32,
    marks: Option<Batch>,
    fills: Option<Batch>,
    polygons: Option<Batch>,
    frame: wgpu::Buffer,
    /// One without air; otherwise one for an eye outside the air and one for an eye inside.
    bind_groups: Vec<wgpu::BindGroup>,
    layouts: Vec<wgpu::BindGroupLayout>,
    side: usize,
    pub shader_bytes: u64,
}

/// Elements of one kind.
struct Batch {
    /// One for each bind group.
    pipelines: Vec<wgpu::RenderPipeline>,
    buffer: Option<wgpu::Buffer>,
    label: &'static str,
    count: u32,
}

const LABEL: &str = "terrella tracks";

/// Lines have a padding point before the first and after the last, without segments.
const PADDING: usize = 2;

impl TracksDrawable {
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        kinds: TrackKinds,
        air: Option<&AirTextures>,
    ) -> Result<Self, ShaderError> {
        let frame = super::uniform_buffer::<TrackUniforms>(device, LABEL);
        let sides = AirSide::of_air(air.is_some());
        let bound = sides.iter().map(|side| {
            let bindings = bindings(&frame, air.zip(*side));
            super::bind(device, LABEL, bindings)
        });
        let (layouts, bind_groups): (Vec<_>, Vec<_>) = bound.unzip();
        let mut shader_bytes = 0;
        let mut batch = |is_wanted: bool, kind: TrackKind, label: &'static str, buffers: &[_]| {
            if !is_wanted {
                return Ok::<_, ShaderError>(None);
            }
            let target = format.target_color();
            let mut pipelines = Vec::with_capacity(sides.len());
            for (air, layout) in sides.iter().copied().zip(&layouts) {
                let shader = ShaderModule::new(device, &TracksVariant { kind, target, air })?;
                shader_bytes += shader.bytes;
                let pipeline = PipelineDescription {
                    label,
                    bind_groups: Some(&[Some(layout)]),
                    module: &shader.module,
                    buffers,
                    primitive: wgpu::PrimitiveState {
                        topology: wgpu::PrimitiveTopology::TriangleStrip,
                        ..Default::default()
                    },
                    format,
                    // Tracks are hidden by what is drawn before the Earth, but hide nothing.
                    writes_depth: false,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                };
                pipelines.push(pipeline.create(device));
            }
            Ok(Some(Batch {
                pipelines,
                buffer: None,
                label,
                count: 0,
            }))
        };
        let point = size_of::<LinePoint>();
        let lines = [
            instances(point, &LINE_BEFORE),
            instances(point, &LINE_A),
            instances(point, &LINE_B),
            instances(point, &LINE_AFTER),
        ];
        let marks = [instances(size_of::<Mark>(), &MARK)];
        let fills = [instances(size_of::<Fill>(), &FILL)];
        let polygons = [instances(size_of::<Triangle>(), &TRIANGLE)];
        let label = "terrella track lines on the ground";
        let is_wanted = kinds.ground_lines && air.is_some();
        let ground_lines = batch(is_wanted, TrackKind::GroundLines, label, &lines)?;
        Ok(Self {
            ground_lines: ground_lines.map_or_else(Vec::new, |batch| batch.pipelines),
            ground_segments: 0,
            lines: batch(
                kinds.lines,
                TrackKind::Lines,
                "terrella track lines",
                &lines,
            )?,
            marks: batch(
                kinds.marks,
                TrackKind::Marks,
                "terrella track marks",
                &marks,
            )?,
            fills: batch(
                kinds.fills,
                TrackKind::Fills,
                "terrella track fills",
                &fills,
            )?,
            polygons: batch(
                kinds.polygons,
                TrackKind::Polygons,
                "terrella track polygons",
                &polygons,
            )?,
            frame,
            bind_groups,
            layouts,
            side: 0,
            shader_bytes,
        })
    }

    /// The same for another view, through that view's air if there is any: it shares pipelines and has its own buffers.
    pub fn for_another_view(&self, device: &wgpu::Device, air: Option<&AirTextures>) -> Self {
        let frame = super::uniform_buffer::<TrackUniforms>(device, LABEL);
        let sides = AirSide::of_air(air.is_some()).iter().zip(&self.layouts);
        let bind_groups = sides.map(|(side, layout)| {
            let bindings = bindings(&frame, air.zip(*side));
            super::bind_to(device, LABEL, layout, bindings)
        });
        let batch = |batch: &Option<Batch>| batch.as_ref().map(Batch::for_another_view);
        Self {
            lines: batch(&self.lines),
            ground_lines: self.ground_lines.clone(),
            ground_segments: 0,
            marks: batch(&self.marks),
            fills: batch(&self.fills),
            polygons: batch(&self.polygons),
            bind_groups: bind_groups.collect(),
            frame,
            layouts: self.layouts.clone(),
            side: 0,
            shader_bytes: self.shader_bytes,
        }
    }

    /// Draws for an eye on this side of the air from now on.
    pub fn set_side(&mut self, side: AirSide) {
        self.side = match self.bind_groups.len() {
            1 => 0,
            _ => side as usize,
        };
    }

    /// Uploads the elements of this frame. `points` is extended temporarily and restored. Returns the bytes written.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &TrackUniforms,
        drawn: DrawnTracks<'_>,
    ) -> u64 {
        let DrawnTracks {
            points,
            ground_points,
            marks,
            fills,
            triangles,
        } = drawn;
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        let mut bytes = size_of::<TrackUniforms>() as u64;
        if let Some(batch) = &mut self.lines {
            // Segment i connects points i + 1 and i + 2; segments from and to the padding are not drawn.
            let count = points.len().saturating_sub(1);
            if let Some(first) = points.first().copied() {
                let end = LinePoint { flags: 0, ..first };
                points.push(end);
                points.push(end);
                points.rotate_right(1);
                bytes += batch.write(device, queue, points, count);
                points.rotate_left(1);
                points.truncate(points.len() - PADDING);
            }
            batch.count = count as u32;
            let ground_segments = ground_points.min(count) as u32;
            self.ground_segments = match self.ground_lines.is_empty() {
                true => 0,
                false => ground_segments,
            };
        }
        if let Some(batch) = &mut self.marks {
            bytes += batch.write(device, queue, marks, marks.len());
        }
        if let Some(batch) = &mut self.fills {
            bytes += batch.write(device, queue, fills, fills.len());
        }
        if let Some(batch) = &mut self.polygons {
            bytes += batch.write(device, queue, triangles, triangles.len());
        }
        bytes
    }

    /// Draws all elements.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(bind_group) = self.bind_groups.get(self.side) else {
            return;
        };
        for batch in [&self.polygons, &self.fills].into_iter().flatten() {
            batch.render(pass, self.side, bind_group);
        }
        if let Some(batch) = &self.lines
            && let Some(buffer) = batch.buffer.as_ref().filter(|_| batch.count > 0)
        {
            pass.set_bind_group(0, bind_group, &[]);
            for slot in 0..4 {
                let from = u64::from(slot) * size_of::<LinePoint>() as u64;
                pass.set_vertex_buffer(slot, buffer.slice(from..));
            }
            let ground = self.ground_lines.get(self.side);
            if let Some(pipeline) = ground.filter(|_| self.ground_segments > 0) {
                pass.set_pipeline(pipeline);
                pass.draw(0..4, 0..self.ground_segments);
            }
            if self.ground_segments < batch.count {
                pass.set_pipeline(&batch.pipelines[self.side]);
                pass.draw(0..4, self.ground_segments..batch.count);
            }
        }
        if let Some(batch) = &self.marks {
            batch.render(pass, self.side, bind_group);
        }
    }

    /// Number of draw calls and triangles of a frame.
    pub fn calls(&self) -> (u32, u32) {
        let batches = [&self.polygons, &self.fills, &self.lines, &self.marks];
        let batches = batches.into_iter().flatten();
        let lines = self.lines.as_ref().map_or(0, |batch| batch.count);
        // Lines of both kinds are two calls.
        let more = u32::from((1..lines).contains(&self.ground_segments));
        batches.fold((more, 0), |(calls, triangles), batch| {
            (
                calls + u32::from(batch.count > 0),
                triangles + 2 * batch.count,
            )
        })
    }
}

/// Group 0.
fn bindings<'a>(
    frame: &'a wgpu::Buffer,
    air: Option<(&'a AirTextures, AirSide)>,
) -> Vec<Binding<'a>> {
    let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let mut bindings = vec![(
        super::uniform_entry(0, stages, size_of::<TrackUniforms>()),
        wgpu::BindGroupEntry {
            binding: 0,
            resource: frame.as_entire_binding(),
        },
    )];
    if let Some((air, side)) = air {
        bindings.extend(air.bindings(side));
    }
    bindings
}

impl Batch {
    /// The same pipelines, with nothing to draw.
    fn for_another_view(&self) -> Self {
        Self {
            pipelines: self.pipelines.clone(),
            buffer: None,
            label: self.label,
            count: 0,
        }
    }

    /// Uploads elements; `count` of them are drawn.
    fn write<T: Pod>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        things: &[T],
        count: usize,
    ) -> u64 {
        self.count = count as u32;
        if things.is_empty() {
            return 0;
        }
        let bytes: &[u8] = bytemuck::cast_slice(things);
        let size = bytes.len() as u64;
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() >= size => buffer,
            // Twice the required size, so that growing content seldom needs a new buffer.
            _ => device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: 2 * size,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        };
        queue.write_buffer(&buffer, 0, bytes);
        self.buffer = Some(buffer);
        size
    }

    fn render(&self, pass: &mut wgpu::RenderPass<'_>, side: usize, bind_group: &wgpu::BindGroup) {
        let Some(buffer) = self.buffer.as_ref().filter(|_| self.count > 0) else {
            return;
        };
        pass.set_pipeline(&self.pipelines[side]);
        pass.set_bind_group(0, bind_group, &[]);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..4, 0..self.count);
    }
}

fn instances(
    stride: usize,
    attributes: &[wgpu::VertexAttribute],
) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout {
        array_stride: stride as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes,
    })
}
