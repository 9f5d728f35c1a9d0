//! Dates and places as people type them, and what is expected where a text is neither.

use terrella::frames::{Epoch, utc_from_text};
use terrella::tracks::NamedPlace;

/// Most names that a message lists.
const LISTED_NAMES: usize = 5;
const EXPECTED_DATE: &str = "expected: a date in UTC, for example 2018-01-20 or 2018-01-20 06:05";
const EXPECTED_PLACE: &str =
    "expected: latitude, longitude in degrees, for example 78.2, 15.4, or the name of a city";

/// A date, or the message that says what is expected.
pub fn date_of(text: &str) -> Result<Epoch, String> {
    utc_from_text(text.trim()).map_err(|_| EXPECTED_DATE.to_owned())
}

/// Latitude and longitude in degrees of numbers or of a city's name, or the message that says what is expected. `cities` has the most
/// important first.
pub fn place_of(text: &str, cities: &[NamedPlace]) -> Result<(f64, f64), String> {
    if let Some(place) = read_place(text) {
        return Ok(place);
    }
    if cities.is_empty() || text.contains(|c: char| c.is_ascii_digit()) {
        return Err(EXPECTED_PLACE.to_owned());
    }
    city(text.trim(), cities)
}

/// Latitude and longitude in degrees, separated by a comma or a space, with signs or with the letters N, S, E and W.
pub fn read_place(text: &str) -> Option<(f64, f64)> {
    let mut spaced = String::new();
    for c in text.chars() {
        match c.to_ascii_uppercase() {
            ',' | ';' | '°' => spaced.push(' '),
            '−' => spaced.push('-'),
            letter @ ('N' | 'S' | 'E' | 'W') => spaced.extend([' ', letter, ' ']),
            other => spaced.push(other),
        }
    }
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let (lat, lon) = match words[..] {
        [lat, lon] => (lat.parse().ok()?, lon.parse().ok()?),
        [lat, of_lat @ ("N" | "S"), lon, of_lon @ ("E" | "W")] => {
            (signed(lat, of_lat == "S")?, signed(lon, of_lon == "W")?)
        }
        _ => return None,
    };
    let is_place = f64::abs(lat) <= 90.0 && f64::abs(lon) <= 360.0;
    is_place.then_some((lat, lon))
}

/// A number with a letter in place of its sign.
fn signed(number: &str, is_negative: bool) -> Option<f64> {
    let number: f64 = number.parse().ok().filter(|number| *number >= 0.0)?;
    Some(if is_negative { -number } else { number })
}

/// The city of this name, letter case aside, else the only one whose name begins so.
fn city(text: &str, cities: &[NamedPlace]) -> Result<(f64, f64), String> {
    let wanted = text.to_lowercase();
    let mut begin_so = Vec::new();
    for city in cities {
        let name = city.name.to_lowercase();
        if name == wanted {
            // The first is the most important of this name.
            return Ok(degrees(city));
        }
        if name.starts_with(&wanted) {
            begin_so.push(city);
        }
    }
    match begin_so[..] {
        [] => Err(format!(
            "no known city begins with {text:?}; {EXPECTED_PLACE}"
        )),
        [city] => Ok(degrees(city)),
        _ => {
            let listed = begin_so.iter().take(LISTED_NAMES);
            let names: Vec<&str> = listed.map(|city| city.name.as_str()).collect();
            let others = match begin_so.len() - names.len() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let names = names.join(", ");
            Err(format!(
                "several cities begin with {text:?}: {names}{others}"
            ))
        }
    }
}

fn degrees(city: &NamedPlace) -> (f64, f64) {
    let place = city.place;
    (place.lat_rad.to_degrees(), place.lon_rad.to_degrees())
}
