//! Files from outside, read into memory within limits.

use super::OrbitError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

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
    let file = File::open(path).map_err(read_error)?;
    if file.metadata().map_err(read_error)?.len() > limit {
        return Err(too_large());
    }
    // A device or a pipe says it is empty and may never end: the limit holds for what is read, too.
    let mut bytes = Vec::new();
    file.take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(read_error)?;
    if bytes.len() as u64 > limit {
        return Err(too_large());
    }
    String::from_utf8(bytes).map_err(|e| OrbitError::NotText {
        path: path.to_owned(),
        line: 1 + e
            .as_bytes()
            .iter()
            .take(e.utf8_error().valid_up_to())
            .filter(|&&b| b == b'\n')
            .count(),
    })
}
