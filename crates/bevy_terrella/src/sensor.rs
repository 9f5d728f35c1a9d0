//! A camera with a sensor: raw frames of everything in its view.

use crate::{
    Earth, EarthCamera, EarthCameraStatus, EarthEpoch, EarthFault, EarthSky, TerrellaSystems,
};
use bevy::app::{App, PostUpdate, PreUpdate};
use bevy::asset::{Assets, Handle};
use bevy::camera::{
    CameraProjection, CameraUpdateSystems, Hdr, Projection, RenderTarget, SubCameraView,
};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::event::EntityEvent;
use bevy::ecs::observer::On;
use bevy::ecs::query::{Changed, With};
use bevy::ecs::reflect::ReflectComponent;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Commands, Query, Res, ResMut};
use bevy::image::Image;
use bevy::math::{Mat4, Vec3A};
use bevy::reflect::Reflect;
use bevy::render::gpu_readback::{ReadbackComplete, ReadbackOnce};
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::Msaa;
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool};
use std::collections::VecDeque;
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella_sensor::{
    ASTRONOMICAL_UNIT_M, PinholeFrame, PinholePicture, RawFrame, Sensor, SensorError, Shutter,
    Wells,
};

/// Format of a sensor's target: linear light, four floats per pixel.
const LIGHT: TextureFormat = TextureFormat::Rgba32Float;
const LIGHT_BYTES: usize = 16;

/// Adds a lens and a detector to an [`EarthCamera`]: the Earth, the sky and your meshes become raw frames.
///
/// The component gives the camera a target, a projection, `Hdr`, and no tone curve. The target is the image of a pinhole camera, with `oversampling`
/// samples across a pixel and the margins for distortion and point spread. Set the camera's pose as usual: the axis of the lens is the camera's
/// forward direction. Trigger [`TakeRawFrame`] for each frame.
///
/// Bevy's main texture holds half floats, so light is rounded to 1/2048 of itself.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, PartialEq)]
#[require(EarthCamera, RawRequests)]
pub struct EarthSensor {
    /// Lens, aperture, shutter and detector. The shutter must be global: a frame has one pose.
    pub sensor: Sensor,
    /// Smallest depth that is drawn, units of the world.
    pub near: f32,
    /// Meshes beyond this depth are not drawn; the Earth always is.
    pub far: f32,
}

impl EarthSensor {
    /// A sensor with Bevy's usual depths: 0.1 to 1000.
    pub fn new(sensor: Sensor) -> Self {
        Self {
            sensor,
            near: 0.1,
            far: 1000.0,
        }
    }

    /// The image that the camera draws.
    fn fit(&self, device: Option<&RenderDevice>) -> Result<PinholeFrame, EarthFault> {
        self.sensor.check()?;
        if matches!(self.sensor.shutter, Shutter::Rolling { .. }) {
            return Err(EarthFault::RollingShutter);
        }
        let [_, rows] = self.sensor.lens.size();
        let frame = self.sensor.pinhole(0..rows)?;
        if let Some(device) = device {
            let limits = device.limits();
            let side = limits.max_texture_dimension_2d;
            let bytes = frame.len() as u64 * LIGHT_BYTES as u64;
            if frame.size.iter().any(|&size| size > side) || bytes > limits.max_buffer_size {
                let [width, height] = frame.size;
                return Err(EarthFault::SensorSize {
                    width,
                    height,
                    side,
                    megabytes: limits.max_buffer_size >> 20,
                });
            }
        }
        Ok(frame)
    }
}

/// Requests a raw frame from an [`EarthSensor`]: the next frame in which its camera sees the Earth. [`RawFrameTaken`] follows some frames
/// later.
#[derive(EntityEvent, Clone, Copy, Debug)]
pub struct TakeRawFrame {
    /// The camera.
    pub entity: Entity,
    /// The frame's number. Noise depends only on the sensor's seed and on this number.
    pub number: u32,
}

/// A raw frame was taken, or failed with a reason.
#[derive(EntityEvent, Clone, Debug)]
pub struct RawFrameTaken {
    /// The camera.
    pub entity: Entity,
    /// The requested number.
    pub number: u32,
    /// The Earth's epoch in the drawn frame.
    pub epoch: Epoch,
    /// Output of the converter, and the electrons that it read.
    pub raw: Result<(RawFrame, Wells), Arc<EarthFault>>,
}

/// Numbers of requested frames.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct RawRequests(VecDeque<u32>);

/// Target that a camera draws for its sensor.
#[derive(Component)]
enum SensorTarget {
    Fits {
        image: Handle<Image>,
        frame: PinholeFrame,
    },
    Fails(Arc<EarthFault>),
}

/// A frame that is being read back, on a separate entity.
#[derive(Component)]
struct Capture {
    camera: Entity,
    number: u32,
    epoch: Epoch,
    sun_distance_au: f64,
    sensor: Sensor,
    frame: PinholeFrame,
}

/// A frame that the sensor model is reading out.
#[derive(Component)]
struct ReadOut(Task<Result<(RawFrame, Wells), SensorError>>);

/// A pinhole camera that shows a rectangle of the plane at unit focal length, with an infinite far plane and
/// reversed depth.
#[derive(Clone, Copy, Debug)]
struct PinholeProjection {
    frame: PinholeFrame,
    near: f32,
    far: f32,
}

impl CameraProjection for PinholeProjection {
    fn get_clip_from_view(&self) -> Mat4 {
        self.frame.rect.clip_from_view(self.near.into()).as_mat4()
    }

    /// A sensor has no sub-views.
    fn get_clip_from_view_for_sub(&self, _: &SubCameraView) -> Mat4 {
        self.get_clip_from_view()
    }

    /// The sensor determines the target's size.
    fn update(&mut self, _: f32, _: f32) {}

    fn far(&self) -> f32 {
        self.far
    }

    fn get_frustum_corners(&self, z_near: f32, z_far: f32) -> [Vec3A; 8] {
        let (least, most) = (
            self.frame.rect.least.as_vec2(),
            self.frame.rect.most.as_vec2(),
        );
        let corners = |z: f32| {
            let depth = z.abs();
            [
                (most.x, most.y),
                (most.x, least.y),
                (least.x, least.y),
                (least.x, most.y),
            ]
            .map(|(x, down)| Vec3A::new(x * depth, -down * depth, z))
        };
        let ([a, b, c, d], [e, f, g, h]) = (corners(z_near), corners(z_far));
        [a, b, c, d, e, f, g, h]
    }
}

/// Adds the sensor systems.
pub(crate) fn build(app: &mut App) {
    app.register_type::<EarthSensor>()
        .add_observer(request)
        .add_systems(PreUpdate, deliver)
        .add_systems(
            PostUpdate,
            (
                fit_cameras.before(CameraUpdateSystems),
                capture.after(TerrellaSystems::Sky).after(fit_cameras),
            ),
        );
}

/// Gives cameras the target and the projection of their sensor.
fn fit_cameras(
    sensors: Query<(Entity, &EarthSensor), Changed<EarthSensor>>,
    device: Option<Res<RenderDevice>>,
    images: Option<ResMut<Assets<Image>>>,
    mut commands: Commands,
) {
    let Some(mut images) = images else { return };
    for (entity, sensor) in &sensors {
        let mut camera = commands.entity(entity);
        let frame = match sensor.fit(device.as_deref()) {
            Ok(frame) => frame,
            Err(fault) => {
                tracing::error!("camera {entity} takes no raw frames: {fault}");
                camera.insert(SensorTarget::Fails(Arc::new(fault)));
                continue;
            }
        };
        let [width, height] = frame.size;
        let mut image = Image::new_target_texture(width, height, LIGHT, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let image = images.add(image);
        let projection = PinholeProjection {
            frame,
            near: sensor.near,
            far: sensor.far,
        };
        camera.insert((
            Hdr,
            Msaa::Off,
            Tonemapping::None,
            DebandDither::Disabled,
            Projection::custom(projection),
            RenderTarget::Image(image.clone().into()),
            SensorTarget::Fits { image, frame },
        ));
    }
}

/// Records a request.
fn request(take: On<TakeRawFrame>, mut cameras: Query<&mut RawRequests>) {
    match cameras.get_mut(take.entity) {
        Ok(mut requests) => requests.0.push_back(take.number),
        Err(_) => tracing::error!(
            "entity {} takes no raw frame: it has no EarthSensor",
            take.entity
        ),
    }
}

/// Starts a readback of the coming frame for cameras that saw the Earth in the previous one.
fn capture(
    mut cameras: Query<(
        Entity,
        &mut RawRequests,
        &EarthSensor,
        &SensorTarget,
        &EarthCameraStatus,
    )>,
    earths: Query<(&EarthEpoch, &EarthSky), With<Earth>>,
    mut commands: Commands,
) {
    let Ok((epoch, sky)) = earths.single() else {
        return;
    };
    for (camera, mut requests, sensor, target, status) in &mut cameras {
        match target {
            SensorTarget::Fails(fault) => {
                for number in requests.0.drain(..) {
                    commands.trigger(RawFrameTaken {
                        entity: camera,
                        number,
                        epoch: epoch.0,
                        raw: Err(fault.clone()),
                    });
                }
            }
            SensorTarget::Fits { image, frame } if status.is_drawn() => {
                let Some(number) = requests.0.pop_front() else {
                    continue;
                };
                let capture = Capture {
                    camera,
                    number,
                    epoch: epoch.0,
                    sun_distance_au: sky.0.sun_distance_m / ASTRONOMICAL_UNIT_M,
                    sensor: sensor.sensor.clone(),
                    frame: *frame,
                };
                commands
                    .spawn((capture, ReadbackOnce::texture(image.clone())))
                    .observe(read_out);
            }
            SensorTarget::Fits { .. } => {}
        }
    }
}

/// Starts the sensor model when the light has been read back.
fn read_out(done: On<ReadbackComplete>, captures: Query<&Capture>, mut commands: Commands) {
    let Ok(capture) = captures.get(done.entity) else {
        return;
    };
    let light = light(&done.data, capture.frame.size);
    let (sensor, frame) = (capture.sensor.clone(), capture.frame);
    let (number, sun_distance_au) = (capture.number, capture.sun_distance_au);
    let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
    let task = pool.spawn(async move {
        let picture = PinholePicture::new(frame, &light)?;
        let [_, rows] = sensor.lens.size();
        let exposed = sensor.expose(0..rows, &picture)?;
        sensor.read_out(&exposed, sun_distance_au, number)
    });
    commands.entity(done.entity).insert(ReadOut(task));
}

/// Pixels of a target. Bevy pads its rows to multiples of 256 bytes.
fn light(bytes: &[u8], [width, height]: [u32; 2]) -> Vec<[f32; 4]> {
    let row_bytes = bytes.len() / height.max(1) as usize;
    let rows = bytes.chunks_exact(row_bytes.max(1));
    let pixels = rows.flat_map(|row| {
        row.chunks_exact(LIGHT_BYTES)
            .take(width as usize)
            .map(|pixel| {
                let mut light = [0.0; 4];
                for (light, bytes) in light.iter_mut().zip(pixel.chunks_exact(4)) {
                    *light = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                }
                light
            })
    });
    pixels.collect()
}

/// Delivers the finished frames.
fn deliver(
    mut reading: Query<(Entity, &Capture, &mut ReadOut)>,
    cameras: Query<(), With<EarthSensor>>,
    mut commands: Commands,
) {
    for (entity, capture, mut task) in &mut reading {
        let Some(raw) = check_ready(&mut task.0) else {
            continue;
        };
        commands.entity(entity).despawn();
        if cameras.contains(capture.camera) {
            commands.trigger(RawFrameTaken {
                entity: capture.camera,
                number: capture.number,
                epoch: capture.epoch,
                raw: raw.map_err(|fault| Arc::new(fault.into())),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{Vec3, Vec4};
    use terrella_sensor::{Distortion, Lens};

    #[test]
    fn directions_are_drawn_where_the_plane_has_them() {
        let lens = Lens::new([64, 48], 20.0, 100.0, Some([20.0, 30.0]), Distortion::NONE);
        let lens = lens.expect("a lens");
        let rect = lens.bounds(0..48, 2.0).expect("a rectangle");
        let frame = PinholeFrame {
            rect,
            size: [200, 150],
        };
        let projection = PinholeProjection {
            frame,
            near: 0.1,
            far: 50.0,
        };
        for (x, down) in [(0.0, 0.0), (0.1, -0.05), (-0.07, 0.06)] {
            let clip = projection.get_clip_from_view() * Vec4::new(x * 3.0, -down * 3.0, -3.0, 1.0);
            let ndc = clip.truncate() / clip.w;
            let at = frame.at((f64::from(x), f64::from(down)).into());
            let found = [100.0 * (ndc.x + 1.0), 75.0 * (1.0 - ndc.y)].map(f64::from);
            assert!((found[0] - at.x).abs() < 1e-3 && (found[1] - at.y).abs() < 1e-3);
            assert!((ndc.z - 0.1 / 3.0).abs() < 1e-6);
        }
        let corners = projection.get_frustum_corners(-0.1, -50.0);
        let clip = projection
            .get_clip_from_view()
            .project_point3(Vec3::from(corners[5]));
        assert!(
            (clip.x - 1.0).abs() < 1e-5 && (clip.y - 1.0).abs() < 1e-5,
            "{clip}"
        );
    }

    #[test]
    fn padding_of_rows_is_left_out() {
        let mut bytes = vec![0xff; 512];
        for (row, value) in [(0, 1.0_f32), (256, 2.0)] {
            for channel in 0..4 {
                bytes[row + 4 * channel..][..4].copy_from_slice(&value.to_le_bytes());
            }
        }
        assert_eq!(light(&bytes, [1, 2]), [[1.0; 4], [2.0; 4]]);
    }
}
