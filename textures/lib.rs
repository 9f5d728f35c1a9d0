//! The starter maps of Terrella. `SOURCES.md` says where each comes from and under which licence.

/// The folder of the maps, where this crate was built. A program that is moved to another machine takes the maps with it, in `textures`
/// beside it or in `../share/terrella/textures`.
pub const FOLDER: &str = env!("CARGO_MANIFEST_DIR");
