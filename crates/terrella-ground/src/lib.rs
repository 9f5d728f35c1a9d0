//! The ground and its light in numbers: this crate uses no GPU.
//!
//! | module | what |
//! |---|---|
//! | [`height`] | ranges of heights, and statistics of streamed heights |
//! | [`elevation`] | heights of the ground: grids, their pyramids, readers of elevation data; with the feature `terrain` |
//! | [`globe`] | the block sphere, and surfaces with relief: vertices, culling, level of detail |
//! | [`air`] | density, scattering tables, the billboard |
//! | [`light`] | exposure, tone curves, metering |
//! | [`half`] | half floats |
//! | [`step`] | the smooth step |
//!
//! Hosts of the renderer find the items that they need in the crate `terrella`.

// docs.rs shows the required feature of each item.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![allow(
    missing_docs,
    reason = "what hosts meet of it is documented, the rest says itself"
)]

// Test files shared with other crates use this crate's name.
#[cfg(test)]
extern crate self as terrella_ground;

pub mod air;
#[cfg(feature = "terrain")]
pub mod elevation;
pub mod globe;
pub mod half;
pub mod height;
pub mod light;
pub mod step;
