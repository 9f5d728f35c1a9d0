//! DTED of levels 0, 1 and 2 (MIL-PRF-89020B): columns of heights from the south, metres above the geoid, a degree by a degree.

use super::error::FileContext;
use super::missing::Missing;
use super::sidecar::HeightUnit;
use super::{Conversion, Header, HeightFileError};
use crate::elevation::geoid::VerticalDatum;
use crate::elevation::{Georeference, Registration};
use std::io::{BufRead, Seek, SeekFrom};
use terrella_files::excerpt;

/// Bytes of a tape label, of the header, and of everything before the columns.
const LABEL_BYTES: u64 = 80;
const HEADER_BYTES: usize = 80;
const BEFORE_BYTES: usize = 80 + 648 + 2700;

/// Maximum columns and rows: those of level 2.
const MOST: u32 = 3601;

const VOID: i16 = -32_767;

/// Below this, some programs store integer metres as two's complement, not as sign and magnitude.
const LOWEST: i16 = -16_000;

/// A file with a parsed header.
pub(super) struct Dted<R: BufRead + Seek> {
    reader: R,
    columns: usize,
    rows: usize,
    /// Start of the columns.
    start: u64,
}

impl<R: BufRead + Seek> Dted<R> {
    pub(super) fn open(
        mut reader: R,
        context: &FileContext,
    ) -> Result<(Self, Header), HeightFileError> {
        let mut bytes = vec![0; BEFORE_BYTES];
        let mut first = 0;
        // Tape labels may come first.
        for _ in 0..4 {
            reader
                .seek(SeekFrom::Start(first))
                .map_err(|error| context.reading(error))?;
            reader
                .read_exact(&mut bytes)
                .map_err(|error| context.reading(error))?;
            if bytes.starts_with(b"UHL") {
                break;
            }
            first += LABEL_BYTES;
        }
        let damaged = |what: &str, text: &[u8]| {
            let text = String::from_utf8_lossy(text);
            context.damaged(format!("the header has the {what} {:?}", excerpt(&text)))
        };
        if !bytes.starts_with(b"UHL") {
            return Err(context.damaged("no header of DTED"));
        }
        let header = &bytes[..HEADER_BYTES];
        let number = |what: &str, from: usize| {
            let text = &header[from..from + 4];
            let number = std::str::from_utf8(text)
                .ok()
                .and_then(|text| text.trim().parse::<u32>().ok());
            number.ok_or_else(|| damaged(what, text))
        };
        let corner = |what: &str, from: usize| {
            let text = &header[from..from + 8];
            angle_deg(text).ok_or_else(|| damaged(what, text))
        };
        let (west_deg, south_deg) = (corner("longitude", 4)?, corner("latitude", 12)?);
        let steps = (number("interval", 20)?, number("interval", 24)?);
        let (columns, rows) = (
            number("number of columns", 47)?,
            number("number of rows", 51)?,
        );
        let sides = 2..=MOST;
        if !sides.contains(&columns) || !sides.contains(&rows) || steps.0 == 0 || steps.1 == 0 {
            return Err(context.rejected(
                format!("is DTED of {columns} x {rows} heights"),
                format!(
                    "levels 0 to 2, of 2 to {MOST} heights a side, with the steps between them"
                ),
                format!(
                    "`gdal_translate -of GTiff {} OUT.tif`",
                    context.path().display()
                ),
            ));
        }
        let datum =
            String::from_utf8_lossy(&bytes[HEADER_BYTES + 144..HEADER_BYTES + 149]).into_owned();
        if !matches!(datum.trim(), "WGS84" | "WGS72" | "") {
            return Err(context.other_coordinates(format!("the datum {:?}", excerpt(datum.trim()))));
        }
        let above = match &bytes[HEADER_BYTES + 141..HEADER_BYTES + 144] {
            b"E96" => Some(VerticalDatum::Egm96),
            b"E08" => Some(VerticalDatum::Egm2008),
            b"MSL" => Some(VerticalDatum::Sea),
            _ => None,
        };
        // Intervals are tenths of a second.
        let step_deg = |tenths: u32| f64::from(tenths) / 36_000.0;
        let lat_step_deg = step_deg(steps.1);
        let header = Header {
            georeference: Some(Georeference {
                columns,
                rows,
                registration: Registration::Posts,
                north_rad: (south_deg + f64::from(rows - 1) * lat_step_deg).to_radians(),
                lat_step_rad: lat_step_deg.to_radians(),
                west_rad: west_deg.to_radians(),
                lon_step_rad: step_deg(steps.0).to_radians(),
            }),
            unit: Some(HeightUnit::Metres),
            above,
            ..Header::of_size(columns, rows, Missing::of(Some(f64::from(VOID))))
        };
        let dted = Self {
            reader,
            columns: columns as usize,
            rows: rows as usize,
            start: first + BEFORE_BYTES as u64,
        };
        Ok((dted, header))
    }

    /// Peak memory of reading, bytes: all heights, because they are stored by columns.
    pub fn working_bytes(&self) -> u64 {
        (self.columns * (self.rows * 2 + 4) + self.rows * 2) as u64
    }

    /// Passes on all rows.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let stored = self.all(context)?;
        let mut heights_m = vec![0.0; self.columns];
        for row in 0..self.rows {
            // The first value of a column is the southern one.
            let at = self.rows - 1 - row;
            for (column, height_m) in heights_m.iter_mut().enumerate() {
                *height_m = conversion.metres(f64::from(stored[column * self.rows + at]));
            }
            put(row, 0, &mut heights_m)?;
        }
        Ok(())
    }

    /// All heights by columns; missing columns are void.
    fn all(&mut self, context: &FileContext) -> Result<Vec<i16>, HeightFileError> {
        let reading = |error| context.reading(error);
        let end = self.reader.seek(SeekFrom::End(0)).map_err(reading)?;
        self.reader
            .seek(SeekFrom::Start(self.start))
            .map_err(reading)?;
        let record_bytes = 8 + 2 * self.rows + 4;
        let bytes = end.saturating_sub(self.start);
        let records = bytes / record_bytes as u64;
        if !bytes.is_multiple_of(record_bytes as u64)
            || records == 0
            || records > self.columns as u64
        {
            return Err(context.damaged("its columns do not end with the file"));
        }
        let mut stored = vec![VOID; self.columns * self.rows];
        let mut is_read = vec![false; self.columns];
        let mut record = vec![0; record_bytes];
        for _ in 0..records {
            self.reader.read_exact(&mut record).map_err(reading)?;
            let (body, sum) = record.split_at(record_bytes - 4);
            let column = usize::from(u16::from_be_bytes([body[4], body[5]]));
            let is_new = is_read
                .get_mut(column)
                .map(|is_read| !std::mem::replace(is_read, true));
            if body[0] != 0xAA || is_new != Some(true) {
                return Err(context.damaged(format!("column {column} is none or comes twice")));
            }
            let found: u32 = body.iter().map(|byte| u32::from(*byte)).sum();
            if sum != found.to_be_bytes() {
                return Err(context.damaged(format!("the checksum of column {column} is wrong")));
            }
            let (pairs, _) = body[8..].as_chunks::<2>();
            let heights = &mut stored[column * self.rows..][..self.rows];
            for (height, pair) in heights.iter_mut().zip(pairs) {
                *height = signed(*pair);
            }
        }
        Ok(stored)
    }
}

/// Decodes a number of sign and magnitude.
fn signed(pair: [u8; 2]) -> i16 {
    let bits = u16::from_be_bytes(pair);
    // 15 bits.
    let magnitude = (bits & 0x7FFF) as i16;
    let number = if bits & 0x8000 == 0 {
        magnitude
    } else {
        -magnitude
    };
    match number < LOWEST && number != VOID {
        true => i16::from_be_bytes(pair),
        false => number,
    }
}

/// An angle as `DDDMMSSH` or `DDMMSSH`, with H one of N, S, E, W.
fn angle_deg(text: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(text).ok()?.trim();
    let sign = match text.chars().last()? {
        'N' | 'E' => 1.0,
        'S' | 'W' => -1.0,
        _ => return None,
    };
    let digits = &text[..text.len() - 1];
    if !digits.bytes().all(|byte| byte.is_ascii_digit()) || digits.len() < 5 {
        return None;
    }
    let (degrees, rest) = digits.split_at(digits.len() - 4);
    let number = |text: &str| text.parse::<f64>().ok();
    let (minutes, seconds) = (number(&rest[..2])?, number(&rest[2..])?);
    let angle = number(degrees)? + minutes / 60.0 + seconds / 3600.0;
    (angle <= 180.0).then_some(sign * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_signs_are_read() {
        assert_eq!(angle_deg(b"0060000E"), Some(6.0));
        assert_eq!(angle_deg(b"0453000S"), Some(-45.5));
        assert_eq!(
            angle_deg(b"1200036W").map(|deg| (deg * 100.0).round()),
            Some(-12_001.0)
        );
        for bad in [b"00600X0E", b"0060000Q", b"       E", b"9990000E"] {
            assert_eq!(angle_deg(bad), None);
        }
        assert_eq!(
            [signed([0x80, 0x64]), signed([0, 100]), signed([0xFF, 0xFF])],
            [-100, 100, VOID]
        );
        // −100 as two's complement would be −32 668 as sign and magnitude.
        assert_eq!(signed([0xFF, 0x9C]), -100);
    }
}
