//! Many satellites from one file.

use super::choose::{Candidate, Key, choose};
use super::entry::{Faults, MAX_ENTRIES};
use super::file::read_text;
use super::omm;
use super::tle_text::{element_sets, sets_and_faults};
use super::{FileFormat, OrbitError, Sgp4Feed};
use std::path::Path;
use std::sync::Arc;

/// The satellites of a file of elements, in its order.
#[derive(Debug)]
pub struct Catalogue {
    /// What kind of file it was: [`FileFormat::Tle`] or [`FileFormat::Omm`].
    pub format: FileFormat,
    /// Satellites that can be propagated.
    pub feeds: Vec<Sgp4Feed>,
    /// What is wrong with the others: the first thousand faults.
    pub faults: Vec<OrbitError>,
    /// How many faults there are beyond those.
    pub faults_left_out: usize,
}

impl Catalogue {
    /// Largest file read, bytes: all that is tracked, in the widest of the forms.
    pub const MAX_FILE_BYTES: u64 = 128 << 20;

    /// Most satellites read from a file.
    pub const MAX_SATELLITES: usize = MAX_ENTRIES;

    /// Reads every set of a file of two-line elements (with name lines or without) or of an OMM (CCSDS 502.0: KVN, XML,
    /// JSON, CSV). Which it is, the text itself says: XML begins with `<`, JSON with `[` or `{`, KVN with `CCSDS_OMM_VERS`,
    /// and CSV's first line names `MEAN_MOTION` between commas.
    ///
    /// Sets that are spoilt, or that SGP4 cannot fly, are listed and the others used; `is_strict` refuses the file instead.
    ///
    /// # Errors
    /// If no set is good, or, when strict, if one is not: says which line and column is wrong, how, and what to do.
    pub fn from_file(path: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        Self::from_text(&read_text(path, Self::MAX_FILE_BYTES)?, path, is_strict)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` is named in errors.
    ///
    /// # Errors
    /// As [`Self::from_file`], but for what is wrong with the file itself.
    pub fn from_text(text: &str, origin: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        let mut faults = Faults::new(is_strict);
        if let Some(cut) = omm::cut_off(text, origin) {
            faults.note(cut.into())?;
        }
        Self::read(text, origin, faults)
    }

    fn read(text: &str, origin: &Path, mut faults: Faults<OrbitError>) -> Result<Self, OrbitError> {
        let mut feeds = Vec::new();
        let path: Arc<Path> = Arc::from(origin);
        let format = match omm::is_omm(text) {
            true => FileFormat::Omm,
            false => FileFormat::Tle,
        };
        if format == FileFormat::Omm {
            omm::each_elements(text, origin, &mut |result| {
                let feed = result.and_then(|(elements, line)| {
                    Sgp4Feed::from_elements(elements, Arc::clone(&path), line)
                });
                match feed {
                    Ok(feed) => feeds.push(feed),
                    Err(error) => faults.note(error)?,
                }
                Ok(())
            })?;
        } else {
            for set in sets_and_faults(text, origin, &mut faults)? {
                match Sgp4Feed::from_set(&set, &path) {
                    Ok(feed) => feeds.push(feed),
                    Err(error) => faults.note(error)?,
                }
            }
        }
        if feeds.is_empty() {
            // The first fault says more than that there is nothing.
            return Err(match faults.kept.is_empty() {
                true => OrbitError::NoElements {
                    path: origin.to_owned(),
                },
                false => faults.kept.swap_remove(0),
            });
        }
        Ok(Self {
            format,
            feeds,
            faults: faults.kept,
            faults_left_out: faults.left_out,
        })
    }

    /// The satellite of that name, letter case aside, or catalogue number; `None` takes the only one there is.
    ///
    /// # Errors
    /// If none or more than one answers: says which there are.
    pub fn into_one(mut self, origin: &Path, name: Option<&str>) -> Result<Sgp4Feed, OrbitError> {
        let candidates: Vec<_> = self
            .feeds
            .iter()
            .map(|feed| Candidate {
                label: feed.elements().name.as_str().into(),
                key: Some(feed.catalogue_number().to_string().into()),
                line: feed.line(),
            })
            .collect();
        let chosen = choose(&candidates, Key::CatalogueNumber, origin, name)?;
        Ok(self.feeds.swap_remove(chosen))
    }
}

impl Sgp4Feed {
    /// Reads a file of element sets and takes the one that `name` names: by its name, letter case aside, or by its
    /// catalogue number. `None` takes the only set there is.
    ///
    /// The file holds two-line elements or an OMM in any of its forms ([`Catalogue`] says which). Two-line sets may have a
    /// name line first, with or without a leading `0 `. Empty lines and lines that begin with `#` are passed over. Every
    /// line is checked, also those of other satellites.
    ///
    /// # Errors
    /// Says which file, line and column is wrong, how, and what to do.
    pub fn from_file(path: &Path, name: Option<&str>) -> Result<Self, OrbitError> {
        Self::from_text(&read_text(path, Self::MAX_FILE_BYTES)?, path, name)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` is named in errors.
    ///
    /// # Errors
    /// Says which line and column is wrong, how, and what to do.
    pub fn from_text(text: &str, origin: &Path, name: Option<&str>) -> Result<Self, OrbitError> {
        if omm::is_omm(text) {
            return Catalogue::read(text, origin, Faults::new(true))?.into_one(origin, name);
        }
        let sets = element_sets(text, origin)?;
        let candidates: Vec<_> = sets
            .iter()
            .map(|set| Candidate {
                label: set.label().into(),
                key: Some(set.catalogue().into()),
                line: set.at1,
            })
            .collect();
        let chosen = choose(&candidates, Key::CatalogueNumber, origin, name)?;
        let set = sets.get(chosen).ok_or_else(|| OrbitError::NoElements {
            path: origin.to_owned(),
        })?;
        Self::from_set(set, &Arc::from(origin))
    }
}
