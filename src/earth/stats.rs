//! What a frame drew.

use std::time::Duration;
use terrella_frames::Geodetic;
use terrella_ground::globe::SurfaceStats;
use terrella_ground::height::HeightTileStats;
use terrella_imagery::residency::StreamCounters;
use terrella_imagery::tile::MAX_LEVELS;

/// Counts of what one frame drew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Blocks left by the horizon test.
    pub blocks_visible: u32,
    /// Blocks left by the frustum test too.
    pub blocks_drawn: u32,
    /// Cells per block edge that were drawn.
    pub subdivision: u32,
    /// The ground's patches, all zero without relief.
    pub ground: SurfaceStats,
    /// Elevation tiles, all zero unless elevation data is streamed.
    pub height_tiles: HeightTileStats,
    /// Bytes of the terrain's vertices, triangles and elevation data on the GPU; 0 without terrain.
    pub ground_bytes: u64,
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
    /// Whether the Moon's shadow may be in view: the frame was drawn with it.
    pub moon_shadow: bool,
    /// Metres on the ground that a pixel would cover straight below the eye; 0 at and below the surface.
    pub pixel_m: f64,
    /// How many times brighter than in truth the lights of the night were drawn: [`SurfaceLight::night_gain`](crate::SurfaceLight::night_gain),
    /// less where the picture shows daylight and they fade.
    pub night_gain: f64,
    /// What light was multiplied by before it was shown, as an exposure value: 2 to the power of it. Metered where that is
    /// asked for. A float target gets light without it.
    pub exposure_ev: f64,
    /// Texels of the day map per screen pixel, seen face on at the nearest point of the block where there are fewest;
    /// 1 and more is sharp. Blocks that lie in the dark are not counted; 0 where none is left.
    pub texels_per_pixel: f64,
    /// Blocks in daylight by the level of the day map that they are drawn with, the finest first; all zero without a
    /// pack.
    pub day_levels: [u32; MAX_LEVELS],
    /// Tiles, all zero without a pack.
    pub tiles: StreamCounters,
    /// The part of `prepare` that copied tiles for upload.
    pub tile_upload: Duration,
}
