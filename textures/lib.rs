//! The starter maps of Terrella. `SOURCES.md` says where each comes from and under which licence.

/// The folder of the maps, where this crate was built. A program that is moved to another machine takes the maps with it, in `textures`
/// beside it or in `../share/terrella/textures`.
///
/// `None` if the environment variable `TERRELLA_RELEASE` was set at build time: a release must not use the folder of the machine that built it.
pub const FOLDER: Option<&str> = match option_env!("TERRELLA_RELEASE") {
    Some(_) => None,
    None => Some(env!("CARGO_MANIFEST_DIR")),
};
