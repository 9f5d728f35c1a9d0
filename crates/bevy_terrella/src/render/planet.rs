//! An Earth for one format and sample count: made by a task, with a view for each camera.

use super::extract::SeenScene;
use crate::{EarthCameraStatus, EarthFault};
use bevy::ecs::entity::Entity;
use bevy::ecs::resource::Resource;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool};
use std::sync::Arc;
use terrella::{Earth, EarthView, Exposure, EyeView, FrameRequest, Sky, ViewFrame, Viewport, wgpu};

/// What pipelines are made for: the format and the samples of a camera's pass.
pub(super) type Key = (TextureFormat, u32);

/// One camera's picture of the Earth.
pub(super) struct Picture {
    pub camera: Entity,
    pub eye: EyeView,
    pub exposure: Exposure,
    pub target: Viewport,
    pub key: Key,
}

/// Frames after which an Earth that no camera sees is let go of.
const IDLE_FRAMES: u32 = 300;

/// The Earths that there are.
#[derive(Resource, Default)]
pub(super) struct Planets(Vec<Planet>);

impl Planets {
    /// The one for a key, made or being made as the scene says.
    pub fn of(
        &mut self,
        key: Key,
        scene: &SeenScene,
        device: &RenderDevice,
        queue: &RenderQueue,
    ) -> &mut Planet {
        let at = self.0.iter().position(|planet| planet.key == key);
        let at = at.unwrap_or_else(|| {
            self.0.push(Planet::new(key));
            self.0.len() - 1
        });
        let planet = &mut self.0[at];
        planet.idle_frames = 0;
        planet.follow(scene, device, queue);
        planet
    }

    /// Ends a frame: those that no camera has seen for long are let go of.
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

    /// Lets all go.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether there is a picture for a camera.
    pub fn is_prepared(&self, camera: Entity) -> bool {
        self.seat(camera).is_some()
    }

    /// Draws what was prepared for a camera.
    pub fn render(&self, camera: Entity, pass: &mut wgpu::RenderPass<'_>) {
        match self.seat(camera) {
            Some((earth, Some(view))) => earth.render_view(view, pass),
            Some((earth, None)) => earth.render(pass),
            None => {}
        }
    }

    fn seat(&self, camera: Entity) -> Option<(&Earth, Option<&EarthView>)> {
        let drawn = self.0.iter().filter_map(|planet| planet.drawn.as_ref());
        drawn.into_iter().find_map(|drawn| {
            let first = (drawn.first == Some(camera)).then_some((&drawn.earth, None));
            first.or_else(|| {
                let other = drawn.others.iter().find(|other| other.0 == camera);
                other.map(|(_, view)| (&drawn.earth, Some(view)))
            })
        })
    }
}

/// An Earth for one key.
pub(super) struct Planet {
    key: Key,
    /// The scene's revision that it was made for, or is being made for.
    revision: u64,
    making: Option<Task<Result<Earth, EarthFault>>>,
    drawn: Option<Drawn>,
    fault: Option<Arc<EarthFault>>,
    idle_frames: u32,
}

/// An Earth with the cameras that see it. The first sees by the Earth's own view, each of the others by one of its own.
struct Drawn {
    earth: Earth,
    first: Option<Entity>,
    others: Vec<(Entity, EarthView)>,
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

    /// Takes what a task has made, and starts one where the scene has changed.
    fn follow(&mut self, scene: &SeenScene, device: &RenderDevice, queue: &RenderQueue) {
        if let Some(made) = self.making.as_mut().and_then(check_ready) {
            self.making = None;
            self.drawn = None;
            match made {
                Ok(earth) => {
                    self.drawn = Some(Drawn {
                        earth,
                        first: None,
                        others: Vec::new(),
                    });
                }
                Err(fault) => self.fault = Some(Arc::new(fault)),
            }
        }
        // One at a time: what is made now is shown before the next is begun.
        if self.revision == scene.revision || self.making.is_some() {
            return;
        }
        self.revision = scene.revision;
        self.fault = None;
        let (earth, (format, samples)) = (scene.earth.clone(), self.key);
        let (device, queue) = (device.clone(), queue.clone());
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        self.making = Some(pool.spawn(async move {
            let options = earth.options(format, samples)?;
            Ok(Earth::new(device.wgpu_device(), &queue, &options)?)
        }));
    }

    /// Prepares the pictures of a frame, and tells what became of them.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        sky: &Sky,
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
        if let Err(fault) = drawn.prepare(queue, sky, pictures, tell) {
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
    /// Those who have left give up their views.
    fn seat(&mut self, pictures: &[&Picture]) {
        let is_there = |camera: Entity| pictures.iter().any(|picture| picture.camera == camera);
        self.first = self.first.filter(|&camera| is_there(camera));
        self.others.retain(|&(camera, _)| is_there(camera));
        // The Earth's own view is always somebody's: it must be prepared with the others.
        if self.first.is_none() {
            self.first = self.others.pop().map(|(camera, _)| camera);
        }
    }

    fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        sky: &Sky,
        pictures: &[&Picture],
        tell: &mut dyn FnMut(Entity, EarthCameraStatus),
    ) -> Result<(), EarthFault> {
        self.seat(pictures);
        let mut own = None;
        for &picture in pictures {
            let camera = picture.camera;
            if *self.first.get_or_insert(camera) == camera {
                self.earth.set_exposure(picture.exposure)?;
                own = Some(picture);
                continue;
            }
            let at = self.others.iter().position(|other| other.0 == camera);
            let at = match at {
                Some(at) => at,
                None => {
                    self.others.push((camera, self.earth.new_view()?));
                    self.others.len() - 1
                }
            };
            self.others[at].1.set_exposure(picture.exposure)?;
        }
        let Some(own) = own else {
            return Ok(());
        };
        let of = |camera: Entity| pictures.iter().find(|picture| picture.camera == camera);
        let others = self.others.iter_mut().filter_map(|(camera, view)| {
            let picture = of(*camera)?;
            Some(ViewFrame {
                view,
                eye: &picture.eye,
                sky,
                target: picture.target,
            })
        });
        let mut others: Vec<_> = others.collect();
        let stats = self.earth.prepare(
            queue,
            FrameRequest::new(&own.eye, sky, own.target).with_views(&mut others),
        );
        tell(own.camera, EarthCameraStatus::Drawn(Box::new(stats)));
        for (camera, view) in &self.others {
            let stats = Box::new(*view.stats());
            tell(*camera, EarthCameraStatus::Drawn(stats));
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
