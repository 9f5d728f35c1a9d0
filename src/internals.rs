//! What the Earth is made of, for the tests, benches, fuzz targets and the command of this repository. Hosts need none of it: it changes
//! with any version. The table of modules in the crate's documentation says what each knows.

#![allow(
    missing_docs,
    reason = "what hosts meet is documented where it is exported"
)]

#[path = "earth/mod.rs"]
pub mod earth;
#[path = "gpu/mod.rs"]
pub mod gpu;
#[cfg(feature = "offscreen")]
#[path = "offscreen/mod.rs"]
pub mod offscreen;
#[path = "plan/mod.rs"]
pub mod plan;
#[path = "shipped.rs"]
pub mod shipped;
