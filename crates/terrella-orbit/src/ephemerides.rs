//! Ephemerides from files: OEM, CZML, CSV, SP3 and those of STK.

use super::choose::{Candidate, Key, choose};
use super::entry::{Faults, RecordError};
use super::file::read_text;
use super::found::Found;
use super::interpolated::EphemerisFeed;
use super::recognise::{has_elements, message_of_another_kind};
use super::rejected::{Rejected, Rejections};
use super::text::{unmarked, with_line_feeds};
use super::{Feed, FileFormat, OrbitError, czml, ephemeris_csv, oem, omm, sp3, stk};
use std::collections::HashMap;
use std::path::Path;

/// The objects of a file of sampled states, in its order.
#[derive(Debug)]
pub struct Ephemerides {
    /// Format of the file: [`FileFormat::Oem`], [`FileFormat::Czml`], [`FileFormat::Csv`], [`FileFormat::Sp3`] or [`FileFormat::Stk`].
    pub format: FileFormat,
    /// Satellites that can be propagated.
    pub feeds: Vec<EphemerisFeed>,
    /// Errors of rejected objects and of skipped states: the first thousand.
    pub faults: Vec<OrbitError>,
    /// How many faults there are beyond those.
    pub faults_left_out: usize,
    /// Objects that are where others are, which only their names choose.
    followers: Vec<EphemerisFeed>,
    /// Why the first object that cannot be flown cannot be.
    faulty: Option<RecordError>,
    /// What cannot be flown, by name.
    rejected: Vec<Rejected>,
}

impl Ephemerides {
    /// Largest file read, bytes.
    pub const MAX_FILE_BYTES: u64 = 128 << 20;

    /// Reads a file of states. The format is detected from the text:
    ///
    /// - an OEM of CCSDS 502.0 starts with `CCSDS_OEM_VERS` (KVN) or `<` (XML). States may be in ICRF, GCRF, EME2000, TEME, TOD, MOD, ITRF… or
    ///   GTOD, times in UTC, TAI, TT, TDB or GPS; others are rejected. The default interpolation is
    ///   [`Interpolation::WITH_VELOCITIES`](super::interpolated::Interpolation::WITH_VELOCITIES).
    /// - CZML starts with `[`. Every `id` with a sampled `position`, in one packet or several, is an object; `INERTIAL` is read as GCRF, `FIXED` as
    ///   ITRF. Fixed points are skipped. Objects whose position refers to another's, such as sensors, are not among [`Self::feeds`], but
    ///   [`Self::one`] finds them by name.
    /// - CSV, with commas, semicolons or tabs, has a header with `epoch_utc,x_km,y_km,z_km`, and optionally `vx_km_s,vy_km_s,vz_km_s`, in any order (also `epoch_tai`, `…_tt`,
    ///   `…_gps`; `x_m` with `vx_m_s`); other columns are skipped. A column `error_m` is the uncertainty of a state, one standard deviation, and may
    ///   be empty. Columns `name` and `frame` give the satellite and the frame of a row. A comment before the header can give them for all rows,
    ///   together with the interpolation: `# frame = TEME, name = ISS, interpolation = HERMITE, degree = 7`. The frame is required.
    /// - SP3 starts with `#` and a version, a to d. Its frame is GCRF, EME2000 or TEME if the first line names it, else ITRF; every satellite is
    ///   an object named by its identifier (`G01`). Positions of zeros are gaps.
    /// - An STK ephemeris starts with `stk.v.`; its coordinate systems ICRF, J2000, Fixed and TEMEOfDate are supported.
    ///
    /// Unreadable states, and those out of the order of time, are listed and skipped. Faulty objects are listed and the others used. `is_strict`
    /// rejects the file instead. Successive OEMs of one object that do not overlap are one ephemeris.
    ///
    /// # Errors
    /// If no object is valid, or, when strict, if anything is invalid: names line and column, the error, and the remedy.
    pub fn from_file(path: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        Self::from_text(&read_text(path, Self::MAX_FILE_BYTES)?, path, is_strict)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` names it in errors.
    ///
    /// # Errors
    /// As [`Self::from_file`], except errors of the file itself.
    pub fn from_text(text: &str, origin: &Path, is_strict: bool) -> Result<Self, OrbitError> {
        let text = with_line_feeds(unmarked(text));
        let text = text.as_ref();
        if let Some(other) = message_of_another_kind(text) {
            return Err(other.error(origin));
        }
        // It is read to its end even when strict: an error that invalidates an object is more informative than an earlier one that does not.
        let mut faults = Faults::<RecordError>::new(false);
        let mut first_fault = None;
        let mut feeds = Vec::new();
        let (mut followers, mut faulty) = (Vec::new(), None);
        let mut rejected = Rejections::default();
        let mut each = |found| match found {
            Found::Object(feed) => {
                feeds.push(feed);
                Ok(())
            }
            Found::Follower(feed) => {
                followers.push(feed);
                Ok(())
            }
            Found::Corrupt(names, error) => {
                rejected.add(names, &error);
                faulty.get_or_insert_with(|| error.clone());
                first_fault.get_or_insert_with(|| error.clone());
                faults.note(error)
            }
            Found::BadState(error) if error.is_of_good_form() => {
                faults.keep(error);
                Ok(())
            }
            Found::BadState(error) => {
                first_fault.get_or_insert_with(|| error.clone());
                faults.note(error)
            }
            Found::BadStateOf(name, error) => {
                rejected.add(vec![name], &error);
                first_fault.get_or_insert_with(|| error.clone());
                faults.note(error)
            }
        };
        let format = match text.trim_start() {
            _ if oem::is_oem(text) => FileFormat::Oem,
            _ if sp3::is_sp3(text) => FileFormat::Sp3,
            _ if stk::is_stk(text) => FileFormat::Stk,
            start if start.starts_with(['[', '{']) => FileFormat::Czml,
            _ => FileFormat::Csv,
        };
        match format {
            FileFormat::Oem => oem::each_object(text, origin, &mut each)?,
            FileFormat::Czml => czml::each_object(text, origin, &mut each)?,
            FileFormat::Sp3 => sp3::each_object(text, origin, &mut each)
                .or_else(|error| each(Found::corrupt(error)))?,
            FileFormat::Stk => stk::each_object(text, origin, &mut each)
                .or_else(|error| each(Found::corrupt(error)))?,
            _ if ephemeris_csv::is_table(text) => {
                ephemeris_csv::each_object(text, origin, &mut each)
                    .or_else(|error| each(Found::corrupt(error)))?;
            }
            _ if omm::is_omm(text) || has_elements(text) => {
                return Err(OrbitError::NotRead {
                    path: origin.to_owned(),
                    kind: "a file of mean elements",
                    remedy: "has no ephemeris; a scene reads it with source = \"tle\" or \"omm\"",
                });
            }
            _ => {
                if let Some(error) = ephemeris_csv::missing_columns(text, origin) {
                    return Err(error.into());
                }
            }
        }
        let telling = faulty.clone().filter(|error| !error.is_of_emptiness());
        if let Some(first) = first_fault.filter(|_| is_strict) {
            return Err(telling.unwrap_or(first).into());
        }
        let mut kept: Vec<_> = faults.kept.into_iter().map(OrbitError::from).collect();
        if feeds.is_empty() {
            // An error that invalidates an object is more informative than one of a single state, and that more than an empty result.
            return Err(match (telling, kept.is_empty()) {
                (Some(faulty), _) => faulty.into(),
                (None, true) if format == FileFormat::Czml => OrbitError::NotRead {
                    path: origin.to_owned(),
                    kind: "CZML",
                    remedy: "with no object that moves; give one a position with samples",
                },
                (None, true) => OrbitError::NoEphemeris {
                    path: origin.to_owned(),
                },
                (None, false) => kept.swap_remove(0),
            });
        }
        if format == FileFormat::Oem {
            feeds = of_one_object_each(feeds);
        }
        Ok(Self {
            format,
            feeds,
            faults: kept,
            faults_left_out: faults.left_out,
            followers,
            faulty,
            rejected: rejected.all,
        })
    }

    /// The object of that name, letter case aside, international designator or `id` of CZML; `None` takes the only one there is.
    ///
    /// # Errors
    /// None or several match: it lists them. Without a name also if an object is faulty, as that leaves
    /// open which is the only one.
    pub fn into_one(self, origin: &Path, name: Option<&str>) -> Result<EphemerisFeed, OrbitError> {
        self.one(origin, name)
    }

    /// As [`Self::into_one`], where others are taken too: feeds share their samples.
    ///
    /// # Errors
    /// As [`Self::into_one`].
    pub fn one(&self, origin: &Path, name: Option<&str>) -> Result<EphemerisFeed, OrbitError> {
        if let (None, Some(error)) = (name, &self.faulty) {
            return Err(error.clone().into());
        }
        let followers = self.followers.iter().filter(|_| name.is_some());
        let feeds: Vec<_> = self.feeds.iter().chain(followers).collect();
        let candidates: Vec<_> = feeds
            .iter()
            .map(|feed| Candidate {
                label: feed.name().into(),
                key: feed.id().or(feed.object_id()).map(Into::into),
                line: feed.line(),
            })
            .collect();
        let key = match self.format {
            FileFormat::Czml => Key::Id,
            _ => Key::Designator,
        };
        let chosen = choose(&candidates, key, origin, name)
            .map_err(|error| Rejected::explain(&self.rejected, error))?;
        let chosen = feeds.get(chosen);
        let chosen = chosen.map(|&feed| feed.clone());
        chosen.ok_or_else(|| OrbitError::NoEphemeris {
            path: origin.to_owned(),
        })
    }
}

/// Successive messages of one object as one ephemeris, unless they overlap.
fn of_one_object_each(feeds: Vec<EphemerisFeed>) -> Vec<EphemerisFeed> {
    let mut kept: Vec<EphemerisFeed> = Vec::new();
    let mut by_object: HashMap<(String, Option<String>), usize> = HashMap::new();
    for feed in feeds {
        let object = (feed.name().to_owned(), feed.object_id().map(str::to_owned));
        let at = *by_object.entry(object).or_insert(kept.len());
        match kept.get_mut(at) {
            Some(earlier) => match earlier.joined(&feed) {
                Some(joined) => *earlier = joined,
                None => kept.push(feed),
            },
            None => kept.push(feed),
        }
    }
    kept
}
