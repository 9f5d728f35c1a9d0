//! Many satellites from one file.

use super::choose::{Candidate, Key, choose};
use super::entry::{Faults, MAX_ENTRIES};
use super::file::read_text;
use super::omm;
use super::recognise::message_of_another_kind;
use super::rejected::{MAX_REJECTED, Rejected};
use super::sgp4_set::Sgp4Set;
use super::text::with_line_feeds;
use super::tle_fields::{catalogue_number, elements};
use super::tle_text::{ElementSet, element_sets, sets_and_faults};
use super::{FileFormat, MeanElements, OrbitError, Sgp4Feed};
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// The satellites of a file of elements, in its order.
#[derive(Debug)]
pub struct Catalogue {
    /// Format of the file: [`FileFormat::Tle`] or [`FileFormat::Omm`].
    pub format: FileFormat,
    /// Satellites that can be propagated.
    pub feeds: Vec<Sgp4Feed>,
    /// Errors of the rejected sets: the first thousand.
    pub faults: Vec<OrbitError>,
    /// How many faults there are beyond those.
    pub faults_left_out: usize,
    rejected: Vec<Rejected>,
    index: OnceLock<Index>,
}

/// The satellites of a file, in the order of their first sets.
#[derive(Default)]
struct Groups {
    /// Of most there is one set: no list of it is made.
    feeds: Vec<Sgp4Feed>,
    /// The first of each catalogue number, and the others that share one.
    by_number: HashMap<u64, usize>,
    others: HashMap<u64, Vec<usize>>,
}

impl Groups {
    fn add(&mut self, set: Sgp4Set) {
        let number = set.elements.catalogue_number;
        let next = self.feeds.len();
        let first = *self.by_number.entry(number).or_insert(next);
        if first == next {
            return self.feeds.push(Sgp4Feed::of_set(set));
        }
        let others = self.others.entry(number).or_default();
        let same = std::iter::once(first)
            .chain(others.iter().copied())
            .find(|&at| {
                let known = self.feeds.get(at).map(Sgp4Feed::elements);
                known.is_some_and(|known| is_same_satellite(known, &set.elements))
            });
        match same.and_then(|at| self.feeds.get_mut(at)) {
            Some(feed) => feed.add(set),
            None => {
                others.push(next);
                self.feeds.push(Sgp4Feed::of_set(set));
            }
        }
    }

    fn feeds(mut self) -> Vec<Sgp4Feed> {
        self.feeds.iter_mut().for_each(Sgp4Feed::put_in_order);
        self.feeds
    }
}

/// Whether two sets with the same catalogue number belong to the same satellite. Numbers of uncatalogued objects are shared by many; and satellites
/// are renamed, but have one name at a time.
fn is_same_satellite(one: &MeanElements, other: &MeanElements) -> bool {
    let is_one_name = one.name.to_lowercase() == other.name.to_lowercase();
    let is_renamed = one.object_id.is_some() && one.object_id == other.object_id;
    is_one_name && (one.catalogue_number != 0 || one == other)
        || is_renamed && one.epoch != other.epoch && one.catalogue_number != 0
}

impl Catalogue {
    /// Largest file read, bytes: all that is tracked, in the widest of the forms.
    pub const MAX_FILE_BYTES: u64 = 128 << 20;

    /// Most satellites read from a file.
    pub const MAX_SATELLITES: usize = MAX_ENTRIES;

    /// Reads every set of a file of two-line elements (with name lines or without) or of an OMM (CCSDS 502.0: KVN, XML, JSON, CSV). The format is
    /// detected from the text: XML starts with `<`, JSON with `[` or `{`, KVN with `CCSDS_OMM_VERS`, and the first line of CSV has `MEAN_MOTION`
    /// between commas, semicolons or tabs. JSON is an array of objects, an object that contains one, or one object per line.
    ///
    /// Sets of several epochs of one satellite form one feed, in which each applies to the times nearest to its epoch; a notice reports it. Faulty
    /// sets, and sets that SGP4 cannot propagate, are listed and the others used; `is_strict` rejects the file instead.
    ///
    /// # Errors
    /// If no set is valid, or, when strict, if any is invalid: names line and column, the error, and the remedy.
    pub fn from_file(path: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        Self::from_text(&read_text(path, Self::MAX_FILE_BYTES)?, path, is_strict)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` names it in errors.
    ///
    /// # Errors
    /// As [`Self::from_file`], except errors of the file itself.
    pub fn from_text(text: &str, origin: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        let text = with_line_feeds(text);
        let text = text.as_ref();
        if let Some(other) = message_of_another_kind(text) {
            return Err(other.error(origin));
        }
        let mut faults = Faults::new(is_strict);
        if let Some(cut) = omm::cut_off(text, origin) {
            faults.note(cut.into())?;
        }
        Self::read(text, origin, faults)
            .map_err(|error| of_another_kind(text, origin).unwrap_or(error))
    }

    fn read(text: &str, origin: &Path, mut faults: Faults<OrbitError>) -> Result<Self, OrbitError> {
        let mut groups = Groups::default();
        let mut rejected = Vec::new();
        let path: Arc<Path> = Arc::from(origin);
        let format = match omm::is_omm(text) {
            true => FileFormat::Omm,
            false => FileFormat::Tle,
        };
        let mut reject = |names: Vec<String>, error: OrbitError| {
            if rejected.len() < MAX_REJECTED {
                rejected.push(Rejected::new(names, &error));
            }
            faults.note(error)
        };
        if format == FileFormat::Omm {
            omm::each_elements(text, origin, &mut |result| {
                let (elements, line) = match result {
                    Ok(read) => read,
                    Err(bad) => return reject(bad.names, bad.error),
                };
                let names = vec![elements.name.clone(), elements.catalogue_number.to_string()];
                match Sgp4Set::new(elements, Arc::clone(&path), line) {
                    Ok(set) => groups.add(set),
                    Err(error) => reject(names, error)?,
                }
                Ok(())
            })?;
        } else {
            for set in sets_and_faults(text, origin, &mut reject)? {
                let flown = elements(&set, origin)
                    .and_then(|elements| Sgp4Set::new(elements, Arc::clone(&path), set.at1));
                match flown {
                    Ok(set) => groups.add(set),
                    Err(error) => {
                        let names = [set.label(), set.catalogue()];
                        reject(names.map(str::to_owned).to_vec(), error)?;
                    }
                }
            }
        }
        let feeds = groups.feeds();
        if feeds.is_empty() {
            // An error in a set is more informative than a notice, and a notice more than an empty result.
            let first = faults.kept.iter().position(|error| !error.is_notice());
            return Err(match faults.kept.is_empty() {
                true => OrbitError::NoElements {
                    path: origin.to_owned(),
                },
                false => faults.kept.swap_remove(first.unwrap_or(0)),
            });
        }
        for history in feeds.iter().filter_map(|feed| feed.history(origin)) {
            faults.keep(history);
        }
        Ok(Self {
            format,
            feeds,
            faults: faults.kept,
            faults_left_out: faults.left_out,
            rejected,
            index: OnceLock::new(),
        })
    }

    /// Whether a rejected record may be of another satellite than the only one that can be propagated, so that it is open which is meant
    /// without a name.
    pub fn is_open_which_is_meant(&self) -> bool {
        let [only] = self.feeds.as_slice() else {
            return true;
        };
        let elements = only.elements();
        let own = [&elements.name, &elements.catalogue_number.to_string()];
        let faults = self.faults.iter().filter(|fault| !fault.is_notice());
        faults.count() + self.faults_left_out > self.rejected.len()
            || !self.rejected.iter().all(|record| record.is_only_of(own))
    }

    /// The satellite of that name, letter case aside, or catalogue number; `None` takes the only one there is.
    ///
    /// # Errors
    /// None or several match: it lists them, or states why the matching one cannot be propagated.
    pub fn into_one(self, origin: &Path, name: Option<&str>) -> Result<Sgp4Feed, OrbitError> {
        self.one(origin, name)
    }

    /// As [`Self::into_one`], where others are taken too: from the second on a satellite is found without a look at the others.
    ///
    /// # Errors
    /// As [`Self::into_one`].
    pub fn one(&self, origin: &Path, name: Option<&str>) -> Result<Sgp4Feed, OrbitError> {
        let index = self.index.get_or_init(|| Index::of(&self.feeds));
        let found = name.and_then(|name| index.find(name.trim()));
        if let Some(feed) = found.and_then(|at| self.feeds.get(at)) {
            return Ok(feed.clone());
        }
        let numbers = self.feeds.iter().map(|feed| feed.catalogue_number());
        let candidates: Vec<_> = self
            .feeds
            .iter()
            .zip(numbers)
            .map(|(feed, number)| Candidate {
                label: feed.elements().name.as_str().into(),
                key: Some(number.to_string().into()),
                line: feed.line(),
            })
            .collect();
        match choose(&candidates, Key::CatalogueNumber, origin, name) {
            Ok(chosen) => self.feeds.get(chosen).cloned().ok_or_else(|| {
                let path = origin.to_owned();
                OrbitError::NoElements { path }
            }),
            Err(error) => Err(Rejected::explain(&self.rejected, error)),
        }
    }
}

/// Names and numbers that are unique in a catalogue, for direct lookup.
#[derive(Debug, Default)]
struct Index {
    by_number: HashMap<u64, Option<usize>>,
    by_name: HashMap<String, Option<usize>>,
}

impl Index {
    fn of(feeds: &[Sgp4Feed]) -> Self {
        let mut index = Self::default();
        for (at, feed) in feeds.iter().enumerate() {
            let number = index.by_number.entry(feed.catalogue_number());
            number.and_modify(|at| *at = None).or_insert(Some(at));
            let name = index.by_name.entry(feed.elements().name.to_lowercase());
            name.and_modify(|at| *at = None).or_insert(Some(at));
        }
        index
    }

    /// The satellite with this name or number; `None` if a search is needed.
    fn find(&self, wanted: &str) -> Option<usize> {
        let number = catalogue_number(wanted).and_then(|number| self.by_number.get(&number));
        let name = self.by_name.get(&wanted.to_lowercase());
        match (number, name) {
            (Some(at), None) | (None, Some(at)) => *at,
            (Some(at), Some(same)) if at == same => *at,
            _ => None,
        }
    }
}

/// Why there are no elements in a text that has none: it is an ephemeris, or a table of other columns.
fn of_another_kind(text: &str, origin: &Path) -> Option<OrbitError> {
    match FileFormat::of_text(text) {
        None => omm::missing_columns(text, origin).map(OrbitError::from),
        Some(FileFormat::Tle | FileFormat::Omm | FileFormat::Opm) => None,
        Some(
            FileFormat::Oem
            | FileFormat::Czml
            | FileFormat::Csv
            | FileFormat::Sp3
            | FileFormat::Stk,
        ) => Some(OrbitError::NotRead {
            path: origin.to_owned(),
            kind: "an ephemeris",
            remedy: "has no mean elements; a scene reads it with source = \"oem\", \"czml\", \"csv\", \"sp3\" or \"stk\"",
        }),
    }
}

impl Sgp4Feed {
    /// Reads a file of element sets and selects the satellite `name`: by its name, letter case aside, or by its catalogue number. `None` selects
    /// the only set.
    ///
    /// The file holds two-line elements or an OMM in any of its formats (see [`Catalogue`]). Two-line sets may have a name line first, with or
    /// without a leading `0 `. Empty lines and lines that begin with `#` are skipped. Every line is checked, also those of other satellites.
    ///
    /// # Errors
    /// Names file, line and column, the error, and the remedy.
    pub fn from_file(path: &Path, name: Option<&str>) -> Result<Self, OrbitError> {
        Self::from_text(&read_text(path, Self::MAX_FILE_BYTES)?, path, name)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` names it in errors.
    ///
    /// # Errors
    /// Names line and column, the error, and the remedy.
    pub fn from_text(text: &str, origin: &Path, name: Option<&str>) -> Result<Self, OrbitError> {
        let text = with_line_feeds(text);
        let text = text.as_ref();
        if omm::is_omm(text) {
            return Catalogue::read(text, origin, Faults::new(true))?.into_one(origin, name);
        }
        let sets = element_sets(text, origin)
            .map_err(|error| of_another_kind(text, origin).unwrap_or(error))?;
        let path: Arc<Path> = Arc::from(origin);
        // Groups sets of one satellite; the fields of others are not parsed.
        let mut of_label: HashMap<(&str, &str), usize> = HashMap::new();
        let mut groups: Vec<Vec<&ElementSet<'_>>> = Vec::new();
        for set in &sets {
            let key = (set.catalogue(), set.label());
            let at = *of_label.entry(key).or_insert(groups.len());
            match groups.get_mut(at) {
                Some(group) => group.push(set),
                None => groups.push(vec![set]),
            }
        }
        let firsts = groups.iter().filter_map(|group| group.first());
        let candidates: Vec<_> = firsts
            .map(|set| Candidate {
                label: set.label().into(),
                key: Some(set.catalogue().into()),
                line: set.at1,
            })
            .collect();
        let chosen = choose(&candidates, Key::CatalogueNumber, origin, name)?;
        let group = groups.get(chosen).into_iter().flatten();
        let flown: Result<Vec<_>, _> = group
            .map(|set| Sgp4Set::new(elements(set, origin)?, Arc::clone(&path), set.at1))
            .collect();
        Self::of_sets(flown?).ok_or_else(|| OrbitError::NoElements {
            path: origin.to_owned(),
        })
    }
}
