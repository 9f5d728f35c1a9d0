//! Common handling of files and of untrusted text in every crate of Terrella: opening files, writing files that survive a power failure, removing
//! unfinished ones, quoting text in messages, loading in the background; and platform differences: the clock and threads.

// docs.rs shows the required feature of each item.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod clock;
pub mod durable;
#[cfg(feature = "loaders")]
pub mod loaders;
mod message;
mod open;
mod packed;
pub mod parallel;
mod unfinished;

pub use message::{MAX_QUOTED_CHARS, cause, excerpt, is_unprintable, printable};
pub use open::{MAX_PATH_BYTES, first_bytes, open, open_with, path_complaint, read, read_text};
pub use packed::packing;
pub use unfinished::{Unfinished, remove_unfinished};
