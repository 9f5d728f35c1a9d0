//! Written files, and their description.

use std::path::{Path, PathBuf};
use std::time::Duration;

/// A file, or the files of a folder, written.
pub struct Written {
    pub path: PathBuf,
    /// Total size, bytes.
    pub bytes: u64,
    /// Pictures that were written, where it is a folder.
    pub pictures: Option<u64>,
}

impl Written {
    /// A file under its final name.
    pub fn file(path: PathBuf) -> Self {
        let bytes = std::fs::metadata(&path).map_or(0, |found| found.len());
        Self {
            path,
            bytes,
            pictures: None,
        }
    }

    pub(super) fn line(&self, frames: u64, elapsed: Duration) -> String {
        let what = match self.pictures {
            None => counted(frames, "frame"),
            Some(pictures) => counted(pictures, "image"),
        };
        format!(
            "{}: {}, {what}, {:.1} s",
            self.path.display(),
            size_text(self.bytes),
            elapsed.as_secs_f64()
        )
    }
}

/// The line that reports a picture under its final name: path, pixels, bytes, and the time it took.
pub fn written_picture(path: &Path, (width, height): (u32, u32), elapsed: Duration) -> String {
    let file = Written::file(path.to_owned());
    format!(
        "{}: {width} × {height} pixels, {}, {:.1} s",
        path.display(),
        size_text(file.bytes),
        elapsed.as_secs_f64()
    )
}

/// A number of things: "1 frame", "2 frames".
pub(super) fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Bytes, and the same in the largest unit that leaves a whole one.
pub(super) fn size_text(bytes: u64) -> String {
    let units = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    let unit = units.iter().find(|(unit, _)| bytes as f64 >= *unit);
    match unit {
        Some((unit, name)) => format!("{:.1} {name} ({bytes} bytes)", bytes as f64 / unit),
        None => counted(bytes, "byte"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_reported_with_its_size() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        std::fs::write(&path, [0; 1500]).expect("writes");
        let line = written_picture(&path, (64, 36), Duration::from_millis(1260));
        let end = "a.png: 64 × 36 pixels, 1.5 kB (1500 bytes), 1.3 s";
        assert!(line.ends_with(end), "{line}");
    }

    #[test]
    fn sizes_are_reported_in_bytes_and_for_people() {
        assert_eq!(size_text(1), "1 byte");
        assert_eq!(size_text(999), "999 bytes");
        assert_eq!(size_text(1_000), "1.0 kB (1000 bytes)");
        assert_eq!(size_text(12_345_678), "12.3 MB (12345678 bytes)");
        assert_eq!(size_text(5_000_000_000), "5.0 GB (5000000000 bytes)");
    }
}
