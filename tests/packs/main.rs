//! Packs of tiles: on disk, being built, and streamed.

#[cfg(feature = "pack-build")]
mod build;
mod on_disk;
mod streaming;
