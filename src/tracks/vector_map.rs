//! Coast lines and borders, from a file.

use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_frames::Geodetic;

/// First bytes of a file of lines.
const MAGIC: &[u8; 8] = b"TRLINES1";
/// The magic, the checksum and three counts.
const HEADER_BYTES: usize = 24;
/// Largest file, bytes, and largest number of lines in it: ten times those of Natural Earth at 1:10 million.
const MAX_FILE_BYTES: usize = 16_000_000;
const MAX_LINES: usize = 200_000;
/// Integer units of the file per degree.
const PER_DEGREE: f64 = 1000.0;
/// 180° and 90° in these units.
const HALF_TURN: i64 = 180_000;
const QUARTER_TURN: i64 = 90_000;

/// Why a file of lines is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum VectorMapError {
    /// It cannot be read.
    #[error("{}: {cause}", path.display())]
    Unreadable {
        path: PathBuf,
        /// Error message of the system.
        cause: String,
    },
    /// It does not start with the magic bytes.
    #[error("it is not a file of lines: it does not begin with TRLINES1 and {HEADER_BYTES} bytes")]
    Kind,
    /// The file exceeds the size limit.
    #[error("it has more than {MAX_FILE_BYTES} bytes")]
    TooLarge,
    /// Its counts exceed its size or the limits.
    #[error(
        "it says {lines} lines of {points} points and has {bytes} bytes for them, or they are more than {MAX_LINES} lines"
    )]
    Counts {
        lines: usize,
        points: usize,
        /// Number of bytes after the header.
        bytes: usize,
    },
    /// The checksum does not match.
    #[error("it is corrupt or truncated: its checksum does not match")]
    Checksum,
    /// The bytes end inside a line, or continue after the last.
    #[error("line {line} has a different length than it declares")]
    Length {
        /// Number of the line, from 1.
        line: usize,
    },
    /// A latitude beyond a pole, or a number out of range.
    #[error("line {line} leaves the globe")]
    Place {
        /// Number of the line, from 1.
        line: usize,
    },
}

impl VectorMapError {
    /// The message with the file's name in front.
    pub fn named(&self, path: &Path) -> String {
        match self {
            Self::Unreadable { .. } => self.to_string(),
            _ => format!("{}: {self}", path.display()),
        }
    }
}

/// Coast lines and national borders, on the ground: for [`Polylines::on_ground`](super::Polylines::on_ground).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VectorMap {
    /// Boundaries between land and sea.
    pub coast_lines: Vec<Vec<Geodetic>>,
    /// Boundaries between countries.
    pub borders: Vec<Vec<Geodetic>>,
}

impl VectorMap {
    /// Reads a file of lines; `textures/SOURCES.md` describes its format.
    ///
    /// # Errors
    /// A missing file, and the errors of [`Self::from_bytes`].
    pub fn read(path: &Path) -> Result<Self, VectorMapError> {
        let unreadable = |cause: std::io::Error| VectorMapError::Unreadable {
            path: path.to_owned(),
            cause: cause.to_string(),
        };
        match files::read(path, MAX_FILE_BYTES as u64).map_err(unreadable)? {
            Some(bytes) => Self::from_bytes(&bytes),
            None => Err(VectorMapError::TooLarge),
        }
    }

    /// As [`Self::read`], from a file's bytes.
    ///
    /// # Errors
    /// Another kind of file, a corrupt or truncated file, or positions off the globe.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, VectorMapError> {
        if bytes.len() > MAX_FILE_BYTES {
            return Err(VectorMapError::TooLarge);
        }
        let rest = bytes.strip_prefix(MAGIC).ok_or(VectorMapError::Kind)?;
        let (checksum, rest) = rest.split_first_chunk().ok_or(VectorMapError::Kind)?;
        let (counts, lines) = rest
            .split_first_chunk::<{ HEADER_BYTES - 12 }>()
            .ok_or(VectorMapError::Kind)?;
        if crc32fast::hash(rest) != u32::from_le_bytes(*checksum) {
            return Err(VectorMapError::Checksum);
        }
        let count = |k: usize| {
            let bytes = counts.as_chunks::<4>().0[k];
            u32::from_le_bytes(bytes) as usize
        };
        let [coasts, borders, points] = [0, 1, 2].map(count);
        let count = coasts.saturating_add(borders);
        // A point has at least two bytes, and a line one more.
        let needed = points.saturating_mul(2).saturating_add(count);
        if count > MAX_LINES || needed > lines.len() {
            return Err(VectorMapError::Counts {
                lines: count,
                points,
                bytes: lines.len(),
            });
        }
        let mut reader = Reader {
            bytes: lines,
            points,
            line: 0,
        };
        let map = Self {
            coast_lines: reader.lines(coasts)?,
            borders: reader.lines(borders)?,
        };
        match reader.bytes.is_empty() && reader.points == 0 {
            true => Ok(map),
            false => Err(VectorMapError::Length { line: reader.line }),
        }
    }
}

/// The bytes that have not been read yet.
struct Reader<'b> {
    bytes: &'b [u8],
    /// Points remaining according to the header.
    points: usize,
    /// Number of the line that is read, from 1.
    line: usize,
}

impl Reader<'_> {
    fn lines(&mut self, count: usize) -> Result<Vec<Vec<Geodetic>>, VectorMapError> {
        (0..count).map(|_| self.line()).collect()
    }

    /// The number of points, then longitude and latitude of the first, then increments to each of the others.
    fn line(&mut self) -> Result<Vec<Geodetic>, VectorMapError> {
        self.line += 1;
        let length = VectorMapError::Length { line: self.line };
        let count = self.number().map(|number| number as usize);
        let count = count
            .filter(|count| *count <= self.points)
            .ok_or_else(|| length.clone())?;
        self.points -= count;
        let mut line = Vec::with_capacity(count);
        let (mut lon, mut lat) = (0_i64, 0_i64);
        for _ in 0..count {
            lon += self.change().ok_or_else(|| length.clone())?;
            lat += self.change().ok_or_else(|| length.clone())?;
            // Beyond 180° lines continue, by at most one turn.
            if lon.abs() > 3 * HALF_TURN || lat.abs() > QUARTER_TURN {
                return Err(VectorMapError::Place { line: self.line });
            }
            let wrapped = (lon + HALF_TURN).rem_euclid(2 * HALF_TURN) - HALF_TURN;
            let [lat_deg, lon_deg] = [lat, wrapped].map(|number| number as f64 / PER_DEGREE);
            line.push(Geodetic::from_degrees(lat_deg, lon_deg, 0.0));
        }
        Ok(line)
    }

    /// A zigzag-encoded number: 0, 1, 2, 3, 4 … encode 0, −1, 1, −2, 2 …
    fn change(&mut self) -> Option<i64> {
        let number = i64::from(self.number()?);
        Some((number >> 1) ^ -(number & 1))
    }

    /// Seven bits a byte, the lowest first; the highest bit marks that more follow.
    fn number(&mut self) -> Option<u32> {
        let mut number = 0_u32;
        for shift in [0, 7, 14, 21] {
            let (byte, rest) = self.bytes.split_first()?;
            self.bytes = rest;
            number |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One coast line of three points and one border across the date line.
    fn file() -> Vec<u8> {
        // 10.000° E 50.000° N, then 1° east, then 0.5° south; 179.9° E 0°, then 0.2° east.
        let signed = [
            (10_000, 50_000),
            (1000, 0),
            (0, -500),
            (179_900, 0),
            (200, 0),
        ];
        let number = |mut value: u32, bytes: &mut Vec<u8>| {
            while value >= 128 {
                bytes.push((value % 128 + 128) as u8);
                value /= 128;
            }
            bytes.push(value as u8);
        };
        let zigzag = |value: i32| match value < 0 {
            true => (-2 * value - 1) as u32,
            false => (2 * value) as u32,
        };
        let mut lines = Vec::new();
        for (k, (lon, lat)) in signed.into_iter().enumerate() {
            match k {
                0 => number(3, &mut lines),
                3 => number(2, &mut lines),
                _ => {}
            }
            number(zigzag(lon), &mut lines);
            number(zigzag(lat), &mut lines);
        }
        with_header(&lines, [1, 1, 5])
    }

    fn with_header(lines: &[u8], counts: [u32; 3]) -> Vec<u8> {
        let mut rest = counts.map(u32::to_le_bytes).concat();
        rest.extend(lines);
        [
            &b"TRLINES1"[..],
            &crc32fast::hash(&rest).to_le_bytes(),
            &rest,
        ]
        .concat()
    }

    #[test]
    fn a_file_is_read() {
        let map = VectorMap::from_bytes(&file()).expect("good");
        let degrees = |line: &[Geodetic]| -> Vec<[f64; 2]> {
            let of = |place: &Geodetic| [place.lat_rad, place.lon_rad].map(f64::to_degrees);
            line.iter().map(of).collect()
        };
        let near = |a: &[[f64; 2]], b: &[[f64; 2]]| {
            a.len() == b.len()
                && a.as_flattened()
                    .iter()
                    .zip(b.as_flattened())
                    .all(|(a, b)| (a - b).abs() < 1e-9)
        };
        let coast = degrees(&map.coast_lines[0]);
        assert!(near(&coast, &[[50.0, 10.0], [50.0, 11.0], [49.5, 11.0]]));
        let border = degrees(&map.borders[0]);
        assert!(near(&border, &[[0.0, 179.9], [0.0, -179.9]]), "{border:?}");
    }

    /// The check value from the catalogue of CRCs (Greg Cook), CRC-32/ISO-HDLC.
    #[test]
    fn the_checksum_is_that_of_zip() {
        assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn corrupt_files_are_rejected_by_name() {
        let good = file();
        for end in 0..good.len() {
            assert!(VectorMap::from_bytes(&good[..end]).is_err(), "{end}");
        }
        for at in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[at] ^= 1 << bit;
                let read = VectorMap::from_bytes(&bad);
                assert!(read.is_err(), "bit {bit} of byte {at}: {read:?}");
            }
        }
        let of = |lines: &[u8], counts: [u32; 3]| {
            VectorMap::from_bytes(&with_header(lines, counts)).expect_err("bad")
        };
        assert_eq!(
            VectorMap::from_bytes(b"TRSTARS1"),
            Err(VectorMapError::Kind)
        );
        assert!(matches!(
            of(&[], [u32::MAX, u32::MAX, u32::MAX]),
            VectorMapError::Counts { .. }
        ));
        // A number without an end; more points than in the header; bytes after the last line.
        for lines in [&[0x80; 9][..], &[4, 0, 0, 0, 0, 0, 0, 0, 0], &[1, 0, 0, 0]] {
            let error = of(lines, [1, 0, 1]);
            assert_eq!(error, VectorMapError::Length { line: 1 }, "{lines:?}");
        }
        // 91° north: zigzag of 91 000 is 182 000.
        let north = [1, 0, 0xf0, 0x8d, 0x0b];
        assert_eq!(of(&north, [1, 0, 1]), VectorMapError::Place { line: 1 });
        let path = Path::new("/nowhere/lines.bin");
        let error = VectorMap::read(path).expect_err("no file");
        assert!(error.named(path).starts_with("/nowhere/lines.bin: "));
    }
}
