//! What a frame draws, as plain values: planned by code that knows no GPU, read by the drawables, which return nothing to it.
//!
//! | file | what |
//! |---|---|
//! | `frame.rs` | all that a frame draws |
//! | `air.rs` | its air |
//! | `uniforms.rs` | the structs that shaders read |

mod air;
mod frame;
mod uniforms;

pub(crate) use air::AirPlan;
pub use air::AirSide;
pub(crate) use frame::{BlockTiles, ChosenTiles, FramePlan};
pub use uniforms::{AirUniforms, FrameUniforms, MoonShadowUniforms, SurfaceLightUniforms};
