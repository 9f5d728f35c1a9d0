//! Common code of the tests of several trees.

#[path = "../../../../terrella-ground/src/globe/contours/tests/ground.rs"]
pub mod ground;
