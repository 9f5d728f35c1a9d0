//! An Earth for one format and sample count: built by a task, with a view for each camera.

use super::extract::SeenScene;
use super::overlays::{Moment, Overlays, Seat, SeenTracks};
use crate::maps::{self, Beside};
use crate::{EarthCameraStatus, EarthFault};
use bevy::asset::AssetServer;
use bevy::ecs::entity::Entity;
use bevy::ecs::resource::Resource;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool};
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella::{Earth, EarthView, Exposure, EyeView, FrameRequest, ViewFrame, Viewport, wgpu};

/// Pipeline key: the format and the sample count of a camera's pass.
pub(super) type Key = (TextureFormat, u32);

/// One camera's image of the Earth.
pub(super) struct Picture {
    pub camera: Entity,
    pub eye: EyeView,
    pub exposure: Exposure,
    pub target: Viewport,
    pub key: Key,
}

impl Picture {
    fn moment(&self, epoch: Epoch) -> Moment<'_> {
        Moment {
            epoch,
            eye: &self.eye,
            target: self.target,
        }
    }
}

/// Frames after which an unused Earth is dropped.
const IDLE_FRAMES: u32 = 300;

/// All Earths.
#[derive(Resource, Default)]
pub(super) struct Planets(Vec<Planet>);

impl Planets {
    /// The Earth of a key; built, or being built, from the scene.
    pub fn of(&mut self, key: Key, scene: &SeenScene, gpu: Gpu<'_>) -> &mut Planet {
        let at = self.0.iter().position(|planet| planet.key == key);
        let at = at.unwrap_or_else(|| {
            self.0.push(Planet::new(key));
            self.0.len() - 1
        });
        let planet = &mut self.0[at];
        planet.idle_frames = 0;
        planet.follow(scene, gpu);
        planet
    }

    /// Ends a frame, and drops Earths that are unused for long.
    pub fn age(&mut self) {
        for planet in &mut self.0 {
            planet.idle_frames += 1;
            if planet.idle_frames > 1
                && let Some(drawn) = &mut planet.drawn
            {
                drawn.seat(&[]);
            }
        }
        self.0.retain(|planet| planet.idle_frames <= IDLE_FRAMES);
    }

    /// Drops all Earths.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether an image is prepared for a camera.
    pub fn is_prepared(&self, camera: Entity) -> bool {
        self.seat(camera).is_some()
    }

    /// Draws the prepared image of a camera: the Earth, the sky beyond it, clouds above the eye, and
    /// tracks.
    pub fn render(&self, camera: Entity, pass: &mut wgpu::RenderPass<'_>) {
        match self.seat(camera) {
            Some((drawn, Some(other))) => {
                drawn.earth.render_view_surface(&other.view, pass);
                drawn.earth.render_view_air(&other.view, pass);
                other.overlays.render_sky(pass);
                drawn.earth.render_view_clouds_overhead(&other.view, pass);
                other.overlays.render_tracks(pass);
            }
            Some((drawn, None)) => {
                drawn.earth.render_surface(pass);
                drawn.earth.render_air(pass);
                drawn.overlays.render_sky(pass);
                drawn.earth.render_clouds_overhead(pass);
                drawn.overlays.render_tracks(pass);
            }
            None => {}
        }
    }

    fn seat(&self, camera: Entity) -> Option<(&Drawn, Option<&Other>)> {
        let drawn = self.0.iter().filter_map(|planet| planet.drawn.as_ref());
        drawn.into_iter().find_map(|drawn| {
            let first = (drawn.first == Some(camera)).then_some((drawn, None));
            first.or_else(|| {
                let other = drawn.others.iter().find(|other| other.camera == camera);
                other.map(|other| (drawn, Some(other)))
            })
        })
    }
}

/// Resources for building Earths.
#[derive(Clone, Copy)]
pub(super) struct Gpu<'g> {
    pub device: &'g RenderDevice,
    pub queue: &'g RenderQueue,
    /// Reads maps stored as assets.
    pub assets: Option<&'g AssetServer>,
}

/// An Earth for one key.
pub(super) struct Planet {
    key: Key,
    /// The scene revision that it was built for or is being built for.
    revision: u64,
    making: Option<Task<Result<Drawn, EarthFault>>>,
    drawn: Option<Drawn>,
    fault: Option<Arc<EarthFault>>,
    idle_frames: u32,
}

/// An Earth with its cameras. The first uses the Earth's own view; each other camera has a separate one.
struct Drawn {
    earth: Earth,
    /// Overlays of the Earth's own view.
    overlays: Overlays,
    /// The revision of the drawn tracks, and the reason if they are not drawn.
    tracks: (u64, Option<Arc<EarthFault>>),
    first: Option<Entity>,
    others: Vec<Other>,
}

/// Another camera.
struct Other {
    camera: Entity,
    view: EarthView,
    overlays: Overlays,
}

impl Planet {
    fn new(key: Key) -> Self {
        Self {
            key,
            revision: 0,
            making: None,
            drawn: None,
            fault: None,
            idle_frames: 0,
        }
    }

    /// Accepts the result of a task, and starts one if the scene changed.
    fn follow(&mut self, scene: &SeenScene, gpu: Gpu<'_>) {
        if let Some(made) = self.making.as_mut().and_then(check_ready) {
            self.making = None;
            self.drawn = None;
            match made {
                Ok(drawn) => self.drawn = Some(drawn),
                Err(fault) => self.fault = Some(Arc::new(fault)),
            }
        }
        // One task at a time: the current result is shown before the next task starts.
        if self.revision == scene.revision || self.making.is_some() {
            return;
        }
        self.revision = scene.revision;
        self.fault = None;
        let (earth, (format, samples)) = (scene.earth.clone(), self.key);
        let (device, queue) = (gpu.device.clone(), gpu.queue.clone());
        let assets = gpu.assets.cloned();
        let beside = Beside {
            city_lights: earth.light.detail,
            #[cfg(feature = "celestial")]
            celestial: scene.celestial,
        };
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        self.making = Some(pool.spawn(async move {
            let gpu = (device.wgpu_device(), &*queue);
            let assets = assets.as_ref();
            let read = maps::read(&earth.maps, beside, earth.shading, assets, gpu).await?;
            #[cfg(feature = "celestial")]
            let sky = read.celestial.clone();
            let options = earth.options(read, format, samples);
            let earth = Earth::new(gpu.0, gpu.1, &options)?;
            Ok(Drawn {
                #[cfg(feature = "celestial")]
                overlays: Overlays::with_sky(gpu.0, gpu.1, &earth, sky.as_ref())?,
                #[cfg(not(feature = "celestial"))]
                overlays: Overlays::default(),
                earth,
                tracks: (0, None),
                first: None,
                others: Vec::new(),
            })
        }));
    }

    /// Prepares the images of a frame, and returns their status.
    pub fn prepare(
        &mut self,
        gpu: Gpu<'_>,
        (scene, tracks): (&SeenScene, &SeenTracks),
        pictures: &[&Picture],
        tell: &mut dyn FnMut(Entity, EarthCameraStatus),
    ) {
        let Some(drawn) = &mut self.drawn else {
            for picture in pictures {
                let status = match &self.fault {
                    Some(fault) => EarthCameraStatus::Failed(fault.clone()),
                    None => EarthCameraStatus::Making,
                };
                tell(picture.camera, status);
            }
            return;
        };
        if let Err(fault) = drawn.prepare(gpu, (scene, tracks), pictures, tell) {
            let fault = Arc::new(fault);
            for picture in pictures {
                tell(picture.camera, EarthCameraStatus::Failed(fault.clone()));
            }
            self.drawn = None;
            self.fault = Some(fault);
        }
    }
}

impl Drawn {
    /// Releases the views of cameras that disappeared.
    fn seat(&mut self, pictures: &[&Picture]) {
        let is_there = |camera: Entity| pictures.iter().any(|picture| picture.camera == camera);
        self.first = self.first.filter(|&camera| is_there(camera));
        self.others.retain(|other| is_there(other.camera));
        // The Earth's own view must always have a camera, because it must be prepared with the
        // others.
        if self.first.is_none() {
            self.first = self.others.pop().map(|other| other.camera);
        }
    }

    /// Rebuilds tracks if those of the main world changed.
    fn follow_tracks(&mut self, device: &wgpu::Device, seen: &SeenTracks) {
        if self.tracks.0 == seen.revision {
            return;
        }
        #[cfg(feature = "tracks")]
        let fault = self.overlays.make_tracks(device, &self.earth, seen).err();
        #[cfg(not(feature = "tracks"))]
        let (fault, _) = (None, device);
        self.tracks = (seen.revision, fault.map(Arc::new));
        #[cfg(feature = "tracks")]
        for other in &mut self.others {
            other.overlays.share_tracks(&self.overlays, &other.view);
        }
    }

    fn prepare(
        &mut self,
        gpu: Gpu<'_>,
        (scene, tracks): (&SeenScene, &SeenTracks),
        pictures: &[&Picture],
        tell: &mut dyn FnMut(Entity, EarthCameraStatus),
    ) -> Result<(), EarthFault> {
        let (device, queue, sky) = (gpu.device.wgpu_device(), &**gpu.queue, &scene.sky);
        self.seat(pictures);
        self.follow_tracks(device, tracks);
        let mut own = None;
        for &picture in pictures {
            let camera = picture.camera;
            if *self.first.get_or_insert(camera) == camera {
                self.earth.set_exposure(picture.exposure)?;
                own = Some(picture);
                continue;
            }
            let at = self.others.iter().position(|other| other.camera == camera);
            let at = match at {
                Some(at) => at,
                None => {
                    let view = self.earth.new_view()?;
                    self.others.push(Other {
                        camera,
                        overlays: self.overlays.new_view(device, &view),
                        view,
                    });
                    self.others.len() - 1
                }
            };
            self.others[at].view.set_exposure(picture.exposure)?;
        }
        let Some(own) = own else {
            return Ok(());
        };
        let of = |camera: Entity| pictures.iter().find(|picture| picture.camera == camera);
        let others = self.others.iter_mut().filter_map(|other| {
            let picture = of(other.camera)?;
            Some(ViewFrame {
                view: &mut other.view,
                eye: &picture.eye,
                sky,
                target: picture.target,
            })
        });
        let mut others: Vec<_> = others.collect();
        let mut stats = self.earth.prepare(
            queue,
            FrameRequest::new(&own.eye, sky, own.target).with_views(&mut others),
        );
        let fault = self.tracks.1.as_ref();
        let mut drawn = |camera, stats| match fault {
            Some(fault) => tell(camera, EarthCameraStatus::Failed(fault.clone())),
            None => tell(camera, EarthCameraStatus::Drawn(Box::new(stats))),
        };
        let epoch = scene.epoch;
        let seat = Seat::Own(&self.earth);
        self.overlays
            .prepare(queue, seat, own.moment(epoch), tracks, &mut stats);
        drawn(own.camera, stats);
        for other in &mut self.others {
            let Some(picture) = of(other.camera) else {
                continue;
            };
            let mut stats = *other.view.stats();
            let seat = Seat::Other(&other.view);
            other
                .overlays
                .prepare(queue, seat, picture.moment(epoch), tracks, &mut stats);
            drawn(other.camera, stats);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_earth_that_no_camera_sees_is_let_go_of_after_its_time() {
        let mut planets = Planets::default();
        planets
            .0
            .push(Planet::new((TextureFormat::Rgba8UnormSrgb, 4)));
        for _ in 0..IDLE_FRAMES {
            planets.age();
        }
        assert_eq!(planets.0.len(), 1);
        planets.age();
        assert_eq!(planets.0.len(), 0);
    }
}
