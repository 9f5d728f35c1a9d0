//! The folder that a pack is built in: what may be there, and files that are whole or not there.

use super::error::BuildError;
use super::journal::{JOURNAL_FILE, Journal, Noted, is_share_journal, share_journal_file};
use super::tile_name::TileName;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use terrella_files::durable;
use terrella_files::{self as files, Unfinished};
use terrella_imagery::pack::{
    HEIGHTS_FOLDER, HeightPlace, HeightRecord, HeightsEntry, MANIFEST_FILE, Manifest, TileFile,
};

/// Folder of the tiles.
const TILES: &str = "tiles";

/// Folder for temporary data of a running build.
const SCRATCH: &str = "scratch";

/// Ending of a file that is being written.
const PART: &str = "part";

/// Writes whole files. Tests put their own in its place.
pub(super) trait Writer: Sync {
    /// Writes a file so that it is there with all its contents or not at all.
    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()>;

    /// Bytes that are free in a folder, where that can be known.
    fn free_bytes(&self, folder: &Path) -> Option<u64>;
}

/// Writes to disk: first to a temporary file, which is then renamed. Written files survive a power failure.
pub(super) struct Disk;

impl Writer for Disk {
    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            durable::make_folders(folder)?;
        }
        let mut name = std::ffi::OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(".");
        name.push(PART);
        let part = path.with_file_name(name);
        let (mut file, _unfinished) = Unfinished::create(&part, |path| File::create(path))?;
        let written = file
            .write_all(contents)
            .and_then(|()| durable::replace(&part, path));
        if written.is_err() {
            // The error that counts is the one above.
            let _ = fs::remove_file(&part);
        }
        written
    }

    #[cfg(unix)]
    fn free_bytes(&self, folder: &Path) -> Option<u64> {
        let known = rustix::fs::statvfs(folder).ok()?;
        Some(known.f_bavail.saturating_mul(known.f_frsize))
    }

    #[cfg(not(unix))]
    fn free_bytes(&self, _folder: &Path) -> Option<u64> {
        None
    }
}

/// The folder of scratch files, removed with this.
pub(super) struct ScratchFolder(Unfinished);

impl ScratchFolder {
    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        // The next build in this folder removes what stays.
        let _ = fs::remove_dir_all(self.0.path());
    }
}

/// The folder of one build, locked against others.
pub(super) struct BuildFolder<'a> {
    dir: PathBuf,
    writer: &'a dyn Writer,
    state: Mutex<FolderState>,
}

struct FolderState {
    journal: Journal,
    done: BTreeMap<TileName, TileFile>,
    /// Elevation tiles; as recorded, until they are taken over.
    heights: BTreeMap<HeightPlace, HeightRecord>,
}

impl<'a> BuildFolder<'a> {
    /// Opens or makes the folder. Tiles of an earlier run of the same build, by its fingerprint, are taken over if they
    /// are whole.
    pub(super) fn open(
        dir: &Path,
        fingerprint: &str,
        restart: bool,
        writer: &'a dyn Writer,
    ) -> Result<Self, BuildError> {
        let write_error = |source| BuildError::Write {
            path: dir.to_path_buf(),
            source,
        };
        durable::make_folders(dir).map_err(write_error)?;
        let present = Present::look(dir)?;
        if present.is_finished() && !restart {
            return Err(BuildError::Finished {
                path: dir.to_path_buf(),
            });
        }
        let mut journal = Journal::open(dir, JOURNAL_FILE)?;
        if present.scratch {
            // Left over from a build that was killed: it is created again.
            let path = dir.join(SCRATCH);
            fs::remove_dir_all(&path).map_err(|source| BuildError::Write { path, source })?;
        }
        // Processes that make a share may finish.
        for name in &present.shares {
            drop(Journal::open(dir, name)?);
        }
        if restart {
            for name in &present.shares {
                let path = dir.join(name);
                fs::remove_file(&path).map_err(|source| BuildError::Write { path, source })?;
            }
            // Without its manifest it is no pack any more; then the rest may go.
            for (name, is_there) in [
                (MANIFEST_FILE, present.manifest),
                (TILES, present.tiles),
                (HEIGHTS_FOLDER, present.heights),
            ] {
                let path = dir.join(name);
                let removed = match (is_there, name) {
                    (false, _) => Ok(()),
                    (true, TILES | HEIGHTS_FOLDER) => fs::remove_dir_all(&path),
                    (true, _) => fs::remove_file(&path),
                };
                removed.map_err(|source| BuildError::Write { path, source })?;
            }
            journal.begin(fingerprint)?;
        } else if !journal.has_fingerprint(fingerprint) {
            if !journal.is_empty(fingerprint) {
                return Err(BuildError::OtherBuild {
                    path: dir.to_path_buf(),
                });
            }
            journal.begin(fingerprint)?;
        }
        let mut noted = journal.tiles();
        if !restart {
            noted.extend(present.noted_by_shares(dir, fingerprint));
        }
        Ok(Self::with(dir, writer, journal, noted))
    }

    /// Opens the folder for a share of a build, in a process that makes only that share: it records its tiles in its own journal. Tiles recorded by
    /// others count as done.
    pub(super) fn open_share(
        dir: &Path,
        fingerprint: &str,
        share: &str,
        writer: &'a dyn Writer,
    ) -> Result<Self, BuildError> {
        let present = Present::look(dir)?;
        if present.is_finished() {
            return Err(BuildError::Finished {
                path: dir.to_path_buf(),
            });
        }
        let others = Journal::tiles_of(&dir.join(JOURNAL_FILE), fingerprint);
        let mut journal = Journal::open(dir, &share_journal_file(share))?;
        if !journal.has_fingerprint(fingerprint) {
            if !journal.is_empty(fingerprint) {
                return Err(BuildError::OtherBuild {
                    path: dir.to_path_buf(),
                });
            }
            journal.begin(fingerprint)?;
        }
        let mut noted = journal.tiles();
        noted.extend(others);
        noted.extend(present.noted_by_shares(dir, fingerprint));
        Ok(Self::with(dir, writer, journal, noted))
    }

    fn with(dir: &Path, writer: &'a dyn Writer, journal: Journal, noted: Vec<Noted>) -> Self {
        let (mut done, mut heights) = (BTreeMap::new(), BTreeMap::new());
        for noted in noted {
            match noted {
                Noted::Tile(name, file) => {
                    let path = name.path();
                    if path.is_some_and(|path| holds(&dir.join(path), file)) {
                        done.insert(name, file);
                    }
                }
                Noted::Heights(record) => drop(heights.insert(record.place, record)),
            }
        }
        Self {
            dir: dir.to_path_buf(),
            writer,
            state: Mutex::new(FolderState {
                journal,
                done,
                heights,
            }),
        }
    }

    /// Keeps those of the recorded elevation tiles that are complete.
    pub(super) fn take_over_heights(&self, entry: &HeightsEntry) {
        let is_whole = |record: &HeightRecord| {
            entry.contains(record.place)
                && holds(&self.dir.join(entry.path(record.place)), record.file)
        };
        self.state().heights.retain(|_, record| is_whole(record));
    }

    /// An elevation tile, if it exists.
    pub(super) fn height(&self, place: HeightPlace) -> Option<HeightRecord> {
        self.state().heights.get(&place).copied()
    }

    /// The bytes of an existing elevation tile.
    pub(super) fn read_height(
        &self,
        entry: &HeightsEntry,
        record: &HeightRecord,
    ) -> Result<Vec<u8>, BuildError> {
        let path = self.dir.join(entry.path(record.place));
        let mut bytes = Vec::new();
        files::open(&path)
            .and_then(|file| file.take(record.file.bytes + 1).read_to_end(&mut bytes))
            .map_err(|source| BuildError::Unreadable {
                path: path.clone(),
                source,
            })?;
        if TileFile::of(&bytes) != record.file {
            let cause = "it has changed since it was written".to_string();
            return Err(BuildError::Damaged { path, cause });
        }
        Ok(bytes)
    }

    /// Writes an elevation tile and records it.
    pub(super) fn put_height(
        &self,
        entry: &HeightsEntry,
        record: HeightRecord,
        contents: &[u8],
    ) -> Result<(), BuildError> {
        self.write(&entry.path(record.place), contents)?;
        let mut state = self.state();
        state.journal.note_heights(&record)?;
        state.heights.insert(record.place, record);
        Ok(())
    }

    /// Writes the index of elevation tiles.
    pub(super) fn put_height_index(&self, contents: &[u8]) -> Result<(), BuildError> {
        self.write(&HeightsEntry::index_path(), contents)
    }

    /// Makes the folder of scratch files.
    pub(super) fn scratch(&self) -> Result<ScratchFolder, BuildError> {
        let path = self.dir.join(SCRATCH);
        match Unfinished::create(&path, |path| fs::create_dir(path)) {
            Ok(((), folder)) => Ok(ScratchFolder(folder)),
            Err(source) => Err(BuildError::Write { path, source }),
        }
    }

    /// Bytes that are free in a folder, where that can be known.
    pub(super) fn free_bytes(&self, folder: &Path) -> Option<u64> {
        self.writer.free_bytes(folder)
    }

    /// Writes a file below the folder.
    fn write(&self, path: &Path, contents: &[u8]) -> Result<(), BuildError> {
        let path = self.dir.join(path);
        let written = self.writer.write(&path, contents);
        written.map_err(|source| BuildError::Write { path, source })
    }

    fn state(&self) -> MutexGuard<'_, FolderState> {
        // Entries are put in whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a tile exists.
    pub(super) fn has(&self, name: TileName) -> bool {
        self.state().done.contains_key(&name)
    }

    /// The tile's file, once it is there.
    pub(super) fn tile(&self, name: TileName) -> Option<TileFile> {
        self.state().done.get(&name).copied()
    }

    /// Writes a tile and notes it.
    pub(super) fn put(&self, name: TileName, contents: &[u8]) -> Result<(), BuildError> {
        let file = TileFile::of(contents);
        self.write(&name.path().unwrap_or_default(), contents)?;
        let mut state = self.state();
        state.journal.note(name, file)?;
        state.done.insert(name, file);
        Ok(())
    }

    /// Records written before this call survive a system crash.
    pub(super) fn sync(&self) -> Result<(), BuildError> {
        self.state().journal.sync()
    }

    /// Writes the manifest, and the build is over.
    pub(super) fn finish(self, manifest: &Manifest) -> Result<(), BuildError> {
        let path = self.dir.join(MANIFEST_FILE);
        self.writer
            .write(&path, manifest.to_toml().as_bytes())
            .map_err(|source| BuildError::Write { path, source })?;
        let state = self
            .state
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        for name in Present::look(&self.dir)?.shares {
            let path = self.dir.join(name);
            fs::remove_file(&path).map_err(|source| BuildError::Write { path, source })?;
        }
        state.journal.remove()
    }
}

/// Existing content of the folder.
struct Present {
    manifest: bool,
    journal: bool,
    /// Names of journals of shares.
    shares: Vec<String>,
    tiles: bool,
    heights: bool,
    scratch: bool,
}

impl Present {
    fn look(dir: &Path) -> Result<Self, BuildError> {
        let unreadable = |source| BuildError::Unreadable {
            path: dir.to_path_buf(),
            source,
        };
        let mut present = Self {
            manifest: false,
            journal: false,
            shares: Vec::new(),
            tiles: false,
            heights: false,
            scratch: false,
        };
        let other = |name: &str| BuildError::NotEmpty {
            path: dir.to_path_buf(),
            found: name.to_string(),
        };
        for entry in fs::read_dir(dir).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let kind = entry.file_type().map_err(unreadable)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            match name.as_str() {
                MANIFEST_FILE if kind.is_file() => present.manifest = true,
                JOURNAL_FILE if kind.is_file() => present.journal = true,
                name if is_share_journal(name) && kind.is_file() => {
                    present.shares.push(name.to_string());
                }
                TILES if kind.is_dir() => present.tiles = true,
                HEIGHTS_FOLDER if kind.is_dir() => present.heights = true,
                SCRATCH if kind.is_dir() => present.scratch = true,
                // Left by a fall between writing and renaming.
                name if name == format!(".{MANIFEST_FILE}.{PART}") => {}
                _ => return Err(other(&name)),
            }
        }
        let is_of_build = present.manifest || present.journal || !present.shares.is_empty();
        for (name, is_there) in [
            (TILES, present.tiles),
            (HEIGHTS_FOLDER, present.heights),
            (SCRATCH, present.scratch),
        ] {
            if is_there && !is_of_build {
                return Err(other(name));
            }
        }
        Ok(present)
    }

    /// Whether there is a complete pack and no build in progress.
    fn is_finished(&self) -> bool {
        self.manifest && !self.journal && self.shares.is_empty()
    }

    /// Tiles recorded by processes that make shares of this build.
    fn noted_by_shares(&self, dir: &Path, fingerprint: &str) -> Vec<Noted> {
        let shares = self.shares.iter();
        shares
            .flat_map(|name| Journal::tiles_of(&dir.join(name), fingerprint))
            .collect()
    }
}

/// Whether the file has this length and checksum.
fn holds(path: &Path, file: TileFile) -> bool {
    let read = || -> io::Result<bool> {
        let opened = files::open(path)?;
        if opened.metadata()?.len() != file.bytes {
            return Ok(false);
        }
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(opened.take(file.bytes))?;
        Ok(hasher.finalize().as_bytes()[..16] == file.checksum)
    };
    read().unwrap_or(false)
}
