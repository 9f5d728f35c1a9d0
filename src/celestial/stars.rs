//! The stars, from a file.

use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use terrella_files as files;

/// First bytes of a star file.
const MAGIC: &[u8; 8] = b"TRSTARS1";
const RECORD: usize = 24;
/// Largest number of stars in a file: Gaia's to magnitude 11.
const MAX_STARS: usize = 1_000_000;
/// Valid ranges of Hipparcos magnitudes and colour indices B − V.
const MAGNITUDES: std::ops::RangeInclusive<f64> = -2.0..=16.0;
const COLORS: std::ops::RangeInclusive<f64> = -1.0..=7.0;
/// Largest proper motion, arc seconds a year; Barnard's star has 10.4.
const MAX_MOTION: f64 = 20.0;
/// The Sun's magnitude V (Willmer 2018).
const SUN_V: f64 = -26.76;

/// Why a star file is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum StarError {
    /// It cannot be read.
    #[error("{}: {cause}", path.display())]
    Unreadable {
        path: PathBuf,
        /// Error message of the system.
        cause: String,
    },
    /// It does not start with the magic bytes.
    #[error("it is not a star file: it does not begin with TRSTARS1")]
    Kind,
    /// Its length does not match its number of stars.
    #[error("it announces {count} stars but has {bytes} bytes for them; each star needs {RECORD}")]
    Length {
        count: usize,
        /// Number of bytes after the header.
        bytes: usize,
    },
    /// The file exceeds the size limit.
    #[error("it has more than {limit} bytes, those of {MAX_STARS} stars")]
    TooLarge {
        /// Size limit, bytes.
        limit: usize,
    },
    /// The number of stars exceeds the limit.
    #[error("{count} stars are more than {MAX_STARS}")]
    TooMany { count: usize },
    /// A value out of range.
    #[error("star {star} (HIP {hip}): {what} {value} is impossible")]
    Value {
        /// Number of the record, from 1.
        star: usize,
        /// Its Hipparcos number.
        hip: u32,
        what: &'static str,
        value: f64,
    },
}

impl StarError {
    /// The message with the file's name in front.
    pub fn named(&self, path: &Path) -> String {
        match self {
            Self::Unreadable { .. } => self.to_string(),
            _ => format!("{}: {self}", path.display()),
        }
    }
}

/// A star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Its number in the Hipparcos catalogue.
    pub hip: u32,
    /// Direction, unit, ICRS at J1991.25, from the barycentre.
    pub direction: DVec3,
    /// Proper motion, radians a Julian year, across that direction.
    pub motion: DVec3,
    /// Magnitude V.
    pub magnitude: f64,
    /// Irradiance at the Earth, RGB: that of the Sun is π, for which a white sheet has radiance 1.
    pub light: Vec3,
}

impl Star {
    /// Direction this many Julian years after J1991.25, unit, ICRS: along a great circle, without parallax.
    pub fn direction_at(&self, years: f64) -> DVec3 {
        (self.direction + years * self.motion).normalize()
    }
}

/// Stars, brightest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StarCatalogue {
    stars: Vec<Star>,
}

impl StarCatalogue {
    /// Reads a star file; `textures/SOURCES.md` describes its format.
    ///
    /// # Errors
    /// A missing file, and the errors of [`Self::from_bytes`].
    pub fn read(path: &Path) -> Result<Self, StarError> {
        let unreadable = |cause: std::io::Error| StarError::Unreadable {
            path: path.to_owned(),
            cause: cause.to_string(),
        };
        let most = MAGIC.len() + 4 + RECORD * MAX_STARS;
        match files::read(path, most as u64).map_err(unreadable)? {
            Some(bytes) => Self::from_bytes(&bytes),
            None => Err(StarError::TooLarge { limit: most }),
        }
    }

    /// As [`Self::read`], from a file's bytes.
    ///
    /// # Errors
    /// Another kind of file, a file that is truncated or too long, or a value out of range.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StarError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(StarError::Kind)?;
        let (count, records) = rest.split_first_chunk().ok_or(StarError::Kind)?;
        let count = u32::from_le_bytes(*count) as usize;
        if count > MAX_STARS {
            return Err(StarError::TooMany { count });
        }
        let (records, left) = records.as_chunks::<RECORD>();
        if records.len() != count || !left.is_empty() {
            return Err(StarError::Length {
                count,
                bytes: records.len() * RECORD + left.len(),
            });
        }
        let stars = (1..)
            .zip(records)
            .map(|(star, record)| read_star(star, record));
        Ok(Self::of(stars.collect::<Result<_, _>>()?))
    }

    /// A catalogue of these stars.
    pub fn of(mut stars: Vec<Star>) -> Self {
        stars.sort_by(|a, b| a.magnitude.total_cmp(&b.magnitude));
        Self { stars }
    }

    /// The stars, brightest first.
    pub fn stars(&self) -> &[Star] {
        &self.stars
    }
}

fn read_star(star: usize, record: &[u8; RECORD]) -> Result<Star, StarError> {
    let four = |at: usize| [record[at], record[at + 1], record[at + 2], record[at + 3]];
    let two = |at: usize| f64::from(i16::from_le_bytes([record[at], record[at + 1]]));
    let hip = u32::from_le_bytes(four(0));
    let unit = TAU / 2_f64.powi(32);
    let right_ascension = f64::from(u32::from_le_bytes(four(4))) * unit;
    let declination = f64::from(i32::from_le_bytes(four(8))) * unit;
    let motions = [12, 16].map(|at| f64::from(i32::from_le_bytes(four(at))) * 1e-5);
    let (hp, b_v) = (two(20) * 1e-3, two(22) * 1e-3);
    let impossible = |what, value| StarError::Value {
        star,
        hip,
        what,
        value,
    };
    if declination.abs() > 0.5 * PI {
        return Err(impossible("declination", declination.to_degrees()));
    }
    if let Some(motion) = motions.iter().find(|motion| motion.abs() > MAX_MOTION) {
        return Err(impossible("proper motion", *motion));
    }
    if !MAGNITUDES.contains(&hp) {
        return Err(impossible("magnitude", hp));
    }
    if !COLORS.contains(&b_v) {
        return Err(impossible("colour index B − V", b_v));
    }
    let (sin_a, cos_a) = right_ascension.sin_cos();
    let (sin_d, cos_d) = declination.sin_cos();
    let east = DVec3::new(-sin_a, cos_a, 0.0);
    let north = DVec3::new(-sin_d * cos_a, -sin_d * sin_a, cos_d);
    let arcsec = PI / 648_000.0;
    let (hp_minus_v, rgb) = photometry(b_v);
    let magnitude = hp - hp_minus_v;
    Ok(Star {
        hip,
        direction: DVec3::new(cos_d * cos_a, cos_d * sin_a, sin_d),
        motion: (east * motions[0] + north * motions[1]) * arcsec,
        magnitude,
        light: rgb * (PI * 10_f64.powf(-0.4 * (magnitude - SUN_V))) as f32,
    })
}

/// Hp − V, and RGB at luminance 1 relative to the Sun as white, for B − V from −0.4 to 2 by 0.1. Hp − V: medians of the stars to Hp 6.5. RGB: black
/// bodies of Ballesteros' temperature (2012) in linear sRGB, divided by one of the Sun's B − V, 0.653.
#[rustfmt::skip]
const PHOTOMETRY: [[f32; 4]; 25] = [
    [-0.118, 0.65514, 0.99870, 2.02834],
    [-0.087, 0.68283, 1.00306, 1.90365],
    [-0.063, 0.71169, 1.00647, 1.78491],
    [-0.027, 0.74171, 1.00893, 1.67211],
    [0.008, 0.77287, 1.01046, 1.56519],
    [0.037, 0.80510, 1.01109, 1.46402],
    [0.063, 0.83835, 1.01086, 1.36845],
    [0.077, 0.87256, 1.00979, 1.27830],
    [0.092, 0.90765, 1.00793, 1.19334],
    [0.108, 0.94357, 1.00533, 1.11334],
    [0.126, 0.98026, 1.00202, 1.03806],
    [0.138, 1.01766, 0.99805, 0.96727],
    [0.150, 1.05572, 0.99346, 0.90070],
    [0.159, 1.09438, 0.98828, 0.83814],
    [0.165, 1.13361, 0.98256, 0.77934],
    [0.167, 1.17336, 0.97632, 0.72408],
    [0.164, 1.21361, 0.96960, 0.67215],
    [0.156, 1.25431, 0.96243, 0.62336],
    [0.142, 1.29543, 0.95483, 0.57751],
    [0.124, 1.33696, 0.94684, 0.53443],
    [0.091, 1.37886, 0.93847, 0.49394],
    [0.082, 1.42111, 0.92975, 0.45589],
    [0.080, 1.46369, 0.92070, 0.42014],
    [0.080, 1.50659, 0.91134, 0.38653],
    [0.080, 1.54977, 0.90169, 0.35495],
];

fn photometry(b_v: f64) -> (f64, Vec3) {
    let at = ((b_v + 0.4) / 0.1).clamp(0.0, (PHOTOMETRY.len() - 1) as f64);
    let first = (at as usize).min(PHOTOMETRY.len() - 2);
    let part = (at - first as f64) as f32;
    let [a, b] = [PHOTOMETRY[first], PHOTOMETRY[first + 1]];
    let mix = |n: usize| a[n] + part * (b[n] - a[n]);
    (f64::from(mix(0)), Vec3::new(mix(1), mix(2), mix(3)))
}
