//! What the Earth draws, through its public interface on a real adapter: places, tiles, relief, tracks, the host's formats.

#[path = "../common/mod.rs"]
mod common;
mod embedding;
mod picture;
mod precision;
mod projected_grid;
mod quality;
mod relief;
mod tiles;
mod tracks;
