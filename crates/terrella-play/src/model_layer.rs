//! Models of satellites in pictures, each at its place and lit by Sun, Moon and Earth.
//!
//! A scene without models has no layer: no pipeline, no buffer, no shader.

mod earth_light;
mod gpu_model;
mod textures;
mod uniforms;

use super::attitude::{Attitude, AttitudeMoment};
use super::camera::OrbitalMotion;
use super::craft::CraftPose;
use super::error::PlayError;
use super::flight::{Flight, Moment, motion};
use super::satellites::orientation_at;
use crate::scene::{ModelAxes, Scene};
use earth_light::{EarthDisc, hides};
use glam::{DMat3, DMat4, DVec3, Vec4};
use gpu_model::{GpuModel, ModelLayouts, buffer};
use std::sync::Arc;
use terrella::frames::{EarthOrientation, Ellipsoid};
use terrella::internals::gpu::{PassFormat, PipelineDescription, ShaderText};
use terrella::{Earth, EarthError, EyeView, FrameStats, GpuContext, Sky, exposure_factor};
use terrella_imagery::NeighbourhoodAlbedo;
use terrella_imagery::tile::MAP_LAYERS;
use terrella_orbit::Feed;
use uniforms::{ATTRIBUTES, ModelFrame, ModelVertex};

/// The models of a picture or a window.
pub struct ModelLayer {
    format: PassFormat,
    shader: wgpu::ShaderModule,
    shader_bytes: u64,
    layouts: ModelLayouts,
    /// For single-sided and double-sided materials; created again when the sample count changes.
    pipelines: Option<[wgpu::RenderPipeline; 2]>,
    models: Vec<GpuModel>,
    craft: Vec<ModelledCraft>,
    ellipsoid: Ellipsoid,
    orientation: Option<EarthOrientation>,
    albedo: Option<(Arc<NeighbourhoodAlbedo>, Vec<Vec4>)>,
    has_moonlight: bool,
}

/// A satellite with a model.
struct ModelledCraft {
    feed: Arc<dyn Feed>,
    is_followed: bool,
    attitude: Attitude,
    model: usize,
    body_from_model: DMat3,
    scale: f64,
    least_length_px: f64,
    length_m: f64,
    radius_m: f64,
    frame: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    is_shown: bool,
}

/// Light on a spacecraft.
pub struct CraftLight {
    pub sun: DVec3,
    pub sunlight: f64,
    pub moon: DVec3,
    pub moonlight: f64,
    pub disc: EarthDisc,
}

/// Position and size of a model.
#[derive(Clone, Copy)]
pub struct Placement {
    pub position_itrf_m: DVec3,
    /// A rotation.
    pub itrf_from_model: DMat3,
    pub scale: f64,
}

/// Rotation from a model's axes to those of its spacecraft: x along flight, y to the right, z down.
pub fn body_from_model(axes: ModelAxes) -> DMat3 {
    match axes {
        // glTF: +Y is up, +Z forward, −X to the right (specification, section 3.4).
        ModelAxes::Gltf => DMat3::from_cols(DVec3::NEG_Y, DVec3::NEG_Z, DVec3::X),
        ModelAxes::Body => DMat3::IDENTITY,
    }
}

impl ModelLayer {
    /// The layer of a scene's satellites; `None` if none has a model.
    pub fn of(flight: &Flight, gpu: &GpuContext, earth: &Earth) -> Result<Option<Self>, PlayError> {
        let scene = flight.scene();
        let models = flight.craft_models();
        if models.models().is_empty() {
            return Ok(None);
        }
        let format = earth.format();
        let text = shader(format)?;
        let shader_bytes = text.text.len() as u64;
        let layouts = ModelLayouts::new(&gpu.device);
        let satellites = scene.orbits.iter().zip(flight.satellites()).enumerate();
        let craft = satellites.filter_map(|(index, (orbit, satellite))| {
            let wanted = orbit.craft.model.as_ref()?;
            let model = models.of_satellite(index)?;
            let shape = models.models().get(model)?;
            let zero = ModelFrame::default();
            let bytes = bytemuck::bytes_of(&zero);
            let frame = buffer(
                gpu,
                "terrella model craft",
                bytes,
                wgpu::BufferUsages::UNIFORM,
            );
            let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("terrella model craft"),
                layout: &layouts.frame,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: frame.as_entire_binding(),
                }],
            });
            Some(ModelledCraft {
                feed: satellite.shared_feed(),
                is_followed: index == flight.followed(),
                attitude: models.attitude(index),
                model,
                body_from_model: body_from_model(wanted.axes),
                scale: wanted.scale,
                least_length_px: wanted.least_length_px,
                length_m: f64::from(shape.length_m()),
                radius_m: f64::from(shape.radius_m()),
                frame,
                bind_group,
                is_shown: false,
            })
        });
        let models = models.models().iter();
        Ok(Some(Self {
            craft: craft.collect(),
            models: models
                .map(|model| GpuModel::new(gpu, &layouts, model))
                .collect(),
            shader: text
                .compile(&gpu.device, "terrella model")
                .map_err(EarthError::from)?,
            shader_bytes,
            format,
            layouts,
            pipelines: None,
            ellipsoid: *flight.ellipsoid(),
            orientation: flight.earth_orientation().cloned(),
            albedo: None,
            has_moonlight: has_moonlight(scene),
        }))
    }

    /// Follows the pass to another sample count.
    pub fn set_samples(&mut self, samples: u32) {
        if samples != self.format.samples {
            self.format.samples = samples;
            self.pipelines = None;
        }
    }

    /// Bytes of the WGSL that the driver got.
    pub fn shader_bytes(&self) -> u64 {
        self.shader_bytes
    }

    /// Whether the followed spacecraft has a model.
    pub fn has_followed(&self) -> bool {
        self.craft.iter().any(|craft| craft.is_followed)
    }

    /// Uploads the models of a moment, with the exposure of the Earth, and counts them. A satellite without a state or attitude has no model, nor
    /// one that the eye is inside.
    pub fn prepare(
        &mut self,
        gpu: &GpuContext,
        earth: &Earth,
        moment: &Moment,
        size: (u32, u32),
        stats: &mut FrameStats,
    ) {
        let wanted = earth.neighbourhood_albedo();
        let is_same = |(known, _): &(Arc<NeighbourhoodAlbedo>, _)| Arc::ptr_eq(known, wanted);
        if !self.albedo.as_ref().is_some_and(is_same) {
            self.albedo = Some((wanted.clone(), wanted.texels(&[true; MAP_LAYERS])));
        }
        let albedo = self.albedo.as_ref().map_or(&[][..], |(_, texels)| texels);
        let orientation = orientation_at(self.orientation.as_ref(), moment.epoch);
        let orientation = orientation.unwrap_or_default();
        let exposure = exposure_factor(stats.exposure_ev) as f32;
        let (ellipsoid, sky) = (&self.ellipsoid, &moment.sky);
        let moon_gain = match self.has_moonlight {
            true => stats.night_gain,
            false => 0.0,
        };
        for craft in &mut self.craft {
            let known = moment.craft.filter(|_| craft.is_followed);
            let pose = known.or_else(|| {
                let state = craft.feed.state_at(moment.epoch).ok()?;
                let motion: OrbitalMotion = motion(&state, &orientation);
                let axes = craft.attitude.itrf_from_craft(&AttitudeMoment {
                    epoch: moment.epoch,
                    motion: &motion,
                    ellipsoid,
                    sky,
                    orientation: &orientation,
                });
                Some(CraftPose::new(&motion, ellipsoid, sky).turned(axes.ok()?))
            });
            craft.is_shown = false;
            let Some(pose) = pose else { continue };
            let scale = craft.scale_in(&pose, &moment.view, size);
            let (eye_itrf_m, _) = moment.view.to_itrf();
            if pose.position_itrf_m.distance(eye_itrf_m) <= scale * craft.radius_m {
                continue;
            }
            let light = craft_light(&pose, ellipsoid, sky, albedo, moon_gain);
            let placement = Placement {
                position_itrf_m: pose.position_itrf_m,
                itrf_from_model: pose.itrf_from_craft * craft.body_from_model,
                scale,
            };
            let frame = model_frame(&placement, &light, &moment.view, exposure);
            gpu.queue
                .write_buffer(&craft.frame, 0, bytemuck::bytes_of(&frame));
            craft.is_shown = true;
            let counts = self.models.get(craft.model).map(GpuModel::counts);
            let (triangles, draw_calls) = counts.unwrap_or_default();
            stats.triangles += triangles;
            stats.draw_calls += draw_calls;
            stats.uploaded_bytes += size_of::<ModelFrame>() as u64;
        }
        if self.pipelines.is_none() && self.craft.iter().any(|craft| craft.is_shown) {
            let sides = [Some(wgpu::Face::Back), None];
            self.pipelines = Some(sides.map(|culled| self.pipeline(gpu, culled)));
        }
    }

    fn pipeline(&self, gpu: &GpuContext, cull_mode: Option<wgpu::Face>) -> wgpu::RenderPipeline {
        PipelineDescription {
            label: "terrella model",
            bind_groups: Some(&[Some(&self.layouts.frame), Some(&self.layouts.material)]),
            module: &self.shader,
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<ModelVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &ATTRIBUTES,
            })],
            primitive: wgpu::PrimitiveState {
                cull_mode,
                ..Default::default()
            },
            format: self.format,
            writes_depth: true,
            blend: None,
        }
        .create(&gpu.device)
    }

    /// Draws them. Call it before the Earth, so that the air is behind them.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(pipelines) = &self.pipelines else {
            return;
        };
        for craft in self.craft.iter().filter(|craft| craft.is_shown) {
            let Some(model) = self.models.get(craft.model) else {
                continue;
            };
            pass.set_bind_group(0, &craft.bind_group, &[]);
            model.render(pass, pipelines);
        }
    }
}

impl ModelledCraft {
    /// The scale at which it is drawn: its own, or as much more as it takes to be so many pixels long.
    fn scale_in(&self, pose: &CraftPose, view: &EyeView, size: (u32, u32)) -> f64 {
        let (eye_itrf_m, clip_from_eye) = view.to_itrf();
        let distance_m = pose.position_itrf_m.distance(eye_itrf_m);
        // Pixels of a metre at one metre ahead.
        let across_px = clip_from_eye.row(1).truncate().length() * 0.5 * f64::from(size.1);
        let length_px = self.scale * self.length_m * across_px / distance_m;
        let more = self.least_length_px / length_px;
        match more.is_finite() && more > 1.0 {
            true => self.scale * more,
            false => self.scale,
        }
    }
}

/// Light on a spacecraft with this pose.
pub fn craft_light(
    pose: &CraftPose,
    ellipsoid: &Ellipsoid,
    sky: &Sky,
    albedo: &[Vec4],
    moon_gain: f64,
) -> CraftLight {
    let position = pose.position_itrf_m;
    let (moon, moonlight) = sky.moonlight();
    let is_hidden = hides(position, moon, ellipsoid);
    CraftLight {
        sun: sky.sun_itrf,
        sunlight: pose.sunlight,
        moon,
        moonlight: if is_hidden {
            0.0
        } else {
            moon_gain * moonlight
        },
        disc: EarthDisc::seen_from(position, ellipsoid, sky.sun_itrf, albedo),
    }
}

/// Uniforms of a model.
pub fn model_frame(
    placement: &Placement,
    light: &CraftLight,
    view: &EyeView,
    exposure: f32,
) -> ModelFrame {
    let (eye_itrf_m, clip_from_eye) = view.to_itrf();
    let from_eye_m = placement.position_itrf_m - eye_itrf_m;
    let model_from_itrf = placement.itrf_from_model.transpose();
    let scaled = placement.itrf_from_model * placement.scale;
    let clip_from_model =
        clip_from_eye * DMat4::from_translation(from_eye_m) * DMat4::from_mat3(scaled);
    let down = -placement.position_itrf_m.normalize_or_zero();
    ModelFrame {
        clip_from_model: clip_from_model.as_mat4(),
        sun: (model_from_itrf * light.sun).as_vec3(),
        sunlight: light.sunlight as f32,
        moon: (model_from_itrf * light.moon).as_vec3(),
        moonlight: light.moonlight as f32,
        eye: (model_from_itrf * -from_eye_m / placement.scale).as_vec3(),
        exposure,
        down: (model_from_itrf * down).as_vec3(),
        limb_sine: light.disc.limb_sine as f32,
        earth_light: light.disc.light,
        padding: 0.0,
    }
}

/// Whether a scene draws moonlight.
fn has_moonlight(scene: &Scene) -> bool {
    scene.earth.light.is_some_and(|light| light.moonlight)
}

/// The shader's text for a pass.
pub fn shader(format: PassFormat) -> Result<ShaderText, EarthError> {
    let conditions = format.target_color().conditions();
    Ok(ShaderText::assemble("craft_model.wgsl", &conditions)?)
}

#[cfg(test)]
#[path = "model_layer/tests.rs"]
mod tests;
