//! The Earth of a world and its cameras.

use crate::maps::ReadMaps;
use crate::{EarthEpoch, EarthFault, EarthFrame, EarthMaps, EarthSky};
use bevy::camera::Camera3d;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;
use bevy::render::render_resource::TextureFormat;
use std::sync::Arc;
use terrella::{
    AirOptions, Atmosphere, DepthBuffer, EarthOptions, Exposure, Figure, FrameStats, GroundOptions,
    Shading, Subdivision, SurfaceLight, TileOptions, Tone,
};

/// The Earth of this world, on exactly one entity. [`EarthFrame`] is its position, [`EarthEpoch`] its time.
///
/// A task of [`AsyncComputeTaskPool`](bevy::tasks::AsyncComputeTaskPool) builds it, once for each format and sample count of the cameras. It is drawn
/// when ready. After a change it is rebuilt; until then the old one is drawn.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default)]
#[require(EarthFrame, EarthEpoch, EarthSky)]
pub struct Earth {
    /// Its maps.
    pub maps: EarthMaps,
    /// WGS84, or the sphere of the 2011 paper.
    pub figure: Figure,
    /// Cells per block edge.
    pub subdivision: Subdivision,
    /// Real sunlight, or the paper's shading.
    pub shading: Shading,
    /// Options of the light on the surface.
    pub light: SurfaceLight,
    /// How the atmosphere is drawn, if at all.
    pub atmosphere: Atmosphere,
    /// Composition of the atmosphere.
    pub air: AirOptions,
    /// Samples of anisotropic map filtering at a grazing view; `None` uses the library's default.
    pub anisotropy: Option<u16>,
    /// Tone curve for cameras without `Hdr`; those with it use Bevy's `Tonemapping`.
    pub tone: Tone,
    /// Tiles of a pack in place of whole maps (feature `packs`).
    pub tiles: Option<TileOptions>,
    /// Terrain (feature `terrain`).
    pub ground: Option<GroundOptions>,
}

impl Earth {
    /// An Earth with these maps and the library's defaults.
    pub fn new(maps: EarthMaps) -> Self {
        Self {
            maps,
            ..Self::default()
        }
    }

    /// The library's options for one of Bevy's passes, with the maps that were read for it.
    pub(crate) fn options(
        &self,
        read: ReadMaps,
        color_format: TextureFormat,
        samples: u32,
    ) -> EarthOptions {
        let defaults = EarthOptions::new(read.layers);
        EarthOptions {
            uploaded: read.uploaded,
            city_lights: read.city_lights,
            tiles: self.tiles.clone(),
            ground: self.ground.clone(),
            figure: self.figure,
            subdivision: self.subdivision,
            shading: self.shading,
            light: self.light,
            atmosphere: self.atmosphere,
            air: self.air,
            color_format,
            samples,
            depth: DepthBuffer::ReversedZ(bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT),
            anisotropy: self.anisotropy.unwrap_or(defaults.anisotropy),
            tone: self.tone,
            ..defaults
        }
    }
}

/// A `Camera3d` that sees the Earth; the `Camera3d` is added if the entity has none.
///
/// With `Hdr` the target receives linear light: a white sheet that faces the Sun is 1. Bevy then applies exposure and tone (`ColorGrading`,
/// `Tonemapping`) to the Earth and the app's meshes alike. Without another choice the tone curve is Khronos' neutral one. It needs no lookup table,
/// unlike Bevy's default.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
#[require(Camera3d, EarthCameraStatus, Tonemapping::KhronosPbrNeutral)]
pub struct EarthCamera {
    /// Exposure of the Earth for cameras without `Hdr`; Bevy exposes those with it.
    pub exposure: Exposure,
}

/// Whether a camera sees the Earth, as of the previous frame.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
pub enum EarthCameraStatus {
    /// There is no Earth, or the camera draws nothing.
    #[default]
    Waiting,
    /// The Earth is being built for the camera's format and sample count.
    Making,
    /// The Earth is drawn.
    Drawn(Box<FrameStats>),
    /// The Earth is not drawn, with the reason.
    Failed(Arc<EarthFault>),
}

impl EarthCameraStatus {
    /// Whether the Earth is drawn.
    pub fn is_drawn(&self) -> bool {
        matches!(self, Self::Drawn(_))
    }

    /// The fault that prevents drawing, if any.
    pub fn fault(&self) -> Option<&EarthFault> {
        match self {
            Self::Failed(fault) => Some(fault),
            _ => None,
        }
    }
}

impl PartialEq for EarthCameraStatus {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Waiting, Self::Waiting) | (Self::Making, Self::Making) => true,
            (Self::Drawn(a), Self::Drawn(b)) => a == b,
            (Self::Failed(a), Self::Failed(b)) => {
                Arc::ptr_eq(a, b) || a.to_string() == b.to_string()
            }
            _ => false,
        }
    }
}
