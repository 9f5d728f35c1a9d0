//! From the main world: the Earth and its cameras; back to it: what became of them.

use crate::time::has_sky;
use crate::{Earth, EarthCamera, EarthCameraStatus, EarthEpoch, EarthFault, EarthFrame, EarthSky};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, ResMut};
use bevy::ecs::world::Ref;
use bevy::render::{Extract, MainWorld};
use std::sync::Arc;
use terrella::Sky;

/// What the main world shows.
#[derive(Resource, Default)]
pub(super) struct SeenEarth {
    pub scene: Option<SeenScene>,
    /// What is wrong with it, for all cameras.
    pub fault: Option<Arc<EarthFault>>,
    pub cameras: Vec<(Entity, EarthCamera)>,
    revisions: u64,
}

/// The one Earth.
#[derive(Clone)]
pub(super) struct SeenScene {
    entity: Entity,
    pub earth: Arc<Earth>,
    /// Counts its changes.
    pub revision: u64,
    pub frame: EarthFrame,
    pub sky: Sky,
}

type Parts<'a> = (
    Entity,
    Ref<'a, Earth>,
    &'a EarthFrame,
    &'a EarthEpoch,
    &'a EarthSky,
);

pub(super) fn extract(
    mut seen: ResMut<SeenEarth>,
    earths: Extract<Query<Parts<'static>>>,
    cameras: Extract<Query<(Entity, &EarthCamera)>>,
) {
    seen.cameras.clear();
    seen.cameras
        .extend(cameras.iter().map(|(entity, camera)| (entity, *camera)));
    seen.cameras.sort_unstable_by_key(|&(entity, _)| entity);
    let count = earths.iter().len();
    let first = earths.iter().next();
    let epoch = first.as_ref().map(|earth| earth.3.0);
    seen.fault = match epoch {
        _ if count > 1 => Some(Arc::new(EarthFault::Several(count))),
        Some(epoch) if !has_sky(epoch) => Some(Arc::new(EarthFault::Epoch(epoch))),
        _ => None,
    };
    let Some((entity, earth, frame, _, sky)) = first.filter(|_| seen.fault.is_none()) else {
        seen.scene = None;
        return;
    };
    let before = seen.scene.take().filter(|scene| scene.entity == entity);
    let (earth, revision) = match before {
        Some(scene) if !earth.is_changed() => (scene.earth, scene.revision),
        _ => {
            seen.revisions += 1;
            (Arc::new(Earth::clone(&earth)), seen.revisions)
        }
    };
    seen.scene = Some(SeenScene {
        entity,
        earth,
        revision,
        frame: *frame,
        sky: sky.0,
    });
}

/// What became of each camera in the frame before.
#[derive(Resource, Default)]
pub(super) struct Reports(pub Vec<(Entity, EarthCameraStatus)>);

pub(super) fn report(mut main: ResMut<MainWorld>, mut reports: ResMut<Reports>) {
    for (entity, status) in reports.0.drain(..) {
        let Ok(mut camera) = main.get_entity_mut(entity) else {
            continue;
        };
        let Some(mut before) = camera.get_mut::<EarthCameraStatus>() else {
            continue;
        };
        if *before == status {
            continue;
        }
        // Once a fault, whatever the numbers in it do from frame to frame.
        let kind = |status: &EarthCameraStatus| status.fault().map(std::mem::discriminant);
        if let Some(fault) = status.fault()
            && kind(&before) != kind(&status)
        {
            tracing::error!("camera {entity} does not see the Earth: {fault}");
        }
        *before = status;
    }
}
