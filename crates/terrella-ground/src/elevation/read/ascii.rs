//! Esri ASCII grids (`.asc`): a header of keys and values, then heights as text, from the north-west.
//!
//! | key | meaning |
//! |---|---|
//! | `ncols`, `nrows` | cells of a row, and rows |
//! | `xllcorner`, `yllcorner`; or `xllcenter`, `yllcenter` | the corner of the south-western cell, or its middle |
//! | `cellsize`; or `dx`, `dy` | size of a cell |
//! | `NODATA_value` | −9999 where it is not there |
//!
//! Source: Esri, "Esri ASCII raster format"; `dx` and `dy` are those of GDAL's driver AAIGrid.

use super::error::FileContext;
use super::missing::Missing;
use super::plain::PlainGrid;
use super::{Conversion, Header, HeightFileError};
use crate::elevation::{GridError, MAX_SIDE, Registration};
use std::io::{BufRead, Read, Seek, SeekFrom};
use terrella_files::excerpt;

/// Maximum header lines, length of a line, and length of a number, bytes.
const HEADER_LINES: usize = 32;
const LINE_BYTES: u64 = 256;
const WORD_BYTES: usize = 64;

const KEYS: [&str; 11] = [
    "ncols",
    "nrows",
    "xllcorner",
    "yllcorner",
    "xllcenter",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
    "nodata",
];

/// Byte order mark that editors write before UTF-8 text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// A file with a parsed header.
pub(super) struct Ascii<R: BufRead + Seek> {
    reader: R,
    columns: usize,
    rows: usize,
    /// Start of the numbers: byte, and line from 1.
    start: u64,
    first_line: usize,
}

/// Whether a file with these first bytes is an ASCII grid.
pub(super) fn begins(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches(BYTE_ORDER_MARK);
    let text = text.trim_start().to_ascii_lowercase();
    let keys = [
        "ncols", "nrows", "xll", "yll", "cellsiz", "nodata", "dx ", "dy ",
    ];
    keys.iter().any(|key| text.starts_with(key))
}

/// Values of a header's keys, with their lines.
#[derive(Default)]
struct Keys(Vec<(String, f64, usize)>);

impl Keys {
    fn get(&self, key: &str) -> Option<f64> {
        self.0
            .iter()
            .find(|(name, ..)| name == key)
            .map(|(_, value, _)| *value)
    }
}

impl<R: BufRead + Seek> Ascii<R> {
    pub(super) fn open(
        mut reader: R,
        context: &FileContext,
    ) -> Result<(Self, Header), HeightFileError> {
        let (keys, start, first_line) = read_header(&mut reader, context)?;
        let needed = |key: &str| {
            keys.get(key).ok_or_else(|| {
                context.rejected(
                    format!("has no {key} in its header"),
                    "ncols, nrows, xllcorner, yllcorner and cellsize",
                    format!("write a line `{key} VALUE` at its beginning"),
                )
            })
        };
        // `as` saturates, and NaN becomes 0.
        let (columns, rows) = (needed("ncols")? as u32, needed("nrows")? as u32);
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(context.grid(GridError::Size { columns, rows }));
        }
        let step = |key: &str| keys.get(key).map_or_else(|| needed("cellsize"), Ok);
        let (dx, dy) = (step("dx")?, step("dy")?);
        if !(dx > 0.0 && dy > 0.0 && dx.is_finite() && dy.is_finite()) {
            return Err(context.rejected(
                format!("has cells of {dx} x {dy}"),
                "a positive cellsize",
                "correct its header",
            ));
        }
        let middle = |axis: char, step: f64| match keys.get(&format!("{axis}llcenter")) {
            Some(middle) => Ok(middle),
            None => needed(&format!("{axis}llcorner")).map(|corner| corner + 0.5 * step),
        };
        let (west, south) = (middle('x', dx)?, middle('y', dy)?);
        let north = south + f64::from(rows - 1) * dy;
        let no_data = keys.get("nodata_value").or(keys.get("nodata"));
        let missing = Missing::of(Some(no_data.unwrap_or(-9999.0)));
        let header = Header {
            plain: Some(PlainGrid {
                columns,
                rows,
                left: west,
                top: north,
                column: dx,
                row: dy,
                registration: Registration::Cells,
                needs_system: false,
            }),
            ..Header::of_size(columns, rows, missing)
        };
        let ascii = Self {
            reader,
            columns: columns as usize,
            rows: rows as usize,
            start,
            first_line,
        };
        Ok((ascii, header))
    }

    /// Peak memory of reading, bytes: a row as metres.
    pub fn working_bytes(&self) -> u64 {
        self.columns as u64 * 4 + (1 << 16)
    }

    /// Passes on all rows.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let begun = self.reader.seek(SeekFrom::Start(self.start));
        begun.map_err(|error| context.reading(error))?;
        let mut words = Words {
            reader: &mut self.reader,
            line: self.first_line,
            word: Vec::with_capacity(WORD_BYTES),
        };
        let mut heights_m = vec![0.0; self.columns];
        for row in 0..self.rows {
            for height_m in &mut heights_m {
                let Some(number) = words.number(context)? else {
                    let cause = format!("it ends in row {} of {}", row + 1, self.rows);
                    return Err(context.damaged(cause).into());
                };
                *height_m = conversion.metres(number);
            }
            put(row, 0, &mut heights_m)?;
        }
        match words.number(context)? {
            None => Ok(()),
            Some(_) => {
                let cause = format!("line {}: more heights than ncols x nrows", words.line);
                Err(context.damaged(cause).into())
            }
        }
    }
}

/// The keys, and the byte and line where the numbers begin.
fn read_header<R: BufRead + Seek>(
    reader: &mut R,
    context: &FileContext,
) -> Result<(Keys, u64, usize), HeightFileError> {
    let mut keys = Keys::default();
    let mut start = 0;
    for line in 1..=HEADER_LINES {
        let mut text = Vec::new();
        let read = reader
            .by_ref()
            .take(LINE_BYTES)
            .read_until(b'\n', &mut text);
        let bytes = read.map_err(|error| context.reading(error))?;
        let text = String::from_utf8_lossy(&text).into_owned();
        let mut words = text.trim_start_matches(BYTE_ORDER_MARK).split_whitespace();
        let key = words.next().unwrap_or_default().to_ascii_lowercase();
        if bytes == 0 || (!key.is_empty() && !KEYS.contains(&key.as_str())) {
            let is_number = key.parse::<f64>().is_ok();
            return match is_number {
                true => Ok((keys, start, line)),
                false => Err(context.rejected(
                    format!(
                        "line {line}: {:?} is neither a key of the header nor a number",
                        excerpt(&key)
                    ),
                    format!("one of {}", KEYS.join(", ")),
                    "correct its header",
                )),
            };
        }
        if !key.is_empty() {
            let value = words.next().unwrap_or_default();
            let number = value
                .parse::<f64>()
                .map_err(|_| not_a_number(line, value, context))?;
            keys.0.push((key, number, line));
        }
        start += bytes as u64;
    }
    Err(context.damaged(format!("a header of more than {HEADER_LINES} lines")))
}

fn not_a_number(line: usize, word: &str, context: &FileContext) -> HeightFileError {
    context.rejected(
        format!("line {line}: {:?} is no number", excerpt(word)),
        "numbers with a decimal point",
        "correct it; commas as decimal points become points by `sed -i s/,/./g`",
    )
}

/// Words of a text in sequence, across line breaks.
struct Words<'a, R> {
    reader: &'a mut R,
    line: usize,
    word: Vec<u8>,
}

impl<R: BufRead> Words<'_, R> {
    fn number(&mut self, context: &FileContext) -> Result<Option<f64>, HeightFileError> {
        self.word.clear();
        loop {
            let bytes = self
                .reader
                .fill_buf()
                .map_err(|error| context.reading(error))?;
            if bytes.is_empty() {
                break;
            }
            let mut used = 0;
            let mut is_over = false;
            for byte in bytes {
                if byte.is_ascii_whitespace() {
                    if !self.word.is_empty() {
                        // Its line break is counted with the next word.
                        is_over = true;
                        break;
                    }
                    self.line += usize::from(*byte == b'\n');
                } else if self.word.len() < WORD_BYTES {
                    self.word.push(*byte);
                }
                used += 1;
            }
            self.reader.consume(used);
            if is_over {
                break;
            }
        }
        if self.word.is_empty() {
            return Ok(None);
        }
        let word = String::from_utf8_lossy(&self.word);
        match word.parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) => Err(not_a_number(self.line, &word, context)),
        }
    }
}
