//! The Earth in Bevy, compared with the native host.
#![allow(
    clippy::duplicate_mod,
    reason = "each example includes the app without a window"
)]

mod assets;
mod cameras;
mod compare;
#[allow(dead_code)]
#[path = "../../examples/craft/main.rs"]
mod craft;
mod depth;
mod example;
mod faults;
mod native;
mod one_frame;
mod overlays;
mod recovery;
mod scene;
mod sensor;
#[allow(dead_code)]
#[path = "../../examples/sensor.rs"]
mod sensor_example;

use craft::headless;
