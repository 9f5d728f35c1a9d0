//! Prepares all images of a frame.

use super::extract::{Reports, SeenEarth};
use super::eye::eye;
use super::planet::{Gpu, Picture, Planets};
use crate::{EarthCamera, EarthCameraStatus, EarthFault, EarthFrame};
use bevy::asset::AssetServer;
use bevy::camera::MainPassResolutionOverride;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::render::camera::{ExtractedCamera, TemporalJitter};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::{ExtractedView, Msaa};
use std::sync::Arc;
use terrella::{EarthError, Exposure};

type View<'a> = (
    &'a ExtractedView,
    &'a Msaa,
    Option<&'a TemporalJitter>,
    Option<&'a MainPassResolutionOverride>,
);

pub(super) fn prepare(
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    assets: Option<Res<AssetServer>>,
    seen: Res<SeenEarth>,
    mut planets: ResMut<Planets>,
    mut reports: ResMut<Reports>,
    views: Query<View, With<ExtractedCamera>>,
) {
    let mut tell = |camera, status| reports.0.push((camera, status));
    let Some(scene) = &seen.scene else {
        planets.clear();
        for &(camera, _) in &seen.cameras {
            let fault = seen.fault.clone();
            tell(
                camera,
                fault.map_or(EarthCameraStatus::Waiting, EarthCameraStatus::Failed),
            );
        }
        return;
    };
    let gpu = Gpu {
        device: &device,
        queue: &queue,
        assets: assets.as_deref(),
    };
    let mut pictures = Vec::with_capacity(seen.cameras.len());
    for (entity, camera) in &seen.cameras {
        let is_its = |view: &View| view.0.retained_view_entity.main_entity.id() == *entity;
        let Some(view) = views.iter().find(is_its) else {
            tell(*entity, EarthCameraStatus::Waiting);
            continue;
        };
        match picture(*entity, camera, view, &scene.frame) {
            Ok(picture) => pictures.push(picture),
            Err(fault) => tell(*entity, EarthCameraStatus::Failed(Arc::new(fault))),
        }
    }
    for (index, picture) in pictures.iter().enumerate() {
        let key = picture.key;
        if pictures[..index].iter().any(|earlier| earlier.key == key) {
            continue;
        }
        let alike: Vec<_> = pictures.iter().filter(|other| other.key == key).collect();
        let planet = planets.of(key, scene, gpu);
        planet.prepare(gpu, (scene, &seen.tracks), &alike, &mut tell);
    }
    planets.age();
}

fn picture(
    entity: Entity,
    camera: &EarthCamera,
    (view, msaa, jitter, resolution): View,
    frame: &EarthFrame,
) -> Result<Picture, EarthFault> {
    let (eye, target) = eye(view, jitter, resolution, frame)?;
    if let Exposure::Ev(ev) = camera.exposure
        && !Exposure::RANGE_EV.contains(&ev)
    {
        return Err(EarthError::Exposure(ev).into());
    }
    Ok(Picture {
        camera: entity,
        eye,
        exposure: camera.exposure,
        target,
        key: (view.target_format, msaa.samples()),
    })
}
