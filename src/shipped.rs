//! Scenes of `config/` that come with every program.

/// The scene that is flown where none is named.
pub const ISS: &str = include_str!("../config/iss.toml");
/// The scene of Basilisk's viewer.
pub const BASILISK: &str = include_str!("../config/basilisk.toml");
