//! Errors of saved simulations.

use std::io;
use std::path::PathBuf;

/// Why a file cannot be played.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum RecordingError {
    /// The system.
    #[error("{}: {source}", path.display())]
    Read {
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Not one message.
    #[error("{}: contains no Basilisk message ({cause}); expected a file that saveFile wrote", path.display())]
    Empty {
        path: PathBuf,
        /// The error at its beginning.
        cause: String,
    },
    /// A message that was there when the file was opened.
    #[error("{}: the message at byte {offset} cannot be played: {cause}", path.display())]
    Message {
        path: PathBuf,
        /// Offset of the message.
        offset: u64,
        cause: String,
    },
}
