//! Playing a scene: clock, cameras, window, stills and video.

pub mod camera;
pub mod clock;
