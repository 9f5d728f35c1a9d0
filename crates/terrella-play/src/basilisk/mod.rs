//! Rendering of Basilisk simulations: their snapshots as moments of a flight, the window's time controlled by a simulation, and the images
//! requested by its cameras.

#[cfg(feature = "window")]
mod camera_service;
#[cfg(feature = "window")]
mod depth;
#[cfg(feature = "window")]
mod eyes;
mod moments;
#[cfg(feature = "window")]
mod service;
#[cfg(feature = "window")]
mod window_time;

#[cfg(feature = "window")]
pub(super) use camera_service::with_camera_service;
#[cfg(feature = "window")]
pub use service::{ServeRequest, serve};
#[cfg(feature = "window")]
pub(super) use window_time::SimulationPlay;
