//! Feeds: SGP4 against its published verification, real orbits against what is known of them, every reader against good
//! and bad files, interpolation against orbits that are known.

mod bad_input;
mod catalogue;
mod cut_off;
mod czml;
mod czml_documents;
mod decay;
mod eclipses;
mod histories;
mod interpolated;
mod oem;
mod oem_bad_input;
mod oem_of_others;
mod omm;
mod omm_of_others;
mod opm;
mod opm_motion;
mod simulators;
mod sp3;
mod stk;
mod table;
mod track;
mod verification;
mod wanted;

use std::path::Path;
use terrella_frames::{Epoch, utc_from_rfc3339};
use terrella_orbit::{OrbitError, TleFeed};

/// The repository's root.
const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The epoch that a test writes down.
fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap()
}

/// A set of `config/orbits`.
fn config(file: &str) -> TleFeed {
    let folder = Path::new(REPOSITORY).join("config/orbits");
    TleFeed::from_file(&folder.join(file), None).unwrap()
}

fn from_text(text: &str, name: Option<&str>) -> Result<TleFeed, OrbitError> {
    TleFeed::from_text(text, Path::new("sets.tle"), name)
}

const ISS: [&str; 2] = [
    "1 25544U 98067A   18020.89808844  .00002078  00000-0  38550-4 0  9992",
    "2 25544  51.6424  32.9776 0003646  28.7227  39.5332 15.54190080 95614",
];

/// The line with other characters from column `first` (from 1) on and a checksum that fits.
fn edited(line: &str, first: usize, characters: &str) -> String {
    let mut line = line.to_owned();
    line.replace_range(first - 1..first - 1 + characters.len(), characters);
    with_checksum(&line)
}

fn with_checksum(line: &str) -> String {
    let sum: u32 = line
        .chars()
        .take(68)
        .map(|c| c.to_digit(10).unwrap_or(u32::from(c == '-')))
        .sum();
    format!("{}{}", &line[..68], sum % 10)
}
