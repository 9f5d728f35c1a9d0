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

/// Scenes of `config/` that come with every program.
pub mod shipped {
    /// The scene that is flown where none is named.
    pub const ISS: &str = include_str!("../config/iss.toml");
    /// The scene of Basilisk's viewer.
    pub const BASILISK: &str = include_str!("../config/basilisk.toml");
}
