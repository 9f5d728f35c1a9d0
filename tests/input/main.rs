//! What comes from outside as text or bytes: scene files, and every reader under mutated input.

mod fuzz_long;
mod fuzz_short;
mod scene;
