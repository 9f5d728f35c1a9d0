//! Packs of tiles: on disk, being built, fetched, and streamed.

/// The repository's root.
const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

mod build;
mod fetch;
mod on_disk;
mod program;
mod streaming;
