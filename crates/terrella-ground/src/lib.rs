//! The ground and the light on it, as numbers: nothing here knows the GPU.
//!
//! | module | what |
//! |---|---|
//! | [`height`] | ranges of heights, and numbers of those that are streamed |
//! | [`elevation`] | heights of the ground: grids, their pyramids, readers of elevation data; with the feature `terrain` |
//! | [`globe`] | the block sphere, and surfaces with relief: vertices, culling, level of detail |
//! | [`air`] | density, scattering tables, the billboard |
//! | [`light`] | exposure, tone curves, metering |
//! | [`half`] | half floats |
//!
//! Hosts of the renderer meet what they need of it in the crate `terrella`.

// docs.rs says of each item which feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![allow(
    missing_docs,
    reason = "what hosts meet of it is documented, the rest says itself"
)]

// Test files that other crates use too name this one as they do.
#[cfg(test)]
extern crate self as terrella_ground;

pub mod air;
#[cfg(feature = "terrain")]
pub mod elevation;
pub mod globe;
pub mod half;
pub mod height;
pub mod light;
