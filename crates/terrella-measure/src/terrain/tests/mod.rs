//! What the tests of several trees share.

pub mod ground;
