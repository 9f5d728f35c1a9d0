//! Files from outside, read into memory within limits.

use super::OrbitError;
use super::encoding::decode;
use std::path::Path;
use terrella_files as files;

/// The text of a file of at most `limit` bytes.
pub(super) fn read_text(path: &Path, limit: u64) -> Result<String, OrbitError> {
    let read_error = |source| OrbitError::Read {
        path: path.to_owned(),
        source,
    };
    let too_large = || OrbitError::TooLarge {
        path: path.to_owned(),
        limit_mib: limit >> 20,
    };
    let bytes = files::read(path, limit).map_err(read_error)?;
    let bytes = bytes.ok_or_else(too_large)?;
    decode(bytes, path)
}
