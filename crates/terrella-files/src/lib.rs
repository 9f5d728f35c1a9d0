//! What every crate of Terrella does alike with files and with text from outside: opening files, writing files that outlast a power
//! failure, removing those that were not finished, quoting text in messages, loading in the background; and what differs between
//! platforms: the clock and threads.

// docs.rs says of each item which feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod clock;
pub mod durable;
#[cfg(feature = "loaders")]
pub mod loaders;
mod message;
mod open;
pub mod parallel;
mod unfinished;

pub use message::{MAX_QUOTED_CHARS, cause, excerpt, is_unprintable, printable};
pub use open::{MAX_PATH_BYTES, first_bytes, open, open_with, path_complaint, read, read_text};
pub use unfinished::{Unfinished, remove_unfinished};
