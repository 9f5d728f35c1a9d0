//! `textures/place_names.bin`: the most important places of the Earth with their names. Part of `cargo xtask places`.

use crate::files::write_bytes;
use crate::places::Place;
use anyhow::{Context, Result};
use std::f64::consts::PI;
use std::path::Path;

/// The generated file.
const PRODUCT: &str = "place_names.bin";
/// Number of places.
const NAMES: usize = 1500;
/// GeoNames code of national capitals, and the factor for their population.
const CAPITAL: &str = "PPLC";
const CAPITAL_WEIGHT: f64 = 4.0;
/// GeoNames code of parts of a city.
const PART_OF_CITY: &str = "PPLX";
/// Lower bound of a capital's population, because some have none in the source.
const LEAST_POPULATION: f64 = 1000.0;
/// A place nearer than this to a more important one is omitted, kilometres: it is a suburb, or its label has no room.
const LEAST_ISOLATION_KM: f64 = 25.0;
/// Isolation of the most important place, kilometres: half of the Earth's circumference.
const FARTHEST_KM: f64 = PI * EARTH_RADIUS_KM;
const EARTH_RADIUS_KM: f64 = 6371.0;
/// Integer steps of the file per degree.
const PER_DEGREE: f64 = 100.0;
/// Flag of a national capital.
const IS_CAPITAL: u8 = 1;

/// A place that may be selected.
struct Candidate<'p> {
    place: &'p Place,
    importance: f64,
    unit: [f64; 3],
    /// Distance to the nearest place that is more important, kilometres.
    isolation_km: f64,
}

/// Selects the places and writes them to the folder of the maps.
///
/// # Errors
/// A name is too long, or a file cannot be written.
pub fn write(places: &[Place], textures: &Path) -> Result<()> {
    let chosen = choose(places, NAMES);
    let bytes = file(&chosen)?;
    let out = textures.join(PRODUCT);
    write_bytes(&out, &bytes)?;
    println!(
        "{}: {} names, {} bytes",
        out.display(),
        chosen.len(),
        bytes.len()
    );
    Ok(())
}

/// The places with the largest product of importance and isolation, most important first, so that sparsely populated countries have names too.
fn choose(places: &[Place], count: usize) -> Vec<Candidate<'_>> {
    let is_capital = |place: &Place| place.kind == CAPITAL;
    let mut all: Vec<_> = places
        .iter()
        .filter(|place| place.kind != PART_OF_CITY)
        .filter(|place| place.population >= LEAST_POPULATION || is_capital(place))
        .map(|place| {
            let (sin_lat, cos_lat) = place.lat_deg.to_radians().sin_cos();
            let (sin_lon, cos_lon) = place.lon_deg.to_radians().sin_cos();
            let weight = if is_capital(place) {
                CAPITAL_WEIGHT
            } else {
                1.0
            };
            Candidate {
                place,
                importance: weight * place.population.max(LEAST_POPULATION),
                unit: [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
                isolation_km: FARTHEST_KM,
            }
        })
        .collect();
    all.sort_by(|a, b| {
        let by_place =
            || (a.place.lat_deg, a.place.lon_deg).partial_cmp(&(b.place.lat_deg, b.place.lon_deg));
        let by_importance = b.importance.total_cmp(&a.importance);
        by_importance.then_with(|| by_place().unwrap_or(std::cmp::Ordering::Equal))
    });
    let mut isolated = isolate(all);
    let score = |candidate: &Candidate<'_>| candidate.importance * candidate.isolation_km;
    let mut scores: Vec<f64> = isolated.iter().map(score).collect();
    scores.sort_by(|a, b| b.total_cmp(a));
    let least = scores.get(count).copied().unwrap_or(0.0);
    isolated.retain(|candidate| score(candidate) > least);
    isolate(isolated)
}

/// From places in order of importance, those that are at least [`LEAST_ISOLATION_KM`] from all kept before them, with their isolation.
fn isolate(candidates: Vec<Candidate<'_>>) -> Vec<Candidate<'_>> {
    let mut kept: Vec<Candidate<'_>> = Vec::new();
    for mut candidate in candidates {
        let [x, y, z] = candidate.unit;
        let chord_squared = kept.iter().fold(4.0_f64, |least, other| {
            let [dx, dy, dz] = [x - other.unit[0], y - other.unit[1], z - other.unit[2]];
            least.min(dx * dx + dy * dy + dz * dz)
        });
        let half_angle = (0.5 * chord_squared.sqrt()).min(1.0).asin();
        candidate.isolation_km = 2.0 * EARTH_RADIUS_KM * half_angle;
        if candidate.isolation_km >= LEAST_ISOLATION_KM {
            kept.push(candidate);
        }
    }
    kept
}

/// `TRNAMES1`, the checksum of the rest, the number of places, then the places.
fn file(places: &[Candidate<'_>]) -> Result<Vec<u8>> {
    let mut rest = (places.len() as u32).to_le_bytes().to_vec();
    for candidate in places {
        let place = candidate.place;
        for degrees in [place.lat_deg, place.lon_deg] {
            rest.extend(((PER_DEGREE * degrees).round() as i16).to_le_bytes());
        }
        rest.extend((candidate.isolation_km.round() as u16).to_le_bytes());
        rest.push(if place.kind == CAPITAL { IS_CAPITAL } else { 0 });
        // Some names have an explanation: "Palikir - National Government Center".
        let name = place.name.split(" - ").next().unwrap_or(&place.name).trim();
        let length = u8::try_from(name.len()).with_context(|| format!("{name} is too long"))?;
        rest.push(length);
        rest.extend(name.bytes());
    }
    let mut checksum = flate2::Crc::new();
    checksum.update(&rest);
    let mut file = b"TRNAMES1".to_vec();
    file.extend(checksum.sum().to_le_bytes());
    file.extend(rest);
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(name: &str, kind: &str, population: f64, lon_deg: f64) -> Place {
        Place {
            lat_deg: 0.0,
            lon_deg,
            population,
            country: *b"AA",
            name: name.to_owned(),
            kind: kind.to_owned(),
        }
    }

    /// On the equator a degree is 111.19 km of a sphere of 6371 km.
    #[test]
    fn importance_and_isolation_choose_and_suburbs_are_left_out() {
        let places = [
            place("Part", "PPLX", 9e6, 40.0),
            place("Suburb", "PPL", 4e5, 0.1),
            place("Capital - seat", "PPLC", 2e6, 0.0),
            place("City", "PPLA", 5e6, 10.0),
            place("Town", "PPL", 9e4, 11.0),
            place("Remote", "PPL", 8e4, 100.0),
        ];
        let chosen = choose(&places, 3);
        let found: Vec<_> = chosen
            .iter()
            .map(|c| (c.place.name.as_str(), c.isolation_km.round()))
            .collect();
        let half = FARTHEST_KM.round();
        // A capital of 2 million counts as 8.
        assert_eq!(
            found,
            [
                ("Capital - seat", half),
                ("City", 1112.0),
                ("Remote", 10_008.0)
            ]
        );
        let bytes = file(&chosen).expect("short names");
        assert_eq!(bytes[12..16], [3, 0, 0, 0]);
        // 0° N, 0° E, 20 015 km, a capital, 7 letters.
        assert_eq!(bytes[16..24], [0, 0, 0, 0, 0x2f, 0x4e, 1, 7]);
        assert_eq!(&bytes[24..31], b"Capital");
    }
}
