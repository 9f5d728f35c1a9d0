//! What the Earth of a world is made of, and the cameras that see it.

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

/// The Earth of this world: one entity has it. Where it stands is its [`EarthFrame`], when it is its [`EarthEpoch`].
///
/// It is made on a thread of [`AsyncComputeTaskPool`](bevy::tasks::AsyncComputeTaskPool), once for each pair of format and sample count that
/// cameras have, and drawn when it is ready. After a change it is made again, and drawn as it was until then.
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
    /// What of the light on the surface can be chosen.
    pub light: SurfaceLight,
    /// The air, or none of it.
    pub atmosphere: Atmosphere,
    /// What the air holds.
    pub air: AirOptions,
    /// Samples that a map is filtered with at a grazing view; `None` takes the library's default.
    pub anisotropy: Option<u16>,
    /// The curve by which cameras without `Hdr` show light; those with it are shown by Bevy's `Tonemapping`.
    pub tone: Tone,
    /// Tiles of a pack in place of whole maps (feature `packs`).
    pub tiles: Option<TileOptions>,
    /// Terrain (feature `terrain`).
    pub ground: Option<GroundOptions>,
}

impl Earth {
    /// An Earth of these maps, all else as the library has it.
    pub fn new(maps: EarthMaps) -> Self {
        Self {
            maps,
            ..Self::default()
        }
    }

    /// The library's options for a pass of Bevy's, with maps that were read for it.
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

/// A `Camera3d` that sees the Earth; it is added where an entity has none.
///
/// With `Hdr` the target gets light itself: a white sheet that faces the Sun is 1, and exposing and tone are Bevy's (`ColorGrading`,
/// `Tonemapping`), for the Earth and the app's things alike. The tone curve is Khronos' neutral one where the camera names no other: it needs no
/// table, which Bevy's default does.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
#[require(Camera3d, EarthCameraStatus, Tonemapping::KhronosPbrNeutral)]
pub struct EarthCamera {
    /// How bright cameras without `Hdr` show the Earth; those with it are exposed by Bevy.
    pub exposure: Exposure,
}

/// Whether a camera sees the Earth: what was prepared in the frame before.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
pub enum EarthCameraStatus {
    /// There is no Earth, or the camera draws nothing.
    #[default]
    Waiting,
    /// The Earth is being made for the camera's format and samples.
    Making,
    /// It is drawn.
    Drawn(Box<FrameStats>),
    /// It is not drawn, and why.
    Failed(Arc<EarthFault>),
}

impl EarthCameraStatus {
    /// Whether the Earth is drawn.
    pub fn is_drawn(&self) -> bool {
        matches!(self, Self::Drawn(_))
    }

    /// Why it is not drawn, where that is a fault.
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
