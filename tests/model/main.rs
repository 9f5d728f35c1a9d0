//! The model of the Earth as numbers: figure, time, blocks, air, and the shaders as text. No adapter, no files.

mod air;
mod frames;
mod globe;
mod halo;
#[cfg(all(feature = "celestial", feature = "terrain", feature = "tracks"))]
mod shaders;
mod tones;
