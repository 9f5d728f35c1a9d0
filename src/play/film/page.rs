//! `frames.json`, the page of a folder of frames.
//!
//! The page is one JSON document. Frames are added to its end: what ends the document is written anew behind each of them, in one
//! write, so that it is whole at any moment. When a run begins, and when it ends, the page is written as a new file and renamed; its
//! frames are then in their order.

use super::error::FilmError;
use super::folder::FrameFolder;
use super::key::{FilmKey, checksum};
use super::record::FrameRecord;
use crate::files::{self, printable};
use crate::frames::{Epoch, TimeScale, ccsds_time};
use crate::play::error::PlayError;
use crate::play::output::{OutputError, PendingFile};
use crate::scene::Scene;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The page's name.
const NAME: &str = "frames.json";
/// What kind of file it is.
const FORMAT: &str = "terrella frames 1";
/// What ends the list of frames, and the document.
const END: &str = "\n  ]\n}\n";
/// Most bytes of an entry, and of all that is before the first.
const MAX_ENTRY_BYTES: u64 = 1 << 10;
const MAX_HEAD_BYTES: u64 = 16 << 20;

/// What stands before the frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PageHead {
    /// What kind of file it is.
    format: String,
    /// The scene's file.
    scene: String,
    /// The film.
    film: FilmKey,
    /// Instant of frame 0, UTC and TAI.
    start_utc: String,
    start_tai: String,
    /// Simulated seconds in a second of the film.
    speed: f64,
    /// Frames in a second of the film.
    frame_rate_hz: f64,
    /// Frames of the whole film.
    frame_count: u64,
    /// The adapter that drew last.
    adapter: String,
}

impl PageHead {
    /// Of a scene's film.
    pub fn new(scene: &Scene, start: Epoch, film: FilmKey, adapter: String) -> Self {
        Self {
            format: FORMAT.to_owned(),
            scene: scene.path.display().to_string(),
            film,
            start_utc: ccsds_time(start, TimeScale::Utc) + "Z",
            start_tai: ccsds_time(start, TimeScale::Tai),
            speed: scene.time.speed,
            frame_rate_hz: scene.time.frame_rate_hz,
            frame_count: scene.time.frame_count(),
            adapter,
        }
    }
}

/// What is kept of an earlier run.
#[derive(Debug, Default)]
pub struct KeptFrames {
    /// The entries of its frames.
    pub entries: BTreeMap<u64, String>,
    /// The adapter that drew last; `None` where no frame is kept.
    pub adapter: Option<String>,
}

/// The page of a film that is being written.
#[derive(Debug)]
pub struct FilmPage {
    path: PathBuf,
    head: String,
    file: File,
    /// Where [`END`] stands.
    end_at: u64,
    /// The entries, by their frames.
    entries: BTreeMap<u64, String>,
}

impl FilmPage {
    /// The frames of an earlier run of this film that are whole, as their entries; of those in `wanted` the bytes are read, of others the
    /// length.
    ///
    /// # Errors
    /// A folder that holds another film, or something else.
    pub fn read_kept(
        folder: &FrameFolder,
        film: &FilmKey,
        frame_count: u64,
        wanted: &Range<u64>,
    ) -> Result<KeptFrames, FilmError> {
        let path = folder.folder().join(NAME);
        let bad = |problem: String| FilmError::BadPage {
            path: path.clone(),
            problem,
        };
        let limit = MAX_HEAD_BYTES + frame_count.saturating_mul(MAX_ENTRY_BYTES);
        let mut text = String::new();
        match files::open(&path) {
            Ok(file) => file
                .take(limit + 1)
                .read_to_string(&mut text)
                .map_err(|error| bad(printable(&error.to_string())))?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                // Nothing but our lock is nothing.
                let mut entries = std::fs::read_dir(folder.folder())
                    .map_err(|error| bad(printable(&error.to_string())))?;
                return match entries.any(|entry| {
                    entry.is_ok_and(|entry| {
                        !entry.file_name().to_string_lossy().starts_with(".terrella")
                    })
                }) {
                    true => Err(FilmError::NoFilm {
                        path: folder.folder().into(),
                    }),
                    false => Ok(KeptFrames::default()),
                };
            }
            Err(error) => return Err(bad(printable(&error.to_string()))),
        };
        if text.len() as u64 > limit {
            return Err(bad(format!(
                "is longer than a film of {frame_count} frames asks for"
            )));
        }
        let page: BTreeMap<String, Box<RawValue>> = serde_json::from_str(&text)
            .map_err(|error| bad(format!("is no page of frames: {error}")))?;
        let of = |name: &str| {
            let value = page.get(name).map(|value| value.get());
            value.ok_or_else(|| bad(format!("is no page of frames: it has no {name}")))
        };
        if serde_json::from_str::<String>(of("format")?)
            .ok()
            .as_deref()
            != Some(FORMAT)
        {
            return Err(bad(format!(
                "its format is {} and not {FORMAT:?}",
                of("format")?
            )));
        }
        let other = |differences| FilmError::OtherFilm {
            path: folder.folder().into(),
            differences,
        };
        // The program first: another version may know other settings.
        let found: serde_json::Value = serde_json::from_str(of("film")?)
            .map_err(|error| bad(printable(&error.to_string())))?;
        if let Some(program) = found["program"]
            .as_str()
            .filter(|program| *program != film.program)
        {
            return Err(other(format!(
                "it was drawn by {program}, this is {}",
                film.program
            )));
        }
        let found: FilmKey =
            serde_json::from_value(found).map_err(|error| bad(printable(&error.to_string())))?;
        if let Some(differences) = film.differences(&found) {
            return Err(other(differences));
        }
        let entries: Vec<Box<RawValue>> = serde_json::from_str(of("frames")?)
            .map_err(|error| bad(printable(&error.to_string())))?;
        let kept = entries.par_iter().filter_map(|entry| {
            let record: FrameRecord = serde_json::from_str(entry.get()).ok()?;
            let is_ours = record.index < frame_count && record.file == folder.name(record.index);
            let is_whole = is_ours && {
                let path = folder.path(record.index);
                match wanted.contains(&record.index) {
                    true => {
                        let bytes = files::read(&path, record.bytes).ok().flatten();
                        bytes.is_some_and(|bytes| checksum(&bytes) == record.blake3)
                    }
                    false => {
                        std::fs::metadata(&path).is_ok_and(|found| found.len() == record.bytes)
                    }
                }
            };
            is_whole.then(|| (record.index, entry.get().to_owned()))
        });
        let entries: BTreeMap<_, _> = kept.collect();
        let adapter = serde_json::from_str(of("adapter")?).ok();
        Ok(KeptFrames {
            adapter: adapter.filter(|_| !entries.is_empty()),
            entries,
        })
    }

    /// Writes the page of a film with the frames that are kept.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn begin(
        folder: &FrameFolder,
        head: &PageHead,
        kept: BTreeMap<u64, String>,
    ) -> Result<Self, PlayError> {
        let path = folder.folder().join(NAME);
        let head = serde_json::to_string_pretty(head)
            .map_err(|error| OutputError::write(&path, error.into()))?;
        let (file, end_at) = write_anew(&path, &head, &kept)?;
        Ok(Self {
            path,
            head,
            file,
            end_at,
            entries: kept,
        })
    }

    /// Adds a frame that is written.
    ///
    /// # Errors
    /// A page that cannot be written; it is then as it was.
    pub fn add(&mut self, record: &FrameRecord) -> Result<(), PlayError> {
        let entry = serde_json::to_string(record);
        let entry = entry.map_err(|error| OutputError::write(&self.path, error.into()))?;
        self.add_entry(record.index, entry)
    }

    /// Adds the frame of this number, as its record was written: what is read and written again may differ in a number's last digit.
    ///
    /// # Errors
    /// As [`Self::add`].
    pub fn add_entry(&mut self, index: u64, entry: String) -> Result<(), PlayError> {
        let failed = |path: &Path, source| PlayError::from(OutputError::write(path, source));
        let added = [separator(self.entries.len()), &entry].concat();
        let text = [&added, END].concat();
        let written = self.write_at_end(text.as_bytes());
        if let Err(source) = written {
            // What stood there before had room.
            if let Err(error) = self
                .write_at_end(END.as_bytes())
                .and_then(|()| self.file.set_len(self.end_at + END.len() as u64))
            {
                tracing::warn!("{}: is not whole any more: {error}", self.path.display());
            }
            return Err(failed(&self.path, source));
        }
        self.end_at += added.len() as u64;
        self.entries.insert(index, entry);
        Ok(())
    }

    fn write_at_end(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.end_at))?;
        self.file.write_all(bytes)
    }

    /// All frames that were wanted are there: brings them into their order.
    ///
    /// # Errors
    /// A page that cannot be written; it is then as it was.
    pub fn finish(&self) -> Result<(), PlayError> {
        write_anew(&self.path, &self.head, &self.entries)?;
        Ok(())
    }
}

/// Writes a page as a new file. Answers it, and where [`END`] stands in it.
fn write_anew(
    path: &Path,
    head: &str,
    entries: &BTreeMap<u64, String>,
) -> Result<(File, u64), OutputError> {
    let head = head.trim_end().trim_end_matches('}').trim_end();
    let mut text = format!("{head},\n  \"frames\": [");
    for (n, entry) in entries.values().enumerate() {
        text.push_str(separator(n));
        text.push_str(entry);
    }
    let end_at = text.len() as u64;
    text.push_str(END);
    PendingFile::create(path, "pages of frames", "json")?.write_whole(text.as_bytes())?;
    let file = files::open_with(File::options().write(true), path);
    let file = file.map_err(|source| OutputError::write(path, source))?;
    Ok((file, end_at))
}

/// What stands before an entry that has so many before it.
fn separator(before: usize) -> &'static str {
    match before {
        0 => "\n    ",
        _ => ",\n    ",
    }
}
