//! Two-line elements through SGP4.

use super::tle_fields::{catalogue_number, elements};
use super::tle_text::{ElementSet, element_sets};
use super::{Feed, Frame, OrbitError, OrbitState};
use crate::frames::{Duration, Epoch, rfc3339};
use glam::DVec3;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// One satellite's two-line elements, flown by SGP4 with the constants WGS72 and in the mode that agrees with the
/// operational code of the US Space Force ("AFSPC"), for which published elements are made.
///
/// States are in TEME. Near their epoch published elements are good to about a kilometre, and the error grows by one to
/// three kilometres a day in low orbit (Vallado et al., AIAA 2006-6753).
///
/// Time runs in elapsed seconds: the satellite flies on through a leap second. Code that counts days of UTC instead
/// lets it wait for that second.
#[derive(Clone, Debug)]
pub struct TleFeed {
    name: String,
    origin: PathBuf,
    line: usize,
    catalogue_number: u64,
    epoch: Epoch,
    constants: sgp4::Constants,
}

/// The International Space Station in January 2018, which the command flies where a scene names no file.
const BUILT_IN_ISS: &str = include_str!("../../config/orbits/iss.tle");

/// Radius below which the reference code says "decayed": one equatorial radius of WGS72, kilometres.
const DECAYED_BELOW_KM: f64 = 6378.135;

/// How many names an error lists.
const NAMES_LISTED: usize = 5;

impl TleFeed {
    /// How far from the epoch of the elements a feed answers, both ways: 30 days. By then a low satellite is tens of
    /// kilometres, or hundreds in a restless atmosphere, from where SGP4 says.
    pub const REACH: Duration = Duration::from_parts(0, 30 * 86_400 * 1_000_000_000);

    /// Largest file read, bytes: more than a hundred thousand sets.
    pub const LARGEST_FILE: u64 = 16 << 20;

    /// Reads a file of element sets and takes the one that `name` names: by its name line, letter case aside, or by its
    /// catalogue number. `None` takes the only set there is.
    ///
    /// Sets have two lines, or three with a name line first, with or without a leading `0 `. Empty lines and lines that
    /// begin with `#` are passed over. Every line is checked, also those of other satellites.
    ///
    /// # Errors
    /// Says which file, line and column is wrong, how, and what to do.
    pub fn from_file(path: &Path, name: Option<&str>) -> Result<Self, OrbitError> {
        let read_error = |source| OrbitError::Read {
            path: path.to_owned(),
            source,
        };
        let too_large = || OrbitError::TooLarge {
            path: path.to_owned(),
            limit_mib: Self::LARGEST_FILE >> 20,
        };
        let file = File::open(path).map_err(read_error)?;
        if file.metadata().map_err(read_error)?.len() > Self::LARGEST_FILE {
            return Err(too_large());
        }
        // A device or a pipe says it is empty and may never end: the limit holds for what is read, too.
        let mut bytes = Vec::new();
        file.take(Self::LARGEST_FILE + 1)
            .read_to_end(&mut bytes)
            .map_err(read_error)?;
        if bytes.len() as u64 > Self::LARGEST_FILE {
            return Err(too_large());
        }
        let text = std::str::from_utf8(&bytes).map_err(|e| OrbitError::NotText {
            path: path.to_owned(),
            line: 1 + bytes
                .iter()
                .take(e.valid_up_to())
                .filter(|&&b| b == b'\n')
                .count(),
        })?;
        Self::from_text(text, path, name)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` is named in errors.
    ///
    /// # Errors
    /// Says which line and column is wrong, how, and what to do.
    pub fn from_text(text: &str, origin: &Path, name: Option<&str>) -> Result<Self, OrbitError> {
        let sets = element_sets(text, origin)?;
        Self::from_set(choose(&sets, origin, name)?, origin)
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

    /// The epoch of the elements.
    pub fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// The satellite's number in the US catalogue.
    pub fn catalogue_number(&self) -> u64 {
        self.catalogue_number
    }

    fn from_set(set: &ElementSet<'_>, origin: &Path) -> Result<Self, OrbitError> {
        let (elements, epoch) = elements(set, origin)?;
        let constants = sgp4::Constants::from_elements_afspc_compatibility_mode(&elements)
            .map_err(|e| OrbitError::Sgp4 {
                path: origin.to_owned(),
                line: set.at1,
                satellite: set.label().to_owned(),
                epoch: rfc3339(epoch),
                cause: e.to_string(),
            })?;
        let feed = Self {
            name: set.label().to_owned(),
            origin: origin.to_owned(),
            line: set.at1,
            catalogue_number: elements.norad_id,
            epoch,
            constants,
        };
        // A set that does not even hold at its own epoch is refused here, not in the middle of a flight.
        feed.state_at(epoch)?;
        Ok(feed)
    }

    fn sgp4_error(&self, epoch: Epoch, cause: String) -> OrbitError {
        OrbitError::Sgp4 {
            path: self.origin.clone(),
            line: self.line,
            satellite: self.name.clone(),
            epoch: rfc3339(epoch),
            cause,
        }
    }
}

impl Feed for TleFeed {
    fn name(&self) -> &str {
        &self.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        (self.epoch - Self::REACH, self.epoch + Self::REACH)
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let (first, last) = self.validity();
        if epoch < first || epoch > last {
            return Err(OrbitError::OutOfReach {
                satellite: self.name.clone(),
                epoch: rfc3339(epoch),
                first: rfc3339(first),
                last: rfc3339(last),
            });
        }
        // Both in TAI: elapsed time, leap seconds included.
        let elapsed = epoch.to_tai_duration() - self.epoch.to_tai_duration();
        let minutes = sgp4::MinutesSinceEpoch(elapsed.to_seconds() / 60.0);
        let prediction = self
            .constants
            .propagate_afspc_compatibility_mode(minutes)
            .map_err(|e| self.sgp4_error(epoch, e.to_string()))?;
        let position_km = DVec3::from(prediction.position);
        let velocity_km_s = DVec3::from(prediction.velocity);
        // Wild elements can make SGP4's series overflow without its noticing.
        if !position_km.is_finite() || !velocity_km_s.is_finite() {
            return Err(self.sgp4_error(epoch, "the result is not a number".to_owned()));
        }
        // The sixth error of the reference code, which the crate leaves to its caller.
        if position_km.length() < DECAYED_BELOW_KM {
            return Err(OrbitError::Decayed {
                path: self.origin.clone(),
                line: self.line,
                satellite: self.name.clone(),
                epoch: rfc3339(epoch),
                depth_km: DECAYED_BELOW_KM - position_km.length(),
            });
        }
        Ok(OrbitState {
            epoch,
            frame: Frame::Teme,
            position_m: position_km * 1000.0,
            velocity_m_s: velocity_km_s * 1000.0,
        })
    }
}

/// The set that is meant, or an error that helps to say which.
fn choose<'s, 't>(
    sets: &'s [ElementSet<'t>],
    origin: &Path,
    wanted: Option<&str>,
) -> Result<&'s ElementSet<'t>, OrbitError> {
    let matching: Vec<_> = match wanted.map(str::trim) {
        None => sets.iter().collect(),
        Some(wanted) => {
            let folded = wanted.to_lowercase();
            let number = catalogue_number(wanted);
            sets.iter()
                .filter(|set| {
                    set.label().to_lowercase() == folded
                        || number.is_some() && catalogue_number(set.catalogue()) == number
                })
                .collect()
        }
    };
    match matching.as_slice() {
        [only] => Ok(*only),
        [] => {
            let wanted = shortened(wanted.unwrap_or_default());
            Err(OrbitError::UnknownName {
                path: origin.to_owned(),
                count: sets.len(),
                nearest: nearest(sets, &wanted),
                wanted,
            })
        }
        [first, others @ ..] => {
            let one_satellite = others.iter().all(|s| s.catalogue() == first.catalogue());
            Err(OrbitError::Ambiguous {
                path: origin.to_owned(),
                wanted: wanted.map(shortened),
                count: matching.len(),
                names: matching
                    .iter()
                    .take(NAMES_LISTED)
                    .map(|set| format!("{} ({}, line {})", set.label(), set.catalogue(), set.at1))
                    .collect(),
                remedy: match (one_satellite, wanted) {
                    (true, _) => "keep only the set nearest to the date",
                    (false, None) => "name the satellite or give its catalogue number",
                    (false, Some(_)) => "give the catalogue number instead",
                },
            })
        }
    }
}

/// The name, or catalogue number, that is most like `wanted`.
fn nearest(sets: &[ElementSet<'_>], wanted: &str) -> String {
    let folded = wanted.to_lowercase();
    let likeness = |set: &ElementSet<'_>| {
        let name = strsim::jaro_winkler(&folded, &set.label().to_lowercase());
        name.max(strsim::jaro_winkler(&folded, set.catalogue()))
    };
    sets.iter()
        .map(|set| (likeness(set), set.label()))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(String::new, |(_, name)| name.to_owned())
}

/// A name from outside, short enough for a message and for comparing with every name of a large file.
fn shortened(name: &str) -> String {
    name.trim().chars().take(128).collect()
}
