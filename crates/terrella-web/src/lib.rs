//! The Earth in a canvas of a web page: what `terrella.js` calls.
//!
//! The page owns canvas, events and time; this crate draws and moves the camera. Lengths in the interface are metres, angles degrees,
//! places on the canvas its own pixels from the upper left corner, instants milliseconds since 1970 (UTC) as `Date.now()` gives them.

#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
mod almanac;
// The player's cameras on satellites.
#[allow(dead_code)]
#[path = "../../terrella-play/src/camera.rs"]
mod camera;
#[cfg(target_family = "wasm")]
mod canvas;
mod compact;
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
mod eye;
#[cfg(target_family = "wasm")]
mod globe;
#[cfg(target_family = "wasm")]
mod maps;
// The window's camera: one place for its mathematics.
#[allow(dead_code)]
#[path = "../../terrella-play/src/orbit_camera.rs"]
mod orbit_camera;
#[cfg(target_family = "wasm")]
mod overlay;
#[allow(dead_code)]
#[path = "../../terrella-play/src/pose.rs"]
mod pose;
#[cfg(target_family = "wasm")]
mod posted;
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
mod pushed;
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
mod ride;
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
mod satellites;
/// Choices of scenes that the player's cameras take.
mod scene {
    /// What is upwards on screen where the camera looks straight down.
    #[allow(dead_code)]
    #[derive(Clone, Copy)]
    pub enum CameraUp {
        /// The direction of flight.
        Flight,
        /// North.
        North,
    }
}
#[allow(dead_code)]
mod tile_layout;

#[cfg(target_family = "wasm")]
pub use globe::{Globe, Opening, PackOpening, PreparedEarth};
#[cfg(target_family = "wasm")]
pub use maps::decode_maps;

/// An error of the page.
#[cfg(target_family = "wasm")]
fn thrown(error: impl std::fmt::Display) -> wasm_bindgen::JsValue {
    js_sys::Error::new(&error.to_string()).into()
}
