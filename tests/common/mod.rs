//! Common code of the picture tests.
#![allow(dead_code, unused_imports)] // Each test crate uses its own part.

mod canvas;
pub mod tiles;

pub use canvas::*;
