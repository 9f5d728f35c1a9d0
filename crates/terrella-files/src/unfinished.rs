//! Files that are being written, known to the whole process: an interruption removes them before it ends the program.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files and folders that are not finished, and how often each is held.
static UNFINISHED: Mutex<Known> = Mutex::new(Known {
    paths: BTreeMap::new(),
    is_ending: false,
});

struct Known {
    paths: BTreeMap<PathBuf, usize>,
    /// The program ends: nothing more is begun.
    is_ending: bool,
}

fn known() -> MutexGuard<'static, Known> {
    // Nobody panics while it is changed.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file that [`remove_unfinished`] removes as long as this lives, or a folder that it removes if nothing else is in it. Dropping this
/// removes nothing.
#[derive(Debug)]
#[must_use = "what is not held is left behind by an interruption"]
pub struct Unfinished {
    path: PathBuf,
}

impl Unfinished {
    /// Makes a file or folder by `create`, which cannot come between an interruption and the end of the program.
    ///
    /// # Errors
    /// That of `create`, and an interruption.
    pub fn create<T>(
        path: &Path,
        create: impl FnOnce(&Path) -> io::Result<T>,
    ) -> io::Result<(T, Self)> {
        let mut known = known();
        if known.is_ending {
            return Err(io::Error::new(
                io::ErrorKind::Interrupted,
                "the program ends",
            ));
        }
        let made = create(path)?;
        let path = path.to_path_buf();
        *known.paths.entry(path.clone()).or_default() += 1;
        Ok((made, Self { path }))
    }
}

impl Unfinished {
    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let mut known = known();
        if let Some(holders) = known.paths.get_mut(&self.path) {
            *holders -= 1;
            if *holders == 0 {
                known.paths.remove(&self.path);
            }
        }
    }
}

/// Removes everything that is unfinished, for a program that ends now: from here on [`Unfinished::create`] is an error.
pub fn remove_unfinished() {
    let mut known = known();
    known.is_ending = true;
    let paths = std::mem::take(&mut known.paths).into_keys();
    let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
    // It may have got its final name a moment ago, and a folder may hold what is finished: both stay.
    for file in files {
        let _ = std::fs::remove_file(file);
    }
    // A path sorts before its children.
    for folder in folders.into_iter().rev() {
        let _ = std::fs::remove_dir(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{self, File};

    // The end itself is tested in `tests/command/interruptions.rs`: in this process it would stop other tests.
    #[test]
    fn what_is_dropped_is_no_longer_known() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.part");
        let is_known = || known().paths.contains_key(&path);
        let (_, first) = Unfinished::create(&path, |path| File::create(path)).expect("made");
        let (_, second) = Unfinished::create(&path, |path| File::create(path)).expect("made");
        drop(first);
        assert!(is_known());
        drop(second);
        assert!(!is_known());
        let missing = folder.path().join("none/b.part");
        assert!(Unfinished::create(&missing, |path| File::create(path)).is_err());
        assert!(!known().paths.contains_key(&missing));
        assert!(fs::exists(&path).expect("looks"));
    }
}
