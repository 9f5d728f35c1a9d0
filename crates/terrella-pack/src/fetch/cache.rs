//! Cache of fetched files on disk: each is either complete or absent, and a journal has their checksums.
//!
//! ```text
//! terrella fetch 1
//! <address with places for column and row>
//! 13/36 48120 <BLAKE3>
//! 13/37 missing
//! ```
//!
//! A line without a line feed, or with invalid content, does not count: its file is fetched again.

use super::check::is_plain_colour;
use super::error::FetchError;
use super::plan::Wanted;
use crate::locked_journal::LockedJournal;
use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use terrella_files::durable;
use terrella_files::{self as files, Unfinished, printable};

/// Name of the journal in a folder.
const JOURNAL_FILE: &str = "fetched.journal";

const FIRST_LINE: &str = "terrella fetch 1";

/// Ending of a file that is being written.
const PART: &str = "part";

/// State of a cached file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    /// It is there, of this length and checksum.
    File { bytes: u64, blake3: String },
    /// The server has no such file.
    Missing,
}

/// At so many places a picture that is no plain colour is no chance.
const MANY: u64 = 4;

/// An image that occurs at many places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Repeated {
    pub count: u64,
    /// One of its files.
    pub path: PathBuf,
    pub blake3: String,
}

/// A folder of files of one address, locked against others.
pub(super) struct Shelf {
    dir: PathBuf,
    state: Mutex<CacheState>,
}

struct CacheState {
    journal: LockedJournal,
    kept: HashMap<String, Kept>,
}

/// A file that is being written, and its checksum so far.
pub(super) struct PartFile {
    file: File,
    _unfinished: Unfinished,
    path: PathBuf,
    hasher: blake3::Hasher,
    bytes: u64,
}

impl Shelf {
    /// Opens or makes the folder for files of an address. Files whose lengths or checksums differ do not count.
    pub(super) fn open(dir: &Path, address: &str) -> Result<Self, FetchError> {
        let path = dir.join(JOURNAL_FILE);
        let fail = |source| FetchError::Cache {
            path: path.clone(),
            source,
        };
        durable::make_folders(dir).map_err(|source| FetchError::Cache {
            path: dir.to_path_buf(),
            source,
        })?;
        let mut journal = LockedJournal::open(&path).map_err(|error| match error {
            TryLockError::WouldBlock => FetchError::Busy {
                path: dir.to_path_buf(),
            },
            TryLockError::Error(error) => fail(error),
        })?;
        let text = journal.text();
        let good = text.rfind('\n').map_or(0, |end| end + 1);
        let mut lines = text[..good].lines();
        let mut kept = HashMap::new();
        let beginning = format!("{FIRST_LINE}\n{address}\n");
        // One whose beginning is cut off notes nothing yet.
        if beginning.starts_with(text) || lines.next() != Some(FIRST_LINE) {
            journal.begin(&beginning).map_err(fail)?;
        } else {
            let found = lines.next().unwrap_or_default();
            if found != address {
                return Err(FetchError::OtherAddress {
                    path: dir.to_path_buf(),
                    found: printable(found),
                    wanted: address.to_string(),
                });
            }
            kept.extend(lines.filter_map(line_of));
            journal.cut(good);
        }
        Ok(Self {
            dir: dir.to_path_buf(),
            state: Mutex::new(CacheState { journal, kept }),
        })
    }

    fn state(&self) -> MutexGuard<'_, CacheState> {
        // Entries are put in whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Path of a file. Names are created by this program or checked by the description's reader.
    pub(super) fn path(&self, file: &str) -> PathBuf {
        self.dir.join(file)
    }

    /// State of a file, if the file on disk agrees: its length and checksum are verified.
    pub(super) fn kept(&self, key: &str, file: &str) -> Option<Kept> {
        let known = self.state().kept.get(key).cloned()?;
        match &known {
            Kept::Missing => Some(known),
            Kept::File { bytes, blake3 } => {
                let path = self.path(file);
                let is_same = fs::metadata(&path)
                    .is_ok_and(|found| found.is_file() && found.len() == *bytes)
                    && hash_of(&path).is_ok_and(|found| found == *blake3);
                is_same.then_some(known)
            }
        }
    }

    /// Begins a file beside its final place.
    pub(super) fn begin(&self, file: &str) -> Result<PartFile, FetchError> {
        PartFile::beside(&self.path(file))
    }

    /// Puts a whole file under its final name and notes it.
    pub(super) fn finish(&self, part: PartFile, key: &str, file: &str) -> Result<u64, FetchError> {
        let (bytes, blake3) = (part.bytes, part.hash());
        part.put(&self.path(file))?;
        self.note(key, Kept::File { bytes, blake3 })?;
        Ok(bytes)
    }

    /// Removes a file and records that there is none.
    pub(super) fn remove(&self, key: &str, file: &str) -> Result<(), FetchError> {
        let path = self.path(file);
        fs::remove_file(&path).map_err(|source| failed(&path, source))?;
        self.note(key, Kept::Missing)
    }

    /// The most frequent image of these files, if it is not a uniform colour and occurs at [`MANY`] places.
    pub(super) fn most_repeated(&self, files: &[Wanted]) -> Option<Repeated> {
        let mut places: HashMap<String, (u64, &str)> = HashMap::new();
        {
            let state = self.state();
            for wanted in files {
                if let Some(Kept::File { blake3, .. }) = state.kept.get(&wanted.key) {
                    places.entry(blake3.clone()).or_insert((0, &wanted.file)).0 += 1;
                }
            }
        }
        let mut many: Vec<_> = places
            .into_iter()
            .filter(|(_, (count, _))| *count >= MANY)
            .collect();
        many.sort_by(|a, b| b.1.0.cmp(&a.1.0).then_with(|| a.0.cmp(&b.0)));
        many.into_iter().find_map(|(blake3, (count, file))| {
            let path = self.path(file);
            (!is_plain_colour(&path)).then_some(Repeated {
                count,
                path,
                blake3,
            })
        })
    }

    /// Records a file, or that there is none.
    pub(super) fn note(&self, key: &str, kept: Kept) -> Result<(), FetchError> {
        let line = match &kept {
            Kept::File { bytes, blake3 } => format!("{key} {bytes} {blake3}\n"),
            Kept::Missing => format!("{key} missing\n"),
        };
        let mut state = self.state();
        state
            .journal
            .append(&line)
            .map_err(|source| FetchError::Cache {
                path: self.dir.join(JOURNAL_FILE),
                source,
            })?;
        state.kept.insert(key.to_string(), kept);
        Ok(())
    }
}

impl PartFile {
    /// Its path until it is finished.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Its checksum so far, 64 hexadecimal digits.
    pub(super) fn hash(&self) -> String {
        self.hasher.finalize().to_hex().to_string()
    }

    /// Begins one beside its final place, whose folder is made.
    fn beside(path: &Path) -> Result<Self, FetchError> {
        let fail = |source| failed(path, source);
        let folder = path.parent().unwrap_or(Path::new(""));
        durable::make_folders(folder).map_err(fail)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let part = folder.join(format!(".{name}.{PART}"));
        let (file, unfinished) =
            Unfinished::create(&part, |path| File::create(path)).map_err(fail)?;
        Ok(Self {
            file,
            _unfinished: unfinished,
            path: part,
            hasher: blake3::Hasher::new(),
            bytes: 0,
        })
    }

    /// Puts it to its final place, or takes it away where that fails.
    fn put(self, path: &Path) -> Result<(), FetchError> {
        let from = self.path;
        drop(self.file);
        durable::replace(&from, path).map_err(|source| {
            let _ = fs::remove_file(&from);
            failed(path, source)
        })
    }

    /// Takes it away.
    pub(super) fn discard(self) {
        let path = self.path.clone();
        drop(self.file);
        // It is overwritten the next time in any case.
        let _ = fs::remove_file(path);
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Key and state, from a line of the journal.
fn line_of(line: &str) -> Option<(String, Kept)> {
    let words: Vec<&str> = line.split(' ').collect();
    match words.as_slice() {
        [key, "missing"] => Some((key.to_string(), Kept::Missing)),
        [key, bytes, digits] if digits.len() == 64 => Some((
            key.to_string(),
            Kept::File {
                bytes: bytes.parse().ok()?,
                blake3: digits.to_string(),
            },
        )),
        _ => None,
    }
}

fn hash_of(path: &Path) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(files::open(path)?)?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// Writes a file so that it is there with all its contents or not at all.
pub(super) fn write_whole(path: &Path, contents: &[u8]) -> Result<(), FetchError> {
    let mut part = PartFile::beside(path)?;
    match part.file.write_all(contents) {
        Ok(()) => part.put(path),
        Err(source) => {
            part.discard();
            Err(failed(path, source))
        }
    }
}

fn failed(path: &Path, source: io::Error) -> FetchError {
    FetchError::Cache {
        path: path.to_path_buf(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADDRESS: &str = "https://a/{row}/{column}";

    fn put(shelf: &Shelf, key: &str, contents: &[u8]) {
        let file = format!("{key}.png");
        let before = fs::read(shelf.path(&file)).ok();
        let mut part = shelf.begin(&file).expect("begun");
        part.write_all(contents).expect("written");
        assert_eq!(
            fs::read(shelf.path(&file)).ok(),
            before,
            "half of it is there"
        );
        shelf.finish(part, key, &file).expect("finished");
    }

    #[test]
    fn whole_files_are_known_again_and_changed_ones_are_not() {
        let dir = tempfile::tempdir().expect("a folder");
        let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
        assert!(matches!(
            Shelf::open(dir.path(), ADDRESS),
            Err(FetchError::Busy { .. })
        ));
        put(&shelf, "1/2", b"tile");
        put(&shelf, "1/3", b"other");
        shelf.note("1/4", Kept::Missing).expect("noted");
        drop(shelf);
        let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
        assert!(shelf.kept("1/2", "1/2.png").is_some());
        assert_eq!(shelf.kept("1/4", "1/4.png"), Some(Kept::Missing));
        assert_eq!(shelf.kept("1/5", "1/5.png"), None);
        fs::write(shelf.path("1/2.png"), b"elit").expect("written");
        assert_eq!(shelf.kept("1/2", "1/2.png"), None);
        fs::remove_file(shelf.path("1/3.png")).expect("removed");
        assert_eq!(shelf.kept("1/3", "1/3.png"), None);
    }

    #[test]
    fn a_journal_cut_anywhere_keeps_the_lines_before_the_cut() {
        let dir = tempfile::tempdir().expect("a folder");
        let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
        put(&shelf, "1/2", b"tile");
        put(&shelf, "1/3", b"tile");
        drop(shelf);
        let journal = dir.path().join(JOURNAL_FILE);
        let text = fs::read(&journal).expect("bytes");
        let ends: Vec<_> = (0..text.len()).filter(|n| text[*n] == b'\n').collect();
        for length in 0..=text.len() {
            for tail in [&b""[..], b"\0\0\xff\xfe"] {
                // A cut in the first two lines leaves nothing to be damaged.
                if length <= ends[1] && !tail.is_empty() {
                    continue;
                }
                fs::write(&journal, [&text[..length], tail].concat()).expect("written");
                let shelf = Shelf::open(dir.path(), ADDRESS)
                    .unwrap_or_else(|error| panic!("{length}: {error}"));
                for (key, end) in [("1/2", ends[2]), ("1/3", ends[3])] {
                    let is_kept = shelf.kept(key, &format!("{key}.png")).is_some();
                    assert_eq!(is_kept, length > end, "{key}, cut at {length}");
                }
                // Files recorded from now on are known again.
                put(&shelf, "1/4", b"tile");
                drop(shelf);
                let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
                assert!(shelf.kept("1/4", "1/4.png").is_some(), "{length}");
            }
        }
    }

    #[test]
    fn a_cut_journal_costs_its_last_line_and_another_address_is_rejected() {
        let dir = tempfile::tempdir().expect("a folder");
        let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
        put(&shelf, "1/2", b"tile");
        put(&shelf, "1/3", b"tile");
        drop(shelf);
        let journal = dir.path().join(JOURNAL_FILE);
        let text = fs::read_to_string(&journal).expect("text");
        fs::write(&journal, &text[..text.len() - 9]).expect("written");
        let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
        assert!(shelf.kept("1/2", "1/2.png").is_some());
        assert_eq!(shelf.kept("1/3", "1/3.png"), None);
        put(&shelf, "1/3", b"tile");
        drop(shelf);
        let shelf = Shelf::open(dir.path(), ADDRESS).expect("opens");
        assert!(shelf.kept("1/3", "1/3.png").is_some());
        drop(shelf);
        let other = Shelf::open(dir.path(), "https://b/{row}/{column}");
        assert!(matches!(other, Err(FetchError::OtherAddress { .. })));
    }
}
