//! A folder of numbered frames: their names, and one run at a time that writes them.

use super::error::FilmError;
use crate::error::PlayError;
use crate::output::{OutputError, PendingFile, make_folder};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use terrella_files::{self as files, Unfinished};

/// Handling of a folder that is not empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// It is rejected.
    #[default]
    Reject,
    /// Frames of the same number are replaced; nothing else is touched.
    Overwrite,
    /// Frames of the same film are kept.
    Resume,
}

/// The file by which a run has a folder for itself.
const LOCK: &str = ".terrella-frames.lock";
/// How frames begin that are not whole yet.
const UNFINISHED: &str = ".terrella-frame-";

/// A folder of numbered frames that this run alone writes to.
#[derive(Debug)]
pub struct FrameFolder {
    folder: PathBuf,
    digits: usize,
    ending: &'static str,
    _lock: FolderLock,
}

/// Held as long as it lives; then its file is taken away.
#[derive(Debug)]
struct FolderLock {
    file: Unfinished,
    _lock: File,
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // One that stays is of no harm: who holds it is what counts.
        let _ = std::fs::remove_file(self.file.path());
    }
}

impl FrameFolder {
    /// Makes the folder, or takes the one that is there, if `existing` allows it, and tries to write there. Frames are files with
    /// this ending.
    ///
    /// # Errors
    /// A folder that cannot be written to, holds something, or is being written to by another run.
    pub fn open(
        folder: &Path,
        frame_count: u64,
        ending: &'static str,
        existing: Existing,
    ) -> Result<Self, PlayError> {
        let rejected = |source| OutputError::write(folder, source);
        make_folder(folder)?;
        let mut is_empty = true;
        for entry in std::fs::read_dir(folder).map_err(rejected)? {
            is_empty &= entry.map_err(rejected)?.file_name() == LOCK;
        }
        if !is_empty && existing == Existing::Reject {
            return Err(FilmError::NotEmpty {
                path: folder.into(),
            }
            .into());
        }
        let lock = lock(folder)?;
        let last = frame_count.saturating_sub(1);
        let frames = Self {
            folder: folder.into(),
            digits: last.to_string().len().max(5),
            ending,
            _lock: lock,
        };
        // Left over from a run that was killed: no other process writes here now.
        frames.remove_unfinished()?;
        if existing == Existing::Overwrite && frames.path(frame_count).exists() {
            tracing::warn!(
                "{} contains frames of a longer film; frames from {} on are kept",
                folder.display(),
                frames.path(frame_count).display()
            );
        }
        // Shows whether files can be made there.
        frames.pending(0)?;
        Ok(frames)
    }

    /// Removes incomplete frames. Only while no process writes any.
    ///
    /// # Errors
    /// A folder that cannot be read, or files that cannot be removed.
    pub fn remove_unfinished(&self) -> Result<(), OutputError> {
        let rejected = |source| OutputError::write(&self.folder, source);
        for entry in std::fs::read_dir(&self.folder).map_err(rejected)? {
            let entry = entry.map_err(rejected)?;
            if entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
                std::fs::remove_file(entry.path()).map_err(rejected)?;
            }
        }
        Ok(())
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The name of a frame's file: `frame_00000.png` and on, with as many digits as the last one needs.
    pub fn name(&self, index: u64) -> String {
        format!(
            "frame_{index:0digits$}.{}",
            self.ending,
            digits = self.digits
        )
    }

    pub fn path(&self, index: u64) -> PathBuf {
        self.folder.join(self.name(index))
    }

    /// Begins the file of a frame.
    ///
    /// # Errors
    /// A file that cannot be made.
    pub fn pending(&self, index: u64) -> Result<PendingFile, OutputError> {
        PendingFile::create_as(&self.path(index), "frames", self.ending, UNFINISHED)
    }
}

fn lock(folder: &Path) -> Result<FolderLock, PlayError> {
    let path = folder.join(LOCK);
    let rejected = |source| OutputError::write(folder, source);
    let mut options = File::options();
    options.create(true).truncate(false).write(true);
    let made = Unfinished::create(&path, |path| files::open_with(&options, path));
    let (file, unfinished) = made.map_err(rejected)?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(FilmError::Busy {
                path: folder.into(),
            }
            .into());
        }
        // Some file systems have no locks.
        Err(TryLockError::Error(error)) => tracing::warn!(
            "{}: cannot be kept to this run ({error}); let no other run write there",
            folder.display()
        ),
    }
    Ok(FolderLock {
        file: unfinished,
        _lock: file,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            let name = entry.expect("an entry").file_name();
            name.into_string().expect("UTF-8")
        };
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }

    #[test]
    fn frames_go_into_an_empty_folder() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path().join("new/frames");
        let open = |path: &Path, count, existing| FrameFolder::open(path, count, "png", existing);
        let frames = open(&folder, 3, Existing::Reject).expect("made");
        assert!(frames.path(0).ends_with("frame_00000.png"));
        let busy = open(&folder, 3, Existing::Resume).expect_err("another run");
        assert!(
            matches!(busy, PlayError::Film(FilmError::Busy { .. })),
            "{busy}"
        );
        frames
            .pending(2)
            .expect("begins")
            .write_whole(b"x")
            .expect("writes");
        drop(frames);
        assert_eq!(names(&folder), ["frame_00002.png"]);
        let rejected = open(&folder, 3, Existing::Reject).expect_err("not empty");
        assert!(matches!(
            rejected,
            PlayError::Film(FilmError::NotEmpty { .. })
        ));
        std::fs::write(folder.join(".terrella-frame-x.part"), b"half").expect("writes");
        drop(open(&folder, 3, Existing::Overwrite).expect("overwrites"));
        assert_eq!(names(&folder), ["frame_00002.png"]);
        let many = open(&root.path().join("many"), 1_000_000, Existing::Reject).expect("made");
        assert!(many.path(7).ends_with("frame_000007.png"));
        let in_the_way = open(&folder.join("frame_00002.png"), 3, Existing::Reject);
        assert!(matches!(
            in_the_way,
            Err(PlayError::Output(OutputError::InTheWay { .. }))
        ));
    }
}
