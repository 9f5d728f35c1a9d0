//! Simulations of Basilisk in pictures: their instants as moments of a flight, the window's time where a simulation gives it, the
//! pictures that its own cameras ask for.

mod camera_service;
mod depth;
mod moments;
mod service;
mod window_time;

pub(super) use camera_service::with_camera_service;
pub use service::{ServeRequest, serve};
pub(super) use window_time::SimulationPlay;
