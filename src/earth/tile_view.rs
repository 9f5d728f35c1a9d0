//! Inputs of tile selection, and the resulting detail.

use glam::{DMat4, DVec3};
use terrella_imagery::tile::MAX_LEVELS;

/// Inputs of a frame's tile selection besides the blocks.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(feature = "tiles"), allow(dead_code))]
pub(super) struct TileView {
    pub eye_itrf_m: DVec3,
    pub sun_itrf: DVec3,
    /// Direction to the Moon, if moonlight is drawn.
    pub moon_itrf: Option<DVec3>,
    /// Angle of a screen pixel.
    pub pixel_rad: f64,
    /// From eye-relative ITRF metres to clip space.
    pub clip_from_eye: DMat4,
}

/// Detail of the maps that a frame is drawn with.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileDetail {
    /// As [`super::FrameStats::texels_per_pixel`].
    pub texels_per_pixel: f64,
    /// As [`super::FrameStats::day_levels`].
    pub day_levels: [u32; MAX_LEVELS],
}
