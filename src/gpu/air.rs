//! The drawable of the air: the halo's ring, and the tables for all shaders that draw through the air.

mod glow;
mod textures;
mod view;

use super::shader::{ShaderModule, ShaderVariant};
use super::{AirVariant, AirViewVariant};
use super::{PassFormat, PipelineDescription, ShaderError};
use crate::plan::{AirPlan, AirSide, AirUniforms, FramePlan, FrameUniforms, SurfaceLight};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use glow::Glow;
use terrella_ground::air::Billboard;
pub(crate) use textures::{AirTextures, Binding};
use view::AirView;

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct AirVertex {
    clip: [f32; 4],
    ray: [f32; 3],
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x3];

pub(crate) struct AirDrawable {
    format: PassFormat,
    /// For the eye outside and inside the air.
    halos: [Halo; 2],
    vertices: wgpu::Buffer,
    staging: Vec<AirVertex>,
    indices: wgpu::Buffer,
    /// Range of the indices to draw.
    drawn: std::ops::Range<u32>,
    side: AirSide,
    textures: AirTextures,
    /// The sky view for an eye in the air.
    view: Option<AirView>,
    moonlight: bool,
    /// Airglow and aurora; `None` if they are not drawn.
    glow: Option<Glow>,
}

struct Halo {
    side: AirSide,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
    plain: HaloPass,
    /// For frames with the Moon's shadow.
    eclipsed: HaloPass,
}

/// Pipeline of one variant of the ring's shader, created on first use or together with all others.
#[derive(Clone, Default)]
struct HaloPass {
    /// `None` if it is not needed or cannot be created.
    variant: Option<AirVariant>,
    pipeline: Option<wgpu::RenderPipeline>,
}

impl HaloPass {
    fn of(variant: AirVariant) -> Self {
        Self {
            variant: Some(variant),
            pipeline: None,
        }
    }

    /// Creates the pipeline if it does not exist. After a failure it does not try again.
    fn make(
        &mut self,
        device: &wgpu::Device,
        format: PassFormat,
        layout: &wgpu::BindGroupLayout,
    ) -> Result<(), ShaderError> {
        if self.pipeline.is_none()
            && let Some(variant) = self.variant.take()
        {
            self.pipeline = Some(pipeline(device, format, layout, variant)?);
            self.variant = Some(variant);
        }
        Ok(())
    }
}

impl Halo {
    fn new(
        device: &wgpu::Device,
        textures: &AirTextures,
        variant: AirVariant,
        eclipses: bool,
    ) -> Self {
        let side = variant.side;
        let (layout, bind_group) = super::bind(device, label(side), textures.bindings(side));
        // During an eclipse the Moon is new and gives no light.
        let eclipsed = AirVariant {
            eclipse: true,
            moonlight: false,
            ..variant
        };
        Self {
            side,
            layout,
            bind_group,
            plain: HaloPass::of(variant),
            eclipsed: match eclipses {
                true => HaloPass::of(eclipsed),
                false => HaloPass::default(),
            },
        }
    }

    /// The same halo for another view, with that view's textures.
    fn for_another_view(&self, device: &wgpu::Device, textures: &AirTextures) -> Self {
        let bindings = textures.bindings(self.side);
        Self {
            side: self.side,
            layout: self.layout.clone(),
            bind_group: super::bind_to(device, label(self.side), &self.layout, bindings),
            plain: self.plain.clone(),
            eclipsed: self.eclipsed.clone(),
        }
    }

    fn passes(&self) -> [&HaloPass; 2] {
        [&self.plain, &self.eclipsed]
    }
}

fn label(side: AirSide) -> &'static str {
    match side {
        AirSide::Outside => "terrella halo from outside",
        AirSide::Inside => "terrella sky",
    }
}

impl AirDrawable {
    /// The air with these textures; creates no pipeline yet.
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        textures: AirTextures,
        light: &SurfaceLight,
    ) -> Self {
        let indices = super::filled_buffer(
            device,
            "terrella halo triangles",
            bytemuck::cast_slice(&Billboard::indices()),
            wgpu::BufferUsages::INDEX,
        );
        let halos = AirSide::ALL.map(|side| {
            let variant = AirVariant {
                side,
                moonlight: light.moonlight,
                eclipse: false,
                target: format.target_color(),
            };
            Halo::new(device, &textures, variant, light.eclipses)
        });
        let glow = Glow::new(device, format, &textures, light);
        Self {
            format,
            halos,
            vertices: vertex_buffer(device),
            staging: Vec::with_capacity(Billboard::MAX_VERTICES),
            indices,
            drawn: 0..0,
            side: AirSide::Outside,
            textures,
            view: None,
            moonlight: light.moonlight,
            glow,
        }
    }

    /// The same air for another view, with shared pipelines and tables, and its own buffers.
    pub fn for_another_view(&self, device: &wgpu::Device) -> Self {
        let textures = self.textures.for_another_view(device);
        let halos = self.halos.each_ref();
        Self {
            format: self.format,
            halos: halos.map(|halo| halo.for_another_view(device, &textures)),
            vertices: vertex_buffer(device),
            staging: Vec::with_capacity(Billboard::MAX_VERTICES),
            indices: self.indices.clone(),
            drawn: 0..0,
            side: AirSide::Outside,
            view: self
                .view
                .as_ref()
                .map(|view| view.for_another_view(device, &textures)),
            moonlight: self.moonlight,
            glow: self
                .glow
                .as_ref()
                .map(|glow| glow.for_another_view(device, &textures)),
            textures,
        }
    }

    /// Textures for shaders that draw through the air.
    pub fn textures(&self) -> &AirTextures {
        &self.textures
    }

    /// Whether the pipelines for such a frame exist.
    pub fn is_ready(&self, plan: &AirPlan, has_moon_shadow: bool) -> bool {
        let side = plan.side();
        let halo = &self.halos[side as usize];
        let eclipsed = halo.eclipsed.pipeline.is_some();
        // If the eclipse variant is not needed or could not be created, the ordinary one is used.
        let needs_eclipsed = has_moon_shadow && halo.eclipsed.variant.is_some();
        let has_ring = match has_moon_shadow && eclipsed {
            true => true,
            false => halo.plain.pipeline.is_some() && !needs_eclipsed,
        };
        let glow = self.glow.as_ref().filter(|_| plan.glow.is_some());
        let has_glow = glow.is_none_or(|glow| glow.is_ready(side));
        has_ring && has_glow && (side == AirSide::Outside || self.view.is_some())
    }

    /// Creates the missing pipelines for a frame with or without the Moon's shadow.
    pub fn make_ready(
        &mut self,
        device: &wgpu::Device,
        plan: &AirPlan,
        has_moon_shadow: bool,
    ) -> Result<(), ShaderError> {
        if let Some(glow) = self.glow.as_mut().filter(|_| plan.glow.is_some()) {
            glow.make(device, self.format, plan.side())?;
        }
        self.make_ring(device, plan.side(), has_moon_shadow)
    }

    fn make_ring(
        &mut self,
        device: &wgpu::Device,
        side: AirSide,
        has_moon_shadow: bool,
    ) -> Result<(), ShaderError> {
        if side == AirSide::Inside && self.view.is_none() {
            self.view = Some(AirView::new(device, &self.textures, self.moonlight)?);
        }
        let halo = &mut self.halos[side as usize];
        if has_moon_shadow {
            halo.eclipsed.make(device, self.format, &halo.layout)?;
        }
        if !has_moon_shadow || halo.eclipsed.pipeline.is_none() {
            halo.plain.make(device, self.format, &halo.layout)?;
        }
        Ok(())
    }

    /// Creates all pipelines, so that no frame waits for one.
    pub fn make_all(&mut self, device: &wgpu::Device) -> Result<(), ShaderError> {
        for side in AirSide::ALL {
            for has_moon_shadow in [false, true] {
                self.make_ring(device, side, has_moon_shadow)?;
            }
            if let Some(glow) = &mut self.glow {
                glow.make(device, self.format, side)?;
            }
        }
        Ok(())
    }

    /// Total length of the WGSL that the driver gets, bytes.
    pub fn shader_bytes(&self) -> u64 {
        let passes = self.halos.iter().flat_map(Halo::passes);
        let rings = passes.filter_map(|pass| pass.variant?.source().ok());
        let moonlight = self.moonlight;
        let view = AirViewVariant { moonlight }.source().ok();
        let glow = self.glow.iter().flat_map(Glow::variants);
        let glow = glow.filter_map(|variant| variant.source().ok());
        rings
            .chain(view)
            .chain(glow)
            .map(|source| source.text.len() as u64)
            .sum()
    }

    /// Uploads this frame's ring, and draws the sky view for an eye in the air. Returns the bytes written.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: &AirPlan,
        frame: &FrameUniforms,
    ) -> u64 {
        self.side = plan.side();
        self.drawn = 0..3 * plan.ring.triangles();
        self.staging.clear();
        self.staging.extend(plan.ring.vertices().map(|v| AirVertex {
            clip: v.clip.as_vec4().to_array(),
            ray: v.ray.as_vec3().to_array(),
        }));
        let vertices: &[u8] = bytemuck::cast_slice(&self.staging);
        queue.write_buffer(&self.vertices, 0, vertices);
        let uniforms = uniforms(plan, frame, &self.textures);
        queue.write_buffer(self.textures.uniforms(), 0, bytemuck::bytes_of(&uniforms));
        if let Some(view) = &mut self.view
            && self.side == AirSide::Inside
        {
            view.draw(device, queue, &self.textures, &uniforms);
        }
        let mut bytes = vertices.len() + size_of::<AirUniforms>();
        if let Some(glow) = &self.glow {
            bytes += glow.write(queue, plan);
        }
        bytes as u64
    }

    /// Draws airglow and aurora over everything behind them.
    pub fn render_glow(&self, pass: &mut wgpu::RenderPass<'_>, plan: &FramePlan) {
        let air = plan.air.as_ref().filter(|air| air.glow.is_some());
        if let Some(glow) = self.glow.as_ref().filter(|_| air.is_some()) {
            glow.render(pass, self.side);
        }
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, plan: &FramePlan) {
        let halo = &self.halos[self.side as usize];
        let eclipsed = halo.eclipsed.pipeline.as_ref();
        let eclipsed = eclipsed.filter(|_| plan.has_moon_shadow);
        let Some(pipeline) = eclipsed.or(halo.plain.pipeline.as_ref()) else {
            return;
        };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &halo.bind_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(self.drawn.clone(), 0, 0..1);
    }
}

/// Uniforms of the air for a frame.
fn uniforms(plan: &AirPlan, frame: &FrameUniforms, textures: &AirTextures) -> AirUniforms {
    let ring = &plan.ring;
    let [across_x, across_y, toward_center] = ring.axes;
    // Sun and Moon relative to the eye's own horizon, with the same azimuth about the line to the centre.
    let seen_from_eye = |light: Vec3| {
        let light = light.as_dvec3();
        let zenith_cosine = light.dot(plan.eye_up).clamp(-1.0, 1.0);
        let level = light - plan.eye_up * zenith_cosine;
        let level = level - toward_center * level.dot(toward_center);
        (zenith_cosine as f32, level.normalize_or(across_x).as_vec3())
    };
    let (eye_sun, sun_level) = seen_from_eye(frame.sun_itrf);
    let (eye_moon, moon_level) = seen_from_eye(frame.moon_itrf);
    let (limb_sin, limb_cos) = ring.limb();
    let coefficients = textures.model().rgb();
    let clouds = textures.above_clouds();
    let before_clouds = clouds.map_or(DVec3::ONE, |clouds| {
        let eye_m = (ring.eye_distance - 1.0) * terrella_ground::air::RADIUS_M;
        textures.model().part_before(clouds.height_m, eye_m)
    });
    let per_radius = |per_m: DVec3| (per_m * terrella_ground::air::RADIUS_M).as_vec3();
    AirUniforms {
        across_x: across_x.as_vec3(),
        eye_distance: ring.eye_distance as f32,
        across_y: across_y.as_vec3(),
        eye_height: (ring.eye_distance - 1.0) as f32,
        toward_center: toward_center.as_vec3(),
        exposure: frame.exposure,
        sun: frame.sun_itrf,
        polar_stretch: frame.polar_stretch,
        sun_level,
        eye_sun,
        sky_albedo: textures.sky_albedo(),
        limb_sin: limb_sin as f32,
        molecules: per_radius(coefficients.molecules),
        limb_cos: limb_cos as f32,
        ozone: per_radius(coefficients.ozone),
        padding_e: 0.0,
        aerosol_scattering: per_radius(coefficients.aerosol_scattering),
        eye_moon,
        aerosol_extinction: per_radius(coefficients.aerosol_extinction),
        moon_light: frame.moon_light,
        moon: frame.moon_itrf,
        padding_a: 0.0,
        moon_level,
        padding_b: 0.0,
        before_clouds: before_clouds.as_vec3(),
        padding_c: 0.0,
        sky_albedo_of_clouds: clouds.map_or(Vec3::ZERO, |clouds| clouds.sky_albedo),
        padding_d: 0.0,
        shadow: frame.shadow,
    }
}

fn vertex_buffer(device: &wgpu::Device) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella halo"),
        size: (Billboard::MAX_VERTICES * size_of::<AirVertex>()) as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// The pipeline of one variant of the ring's shader.
fn pipeline(
    device: &wgpu::Device,
    format: PassFormat,
    layout: &wgpu::BindGroupLayout,
    variant: AirVariant,
) -> Result<wgpu::RenderPipeline, ShaderError> {
    let shader = ShaderModule::new(device, &variant)?;
    let pipeline = PipelineDescription {
        label: label(variant.side),
        bind_groups: Some(&[Some(layout)]),
        module: &shader.module,
        buffers: &[Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<AirVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX_ATTRIBUTES,
        })],
        primitive: Default::default(),
        format,
        writes_depth: false,
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
    };
    Ok(pipeline.create(device))
}
