//! SRTM's `.hgt`: rows of big-endian integer metres from the north, without a header. Each covers one square degree with posts on all
//! edges. The name states the south-west corner (`N45E006.hgt`). Servers also deliver it compressed: `N45E006.hgt.gz`, and a zip file
//! that contains one.
//!
//! Source: NASA, "SRTM Topography" (SRTM_Topo.txt), version 3: −32 768 is a void.

use super::error::FileContext;
use super::missing::Missing;
use super::sidecar::HeightUnit;
use super::zip::ZipEntry;
use super::{Conversion, Header, HeightFileError};
use crate::elevation::geoid::VerticalDatum;
use crate::elevation::{Georeference, Registration};
use flate2::CrcReader;
use flate2::read::{DeflateDecoder, GzDecoder};
use std::io::{BufRead, Read, Seek, SeekFrom};
use std::path::Path;

/// Known sizes, columns and rows: 3″, 1″, 1″ with half as many columns, 0.5″.
const SIZES: [(u32, u32); 4] = [(1201, 1201), (3601, 3601), (1801, 3601), (7201, 7201)];

const VOID: f64 = -32_768.0;

/// Compression of the numbers.
enum Packing {
    Plain,
    Gzip,
    Zip(ZipEntry),
}

/// A file with the location of its numbers.
pub(super) struct Hgt<R: BufRead + Seek> {
    reader: R,
    packing: Packing,
    columns: usize,
    rows: usize,
}

/// Whether the name identifies a file without a signature as this format.
pub(super) fn is_named(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("hgt"))
}

impl<R: BufRead + Seek> Hgt<R> {
    /// Uncompressed numbers.
    pub(super) fn plain(
        mut reader: R,
        context: &FileContext,
    ) -> Result<(Self, Header), HeightFileError> {
        let bytes = reader
            .seek(SeekFrom::End(0))
            .map_err(|error| context.reading(error))?;
        Self::of(reader, Packing::Plain, bytes, context.path(), context)
    }

    /// Numbers compressed by gzip, which stores the uncompressed size at its end.
    pub(super) fn gzip(
        mut reader: R,
        context: &FileContext,
    ) -> Result<(Self, Header), HeightFileError> {
        let mut length = [0; 4];
        let read = reader
            .seek(SeekFrom::End(-4))
            .and_then(|_| reader.read_exact(&mut length));
        read.map_err(|error| context.reading(error))?;
        let bytes = u64::from(u32::from_le_bytes(length));
        Self::of(reader, Packing::Gzip, bytes, context.path(), context)
    }

    /// Numbers in a zip file.
    pub(super) fn zip(
        mut reader: R,
        context: &FileContext,
    ) -> Result<(Self, Header), HeightFileError> {
        let entry = ZipEntry::find(&mut reader, ".hgt", context)?;
        let name = entry.name.clone();
        let bytes = entry.bytes;
        // The name inside counts, or else that of the zip file.
        let name = match corner_of(Path::new(&name)) {
            Some(_) => Path::new(&name),
            None => context.path(),
        };
        Self::of(reader, Packing::Zip(entry), bytes, name, context)
    }

    fn of(
        reader: R,
        packing: Packing,
        bytes: u64,
        name: &Path,
        context: &FileContext,
    ) -> Result<(Self, Header), HeightFileError> {
        let size = SIZES
            .iter()
            .find(|(columns, rows)| 2 * u64::from(*columns) * u64::from(*rows) == bytes);
        let Some(&(columns, rows)) = size else {
            return Err(context.rejected(
                format!("has {bytes} bytes of heights"),
                "those of an .hgt file: 1201 x 1201, 3601 x 3601, 1801 x 3601 or 7201 x 7201 numbers of 16 bits",
                "copy or fetch it again",
            ));
        };
        let place = |(south_deg, west_deg): (f64, f64)| Georeference {
            columns,
            rows,
            registration: Registration::Posts,
            north_rad: (south_deg + 1.0).to_radians(),
            lat_step_rad: (1.0 / f64::from(rows - 1)).to_radians(),
            west_rad: west_deg.to_radians(),
            lon_step_rad: (1.0 / f64::from(columns - 1)).to_radians(),
        };
        let header = Header {
            georeference: corner_of(name).map(place),
            unit: Some(HeightUnit::Metres),
            above: Some(VerticalDatum::Egm96),
            ..Header::of_size(columns, rows, Missing::of(Some(VOID)))
        };
        let hgt = Self {
            reader,
            packing,
            columns: columns as usize,
            rows: rows as usize,
        };
        Ok((hgt, header))
    }

    /// Peak memory of reading, bytes: a row as stored and as metres, and the decompressor.
    pub fn working_bytes(&self) -> u64 {
        self.columns as u64 * 6 + (1 << 20)
    }

    /// Passes on all rows.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let start = match &self.packing {
            Packing::Plain | Packing::Gzip => 0,
            Packing::Zip(entry) => entry.start,
        };
        let begun = self.reader.seek(SeekFrom::Start(start));
        begun.map_err(|error| context.reading(error))?;
        let size = (self.columns, self.rows);
        match &self.packing {
            Packing::Plain => rows_of(&mut self.reader, size, context, conversion, put),
            Packing::Gzip => rows_of(
                GzDecoder::new(&mut self.reader),
                size,
                context,
                conversion,
                put,
            ),
            Packing::Zip(entry) => {
                let packed = (&mut self.reader).take(entry.packed_bytes);
                let bytes: Box<dyn Read + '_> = match entry.is_deflated {
                    true => Box::new(DeflateDecoder::new(packed)),
                    false => Box::new(packed),
                };
                let mut bytes = CrcReader::new(bytes);
                rows_of(&mut bytes, size, context, conversion, put)?;
                match bytes.crc().sum() == entry.crc {
                    true => Ok(()),
                    false => Err(context
                        .damaged("the checksum of its heights is wrong")
                        .into()),
                }
            }
        }
    }
}

fn rows_of<E: From<HeightFileError>>(
    mut bytes: impl Read,
    (columns, rows): (usize, usize),
    context: &FileContext,
    conversion: &Conversion,
    put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
) -> Result<(), E> {
    let (mut row, mut heights_m) = (vec![0; 2 * columns], vec![0.0; columns]);
    for number in 0..rows {
        bytes
            .read_exact(&mut row)
            .map_err(|error| context.reading(error))?;
        let (pairs, _) = row.as_chunks::<2>();
        for (height_m, pair) in heights_m.iter_mut().zip(pairs) {
            *height_m = conversion.metres(f64::from(i16::from_be_bytes(*pair)));
        }
        put(number, 0, &mut heights_m)?;
    }
    // Compressed data have their check at the end.
    match bytes.read(&mut [0]) {
        Ok(0) => Ok(()),
        Ok(_) => Err(context.damaged("more heights than it says").into()),
        Err(error) => Err(context.reading(error).into()),
    }
}

/// Latitude and longitude of the south-west corner, degrees, from a name that begins like `N45E006` in any case.
pub(super) fn corner_of(path: &Path) -> Option<(f64, f64)> {
    let name = path.file_name()?.to_str()?.to_ascii_uppercase();
    let (first, rest) = name.split_at_checked(3)?;
    let rest = rest.strip_prefix('_').unwrap_or(rest);
    let number = |text: &str, signs: [char; 2], most: u32| {
        let digits = text.strip_prefix(signs)?;
        let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
        let number = digits
            .parse::<u32>()
            .ok()
            .filter(|number| is_number && *number <= most)?;
        let sign = if text.starts_with(signs[1]) {
            -1.0
        } else {
            1.0
        };
        Some(sign * f64::from(number))
    };
    let south = number(first, ['N', 'S'], 90)?;
    let west = number(rest.get(..4)?, ['E', 'W'], 180)?;
    (south < 90.0).then_some((south, west))
}
