//! `frames.json`, the page of a folder of frames.
//!
//! The page is one JSON document. Frames are added to its end: what ends the document is written again behind each of them, in one
//! write, so that it is whole at any moment. When a run begins, and when it ends, the page is written as a new file and renamed; its
//! frames are then in their order.

use super::error::FilmError;
use super::folder::FrameFolder;
use super::key::{FilmKey, checksum};
use super::page_text::{BEFORE_FRAMES, END, PageText};
use super::record::FrameRecord;
use crate::error::PlayError;
use crate::output::{OutputError, PendingFile};
use crate::scene::Scene;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use terrella::frames::{Epoch, TimeScale, ccsds_time};
use terrella_files::{self as files, printable};

/// The page's name.
const NAME: &str = "frames.json";
/// What kind of file it is.
const FORMAT: &str = "terrella frames 1";
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
    pub entries: BTreeMap<u64, String>,
    /// The adapter that drew last; `None` where no frame is kept.
    pub adapter: Option<String>,
    /// Whether the page is cut off or damaged and must be written again, also where no frame is missing.
    pub is_cut: bool,
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
    /// length. A page that is cut off keeps its entries up to the cut.
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
        let text = match read_text(&path, frame_count) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return nothing_kept(folder.folder());
            }
            Err(error) => return Err(bad(printable(&error.to_string()))),
        };
        let page = PageText::read(&text).map_err(|error| {
            bad(format!(
                "is no page of frames, or its beginning is cut off: {error}"
            ))
        })?;
        let head = |name: &str| {
            let no_page = || bad(format!("is no page of frames: it has no {name}"));
            page.head(name).ok_or_else(no_page)
        };
        let format = head("format")?;
        if serde_json::from_str::<String>(format).ok().as_deref() != Some(FORMAT) {
            let format: String = format.chars().take(80).collect();
            return Err(bad(format!("its format is {format} and not {FORMAT:?}")));
        }
        if let Some(differences) = differences(film, head("film")?).map_err(bad)? {
            return Err(FilmError::OtherFilm {
                path: folder.folder().into(),
                differences,
            });
        }
        let adapter = serde_json::from_str(head("adapter")?).ok();
        let entries: BTreeMap<u64, String> = page
            .entries
            .into_par_iter()
            .filter_map(|entry| Some((whole_frame(folder, &entry, frame_count, wanted)?, entry)))
            .collect();
        if page.is_cut {
            let (path, kept) = (path.display(), entries.len());
            tracing::warn!(
                "{path}: is truncated or corrupt; the {kept} frames that it still lists are kept, and the others are rendered again"
            );
        }
        Ok(KeptFrames {
            adapter: adapter.filter(|_| !entries.is_empty()),
            is_cut: page.is_cut,
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
                tracing::warn!("{}: is corrupt: {error}", self.path.display());
            }
            return Err(failed(&self.path, source));
        }
        self.end_at += added.len() as u64;
        self.entries.insert(index, entry);
        Ok(())
    }

    fn write_at_end(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.end_at))?;
        self.file.write_all(bytes)?;
        self.file.sync_data()
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

/// The text of a page of so many frames, as far as it is text.
fn read_text(path: &Path, frame_count: u64) -> io::Result<String> {
    let limit = MAX_HEAD_BYTES + frame_count.saturating_mul(MAX_ENTRY_BYTES);
    let mut bytes = Vec::new();
    files::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        let problem = format!("is longer than a film of {frame_count} frames needs");
        return Err(io::Error::other(problem));
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A folder without a page: nothing is kept, and nothing but our own lock may be in it.
fn nothing_kept(folder: &Path) -> Result<KeptFrames, FilmError> {
    let unreadable = |error: io::Error| FilmError::BadPage {
        path: folder.into(),
        problem: error.to_string(),
    };
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name();
        if !name.to_string_lossy().starts_with(".terrella") {
            return Err(FilmError::NoFilm {
                path: folder.into(),
            });
        }
    }
    Ok(KeptFrames::default())
}

/// How the film of a page, as JSON, differs from this one.
///
/// # Errors
/// What is no film, as text.
fn differences(film: &FilmKey, found: &str) -> Result<Option<String>, String> {
    let found: serde_json::Value =
        serde_json::from_str(found).map_err(|error| error.to_string())?;
    // The program first: another version may know other settings.
    let program = found["program"].as_str();
    if let Some(words) = program.and_then(|program| film.program_difference(program)) {
        return Ok(Some(words));
    }
    let found: FilmKey = serde_json::from_value(found)
        .map_err(|error| format!("was written by another build of terrella: {error}"))?;
    Ok(film.differences(&found))
}

/// The number of an entry's frame, if it is of this film and its file is whole.
fn whole_frame(
    folder: &FrameFolder,
    entry: &str,
    frame_count: u64,
    wanted: &Range<u64>,
) -> Option<u64> {
    let record: FrameRecord = serde_json::from_str(entry).ok()?;
    if record.index >= frame_count || record.file != folder.name(record.index) {
        return None;
    }
    let path = folder.path(record.index);
    let is_whole = match wanted.contains(&record.index) {
        true => files::read(&path, record.bytes)
            .ok()
            .flatten()
            .is_some_and(|bytes| checksum(&bytes) == record.blake3),
        false => std::fs::metadata(&path).is_ok_and(|found| found.len() == record.bytes),
    };
    is_whole.then_some(record.index)
}

/// Writes a page as a new file. Answers it, and where [`END`] stands in it.
fn write_anew(
    path: &Path,
    head: &str,
    entries: &BTreeMap<u64, String>,
) -> Result<(File, u64), OutputError> {
    let head = head.trim_end().trim_end_matches('}').trim_end();
    let mut text = format!("{head}{BEFORE_FRAMES}");
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

#[cfg(test)]
mod tests {
    use super::super::folder::Existing;
    use super::super::settings::PictureSettings;
    use super::*;
    use glam::DVec3;
    use terrella::EyeView;

    const FRAMES: u64 = 3;

    /// A film of three frames and its page, in the order of 0, 2, 1 until it is finished.
    fn write_film(folder: &FrameFolder, film: &FilmKey, scene: &Scene) {
        let start = scene.time.start;
        let head = PageHead::new(scene, start, film.clone(), "an adapter".to_owned());
        let mut page = FilmPage::begin(folder, &head, BTreeMap::new()).expect("begins");
        let view = EyeView::itrf(DVec3::X, DVec3::Y, DVec3::Z, 1.0, 1.0);
        for index in [0, 2, 1] {
            let picture = [index as u8; 9];
            let file = folder.pending(index).expect("begins");
            file.write_whole(&picture).expect("writes");
            page.add(&FrameRecord {
                file: folder.name(index),
                bytes: 9,
                blake3: checksum(&picture),
                ..FrameRecord::new(index, start, start, &view, 0.0)
            })
            .expect("adds");
        }
    }

    /// Cut at every byte, and with what a power failure may leave behind the cut.
    #[test]
    fn a_page_cut_anywhere_keeps_the_entries_before_the_cut() {
        let root = tempfile::tempdir().expect("a folder");
        let scene = Scene::from_toml("[camera]\nmode = \"geodetic\"", &root.path().join("a.toml"));
        let scene = scene.expect("a good scene");
        let film = FilmKey::new(&scene, (64, 36), PictureSettings::default()).expect("a film");
        let folder = root.path().join("f");
        let folder = FrameFolder::open(&folder, FRAMES, "png", Existing::Resume).expect("made");
        write_film(&folder, &film, &scene);
        let path = folder.folder().join(NAME);
        let whole = std::fs::read(&path).expect("reads");
        let kept = || FilmPage::read_kept(&folder, &film, FRAMES, &(0..FRAMES));
        assert_eq!(kept().expect("whole").entries.len(), 3);
        let text = std::str::from_utf8(&whole).expect("text");
        let list = text.find(BEFORE_FRAMES).expect("a list") + BEFORE_FRAMES.len();
        let ends = [0, 2, 1].map(|index| {
            let name = text.find(&folder.name(index)).expect("an entry");
            name + text[name..].find("}}").expect("its end") + 2
        });
        for length in 0..text.trim_end().len() {
            for tail in [&b""[..], b"\0\0\0\0", b"\xff\xfe{"] {
                std::fs::write(&path, [&whole[..length], tail].concat()).expect("writes");
                if length < list {
                    let error = kept().expect_err("no film is known").to_string();
                    assert!(error.contains("--overwrite"), "{length}: {error}");
                    continue;
                }
                let kept = kept().unwrap_or_else(|error| panic!("{length}: {error}"));
                let before = ends.iter().filter(|end| length >= **end).count();
                assert_eq!(kept.entries.len(), before, "{length} {tail:?}");
                assert!(kept.is_cut);
            }
        }
    }
}
