//! Files of all formats, and all reasons for rejection.

mod bands;
mod files;
mod formats;
mod netcdf;
mod nothing;
mod rejections;
mod world_files;

use super::*;
use crate::elevation::GridError;
use std::collections::BTreeMap;
use std::io::Cursor;

fn data(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .join("tests/data/heights")
        .join(name)
}

fn open(name: &str) -> HeightFile {
    open_heights(&data(name), &GridLimits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Contents of the files in tests/data/heights: integer metres of a plane.
fn plane(lat_deg: f64, lon_deg: f64) -> f64 {
    (100.0 * lat_deg + 7.0 * lon_deg).round_ties_even()
}

/// Compares samples `step` apart, starting at a first one.
#[track_caller]
fn holds(
    file: &HeightFile,
    first: (f64, f64),
    step: f64,
    size: (u32, u32),
    height: impl Fn(f64, f64) -> f64,
) {
    for row in 0..size.1 {
        for column in 0..size.0 {
            let (lat, lon) = (
                first.0 - f64::from(row) * step,
                first.1 + f64::from(column) * step,
            );
            let got = file.grid.height_m(lat.to_radians(), lon.to_radians(), 0.0);
            let right = height(lat, lon);
            assert!(
                (got - right).abs() < 1e-3,
                "{got} for {right} at {lat} {lon}"
            );
        }
    }
}

/// A TIFF of one uncompressed strip, little-endian: by default 6 × 4 samples of 1° from 10° E 50° N, i16, in metres.
struct Plain {
    /// Type (3, 4, 12 or 2) and bytes of each tag.
    tags: BTreeMap<u16, (u16, Vec<u8>)>,
    samples: Vec<u8>,
}

fn shorts(values: &[u16]) -> (u16, Vec<u8>) {
    (3, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn doubles(values: &[f64]) -> (u16, Vec<u8>) {
    (12, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn keys(pairs: &[(u16, u16)]) -> (u16, Vec<u8>) {
    let mut values = vec![1, 1, 0, pairs.len() as u16];
    values.extend(pairs.iter().flat_map(|(key, value)| [*key, 0, 1, *value]));
    shorts(&values)
}

impl Plain {
    fn new() -> Self {
        let mut tags = BTreeMap::new();
        for (tag, value) in [
            (256, 6),
            (257, 4),
            (258, 16),
            (259, 1),
            (262, 1),
            (277, 1),
            (278, 4),
            (339, 2),
        ] {
            tags.insert(tag, shorts(&[value]));
        }
        tags.insert(33_550, doubles(&[1.0, 1.0, 0.0]));
        tags.insert(33_922, doubles(&[0.0, 0.0, 0.0, 10.0, 50.0, 0.0]));
        tags.insert(
            34_735,
            keys(&[(1024, 2), (1025, 1), (2048, 4326), (4099, 9001)]),
        );
        Self {
            tags,
            samples: (0..24i16).flat_map(|n| (n * 100).to_le_bytes()).collect(),
        }
    }

    fn with(mut self, tag: u16, value: (u16, Vec<u8>)) -> Self {
        self.tags.insert(tag, value);
        self
    }

    fn without(mut self, tag: u16) -> Self {
        self.tags.remove(&tag);
        self
    }

    fn samples(mut self, bits: u16, format: u16, samples: Vec<u8>) -> Self {
        self.samples = samples;
        self.with(258, shorts(&[bits])).with(339, shorts(&[format]))
    }

    fn bytes(mut self) -> Vec<u8> {
        self.tags
            .insert(279, (4, (self.samples.len() as u32).to_le_bytes().to_vec()));
        self.tags.insert(273, (4, vec![0; 4]));
        let values_at = 8 + 2 + 12 * self.tags.len() + 4;
        let tail: usize = self
            .tags
            .values()
            .map(|(_, v)| {
                if v.len() > 4 {
                    v.len().next_multiple_of(2)
                } else {
                    0
                }
            })
            .sum();
        self.tags
            .insert(273, (4, ((values_at + tail) as u32).to_le_bytes().to_vec()));
        let mut file = b"II*\0\x08\0\0\0".to_vec();
        file.extend((self.tags.len() as u16).to_le_bytes());
        let mut values = Vec::new();
        for (tag, (kind, value)) in &self.tags {
            let size = match kind {
                2 => 1,
                3 => 2,
                4 => 4,
                _ => 8,
            };
            file.extend(tag.to_le_bytes());
            file.extend(kind.to_le_bytes());
            file.extend(((value.len() / size) as u32).to_le_bytes());
            if value.len() > 4 {
                file.extend(((values_at + values.len()) as u32).to_le_bytes());
                values.extend(value);
                values.resize(values.len().next_multiple_of(2), 0);
            } else {
                let mut short = value.clone();
                short.resize(4, 0);
                file.extend(short);
            }
        }
        file.extend([0; 4]);
        file.extend(values);
        file.extend(self.samples);
        file
    }
}

fn read(bytes: Vec<u8>, sidecar: &str) -> Result<HeightFile, HeightFileError> {
    let sidecar = (!sidecar.is_empty())
        .then(|| Sidecar::from_toml(sidecar, Path::new("dem.toml")))
        .transpose()?;
    read_heights(
        Cursor::new(bytes),
        sidecar.as_ref(),
        Path::new("dem.tif"),
        &GridLimits::default(),
    )
}

#[track_caller]
fn said(bytes: Vec<u8>, sidecar: &str) -> String {
    let error = read(bytes, sidecar).expect_err("rejected");
    let said = error.to_string();
    assert!(said.starts_with("dem.t"), "{said}");
    said
}

const NORTH_WEST: (f64, f64) = (49.5, 10.5);
