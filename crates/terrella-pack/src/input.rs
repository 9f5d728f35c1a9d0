//! A map of the whole Earth that a pack is built from: one file, or a mosaic.

use super::error::BuildError;
use super::mosaic::{Description, Mosaic, check_whole_earth, is_archive};
use super::source::{self, FileContext, RowSource, SourceInfo, SourceLimits};
use super::values::Meaning;
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_files::first_bytes;
use terrella_ground::elevation::read::check_metres;
use terrella_ground::elevation::vrt::is_vrt;

/// A map that has been looked at.
pub(super) enum MapInput {
    /// One file of the whole Earth.
    File(PathBuf),
    /// Several georeferenced maps.
    Mosaic(Box<Mosaic>),
}

impl MapInput {
    /// A folder is a mosaic, and a file that ends in `.toml`, `.vrt`, `.mbtiles` or `.pmtiles` and is no picture.
    pub(super) fn open(
        path: &Path,
        meaning: Meaning,
        limits: SourceLimits,
    ) -> Result<Self, BuildError> {
        let is_named = is_vrt(path) || is_archive(path) || is_named_toml(path);
        let is_mosaic = path.is_dir() || (is_named && !is_picture(path)?);
        if !is_mosaic {
            return Ok(Self::File(path.to_path_buf()));
        }
        let mut description = Description::read(path)?;
        if meaning == Meaning::Amount {
            description = description.of_amounts();
        }
        let mosaic = Mosaic::of(description, path, None, limits)?;
        Ok(Self::Mosaic(Box::new(mosaic)))
    }

    /// Rejects a file that is not a map of the whole Earth according to the files beside it.
    pub(super) fn check_place(&self, info: &SourceInfo) -> Result<(), BuildError> {
        match self {
            Self::File(path) => check_whole_earth(path, (info.width, info.height)),
            Self::Mosaic(_) => Ok(()),
        }
    }

    /// Differences of its colours from sRGB, according to `source`, its rows, or the files of its parts; a few of them.
    pub(super) fn colour_notes(&self, source: &dyn RowSource) -> Vec<String> {
        const MOST: usize = 8;
        match self {
            Self::File(path) => {
                let note = source.colour_note();
                note.map(|note| format!("{}: {note}", path.display()))
                    .into_iter()
                    .collect()
            }
            Self::Mosaic(mosaic) => {
                let mut notes: Vec<_> = mosaic.colour_notes().collect();
                if notes.len() > MOST {
                    let more = notes.len() - MOST;
                    notes.truncate(MOST);
                    notes.push(format!("{more} more parts have other colours than sRGB"));
                }
                notes
            }
        }
    }

    /// Reads it from its first row.
    pub(super) fn rows(&self, limits: SourceLimits) -> Result<Box<dyn RowSource>, BuildError> {
        match self {
            Self::File(path) => source::open_source(path, limits),
            Self::Mosaic(mosaic) => Ok(Box::new(mosaic.rows(limits))),
        }
    }

    /// Applies the checks of elevation files to elevations, if its files are read directly.
    pub(super) fn check_metres(&self, path: &Path) -> Result<(), BuildError> {
        match self {
            Self::File(_) => check_metres(path, false)?,
            Self::Mosaic(mosaic) => {
                for path in mosaic.plain_files() {
                    check_metres(path, true)?;
                }
            }
        }
        Ok(())
    }

    /// Its name in packs: its own, or that of its file.
    pub(super) fn name(&self, path: &Path) -> String {
        match self {
            Self::Mosaic(mosaic) if mosaic.name().is_some() => {
                mosaic.name().unwrap_or_default().to_string()
            }
            _ => path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
        }
    }

    /// Warnings to report before it is read.
    pub(super) fn notes(&self) -> &[String] {
        match self {
            Self::File(_) => &[],
            Self::Mosaic(mosaic) => mosaic.notes(),
        }
    }

    /// Attribution of its data, as far as given.
    pub(super) fn attribution(&self) -> &[String] {
        match self {
            Self::File(_) => &[],
            Self::Mosaic(mosaic) => mosaic.attribution(),
        }
    }
}

fn is_named_toml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

fn is_picture(path: &Path) -> Result<bool, BuildError> {
    let magic = files::open(path).and_then(first_bytes);
    let magic = magic.map_err(|error| FileContext::new(path).unreadable(error))?;
    Ok(matches!(
        magic.as_slice(),
        [0x89, b'P', b'N', b'G', ..]
            | [0xFF, 0xD8, ..]
            | [b'I', b'I', 42 | 43, 0, ..]
            | [b'M', b'M', 0, 42 | 43, ..]
            | [b'R', b'I', b'F', b'F', ..]
    ))
}
