//! Files from outside, read into memory within limits.

use super::OrbitError;
use super::encoding::decode;
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;
use terrella_files as files;

/// First bytes of a file that is compressed by gzip.
const GZIP: &[u8] = b"\x1f\x8b";

/// The text of a file of at most `limit` bytes, which may be compressed by gzip; the limit then applies to the decompressed size.
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
    if let Some(packing) = files::packing(&bytes) {
        return Err(OrbitError::Packed {
            path: path.to_owned(),
            packing,
        });
    }
    if !bytes.starts_with(GZIP) {
        return decode(bytes, path);
    }
    let whole = decompressed(&bytes, limit).map_err(|source| OrbitError::Compressed {
        path: path.to_owned(),
        source,
    })?;
    decode(whole.ok_or_else(too_large)?, path)
}

/// Decompresses gzip; `None` if the result exceeds `limit` bytes. At most that much memory is used.
fn decompressed(bytes: &[u8], limit: u64) -> std::io::Result<Option<Vec<u8>>> {
    let mut whole = Vec::new();
    let mut decoder = MultiGzDecoder::new(bytes).take(limit + 1);
    decoder.read_to_end(&mut whole)?;
    Ok((whole.len() as u64 <= limit).then_some(whole))
}

/// The first part of a file's text, as far as `head` reaches: decompressed, and without invalid characters.
pub(super) fn first_text(head: &[u8]) -> String {
    const MOST: u64 = 1 << 16;
    let mut first = Vec::new();
    let is_compressed = head.starts_with(GZIP);
    if is_compressed {
        let mut decoder = MultiGzDecoder::new(head).take(MOST);
        // The head ends within the compressed data: what came before that counts.
        let _ = decoder.read_to_end(&mut first);
    }
    let first = if is_compressed { &first } else { head };
    // Half of a character at the end is dropped.
    let even = first.get(..first.len() & !1).unwrap_or_default();
    let lossy = String::from_utf8_lossy(first);
    decode(even.to_vec(), Path::new("")).unwrap_or_else(|_| lossy.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    fn compressed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn compressed_files_are_read_within_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gz");
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read_text(&path, 1 << 20)
        };
        let text = "CCSDS_OEM_VERS = 2.0\n".repeat(40_000);
        assert_eq!(read(&compressed(text.as_bytes())).unwrap(), text);
        // Two concatenated gzip files are one, by its specification.
        let two = [compressed(b"one\n"), compressed(b"two\n")].concat();
        assert_eq!(read(&two).unwrap(), "one\ntwo\n");
        // Sixty-four megabytes of nothing.
        let bomb = compressed(&vec![b' '; 64 << 20]);
        assert!(bomb.len() < 1 << 20);
        assert!(matches!(read(&bomb), Err(OrbitError::TooLarge { .. })));
        let whole = compressed(text.as_bytes());
        let cut = read(&whole[..whole.len() / 2]).unwrap_err().to_string();
        assert!(cut.contains("cannot be decompressed"), "{cut}");
    }

    #[test]
    fn the_first_text_of_a_file_is_found() {
        let text = "CCSDS_OEM_VERS = 2.0\n".repeat(10_000);
        let whole = compressed(text.as_bytes());
        assert!(first_text(&whole[..whole.len() / 2]).starts_with("CCSDS_OEM_VERS"));
        let utf16: Vec<u8> = "\u{feff}COMMENT é"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        assert!(first_text(&utf16[..19]).contains("COMMENT "));
        assert!(first_text(b"plain\xc3").starts_with("plain"));
        assert_eq!(first_text(b""), "");
    }
}
