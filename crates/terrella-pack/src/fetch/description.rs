//! Descriptions of sources: TOML files, each with its own keys.

use super::error::FetchError;
use crate::mosaic::syntax_complaint;
use serde::de::DeserializeOwned;
use std::path::Path;
use terrella_files as files;

/// Largest description, bytes.
pub const MAX_SOURCE_BYTES: u64 = 1 << 20;

fn wrong(path: &Path, cause: String) -> FetchError {
    FetchError::Description {
        path: path.to_path_buf(),
        cause,
    }
}

/// The text of a description.
pub(super) fn read(path: &Path) -> Result<String, FetchError> {
    let text = files::read_text(path, MAX_SOURCE_BYTES);
    let text = text.map_err(|error| wrong(path, error.to_string()))?;
    text.ok_or_else(|| wrong(path, format!("has more than {MAX_SOURCE_BYTES} bytes")))
}

/// A source from the text of its description; `path` is named in errors, and `complaint` finds the key that is wrong, and why.
pub(super) fn parse<T: DeserializeOwned>(
    text: &str,
    path: &Path,
    complaint: impl FnOnce(&T) -> Option<(&'static str, String)>,
) -> Result<T, FetchError> {
    let source =
        toml::from_str(text).map_err(|error| wrong(path, syntax_complaint(text, &error)))?;
    match complaint(&source) {
        None => Ok(source),
        Some((key, cause)) => Err(wrong(path, format!("{key}: {}", files::cause(cause)))),
    }
}
