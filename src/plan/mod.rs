//! The content of a frame as plain values: planned by code without a GPU, and read by the drawables, which return nothing to it.
//!
//! | file | content |
//! |---|---|
//! | `frame.rs` | the content of a frame |
//! | `draws.rs` | the draws of its surface; `ground_draws.rs` for terrain |
//! | `cells.rs` | how cells of the block sphere are lit |
//! | `detail_scales.rs` | scales of synthetic detail that it can show |
//! | `air.rs` | its air |
//! | `aurora.rs` | the aurora: its position and brightness |
//! | `glow.rs` | airglow |
//! | `surface_light.rs` | options of the light on the surface, and their uniforms |
//! | `limits.rs` | limits of a device |
//! | `uniforms.rs` | uniform structs |

mod air;
mod aurora;
mod cells;
mod detail_scales;
mod draws;
mod frame;
mod glow;
#[cfg(feature = "terrain")]
mod ground_draws;
mod limits;
mod surface_light;
mod uniforms;

pub(crate) use air::AirPlan;
pub use air::AirSide;
pub use aurora::AuroraUniforms;
pub(crate) use cells::{CellLight, CellLights, interpolated_cells};
pub use detail_scales::DetailScales;
pub(crate) use detail_scales::{BLENDED_DETAIL_LEVELS, EMPTY_DETAIL_LEVEL, FINE_DETAIL_TILES};
pub(crate) use draws::{
    DrawCosts, DrawLight, LISTED_INDICES, PER_BLOCK_TILES, SurfaceDraw, WHOLE_MAP, draw_blocks,
};
pub(crate) use frame::{BlockTiles, ChosenTiles, CityDraw, FramePlan, LIMB_SEGMENTS};
pub use glow::{AIRGLOW_LUMINANCE, GlowUniforms};
pub(crate) use glow::{
    GLOW_BASE_M, GLOW_DAY_SIN, GLOW_NIGHT_SIN, GLOW_TOP, GREEN_LIGHT, LAYER_HEIGHTS, LAYER_SIGMAS,
    LOW_LIGHT, RED_LIGHT, beneath,
};
#[cfg(feature = "terrain")]
pub(crate) use ground_draws::{GroundDraws, PRISM_INDICES};
pub use limits::DeviceLimits;
pub use surface_light::{
    CITY_RADIANCE, LightEffect, LightEffects, SurfaceLight, SurfaceLightUniforms,
};
pub use uniforms::{AirUniforms, FrameUniforms, MoonShadowUniforms};
