//! Notices when shaders that are read from a folder change.

use std::time::{Duration, Instant, SystemTime};
use terrella::internals::gpu::ShaderFiles;

/// Wait between two looks.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// Looks at the files of shaders from time to time.
pub struct ShaderWatch {
    files: ShaderFiles,
    written: Vec<Option<SystemTime>>,
    looks_at: Option<Instant>,
}

impl ShaderWatch {
    /// Watches these files; none if they are compiled in.
    pub fn new(files: ShaderFiles) -> Self {
        Self {
            written: files.written(),
            looks_at: None,
            files,
        }
    }

    /// Whether files have changed since the last call. It checks a few times a second, however often it is called.
    pub fn has_changed(&mut self, now: Instant) -> bool {
        if self.files == ShaderFiles::Embedded || self.looks_at.is_some_and(|time| now < time) {
            return false;
        }
        self.looks_at = Some(now + LOOK_EVERY);
        let before = std::mem::replace(&mut self.written, self.files.written());
        before != self.written
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_noticed_once_and_not_before_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut watch = ShaderWatch::new(ShaderFiles::Folder(folder.path().to_owned()));
        let begin = Instant::now();
        assert!(!watch.has_changed(begin));
        std::fs::write(folder.path().join("earth.wgsl"), "").expect("writes");
        assert!(!watch.has_changed(begin + LOOK_EVERY / 2));
        assert!(watch.has_changed(begin + LOOK_EVERY));
        assert!(!watch.has_changed(begin + 2 * LOOK_EVERY));
        assert!(!ShaderWatch::new(ShaderFiles::Embedded).has_changed(begin));
    }
}
