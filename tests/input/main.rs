//! Untrusted text and bytes: scene files, and every reader with mutated input.

mod fuzz_long;
mod fuzz_short;
mod scene;

/// The repository's root.
const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
