//! What the tests of several trees share.

#[path = "../../../../terrella-ground/src/globe/contours/tests/ground.rs"]
pub mod ground;
