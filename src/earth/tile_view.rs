//! What tiles are chosen by, and how fine they came out.

use glam::{DMat4, DVec3};
use terrella_imagery::tile::MAX_LEVELS;

/// What a frame's choice depends on beside the blocks.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(feature = "packs"), allow(dead_code))]
pub(super) struct TileView {
    pub eye_itrf_m: DVec3,
    pub sun_itrf: DVec3,
    /// Where moonlight is drawn.
    pub moon_itrf: Option<DVec3>,
    /// Angle of a screen pixel.
    pub pixel_rad: f64,
    /// From eye-relative ITRF metres to clip space.
    pub clip_from_eye: DMat4,
}

/// How fine the maps are that a frame is drawn with.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileDetail {
    /// As [`super::FrameStats::texels_per_pixel`].
    pub texels_per_pixel: f64,
    /// As [`super::FrameStats::day_levels`].
    pub day_levels: [u32; MAX_LEVELS],
}
