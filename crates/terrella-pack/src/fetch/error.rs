//! Why maps could not be fetched, with the place, the cause and the remedy.

use std::path::PathBuf;

/// Why maps could not be fetched. Files fetched before stay in the cache.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum FetchError {
    /// A description of a source is wrong.
    #[error("{}: {cause}", path.display())]
    Description {
        /// The file, or the name of a source that comes with the program.
        path: PathBuf,
        /// The error, with its line if there is one.
        cause: String,
    },
    /// There is no such source.
    #[error("there is no source {name:?}{}; known are {known}; or give the path of a description", near.as_ref().map_or(String::new(), |near| format!(" (did you mean {near}?)")))]
    Unknown {
        /// The requested name.
        name: String,
        /// A known name that is nearly it.
        near: Option<String>,
        /// All known names.
        known: String,
    },
    /// An option that cannot be.
    #[error("{option}: {cause}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The error, and the allowed values.
        cause: String,
    },
    /// The cache could not be read or written.
    #[error("{}: {source}; make room or correct the permissions, then run the same command again to go on", path.display())]
    Cache {
        path: PathBuf,
        source: std::io::Error,
    },
    /// Another process fetches into the same folder.
    #[error("{}: another fetch is writing there; wait for it or give another --cache", path.display())]
    Busy { path: PathBuf },
    /// The folder holds tiles of another address.
    #[error(
        "{}: holds files fetched from {found}, not from {wanted}; give another --cache or remove this folder", path.display()
    )]
    OtherAddress {
        path: PathBuf,
        /// The address that its files are from.
        found: String,
        wanted: String,
    },
    /// The server rejects the request, or is not trustworthy: further requests are pointless.
    #[error("{url}: {cause}; {advice}. What was fetched is kept")]
    Rejected {
        /// The requested address.
        url: String,
        /// The reply.
        cause: String,
        /// The remedy.
        advice: &'static str,
    },
    /// Some files could not be fetched, after all attempts.
    #[error(
        "{failed} of {total} files could not be fetched, the first of them {url}: {cause}; run the same command again to go on, \
         or add --allow-missing to go on without them"
    )]
    Incomplete {
        failed: u64,
        total: u64,
        /// The first that failed.
        url: String,
        /// The reply.
        cause: String,
    },
    /// The clients of HTTP could not be made.
    #[error("{0}")]
    Client(String),
    /// Heights could not be written.
    #[error("{}: {cause}", path.display())]
    Heights {
        path: PathBuf,
        /// The error and the remedy.
        cause: String,
    },
    /// The fetched files cannot be used as a map.
    #[error(transparent)]
    Map(#[from] crate::BuildError),
    /// Stopped on request.
    #[error("stopped; run the same command again to go on")]
    Cancelled,
}
