//! Simulations of Basilisk in pictures: their instants as moments of a flight, the window's time where a simulation gives it, the
//! pictures that its own cameras ask for.

#[cfg(feature = "command")]
mod camera_service;
#[cfg(feature = "command")]
mod depth;
#[cfg(feature = "command")]
mod eyes;
mod moments;
#[cfg(feature = "command")]
mod service;
#[cfg(feature = "command")]
mod window_time;

#[cfg(feature = "command")]
pub(super) use camera_service::with_camera_service;
#[cfg(feature = "command")]
pub use service::{ServeRequest, serve};
#[cfg(feature = "command")]
pub(super) use window_time::SimulationPlay;
