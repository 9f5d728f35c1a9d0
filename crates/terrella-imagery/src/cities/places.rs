//! Populated places, from a file.

/// The file's name in a folder of maps.
pub const PLACES_FILE: &str = "places.bin";
/// First bytes of it.
const MAGIC: &[u8; 8] = b"TRPLACE1";
const RECORD: usize = 8;
/// Most places of a file: twice as many as GeoNames has with 1000 people or more.
pub const MAX_PLACES: usize = 300_000;
/// Steps of latitude and of longitude in a record: 2²⁴ for 180° and 360°.
const STEPS: f64 = (1 << 24) as f64;
/// Population of the code 0, and codes until it is twice as large.
const LEAST_POPULATION: f64 = 1000.0;
const CODES_PER_OCTAVE: f64 = 16.0;

/// A populated place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Geodetic latitude, degrees, −90…90.
    pub lat_deg: f64,
    /// Longitude, degrees, −180…180.
    pub lon_deg: f64,
    /// How many people live there; known to 4 %.
    pub population: f64,
    /// The country's two letters of ISO 3166.
    pub country: [u8; 2],
}

/// Why a file of places is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum PlacesError {
    /// It does not start with the magic bytes.
    #[error("it is not a places file: it does not begin with TRPLACE1")]
    Kind,
    /// More places than are drawn.
    #[error("{count} places are more than {MAX_PLACES}")]
    TooMany { count: usize },
    /// Its length is not what its numbers of countries and places need.
    #[error(
        "its header announces {count} places and {countries} countries; {needed} bytes are needed after it, and {bytes} follow"
    )]
    Length {
        count: usize,
        countries: usize,
        needed: usize,
        bytes: usize,
    },
    /// A country that is not two letters.
    #[error("country {number} is not two capital letters")]
    Country {
        /// Which, from 1.
        number: usize,
    },
    /// A place of a country that it does not list.
    #[error("place {place} is in country {country}; it lists {countries}")]
    NoCountry {
        /// Which record, from 1.
        place: usize,
        country: usize,
        countries: usize,
    },
}

/// Reads a file of places; `textures/SOURCES.md` describes the format.
///
/// # Errors
/// Another kind of file, one that is cut off or longer than it announces, and countries that it does not list.
pub fn read_places(bytes: &[u8]) -> Result<Vec<Place>, PlacesError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(PlacesError::Kind)?;
    let (count, rest) = rest.split_first_chunk().ok_or(PlacesError::Kind)?;
    let count = u32::from_le_bytes(*count) as usize;
    if count > MAX_PLACES {
        return Err(PlacesError::TooMany { count });
    }
    let (listed, rest) = rest.split_first().ok_or(PlacesError::Kind)?;
    let listed = usize::from(*listed);
    let needed = 2 * listed + RECORD * count;
    if rest.len() != needed {
        return Err(PlacesError::Length {
            count,
            countries: listed,
            needed,
            bytes: rest.len(),
        });
    }
    let (codes, records) = rest.split_at(2 * listed);
    let countries = codes.as_chunks::<2>().0;
    for (number, country) in (1..).zip(countries) {
        if !country.iter().all(u8::is_ascii_uppercase) {
            return Err(PlacesError::Country { number });
        }
    }
    let records = (1..).zip(records.as_chunks::<RECORD>().0);
    let places = records.map(|(place, [a, b, c, d, e, f, population, country])| {
        let country = usize::from(*country);
        let code = countries.get(country).ok_or(PlacesError::NoCountry {
            place,
            country: country + 1,
            countries: listed,
        })?;
        let part = |bytes: [u8; 3]| {
            let [x, y, z] = bytes;
            (f64::from(u32::from_le_bytes([x, y, z, 0])) + 0.5) / STEPS - 0.5
        };
        Ok(Place {
            lat_deg: 180.0 * part([*a, *b, *c]),
            lon_deg: 360.0 * part([*d, *e, *f]),
            population: LEAST_POPULATION * (f64::from(*population) / CODES_PER_OCTAVE).exp2(),
            country: *code,
        })
    });
    places.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three places in two countries, the first at 48.853 41° N 2.3488° E with 2.1 million people.
    fn file() -> Vec<u8> {
        let mut bytes = b"TRPLACE1\x03\0\0\0\x02AQFR".to_vec();
        bytes.extend([0xfb, 0x7a, 0xc5, 0x96, 0xab, 0x81, 177, 1]);
        bytes.extend([0, 0, 0, 0, 0, 0, 0, 0]);
        bytes.extend([255, 255, 255, 255, 255, 255, 255, 1]);
        bytes
    }

    #[test]
    fn places_are_read_within_metres() {
        let places = read_places(&file()).expect("a good file");
        let [paris, south, north] = places[..] else {
            panic!("{places:?}");
        };
        assert!((paris.lat_deg - 48.853_41).abs() < 1.1e-5, "{paris:?}");
        assert!((paris.lon_deg - 2.348_8).abs() < 2.2e-5, "{paris:?}");
        assert!(
            (paris.population / 2_138_551.0).ln().abs() < 0.023,
            "{paris:?}"
        );
        assert_eq!((paris.country, south.country), (*b"FR", *b"AQ"));
        assert!(south.lat_deg > -90.0 && south.lat_deg < -89.999);
        assert!(north.lat_deg < 90.0 && north.lon_deg < 180.0 && north.lon_deg > 179.999);
    }

    #[test]
    fn files_that_are_cut_or_lie_are_rejected_by_what_is_wrong() {
        let good = file();
        for end in 0..good.len() {
            assert!(read_places(&good[..end]).is_err(), "{end}");
        }
        assert_eq!(read_places(b"TRSTARS1\0\0\0\0\0"), Err(PlacesError::Kind));
        let mut many = good.clone();
        many[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        let count = u32::MAX as usize;
        assert_eq!(read_places(&many), Err(PlacesError::TooMany { count }));
        let mut small = good.clone();
        small[13] = b'a';
        assert_eq!(read_places(&small), Err(PlacesError::Country { number: 1 }));
        let mut nowhere = good;
        let last = nowhere.len() - 1;
        nowhere[last] = 3;
        let error = read_places(&nowhere).expect_err("no such country");
        assert_eq!(error.to_string(), "place 3 is in country 4; it lists 2");
    }
}
