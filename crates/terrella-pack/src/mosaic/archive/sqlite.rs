//! Rows of the tables of an SQLite file, read from its pages (<https://www.sqlite.org/fileformat.html>).
//!
//! Our own reader, because only one table is needed: SQLite itself would add 250 000 lines of C. Supported are files of version 3 without a
//! separate log file, and tables with rowids.

use super::ArchiveFile;
use crate::error::BuildError;

/// Pages within one another from a table's root to its rows.
const MAX_DEPTH: usize = 20;

/// Bytes of a row's header: types of at most a hundred columns.
const MAX_HEADER_BYTES: u64 = 1024;

/// Longest statement that made a table, bytes.
const MAX_STATEMENT_BYTES: u64 = 64 << 10;

/// Most tables, views and indices.
const MAX_OBJECTS: usize = 10_000;

/// A value of a row, or its location.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Null,
    Number(i64),
    Bytes(Content),
}

/// Text or bytes in a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Content {
    /// Offset of the row's payload in the file, and number of its bytes there.
    at: u64,
    local: u64,
    /// The first overflow page; 0 without one.
    overflow: u32,
    /// Offset of the value in the payload.
    first: u64,
    pub length: u64,
}

/// Callback for each row of a table: its rowid and its values.
type EachRow<'a> = dyn FnMut(i64, Vec<Value>, &mut Sqlite) -> Result<(), BuildError> + 'a;

/// A file.
pub(super) struct Sqlite {
    pub file: ArchiveFile,
    page_bytes: u64,
    /// Without what programs keep for themselves at its end.
    usable: u64,
    pages: u64,
}

/// A table or a view.
pub(super) struct Object {
    pub kind: String,
    pub name: String,
    pub root: u32,
    pub statement: String,
}

impl Sqlite {
    pub(super) fn open(mut file: ArchiveFile) -> Result<Self, BuildError> {
        let header = file.bytes(0, 100)?;
        let context = &file.context;
        let page_bytes = match u64::from(header[16]) << 8 | u64::from(header[17]) {
            1 => 65_536,
            bytes => bytes,
        };
        let usable = page_bytes.saturating_sub(u64::from(header[20]));
        if !page_bytes.is_power_of_two() || !(512..=65_536).contains(&page_bytes) || usable < 480 {
            return Err(context.damaged("an SQLite file with pages of no size"));
        }
        if header[59] > 1 {
            let advice =
                "write it as UTF-8 (`sqlite3 IN 'PRAGMA encoding=\"UTF-8\"; VACUUM INTO \"OUT\"'`)";
            return Err(context.rejected("holds text in UTF-16", advice));
        }
        let pages = file.length / page_bytes;
        Ok(Self {
            page_bytes,
            usable,
            pages,
            file,
        })
    }

    fn damaged(&self, cause: &str) -> BuildError {
        self.file.context.damaged(format!("SQLite: {cause}"))
    }

    /// All tables and views.
    pub(super) fn objects(&mut self) -> Result<Vec<Object>, BuildError> {
        let mut rows = Vec::new();
        self.rows(1, &mut |_, row, sqlite| {
            if rows.len() >= MAX_OBJECTS {
                return Err(sqlite.damaged("too many tables"));
            }
            rows.push(row);
            Ok(())
        })?;
        let mut objects = Vec::new();
        for row in rows {
            let [kind, name, _, root, statement] = row.as_slice() else {
                return Err(self.damaged("a list of tables of other than five columns"));
            };
            objects.push(Object {
                kind: self.text(kind)?,
                name: self.text(name)?,
                root: match root {
                    Value::Number(root) => u32::try_from(*root).unwrap_or(0),
                    _ => 0,
                },
                statement: self.text(statement)?,
            });
        }
        Ok(objects)
    }

    /// Short text; nothing for numbers.
    pub(super) fn text(&mut self, value: &Value) -> Result<String, BuildError> {
        match value {
            Value::Bytes(content) => {
                let bytes = self.content(content, MAX_STATEMENT_BYTES)?;
                Ok(String::from_utf8_lossy(&bytes).into_owned())
            }
            Value::Null | Value::Number(_) => Ok(String::new()),
        }
    }

    /// Walks over all rows of a table: its rowid and its values.
    pub(super) fn rows(&mut self, root: u32, each: &mut EachRow<'_>) -> Result<(), BuildError> {
        // Pages are counted: a circle would go on without end.
        let mut left = self.pages;
        self.page_rows(root, 0, &mut left, each)
    }

    fn page_rows(
        &mut self,
        page: u32,
        depth: usize,
        left: &mut u64,
        each: &mut EachRow<'_>,
    ) -> Result<(), BuildError> {
        if depth >= MAX_DEPTH || *left == 0 {
            return Err(self.damaged("pages in a circle"));
        }
        *left -= 1;
        let start = self.start_of(page)?;
        let bytes = self.file.bytes(start, self.page_bytes)?;
        // The first page begins with the header of the file.
        let header = if page == 1 { 100 } else { 0 };
        let is_leaf = match bytes[header] {
            13 => true,
            5 => false,
            _ => return Err(self.damaged("a page that belongs to no table with rowids")),
        };
        let count = usize::from(short(&bytes, header + 3));
        let cells = header + if is_leaf { 8 } else { 12 };
        if cells + 2 * count > bytes.len() {
            return Err(self.damaged("a page of too many rows"));
        }
        for n in 0..count {
            let at = usize::from(short(&bytes, cells + 2 * n));
            let cell = bytes.get(at..).unwrap_or_default();
            if is_leaf {
                let (rowid, row) = self.row(cell, start + at as u64)?;
                each(rowid, row, self)?;
            } else {
                let child = cell.first_chunk::<4>().copied();
                let child = child.ok_or_else(|| self.damaged("a page cut short"))?;
                self.page_rows(u32::from_be_bytes(child), depth + 1, left, each)?;
            }
        }
        if !is_leaf {
            let last = long(&bytes, header + 8);
            self.page_rows(last, depth + 1, left, each)?;
        }
        Ok(())
    }

    fn start_of(&self, page: u32) -> Result<u64, BuildError> {
        match page > 0 && u64::from(page) <= self.pages {
            true => Ok((u64::from(page) - 1) * self.page_bytes),
            false => Err(self.damaged("a page beyond the file's end")),
        }
    }

    /// The values of a row whose cell is at this offset of the file.
    fn row(&mut self, cell: &[u8], at: u64) -> Result<(i64, Vec<Value>), BuildError> {
        let short_row = || self.damaged("a row cut short");
        let mut rest = cell;
        let payload = varint(&mut rest).ok_or_else(short_row)?;
        let rowid = varint(&mut rest).ok_or_else(short_row)?;
        if payload > self.file.length {
            return Err(short_row());
        }
        let before = (cell.len() - rest.len()) as u64;
        // How much of a payload stays on its page, as the format prescribes.
        let (most, least) = (self.usable - 35, (self.usable - 12) * 32 / 255 - 23);
        let local = match payload <= most {
            true => payload,
            false => match least + (payload - least) % (self.usable - 4) {
                local if local <= most => local,
                _ => least,
            },
        };
        let stored = rest.get(..local as usize).ok_or_else(short_row)?;
        let overflow = match local < payload {
            true => long(
                rest.get(local as usize..local as usize + 4)
                    .ok_or_else(short_row)?,
                0,
            ),
            false => 0,
        };
        let mut header = stored;
        let header_bytes = varint(&mut header).ok_or_else(short_row)?;
        if header_bytes > MAX_HEADER_BYTES || header_bytes > local {
            return Err(self.damaged("a row of too many columns"));
        }
        let skipped = (stored.len() - header.len()) as u64;
        let types = header_bytes.checked_sub(skipped).ok_or_else(short_row)?;
        let mut types = &header[..types as usize];
        let (mut first, mut values) = (header_bytes, Vec::new());
        while !types.is_empty() {
            let kind = varint(&mut types).ok_or_else(short_row)?;
            let (value, length) = match kind {
                0 => (Value::Null, 0),
                1..=6 => {
                    let length = [1, 2, 3, 4, 6, 8][kind as usize - 1];
                    let bytes = stored.get(first as usize..(first + length) as usize);
                    let number = signed(bytes.ok_or_else(short_row)?);
                    (Value::Number(number), length)
                }
                // A float, which no column of tiles holds.
                7 => (Value::Null, 8),
                8 => (Value::Number(0), 0),
                9 => (Value::Number(1), 0),
                10 | 11 => return Err(self.damaged("a value of an unknown type")),
                kind => {
                    let length = (kind - 12) / 2;
                    let content = Content {
                        at: at + before,
                        local,
                        overflow,
                        first,
                        length,
                    };
                    (Value::Bytes(content), length)
                }
            };
            first = first
                .checked_add(length)
                .filter(|end| *end <= payload)
                .ok_or_else(short_row)?;
            values.push(value);
        }
        Ok((rowid as i64, values))
    }

    /// The bytes of a value, of at most so many.
    pub(super) fn content(&mut self, of: &Content, most: u64) -> Result<Vec<u8>, BuildError> {
        if of.length > most {
            return Err(self.damaged("a value that is too long"));
        }
        let end = of.first + of.length;
        let mut bytes = Vec::new();
        // End of the payload that has been passed.
        let mut passed = of.local;
        if of.first < of.local {
            let count = end.min(of.local) - of.first;
            bytes = self.file.bytes(of.at + of.first, count)?;
        }
        let (mut page, mut left) = (of.overflow, self.pages);
        while passed < end {
            left = left
                .checked_sub(1)
                .ok_or_else(|| self.damaged("pages in a circle"))?;
            let start = self.start_of(page)?;
            let whole = self.file.bytes(start, self.usable)?;
            let (next, data) = whole.split_at(4);
            let behind = passed + data.len() as u64;
            let first = of.first.clamp(passed, behind) - passed;
            let last = end.clamp(passed, behind) - passed;
            bytes.extend(&data[first as usize..last as usize]);
            passed = behind;
            page = long(next, 0);
        }
        Ok(bytes)
    }
}

fn short(bytes: &[u8], at: usize) -> u16 {
    u16::from_be_bytes([bytes[at], bytes[at + 1]])
}

fn long(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// A big-endian number of 1 to 8 bytes in two's complement.
fn signed(bytes: &[u8]) -> i64 {
    let negative = bytes.first().is_some_and(|byte| *byte >= 0x80);
    let start = if negative { -1 } else { 0 };
    bytes
        .iter()
        .fold(start, |number, byte| number << 8 | i64::from(*byte))
}

/// A number of 7 bits a byte, the highest first; a ninth byte has 8.
fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for n in 0..9 {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        if n == 8 {
            return Some(number << 8 | u64::from(*byte));
        }
        number = number << 7 | u64::from(byte & 0x7F);
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}
