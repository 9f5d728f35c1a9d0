//! The cost of a frame's texture samples alone: a reference pass for frame times.
//!
//! | file | content |
//! |---|---|
//! | `samples` | the sampled textures with their number of samples, and the shader |
//! | `view` | position of the eye, and the Earth's edge on screen |

mod samples;
mod view;

use samples::Samples;
use terrella::internals::gpu::{GpuContext, PassFormat, PipelineDescription};
use terrella::{EarthOptions, EyeView, Sky};
use view::{CORNERS, FloorView};

/// A pass that takes the texture samples of a frame and computes no light.
///
/// It covers the disc of the Earth as seen from the eye, one pixel at a time as frames do, in the same targets, with the same number of samples a
/// pixel and the same resolve. For each pixel it computes where the ray meets the exact ellipsoid, as the Earth's shader does, and samples there:
/// each map with its texture coordinates and the footprint of the pixel, so that as many texels are read from the same mip levels; clouds once more
/// if they cast shadows; the air's tables at coordinates that increase with the zenith angles of ray and Sun. It takes one sample of each map that
/// the shading reads, two of the sunlight table, one more of it for clouds, and one of each other table of the air; on the night side also one of
/// the city lights, and with moonlight those that are read for the Moon.
///
/// It is not a lower bound for all programs: another one might need fewer samples or smaller maps. It is the cost of this image's samples without
/// any use of them, so that the ratio of frame to floor gives the cost of light, air, meshes, sky and CPU work in units of sampling. It omits some
/// reads of a frame: cloud shadows and clouds are sampled at the place itself, displaced by a constant and not by their height; near the terminator
/// the Earth reads city lights in blocks that are partly dark; tables are empty, which hardware may compress; an Earth of a pack has the floor of
/// its coarsest whole maps; terrain has that of the smooth ellipsoid; synthetic detail, stars, the Milky Way and tracks are not included. From the
/// distance of the Moon, both are mostly the cost of any pass that clears and waits.
pub struct Floor {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    view: wgpu::Buffer,
    ellipsoid: terrella::frames::Ellipsoid,
    /// Whether the eye is above the ground; otherwise nothing is drawn.
    sees_ground: bool,
}

impl Floor {
    /// Makes the drawing for an Earth with these options, in the pass that it is drawn in.
    pub fn new(gpu: &GpuContext, options: &EarthOptions, format: PassFormat) -> Self {
        let device = &gpu.device;
        let samples = Samples::of(options);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("terrella floor"),
            source: wgpu::ShaderSource::Wgsl(samples.shader().into()),
        });
        let pipeline = PipelineDescription {
            label: "terrella floor",
            bind_groups: None,
            module: &module,
            buffers: &[],
            primitive: Default::default(),
            format,
            writes_depth: true,
            blend: None,
        }
        .create(device);
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella floor"),
            size: size_of::<FloorView>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            bind_group: samples.bind(gpu, options, &pipeline, &view),
            pipeline,
            view,
            ellipsoid: options.figure.ellipsoid(),
            sees_ground: false,
        }
    }

    /// Writes where the eye and the Sun are, for a target of `size` pixels.
    pub fn prepare(&mut self, queue: &wgpu::Queue, view: &EyeView, sky: &Sky, size: (u32, u32)) {
        let view = FloorView::new(&self.ellipsoid, view, sky.sun_itrf, size);
        self.sees_ground = view.is_some();
        if let Some(view) = view {
            queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        }
    }

    /// Draws the floor into a pass; nothing for an eye in the ground.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if !self.sees_ground {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3 * (CORNERS - 2), 0..1);
    }
}
