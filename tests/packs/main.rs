//! Packs of tiles: on disk, being built, fetched, and streamed.

#[cfg(feature = "pack-build")]
mod build;
#[cfg(feature = "fetch")]
mod fetch;
mod on_disk;
#[cfg(feature = "command")]
mod program;
mod streaming;
