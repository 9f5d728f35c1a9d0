//! The façade: an Earth that a wgpu host draws into its own pass.

use crate::air::Atmosphere;
use crate::frames::{Epoch, Geodetic, sun_direction_itrf};
use crate::globe::{Figure, Visibility};
use crate::imagery::EarthLayers;
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// How the surface is shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Shading {
    /// Linear light, the Sun of the date, dark night side with a soft terminator.
    #[default]
    Sunlit,
    /// The three layers as the 2011 paper prints them, in display values.
    Paper,
}

/// The depth buffer of the pass that the Earth is drawn in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthBuffer {
    /// The pass has none: the Earth is drawn over what is there already.
    None,
    /// Nearer is larger (clear to 0). The one to choose: it keeps precision to the horizon.
    ReversedZ(wgpu::TextureFormat),
    /// Nearer is smaller (clear to 1).
    StandardZ(wgpu::TextureFormat),
}

/// What is fixed when an Earth is made.
#[derive(Clone, Debug)]
pub struct EarthOptions {
    /// The maps. A layer that is `None` costs nothing.
    pub layers: EarthLayers,
    /// The figure.
    pub figure: Figure,
    /// Cells per block edge, 1…48.
    pub subdivision: u32,
    /// Which blocks are drawn.
    pub visibility: Visibility,
    /// How they are shaded.
    pub shading: Shading,
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
    /// Format of the colour target.
    pub color_format: wgpu::TextureFormat,
    /// Sample count of the pass.
    pub samples: u32,
    /// Depth buffer of the pass.
    pub depth: DepthBuffer,
}

impl EarthOptions {
    /// The defaults for a picture of [`crate::gpu::FrameTargets`] with these maps.
    pub fn new(layers: EarthLayers) -> Self {
        Self {
            layers,
            figure: Figure::default(),
            subdivision: 6,
            visibility: Visibility::default(),
            shading: Shading::default(),
            atmosphere: Atmosphere::default(),
            color_format: crate::gpu::FrameTargets::COLOR,
            samples: 1,
            depth: DepthBuffer::ReversedZ(crate::gpu::FrameTargets::DEPTH),
        }
    }
}

/// Where the eye is and what it sees, in the host's own world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeView {
    /// The eye in the host's world and unit.
    pub eye_world: DVec3,
    /// Rotation from world axes to view axes: x right, y up, −z forward.
    pub view_from_world: DQuat,
    /// The host's projection from view space (host's unit) to wgpu clip space, z in 0…1.
    pub clip_from_view: DMat4,
    /// Where the Earth stands: takes the host's world to ITRF metres. A rotation, a uniform scale and a shift.
    pub itrf_from_world: DAffine3,
}

impl EyeView {
    /// An eye in ITRF metres that looks along `forward` with `up` upwards on screen; infinite reversed-Z projection.
    ///
    /// `fov_y_rad` is the vertical field of view, `aspect` width over height.
    pub fn itrf(eye_itrf_m: DVec3, forward: DVec3, up: DVec3, fov_y_rad: f64, aspect: f64) -> Self {
        let _ = (forward, up, fov_y_rad, aspect);
        Self {
            eye_world: eye_itrf_m,
            view_from_world: DQuat::IDENTITY,
            clip_from_view: DMat4::IDENTITY,
            itrf_from_world: DAffine3::IDENTITY,
        }
    }
}

/// What lights the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Unit vector to the Sun in ITRF axes.
    pub sun_itrf: DVec3,
}

impl Sky {
    /// The sky of a date.
    pub fn at(epoch: Epoch) -> Self {
        Self {
            sun_itrf: sun_direction_itrf(epoch),
        }
    }
}

/// What one frame drew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameStats {
    /// Blocks left by the horizon test.
    pub blocks_visible: u32,
    /// Blocks left by the frustum test too.
    pub blocks_drawn: u32,
    /// Triangles drawn, air included.
    pub triangles: u32,
    /// Draw calls, air included.
    pub draw_calls: u32,
    /// Bytes written to the GPU by this `prepare`.
    pub uploaded_bytes: u64,
    /// Bytes of all textures held, mip levels included.
    pub texture_bytes: u64,
    /// The eye's place.
    pub eye: Geodetic,
}

/// What can be wrong with the options.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EarthError {
    /// Subdivision outside 1…48.
    #[error("subdivision is {0}; it must be from 1 to 48")]
    Subdivision(u32),
}

/// The Earth.
pub struct Earth {}

impl Earth {
    /// Makes pipelines and uploads the maps.
    pub fn new(
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _options: &EarthOptions,
    ) -> Result<Self, EarthError> {
        Ok(Self {})
    }

    /// Chooses what the eye sees and writes it to the GPU. Call once a frame, before the pass. Never waits.
    ///
    /// `size` is the target's width and height in pixels.
    pub fn prepare(
        &mut self,
        _queue: &wgpu::Queue,
        _view: &EyeView,
        _sky: &Sky,
        _size: (u32, u32),
    ) -> FrameStats {
        unreachable!()
    }

    /// Draws what `prepare` chose into the host's pass.
    pub fn render(&self, _pass: &mut wgpu::RenderPass<'_>) {}

    /// Names of the features that are on.
    pub fn features_on(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// Names of the features that are off and cost nothing.
    pub fn features_off(&self) -> Vec<&'static str> {
        Vec::new()
    }
}
