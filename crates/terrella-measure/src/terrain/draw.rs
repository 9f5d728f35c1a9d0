//! Drawing the triangles of a flat tree, to time them: no maps, no air, each face in one grey by its slope.

use super::quadtree::GridQuadtree;
use glam::{DMat4, DVec3, Mat4, Vec3};
use image::RgbaImage;
use terrella::internals::gpu::{FrameTargets, GpuContext, PassFormat, PipelineDescription};
use terrella_play::{PlayError, rgba_image};

/// Width and height of the picture, pixels.
pub(super) const SIZE: (u32, u32) = (640, 480);
/// Of the picture from top to bottom, radians.
const FIELD_OF_VIEW_RAD: f64 = 1.0;
/// How far below the horizon the middle of the picture is, radians.
const DOWN_RAD: f64 = 0.15;
/// Nearest that is drawn, metres.
const NEAR_M: f64 = 1.0;

const SHADER: &str = include_str!("../../shaders/terrain.wgsl");

/// Render target of trees.
pub(super) struct Canvas {
    gpu: GpuContext,
    targets: FrameTargets,
    pipeline: wgpu::RenderPipeline,
    view: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    posts: wgpu::Buffer,
    middle_m: DVec3,
    triangles: wgpu::Buffer,
    indices: u32,
}

impl Canvas {
    pub fn new(gpu: GpuContext) -> Self {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("terrella terrain"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let pipeline = PipelineDescription {
            label: "terrella terrain",
            bind_groups: None,
            module: &module,
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Vec3>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3],
            })],
            primitive: Default::default(),
            format: PassFormat {
                color: FrameTargets::COLOR,
                further: &[],
                samples: 1,
                depth: FrameTargets::REVERSED_DEPTH,
                development: Default::default(),
                tone: Default::default(),
                bloom: Default::default(),
                grade: Default::default(),
            },
            writes_depth: true,
            blend: None,
        }
        .create(device);
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella terrain view"),
            size: 80,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrella terrain"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: view.as_entire_binding(),
            }],
        });
        Self {
            targets: FrameTargets::new(device, SIZE, 1),
            pipeline,
            view,
            bind_group,
            posts: posts_buffer(device, 0),
            middle_m: DVec3::ZERO,
            triangles: triangles_buffer(device, 0),
            indices: 0,
            gpu,
        }
    }

    /// Uploads all posts of a tree; `false` if the device cannot hold them.
    pub fn set_posts(&mut self, tree: &GridQuadtree) -> bool {
        let (columns, rows) = tree.size();
        let count = columns * rows;
        let bytes = (count * size_of::<Vec3>()) as u64;
        if bytes > self.gpu.device.limits().max_buffer_size {
            return false;
        }
        let middle = (rows / 2) * columns + columns / 2;
        self.middle_m = tree.post_m(middle as u32);
        let posts: Vec<Vec3> = (0..count as u32)
            .map(|post| (tree.post_m(post) - self.middle_m).as_vec3())
            .collect();
        if self.posts.size() != bytes.max(4) {
            self.posts = posts_buffer(&self.gpu.device, bytes);
        }
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.posts, 0, bytemuck::cast_slice(&posts));
        true
    }

    /// Uploads triangles, three numbers of posts each; `false` if the device cannot hold them.
    pub fn set_triangles(&mut self, indices: &[u32]) -> bool {
        let bytes = size_of_val(indices) as u64;
        if bytes > self.gpu.device.limits().max_buffer_size {
            return false;
        }
        if self.triangles.size() < bytes {
            self.triangles = triangles_buffer(&self.gpu.device, bytes);
        }
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.triangles, 0, bytemuck::cast_slice(indices));
        self.indices = indices.len() as u32;
        true
    }

    /// Draws a frame from a place that looks north, and waits for the device.
    pub fn draw(&self, eye_m: DVec3) -> Result<(), PlayError> {
        let numbers = view_numbers(eye_m - self.middle_m);
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.view, 0, bytemuck::cast_slice(&numbers));
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("terrella terrain"),
            });
        let mut pass = self.targets.begin_pass(&mut encoder);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, self.posts.slice(..));
        pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.indices, 0, 0..1);
        drop(pass);
        queue.submit([encoder.finish()]);
        match self.gpu.device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(error) => Err(PlayError::DeviceLost(error.to_string())),
        }
    }

    /// The picture that was drawn last, read back.
    pub fn picture(&self) -> Result<RgbaImage, PlayError> {
        let GpuContext { device, queue, .. } = &self.gpu;
        let texels = self.targets.read_back(device, queue)?;
        Ok(rgba_image(SIZE.0, SIZE.1, texels)?)
    }
}

/// The shader's `View`: clip space (reversed depth, infinitely far) from metres east, north and up of the eye, and the eye.
fn view_numbers(eye_from_middle_m: DVec3) -> [f32; 20] {
    let scale = 1.0 / (0.5 * FIELD_OF_VIEW_RAD).tan();
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    let (sin, cos) = DOWN_RAD.sin_cos();
    let (forward, up) = (DVec3::new(0.0, cos, -sin), DVec3::new(0.0, sin, cos));
    let rows = [
        (DVec3::X * scale / aspect).extend(0.0),
        (up * scale).extend(0.0),
        DVec3::ZERO.extend(NEAR_M),
        forward.extend(0.0),
    ];
    let clip = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    let clip: Mat4 = clip.as_mat4();
    let mut numbers = [0.0; 20];
    numbers[..16].copy_from_slice(&clip.to_cols_array());
    numbers[16..19].copy_from_slice(&eye_from_middle_m.as_vec3().to_array());
    numbers
}

fn posts_buffer(device: &wgpu::Device, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella terrain posts"),
        size: bytes.max(4),
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn triangles_buffer(device: &wgpu::Device, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella terrain triangles"),
        size: bytes.max(4),
        usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_backend_takes_the_shader() {
        crate::backends::compile_for_every_backend(super::SHADER);
    }
}
