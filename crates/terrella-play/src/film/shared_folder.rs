//! A folder of frames that several processes fill: one of them has the folder and its page, the others write frames.

use super::folder::{Existing, FrameFolder};
use super::key::{FilmKey, checksum};
use super::page::{FilmPage, KeptFrames, PageHead};
use super::range::FrameRange;
use super::record::FrameRecord;
use super::settings::PictureSettings;
use crate::clock::frame_epoch;
use crate::error::PlayError;
use crate::flight::Flight;
use crate::output::OutputError;
use std::ops::Range;
use std::path::Path;
use terrella_files as files;

/// A film's folder and its page, in the hands of one process while others write frames into it.
pub struct SharedFolder {
    folder: FrameFolder,
    film: FilmKey,
    wanted: Range<u64>,
    frame_count: u64,
    kept: KeptFrames,
    page: Option<FilmPage>,
}

/// What a folder of frames is opened for.
#[derive(Clone, Copy, Debug)]
pub struct FilmRequest<'r> {
    /// The folder.
    pub folder: &'r Path,
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// How pictures are made and kept.
    pub pictures: PictureSettings,
    /// The frames that are wanted.
    pub range: FrameRange,
    /// What becomes of what the folder holds already.
    pub existing: Existing,
}

impl SharedFolder {
    /// Takes the folder.
    ///
    /// # Errors
    /// Frames that the film does not have; a folder that cannot be written to, holds something else or belongs to another run.
    pub fn open(flight: &Flight, request: &FilmRequest<'_>) -> Result<Self, PlayError> {
        let frame_count = flight.scene().time.frame_count();
        let wanted = request.range.of(frame_count)?;
        let ending = request.pictures.format.ending();
        let folder = FrameFolder::open(request.folder, frame_count, ending, request.existing)?;
        let film = FilmKey::new(flight.scene(), request.size, request.pictures)?;
        let kept = match request.existing {
            Existing::Resume => FilmPage::read_kept(&folder, &film, frame_count, &wanted)?,
            Existing::Reject | Existing::Overwrite => KeptFrames::default(),
        };
        Ok(Self {
            folder,
            film,
            wanted,
            frame_count,
            kept,
            page: None,
        })
    }

    /// The frames that are wanted.
    pub fn wanted(&self) -> Range<u64> {
        self.wanted.clone()
    }

    /// Frames of the whole film.
    pub fn frame_count(&self) -> u64 {
        self.frame_count
    }

    /// The name of a frame's file.
    pub fn name(&self, index: u64) -> String {
        self.folder.name(index)
    }

    /// Those of the frames that are wanted that are there already.
    pub fn kept(&self) -> impl Iterator<Item = u64> {
        let entries = self.kept.entries.range(self.wanted.clone());
        entries.map(|(index, _)| *index)
    }

    /// The adapter that drew the frames that are kept.
    pub fn kept_adapter(&self) -> Option<&str> {
        self.kept.adapter.as_deref()
    }

    /// Keeps a frame that an earlier run has written and not brought onto the page, if its file is whole. Before [`Self::begin`].
    /// `entry` is its record as JSON in one line.
    pub fn adopt(&mut self, entry: &str) -> bool {
        let Ok(record) = serde_json::from_str::<FrameRecord>(entry) else {
            return false;
        };
        let is_ours = self.wanted.contains(&record.index)
            && record.file == self.folder.name(record.index)
            && !self.kept.entries.contains_key(&record.index);
        let is_whole = is_ours
            && files::read(&self.folder.path(record.index), record.bytes)
                .is_ok_and(|bytes| bytes.is_some_and(|bytes| checksum(&bytes) == record.blake3));
        if is_whole {
            let entry = entry.trim().to_owned();
            self.kept.entries.insert(record.index, entry);
        }
        is_whole
    }

    /// Writes the page with what is kept.
    ///
    /// # Errors
    /// A page that cannot be written.
    pub fn begin(&mut self, flight: &Flight, adapter: &str) -> Result<(), PlayError> {
        let scene = flight.scene();
        let start = frame_epoch(&scene.time, 0);
        let head = PageHead::new(scene, start, self.film.clone(), adapter.to_owned());
        let kept = self.kept.entries.clone();
        self.page = Some(FilmPage::begin(&self.folder, &head, kept)?);
        Ok(())
    }

    /// Adds a frame that is written to the page, which is begun. `entry` is its record as JSON in one line.
    ///
    /// # Errors
    /// What is no record; a page that cannot be written: it is then as it was.
    pub fn add(&mut self, entry: &str) -> Result<(), PlayError> {
        let record: FrameRecord = serde_json::from_str(entry)
            .map_err(|error| OutputError::write(self.folder.folder(), error.into()))?;
        match &mut self.page {
            Some(page) => page.add_entry(record.index, entry.trim().to_owned()),
            None => Ok(()),
        }
    }

    /// Brings the page's frames into their order, and takes away what processes that died left half written.
    ///
    /// # Errors
    /// A page that cannot be written; files that cannot be taken away.
    pub fn finish(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.folder.remove_unfinished()?;
        if self.page.is_none() && self.kept.is_cut {
            let adapter = self.kept.adapter.clone().unwrap_or_default();
            self.begin(flight, &adapter)?;
        }
        self.page.as_ref().map_or(Ok(()), FilmPage::finish)
    }
}
