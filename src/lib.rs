//! Terrella: a realistic Earth that any program can draw.
#![warn(missing_docs)]

pub mod air;
pub mod earth;
pub mod frames;
pub mod globe;
pub mod gpu;
pub mod imagery;
pub mod orbit;
#[cfg(feature = "command")]
pub mod play;
pub mod scene;

pub use air::Atmosphere;
pub use earth::{DepthBuffer, Earth, EarthError, EarthOptions, EyeView, FrameStats, Sky, Viewport};
pub use globe::{Figure, Shading, Visibility};
