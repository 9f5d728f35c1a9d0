//! Names of cities and towns, from a file.

use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_frames::Geodetic;

/// First bytes of a file of names.
const MAGIC: &[u8; 8] = b"TRNAMES1";
/// Largest file, bytes: some forty times the embedded one.
const MAX_FILE_BYTES: usize = 2_000_000;
/// Size of a place without its name, bytes.
const RECORD_BYTES: usize = 8;
/// Integer units of the file per degree.
const PER_DEGREE: f64 = 100.0;
/// 180° and 90° in these units.
const HALF_TURN: i16 = 18_000;
const QUARTER_TURN: i16 = 9000;
/// Flag of a national capital.
const IS_CAPITAL: u8 = 1;

/// Why a file of names is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum PlaceNamesError {
    /// It cannot be read.
    #[error("{}: {cause}", path.display())]
    Unreadable {
        path: PathBuf,
        /// Error message of the system.
        cause: String,
    },
    /// It does not start with the magic bytes.
    #[error("{}: it is no file of place names: it does not begin with TRNAMES1", path.display())]
    Kind { path: PathBuf },
    /// The file exceeds the size limit.
    #[error("{}: it has more than {MAX_FILE_BYTES} bytes", path.display())]
    TooLarge { path: PathBuf },
    /// The checksum does not match.
    #[error("{}: it is corrupt or cut off: its checksum is not that of its bytes", path.display())]
    Checksum { path: PathBuf },
    /// The bytes end inside a place or continue after the last, or a place is invalid.
    #[error("{}: place {place} of it is cut off, lies off the globe or has no name", path.display())]
    Place {
        path: PathBuf,
        /// Number of the place, from 1.
        place: usize,
    },
}

/// A place with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPlace {
    /// Position, to 0.005°; the height is 0.
    pub place: Geodetic,
    /// Its name, as GeoNames has it.
    pub name: String,
    /// Whether it is the capital of a country or a territory.
    pub is_capital: bool,
    /// Distance to the nearest more important place, metres: the room for its name.
    pub isolation_m: f64,
}

/// Reads a file of place names, the most important first; `textures/SOURCES.md` describes its format.
///
/// # Errors
/// A file that cannot be read, another kind of file, a corrupt or truncated file, or positions off the globe.
pub fn read_place_names(path: &Path) -> Result<Vec<NamedPlace>, PlaceNamesError> {
    let read = files::read(path, MAX_FILE_BYTES as u64);
    let path = || path.to_owned();
    let bytes = read.map_err(|cause| PlaceNamesError::Unreadable {
        path: path(),
        cause: cause.to_string(),
    })?;
    let bytes = bytes.ok_or_else(|| PlaceNamesError::TooLarge { path: path() })?;
    let rest = bytes.strip_prefix(MAGIC);
    let (checksum, rest) = rest
        .and_then(<[u8]>::split_first_chunk)
        .ok_or_else(|| PlaceNamesError::Kind { path: path() })?;
    if crc32fast::hash(rest) != u32::from_le_bytes(*checksum) {
        return Err(PlaceNamesError::Checksum { path: path() });
    }
    places(rest).map_err(|place| PlaceNamesError::Place {
        path: path(),
        place,
    })
}

/// The places after the checksum, or the number of the first invalid one.
fn places(bytes: &[u8]) -> Result<Vec<NamedPlace>, usize> {
    let (count, mut rest) = bytes.split_first_chunk().ok_or(1_usize)?;
    let count = u32::from_le_bytes(*count) as usize;
    // Allocation is bounded by the size of the file, not by its stated count.
    let mut places = Vec::with_capacity(count.min(rest.len() / RECORD_BYTES));
    for number in 1..=count {
        let (place, after) = place(rest).ok_or(number)?;
        places.push(place);
        rest = after;
    }
    match rest.is_empty() {
        true => Ok(places),
        false => Err(count + 1),
    }
}

/// Latitude, longitude (i16), isolation in kilometres (u16), flags, and the name after its length.
fn place(bytes: &[u8]) -> Option<(NamedPlace, &[u8])> {
    let (record, rest) = bytes.split_first_chunk::<RECORD_BYTES>()?;
    let [
        lat_low,
        lat_high,
        lon_low,
        lon_high,
        km_low,
        km_high,
        flags,
        length,
    ] = *record;
    let lat = i16::from_le_bytes([lat_low, lat_high]);
    let lon = i16::from_le_bytes([lon_low, lon_high]);
    if lat.unsigned_abs() > QUARTER_TURN.unsigned_abs()
        || lon.unsigned_abs() > HALF_TURN.unsigned_abs()
    {
        return None;
    }
    let (name, rest) = rest.split_at_checked(usize::from(length))?;
    let name = std::str::from_utf8(name)
        .ok()
        .filter(|name| !name.is_empty())?;
    let [lat_deg, lon_deg] = [lat, lon].map(|number| f64::from(number) / PER_DEGREE);
    let place = NamedPlace {
        place: Geodetic::from_degrees(lat_deg, lon_deg, 0.0),
        name: name.to_owned(),
        is_capital: flags & IS_CAPITAL != 0,
        isolation_m: 1000.0 * f64::from(u16::from_le_bytes([km_low, km_high])),
    };
    Some((place, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(count: u32, places: &[u8]) -> Vec<u8> {
        let rest = [&count.to_le_bytes()[..], places].concat();
        let checksum = crc32fast::hash(&rest).to_le_bytes();
        [&MAGIC[..], &checksum, &rest].concat()
    }

    fn read(bytes: &[u8]) -> Result<Vec<NamedPlace>, PlaceNamesError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("names.bin");
        std::fs::write(&path, bytes).expect("written");
        read_place_names(&path)
    }

    /// 48.21° N, 16.37° W, 300 km, a capital.
    const VIENNA: [u8; 14] = *b"\xd5\x12\x9b\xf9\x2c\x01\x01\x06Vienna";

    #[test]
    fn places_are_read_and_every_corruption_is_found() {
        let good = file(1, &VIENNA);
        let places = read(&good).expect("a good file");
        let [place] = places.as_slice() else {
            panic!("{places:?}")
        };
        assert_eq!((place.name.as_str(), place.is_capital), ("Vienna", true));
        assert_eq!(place.isolation_m, 300_000.0);
        assert!((place.place.lat_rad.to_degrees() - 48.21).abs() < 1e-9);
        assert!((place.place.lon_rad.to_degrees() + 16.37).abs() < 1e-9);
        for end in 0..good.len() {
            assert!(read(&good[..end]).is_err(), "{end}");
        }
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 0x20;
            assert!(read(&bad).is_err(), "byte {at}");
        }
    }

    #[test]
    fn records_are_checked_where_the_checksum_is_right() {
        let error = |count, places: &[u8]| {
            let error = read(&file(count, places)).expect_err("a bad record");
            assert!(error.to_string().contains("names.bin: "), "{error}");
            match error {
                PlaceNamesError::Place { place, .. } => place,
                other => panic!("{other}"),
            }
        };
        // A count beyond the data, bytes after the last place, no name, invalid UTF-8, 90.01° N.
        assert_eq!(error(u32::MAX, &VIENNA), 2);
        assert_eq!(error(1, &[&VIENNA[..], &[0]].concat()), 2);
        assert_eq!(error(1, &[0; 8]), 1);
        assert_eq!(error(1, b"\0\0\0\0\0\0\0\x01\xff"), 1);
        assert_eq!(error(1, b"\x29\x23\0\0\0\0\0\x01A"), 1);
    }
}
