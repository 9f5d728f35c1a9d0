//! What every module does alike with files and with text from outside: opening them, removing those that were not finished, and quoting
//! them in messages.

mod message;
mod open;
mod unfinished;

pub use message::{MAX_QUOTED_CHARS, cause, excerpt, is_unprintable, printable};
pub use open::{MAX_PATH_BYTES, open, open_with, path_complaint, read, read_text};
pub use unfinished::{Unfinished, remove_unfinished};
