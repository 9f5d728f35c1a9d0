//! Packed files, by their first bytes.

/// The program that unpacks a file that begins with these bytes; `None` if it is not packed. gzip is not among them: it is read where files are large.
pub fn packing(head: &[u8]) -> Option<&'static str> {
    const KNOWN: [(&[u8], &str); 5] = [
        (b"PK\x03\x04", "zip"),
        (b"\xfd7zXZ", "xz"),
        (b"BZh", "bzip2"),
        (b"\x28\xb5\x2f\xfd", "zstd"),
        (b"7z\xbc\xaf", "7-Zip"),
    ];
    let mut known = KNOWN.iter();
    let (_, name) = known.find(|(mark, _)| head.starts_with(mark))?;
    Some(name)
}

#[cfg(test)]
mod tests {
    use super::packing;

    #[test]
    fn packed_files_are_known_by_their_first_bytes() {
        assert_eq!(packing(b"PK\x03\x04\x14\x00"), Some("zip"));
        assert_eq!(packing(b"BZh91AY"), Some("bzip2"));
        assert_eq!(packing(b"CCSDS_OEM_VERS = 2.0"), None);
        assert_eq!(packing(b""), None);
    }
}
