//! Rendering of the Earth through its public interface on a real adapter: places, tiles, terrain, tracks, the host's formats.

mod appearances;
mod aurora;
mod bloom;
mod changes;
mod city_lights;
mod clouds_at_limb;
mod clouds_overhead;
#[path = "../common/mod.rs"]
mod common;
mod detail;
#[cfg(feature = "offscreen")]
mod development;
mod embedding;
#[cfg(feature = "offscreen")]
mod faults;
mod interpolation;
mod light;
mod night;
mod picture;
mod precision;
#[cfg(feature = "terrain")]
mod projected_grid;
#[cfg(feature = "packs")]
mod quality;
#[cfg(feature = "terrain")]
mod relief;
mod scaled;
#[cfg(feature = "offscreen")]
mod shared_maps;
#[cfg(feature = "terrain")]
mod streamed_heights;
#[cfg(feature = "packs")]
mod tile_parts;
#[cfg(feature = "packs")]
mod tiles;
#[cfg(feature = "tracks")]
mod tracks;
mod truth;
mod uploaded_maps;
mod views;
mod water;
