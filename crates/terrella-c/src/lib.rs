//! The C interface of Terrella; `include/terrella.h` is made from it by cbindgen, and `docs/embedding/c.md` shows how it is used.
//!
//! No function lets a panic escape. Handles are not addresses but numbers in a table. A handle that is null, freed or of another kind is detected
//! and reported with a status.

mod axes;
mod camera;
mod earth;
mod failure;
mod handles;
mod options;
mod passes;
mod picture;
mod pointers;
mod scene;
mod sensor;
mod time;
mod truth;
mod version;
#[cfg(all(unix, not(target_vendor = "apple")))]
mod vulkan;

pub use axes::*;
pub use camera::*;
pub use earth::*;
pub use failure::*;
pub use options::*;
pub use passes::*;
pub use picture::*;
pub use scene::*;
pub use sensor::*;
pub use time::*;
pub use truth::*;
pub use version::*;
#[cfg(all(unix, not(target_vendor = "apple")))]
pub use vulkan::*;
