//! Streaming keeps its promises: no hole, nothing overwritten that is drawn, nothing lost, nothing awaited that never comes.
//!
//! `paths.rs` drives the state machine along random eye paths, `rules.rs` into single corners; `host.rs` simulates the loader and compares every slot with the
//! tile that it should hold; `threads.rs` does the same in short with real threads.

mod host;
mod hosted;
mod paths;
mod rules;
mod source;
mod threads;
