//! The spacecraft that the chase camera follows: the player's own drawable in front of the Earth.
//!
//! The player is a host like any other: it draws its craft into the pass first, the Earth and its air after it. Nothing
//! of it but its shader exists before the first chase picture.

mod mesh;

use super::camera::OrbitalMotion;
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DMat4, DVec3, Mat4, Vec2, Vec3};
use mesh::CraftVertex;
use terrella::frames::{Ellipsoid, illumination};
use terrella::internals::gpu::{
    GpuContext, PassFormat, PipelineDescription, ShaderError, ShaderText, TargetColor,
};
use terrella::{EarthError, EarthOptions, EyeView, FrameStats, Sky};
use terrella_ground::light::exposure_factor;

/// The shader's text: how light is shown is the Earth's, the materials' numbers are ours.
fn shader(target: TargetColor) -> Result<ShaderText, ShaderError> {
    let mut shader = ShaderText::assemble("common/displayed.wgsl", &target.conditions())?;
    let constants = mesh::material_constants();
    let craft = ShaderText::assemble("craft.wgsl", &[])?;
    let of_constants = constants.lines().map(|_| ("craft.wgsl", 1));
    shader.origins.extend(of_constants.chain(craft.origins));
    shader.text += &constants;
    shader.text += &craft.text;
    Ok(shader)
}

/// Part of the sunlight that the Earth throws back (Bond albedo).
const EARTH_ALBEDO: f64 = 0.3;

/// The craft at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CraftPose {
    /// Where its middle is, ITRF metres.
    pub position_itrf_m: DVec3,
    /// Its axes in ITRF; where it flies level x is along flight, y to the right, z straight down.
    pub itrf_from_craft: DMat3,
    /// How much of the Sun's disc Earth and Moon leave in sight, 0…1.
    pub sunlight: f64,
    /// Irradiance from the day side below on a sheet that faces the Earth; the Sun's in space is 1.
    pub earthshine: f64,
}

impl CraftPose {
    /// The craft at a satellite's place.
    pub fn new(motion: &OrbitalMotion, ellipsoid: &Ellipsoid, sky: &Sky) -> Self {
        let position_itrf_m = motion.position_itrf_m;
        let sun_itrf_m = sky.sun_itrf * sky.sun_distance_m;
        let past_earth = illumination(position_itrf_m, sun_itrf_m, ellipsoid).1;
        let past_moon = sky.moon_shadow();
        let past_moon = past_moon.map_or(1.0, |shadow| shadow.sun_left(position_itrf_m));
        Self {
            position_itrf_m,
            itrf_from_craft: motion.itrf_from_level(ellipsoid),
            sunlight: past_earth * past_moon,
            earthshine: earthshine(position_itrf_m, ellipsoid, sky.sun_itrf),
        }
    }

    /// The same with other axes.
    pub(super) fn turned(self, itrf_from_craft: DMat3) -> Self {
        Self {
            itrf_from_craft,
            ..self
        }
    }

    fn frame(&self, view: &EyeView, sky: &Sky, exposure: f32) -> CraftFrame {
        let (eye_itrf_m, clip_from_eye) = view.to_itrf();
        let from_eye_m = self.position_itrf_m - eye_itrf_m;
        let craft_from_itrf = self.itrf_from_craft.transpose();
        let clip_from_craft = clip_from_eye
            * DMat4::from_translation(from_eye_m)
            * DMat4::from_mat3(self.itrf_from_craft);
        let sun = craft_from_itrf * sky.sun_itrf;
        CraftFrame {
            clip_from_craft: clip_from_craft.as_mat4(),
            sun: sun.as_vec3(),
            sunlight: self.sunlight as f32,
            eye: (craft_from_itrf * -from_eye_m).as_vec3(),
            earthshine: self.earthshine as f32,
            wing: wing_turn(sun),
            exposure,
            padding: 0.0,
        }
    }
}

/// (cos, sin) of the rotation about y that turns the solar cells, −z at rest, towards the Sun as far as possible.
fn wing_turn(sun_craft: DVec3) -> Vec2 {
    // (x, z) ↦ (c x + s z, c z − s x) takes (0, −1) to (−s, −c).
    let across = sun_craft.x.hypot(sun_craft.z);
    if across < 1e-6 {
        return Vec2::X;
    }
    Vec2::new(
        (-sun_craft.z / across) as f32,
        (-sun_craft.x / across) as f32,
    )
}

/// Irradiance from the Earth on a sheet that faces it, an estimate: the albedo, times the view factor 1/r² of a sphere,
/// times the mean of the Sun's height over the part in sight. That mean is μ below a high Sun, and goes to 0 softly as
/// the day's last rim sets: (μ + √(μ² + w²))/2 less its value at night, w a quarter of the rim's sine.
fn earthshine(position_itrf_m: DVec3, ellipsoid: &Ellipsoid, sun_itrf: DVec3) -> f64 {
    let p = ellipsoid.scaled_from_itrf() * position_itrf_m;
    let r = p.length().max(1.0);
    let mu = position_itrf_m.normalize_or_zero().dot(sun_itrf);
    let rim_sine = (1.0 - 1.0 / (r * r)).max(0.0).sqrt();
    let width = 0.25 * rim_sine;
    let soft = |mu: f64| 0.5 * (mu + mu.hypot(width));
    EARTH_ALBEDO / (r * r) * (soft(mu) - soft(-rim_sine)).max(0.0)
}

/// `CraftFrame` of `shaders/craft.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct CraftFrame {
    clip_from_craft: Mat4,
    sun: Vec3,
    sunlight: f32,
    eye: Vec3,
    earthshine: f32,
    wing: Vec2,
    exposure: f32,
    padding: f32,
}

/// The craft of a picture or a window: made by the first moment that has one.
pub struct CraftLayer {
    format: PassFormat,
    shader: wgpu::ShaderModule,
    drawable: Option<CraftDrawable>,
    is_shown: bool,
}

impl CraftLayer {
    /// For the pass of an Earth with these options.
    pub fn new(gpu: &GpuContext, options: &EarthOptions) -> Result<Self, EarthError> {
        let format = options.pass_format();
        Ok(Self {
            shader: shader(format.target_color())?.compile(&gpu.device, "terrella craft")?,
            format,
            drawable: None,
            is_shown: false,
        })
    }

    /// Follows the pass to another sample count.
    pub fn set_samples(&mut self, samples: u32) {
        if samples != self.format.samples {
            self.format.samples = samples;
            self.drawable = None;
        }
    }

    /// Writes the craft of a picture, if it has one, exposed as its Earth is, and counts it.
    pub fn prepare(
        &mut self,
        gpu: &GpuContext,
        pose: Option<&CraftPose>,
        view: &EyeView,
        sky: &Sky,
        stats: &mut FrameStats,
    ) {
        self.is_shown = pose.is_some();
        let Some(pose) = pose else { return };
        let drawable = self
            .drawable
            .get_or_insert_with(|| CraftDrawable::new(gpu, &self.shader, self.format));
        let exposure = exposure_factor(stats.exposure_ev) as f32;
        let frame = pose.frame(view, sky, exposure);
        gpu.queue
            .write_buffer(&drawable.frame, 0, bytemuck::bytes_of(&frame));
        stats.triangles += drawable.vertex_count / 3;
        stats.draw_calls += 1;
        stats.uploaded_bytes += size_of::<CraftFrame>() as u64;
    }

    /// Draws it. Call it before the Earth, so that the air is behind it.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let (true, Some(drawable)) = (self.is_shown, &self.drawable) {
            drawable.render(pass);
        }
    }
}

struct CraftDrawable {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    vertices: wgpu::Buffer,
    vertex_count: u32,
}

impl CraftDrawable {
    fn new(gpu: &GpuContext, shader: &wgpu::ShaderModule, format: PassFormat) -> Self {
        let device = &gpu.device;
        let mesh = mesh::vertices();
        let vertices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella craft vertices"),
            size: size_of_val(mesh.as_slice()) as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue
            .write_buffer(&vertices, 0, bytemuck::cast_slice(&mesh));
        let frame = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella craft frame"),
            size: size_of::<CraftFrame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let pipeline = PipelineDescription {
            label: "terrella craft",
            bind_groups: None,
            module: shader,
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<CraftVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &mesh::ATTRIBUTES,
            })],
            primitive: wgpu::PrimitiveState::default(),
            format,
            writes_depth: true,
            blend: None,
        }
        .create(device);
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrella craft"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: frame.as_entire_binding(),
            }],
        });
        Self {
            pipeline,
            bind_group,
            frame,
            vertices,
            vertex_count: mesh.len() as u32,
        }
    }

    fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.draw(0..self.vertex_count, 0..1);
    }
}

#[cfg(test)]
#[path = "craft/tests.rs"]
mod tests;
