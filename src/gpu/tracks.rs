//! The drawable of satellites' tracks: lines, marks and fills of plain values. `crate::tracks` makes them of satellites.

use super::shader::ShaderModule;
use super::{
    FrameUniforms, PassFormat, PipelineDescription, ShaderError, TrackKind, TracksVariant,
};
use bytemuck::{Pod, Zeroable};

/// `TrackUniforms` of `shaders/tracks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct TrackUniforms {
    /// The eye, its rays and its projection; light and air of it are not read.
    pub frame: FrameUniforms,
    /// Width and height of the viewport, pixels.
    pub size_px: [f32; 2],
    /// Upper boundary of the air, scaled space.
    pub air_top: f32,
    /// 1 draws what lies beyond the air's near boundary, −1 what lies before it.
    pub side: f32,
}

/// A point of a line.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct LinePoint {
    /// From the eye, ITRF metres.
    pub from_eye_m: [f32; 3],
    /// [`FROM_PREVIOUS`](super::TRACK_FROM_PREVIOUS) where a segment comes to it from the point before, [`ON_GROUND`](super::TRACK_ON_GROUND) where it lies there.
    pub flags: u32,
    /// Display values and opacity.
    pub color: [u8; 4],
    /// Half the width of the segment that comes to it, pixels.
    pub half_width_px: f32,
}

/// A dot, or with [`ON_GROUND`](super::TRACK_ON_GROUND) a ring.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Mark {
    /// From the eye, ITRF metres.
    pub from_eye_m: [f32; 3],
    /// [`ON_GROUND`](super::TRACK_ON_GROUND) or 0.
    pub flags: u32,
    /// Display values and opacity.
    pub color: [u8; 4],
    /// Radius, pixels.
    pub radius_px: f32,
}

/// The ground within a cone and in sight of its apex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Fill {
    /// Where on screen it can be: least x and y, greatest x and y, −1…1.
    pub bounds: [f32; 4],
    /// The satellite, scaled space.
    pub apex: [f32; 3],
    /// Depth of its nearest place.
    pub depth: f32,
    /// Straight down, unit, ITRF axes.
    pub down: [f32; 3],
    /// Tangent of the cone's half angle.
    pub tangent: f32,
    /// Display values and opacity.
    pub color: [u8; 4],
}

const LINE_BEFORE: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const LINE_A: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![1 => Float32x3, 2 => Uint32, 3 => Unorm8x4];
const LINE_B: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![4 => Float32x3, 5 => Uint32, 6 => Unorm8x4, 7 => Float32];
const LINE_AFTER: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![8 => Float32x3, 9 => Uint32];
const MARK: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Unorm8x4, 3 => Float32];
const FILL: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x4, 1 => Float32x3, 2 => Float32, 3 => Float32x3, 4 => Float32, 5 => Unorm8x4
];

/// Which kinds of thing there are to draw; pipelines are made for no others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TrackKinds {
    pub lines: bool,
    pub marks: bool,
    pub fills: bool,
}

/// Pipelines and buffers.
pub(crate) struct TracksDrawable {
    lines: Option<Batch>,
    marks: Option<Batch>,
    fills: Option<Batch>,
    /// Beyond the air's near boundary, and before it.
    frames: [wgpu::Buffer; 2],
    bind_groups: [wgpu::BindGroup; 2],
    pub shader_bytes: u64,
}

/// Things of one kind.
struct Batch {
    pipeline: wgpu::RenderPipeline,
    buffer: Option<wgpu::Buffer>,
    label: &'static str,
    count: u32,
}

/// Lines are drawn with a point before the first and one after the last, which no segment comes to.
const PADDING: usize = 2;

impl TracksDrawable {
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        kinds: TrackKinds,
    ) -> Result<Self, ShaderError> {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrella tracks"),
            entries: &[super::uniform_entry(0, stages, size_of::<TrackUniforms>())],
        });
        let frames = ["terrella tracks beyond", "terrella tracks before"]
            .map(|label| super::uniform_buffer::<TrackUniforms>(device, label));
        let bind_groups = frames.each_ref().map(|frame| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("terrella tracks"),
                layout: &layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: frame.as_entire_binding(),
                }],
            })
        });
        let mut shader_bytes = 0;
        let mut batch = |is_wanted: bool, kind: TrackKind, label: &'static str, buffers: &[_]| {
            if !is_wanted {
                return Ok::<_, ShaderError>(None);
            }
            let target = format.target_color();
            let shader = ShaderModule::new(device, &TracksVariant { kind, target })?;
            shader_bytes += shader.bytes;
            Ok(Some(Batch {
                pipeline: PipelineDescription {
                    label,
                    bind_groups: Some(&[Some(&layout)]),
                    module: &shader.module,
                    buffers,
                    primitive: wgpu::PrimitiveState {
                        topology: wgpu::PrimitiveTopology::TriangleStrip,
                        ..Default::default()
                    },
                    format,
                    // What is drawn before the Earth hides tracks, tracks hide nothing.
                    writes_depth: false,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                }
                .create(device),
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
        Ok(Self {
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
            frames,
            bind_groups,
            shader_bytes,
        })
    }

    /// Writes what is drawn from now on; `points` is used to write from and left as it was. Answers the bytes written.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &TrackUniforms,
        points: &mut Vec<LinePoint>,
        marks: &[Mark],
        fills: &[Fill],
    ) -> u64 {
        for (buffer, side) in self.frames.iter().zip([1.0, -1.0]) {
            let frame = TrackUniforms { side, ..*frame };
            queue.write_buffer(buffer, 0, bytemuck::bytes_of(&frame));
        }
        let mut bytes = 2 * size_of::<TrackUniforms>() as u64;
        if let Some(batch) = &mut self.lines {
            // Segment i goes from point i + 1 to i + 2; those from and to the padding are not drawn.
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
        }
        if let Some(batch) = &mut self.marks {
            bytes += batch.write(device, queue, marks, marks.len());
        }
        if let Some(batch) = &mut self.fills {
            bytes += batch.write(device, queue, fills, fills.len());
        }
        bytes
    }

    /// Draws what lies beyond the near boundary of the air, before the air is drawn. Fills lie there: the ground does.
    pub fn render_beyond_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(batch) = &self.fills {
            batch.render(pass, &self.bind_groups[0]);
        }
        self.render(pass, &self.bind_groups[0]);
    }

    /// Draws what lies before the air, after the air is drawn.
    pub fn render_before_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render(pass, &self.bind_groups[1]);
    }

    fn render(&self, pass: &mut wgpu::RenderPass<'_>, side: &wgpu::BindGroup) {
        if let Some(batch) = &self.lines
            && let Some(buffer) = batch.buffer.as_ref().filter(|_| batch.count > 0)
        {
            pass.set_pipeline(&batch.pipeline);
            pass.set_bind_group(0, side, &[]);
            for slot in 0..4 {
                let from = u64::from(slot) * size_of::<LinePoint>() as u64;
                pass.set_vertex_buffer(slot, buffer.slice(from..));
            }
            pass.draw(0..4, 0..batch.count);
        }
        if let Some(batch) = &self.marks {
            batch.render(pass, side);
        }
    }

    /// Draw calls and triangles of a frame.
    pub fn calls(&self) -> (u32, u32) {
        let twice = [&self.lines, &self.marks, &self.marks, &self.lines];
        let batches = twice.into_iter().chain([&self.fills]).flatten();
        batches.fold((0, 0), |(calls, triangles), batch| {
            (
                calls + u32::from(batch.count > 0),
                triangles + 2 * batch.count,
            )
        })
    }
}

impl Batch {
    /// Writes things of which `count` are drawn.
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
            // Twice as much as is needed, so that things that grow seldom want a new one.
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

    fn render(&self, pass: &mut wgpu::RenderPass<'_>, side: &wgpu::BindGroup) {
        let Some(buffer) = self.buffer.as_ref().filter(|_| self.count > 0) else {
            return;
        };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, side, &[]);
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
