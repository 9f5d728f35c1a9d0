//! Scenes of `config/` that are compiled into every program.

/// The scene that is played by default.
pub const ISS: &str = include_str!("../config/iss.toml");
/// The scene of Basilisk's viewer.
pub const BASILISK: &str = include_str!("../config/basilisk.toml");
