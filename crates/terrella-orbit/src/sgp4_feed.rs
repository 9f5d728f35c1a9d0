//! Orbit propagation by SGP4 (SDP4 for deep space) from mean elements.

use super::mean_elements::MeanElements;
use super::sgp4_set::{self, Sgp4Set};
use super::{Feed, OrbitError, OrbitState};
use std::path::Path;
use std::sync::Arc;
use terrella_frames::{Duration, Epoch, rfc3339};

/// One satellite's mean elements, propagated by SGP4 with the constants WGS72 and in the mode that agrees with the
/// operational code of the US Space Force ("AFSPC"), for which published elements are made.
///
/// States are in TEME. Near their epoch published elements are accurate to about a kilometre, and the error grows by one to three kilometres a day
/// in low orbit (Vallado et al., AIAA 2006-6753).
///
/// Time is in elapsed seconds: the satellite moves during a leap second. Code that counts days of UTC instead stops it for that second.
///
/// It is valid for 30 days before and after the epoch, but not beyond the first time, on either side, at which SGP4 fails or puts the satellite
/// below the ground. Beyond that its series is not an orbit, even if it looks like one. That time is computed on first use, from some tens of
/// states.
///
/// If a file has sets of several epochs for one satellite, each applies to the times to which its epoch is nearest.
#[derive(Clone, Debug)]
pub struct Sgp4Feed {
    /// In order of time, all before the newest.
    earlier: Vec<Sgp4Set>,
    newest: Sgp4Set,
}

/// Two-line elements are one of the forms that [`Sgp4Feed`] reads.
pub type TleFeed = Sgp4Feed;

/// The International Space Station in January 2018, which the command flies where a scene names no file: `config/orbits/iss.tle`.
const BUILT_IN_ISS: &str = include_str!("../data/iss.tle");

impl Sgp4Feed {
    /// Validity of elements before and after their epoch: 30 days. By then the true position of a low satellite differs from SGP4's by tens of
    /// kilometres, or hundreds in a disturbed atmosphere.
    pub const VALIDITY: Duration = sgp4_set::VALIDITY;

    /// Largest file read for one satellite, bytes: more than a hundred thousand two-line sets.
    pub const MAX_FILE_BYTES: u64 = 16 << 20;

    /// A feed from elements in memory; `origin` and `line` name them in errors.
    ///
    /// # Errors
    /// If SGP4 cannot start from them, or the satellite has decayed at their own epoch.
    pub fn from_elements(
        elements: MeanElements,
        origin: Arc<Path>,
        line: usize,
    ) -> Result<Self, OrbitError> {
        Ok(Self::of_set(Sgp4Set::new(elements, origin, line)?))
    }

    /// A feed of one set.
    pub(super) fn of_set(newest: Sgp4Set) -> Self {
        let earlier = Vec::new();
        Self { earlier, newest }
    }

    /// Adds a set of the same satellite; [`Self::put_in_order`] follows the last one. Until then [`Self::elements`] are those of the first.
    pub(super) fn add(&mut self, set: Sgp4Set) {
        self.earlier.push(set);
    }

    /// Puts sets that were added in the order of their epochs.
    pub(super) fn put_in_order(&mut self) {
        if self.earlier.is_empty() {
            return;
        }
        let sets = std::iter::once(self.newest.clone()).chain(self.earlier.drain(..));
        if let Some(feed) = Self::of_sets(sets.collect()) {
            *self = feed;
        }
    }

    /// A feed of sets of one satellite in the order of their file; `None` if there is none. Of two sets of one epoch, the later one is used.
    pub(super) fn of_sets(mut sets: Vec<Sgp4Set>) -> Option<Self> {
        sets.sort_by_key(|set| set.elements.epoch);
        // The last of each epoch is kept.
        sets.reverse();
        sets.dedup_by_key(|set| set.elements.epoch);
        sets.reverse();
        let newest = sets.pop()?;
        let earlier = sets;
        Some(Self { earlier, newest })
    }

    /// The notice that it has sets of several epochs.
    pub(super) fn history(&self, origin: &Path) -> Option<OrbitError> {
        let first = self.earlier.first()?;
        let line = self.earlier.iter().map(|set| set.line);
        Some(OrbitError::History {
            path: origin.to_owned(),
            line: line.min().unwrap_or(first.line).min(self.newest.line),
            satellite: self.newest.elements.name.clone(),
            count: self.earlier.len() + 1,
            first: rfc3339(first.elements.epoch),
            last: rfc3339(self.newest.elements.epoch),
        })
    }

    /// The International Space Station, ISS (ZARYA), with elements of 20 January 2018.
    ///
    /// # Errors
    /// None as long as `config/orbits/iss.tle` is as released.
    pub fn built_in_iss() -> Result<Self, OrbitError> {
        Self::from_text(
            BUILT_IN_ISS,
            Path::new("config/orbits/iss.tle (built in)"),
            None,
        )
    }

    /// The epoch of the elements, of the newest ones where there are several sets.
    pub fn epoch(&self) -> Epoch {
        self.newest.elements.epoch
    }

    /// The satellite's number in the US catalogue.
    pub fn catalogue_number(&self) -> u64 {
        self.newest.elements.catalogue_number
    }

    /// The elements it flies, the newest ones where there are several sets.
    pub fn elements(&self) -> &MeanElements {
        &self.newest.elements
    }

    /// The line of the file at which its elements begin, from 1; with several sets, those of the latest.
    pub fn line(&self) -> usize {
        self.newest.line
    }

    /// All sets in order of time.
    fn sets(&self) -> impl Iterator<Item = &Sgp4Set> {
        self.earlier.iter().chain([&self.newest])
    }

    /// The set whose epoch is the nearest; of two as near, the later one.
    fn nearest(&self, epoch: Epoch) -> &Sgp4Set {
        let behind = self
            .earlier
            .partition_point(|set| set.elements.epoch <= epoch);
        let after = self.earlier.get(behind).unwrap_or(&self.newest);
        let before = behind.checked_sub(1).and_then(|i| self.earlier.get(i));
        let is_nearer =
            |before: &&Sgp4Set| epoch - before.elements.epoch < after.elements.epoch - epoch;
        before.filter(is_nearer).unwrap_or(after)
    }

    /// The intervals of the sets, in order, each the times nearest to its epoch.
    fn spans(&self) -> Vec<(Epoch, Epoch)> {
        let sets: Vec<_> = self.sets().collect();
        let middle = |a: Option<&&Sgp4Set>, b: Option<&&Sgp4Set>| {
            let (a, b) = (a?.elements.epoch, b?.elements.epoch);
            Some(a + (b - a) / 2_i64)
        };
        let span = |(at, set): (usize, &&Sgp4Set)| {
            let (first, last) = set.validity();
            let before = at.checked_sub(1).and_then(|at| sets.get(at));
            let begins = middle(before, Some(set)).map_or(first, |begins| begins.max(first));
            let ends = middle(Some(set), sets.get(at + 1)).map_or(last, |ends| ends.min(last));
            (begins, ends)
        };
        let spans = sets.iter().enumerate().map(span);
        spans.filter(|(begins, ends)| begins <= ends).collect()
    }
}

impl Feed for Sgp4Feed {
    fn name(&self) -> &str {
        &self.newest.elements.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        let oldest = self.earlier.first().unwrap_or(&self.newest);
        (oldest.validity().0, self.newest.validity().1)
    }

    fn decay(&self) -> (Option<Epoch>, Option<Epoch>) {
        let oldest = self.earlier.first().unwrap_or(&self.newest);
        (oldest.reach().before, self.newest.reach().after)
    }

    fn gaps(&self) -> Vec<(Epoch, Epoch)> {
        if self.earlier.is_empty() {
            return Vec::new();
        }
        let spans = self.spans();
        let pairs = spans.iter().zip(spans.iter().skip(1));
        let between = pairs.map(|(a, b)| (a.1, b.0));
        // Adjacent intervals share a time, to a nanosecond.
        let is_gap = |(end, begin): &(Epoch, Epoch)| (*begin - *end).to_seconds() > 1e-6;
        between.filter(is_gap).collect()
    }

    fn breaks(&self) -> Vec<Epoch> {
        match self.earlier.is_empty() {
            true => Vec::new(),
            false => self.spans().iter().skip(1).map(|span| span.0).collect(),
        }
    }

    fn object_id(&self) -> Option<&str> {
        self.newest.elements.object_id.as_deref()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        self.nearest(epoch).state_at(epoch)
    }
}
