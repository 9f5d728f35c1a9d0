//! Statistics of a frame.

use std::time::Duration;
use terrella_frames::Geodetic;
use terrella_ground::globe::SurfaceStats;
use terrella_ground::height::HeightTileStats;
use terrella_imagery::residency::StreamCounters;
use terrella_imagery::tile::MAX_LEVELS;

/// Counts of what one frame drew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Blocks that pass the horizon test.
    pub blocks_visible: u32,
    /// Blocks that pass the frustum test too.
    pub blocks_drawn: u32,
    /// Cells per block edge of the drawn mesh.
    pub subdivision: u32,
    /// Statistics of the terrain, all zero without terrain.
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
    /// Position of the eye.
    pub eye: Geodetic,
    /// Whether the frame was drawn with the Moon's shadow, which may then be in view.
    pub moon_shadow: bool,
    /// Metres on the ground that a pixel would cover straight below the eye; 0 at and below the surface.
    pub pixel_m: f64,
    /// Brightness of night lights relative to the true one: [`SurfaceLight::night_gain`](crate::SurfaceLight::night_gain), reduced if the image
    /// shows daylight and they fade.
    pub night_gain: f64,
    /// Exposure value: light is multiplied by 2 to the power of it before display. It is metered if requested. A float target gets unexposed light.
    pub exposure_ev: f64,
    /// Texels of the day map per screen pixel, seen face on at the nearest point of the block, for the block with the fewest; 1 and more is sharp.
    /// Dark blocks are not counted; 0 if none is left.
    pub texels_per_pixel: f64,
    /// Number of blocks in daylight per level of the day map, the finest level first; all zero without a pack.
    pub day_levels: [u32; MAX_LEVELS],
    /// Counters of imagery tiles, all zero without a pack.
    pub tiles: StreamCounters,
    /// Time of `prepare` spent on copying tiles for upload.
    pub tile_upload: Duration,
}
