//! Extracts the Earth and its cameras from the main world, and reports their status back.

use super::overlays::SeenTracks;
#[cfg(feature = "celestial")]
use crate::EarthCelestial;
use crate::time::has_sky;
use crate::{Earth, EarthCamera, EarthCameraStatus, EarthEpoch, EarthFault, EarthFrame, EarthSky};
#[cfg(feature = "tracks")]
use crate::{EarthLines, EarthStation, EarthTrack};
use bevy::ecs::change_detection::DetectChanges;
#[cfg(feature = "tracks")]
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::resource::Resource;
#[cfg(feature = "tracks")]
use bevy::ecs::system::Local;
use bevy::ecs::system::{Query, ResMut};
use bevy::ecs::world::Ref;
use bevy::render::{Extract, MainWorld};
use std::sync::Arc;
use terrella::Sky;
use terrella::frames::Epoch;

/// Contents of the main world.
#[derive(Resource, Default)]
pub(super) struct SeenEarth {
    pub scene: Option<SeenScene>,
    /// Fault of the scene, for all cameras.
    pub fault: Option<Arc<EarthFault>>,
    pub cameras: Vec<(Entity, EarthCamera)>,
    pub tracks: SeenTracks,
    revisions: u64,
}

/// The single Earth.
#[derive(Clone)]
pub(super) struct SeenScene {
    entity: Entity,
    pub earth: Arc<Earth>,
    /// Change counter.
    pub revision: u64,
    pub frame: EarthFrame,
    pub epoch: Epoch,
    pub sky: Sky,
    #[cfg(feature = "celestial")]
    pub celestial: Option<EarthCelestial>,
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
    #[cfg(feature = "celestial")] skies: Extract<Query<&EarthCelestial>>,
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
    #[cfg(feature = "celestial")]
    let celestial = skies.get(entity).ok().copied();
    #[cfg(feature = "celestial")]
    let before = before.filter(|scene| {
        scene.celestial.map(EarthCelestial::key) == celestial.map(EarthCelestial::key)
    });
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
        epoch: epoch.unwrap_or_default(),
        sky: sky.0,
        #[cfg(feature = "celestial")]
        celestial,
    });
}

/// Extracts satellites, stations and lines if one of them changed, appeared or disappeared.
#[cfg(feature = "tracks")]
pub(super) fn extract_tracks(
    mut seen: ResMut<SeenEarth>,
    satellites: Extract<Query<(Entity, Ref<EarthTrack>)>>,
    stations: Extract<Query<(Entity, Ref<EarthStation>)>>,
    lines: Extract<Query<(Entity, Ref<EarthLines>)>>,
    mut counts: Local<[usize; 3]>,
) {
    let now = [
        satellites.iter().len(),
        stations.iter().len(),
        lines.iter().len(),
    ];
    // If one disappears and another appears in the same frame, the new one counts as a change.
    let is_same = *counts == now
        && !satellites.iter().any(|(_, one)| one.is_changed())
        && !stations.iter().any(|(_, one)| one.is_changed())
        && !lines.iter().any(|(_, one)| one.is_changed());
    if is_same {
        return;
    }
    *counts = now;
    seen.tracks = SeenTracks {
        revision: seen.tracks.revision + 1,
        satellites: in_order(satellites.iter()),
        stations: in_order(stations.iter()),
        lines: in_order(lines.iter()),
    };
}

#[cfg(feature = "tracks")]
fn in_order<'w, T: Component + Clone>(
    found: impl Iterator<Item = (Entity, Ref<'w, T>)>,
) -> Arc<Vec<T>> {
    let mut found: Vec<_> = found.collect();
    found.sort_unstable_by_key(|&(entity, _)| entity);
    Arc::new(found.into_iter().map(|(_, one)| T::clone(&one)).collect())
}

/// Status of each camera in the previous frame.
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
        // Logs each kind of fault once, even if its numbers change from frame to frame.
        let kind = |status: &EarthCameraStatus| status.fault().map(std::mem::discriminant);
        if let Some(fault) = status.fault()
            && kind(&before) != kind(&status)
        {
            tracing::error!("camera {entity} does not see the Earth: {fault}");
        }
        *before = status;
    }
}
