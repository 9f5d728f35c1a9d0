//! Finds the only file of a kind in a zip file (PKWARE, APPNOTE 6.3): stored or deflated, in one part, without a
//! password.

use super::HeightFileError;
use super::error::FileContext;
use std::io::{Read, Seek, SeekFrom};
use terrella_files::excerpt;

/// Maximum size of the central directory, bytes.
const LIST_BYTES: u64 = 1 << 20;

/// Range at the end of a zip file that contains the end record: 22 bytes and a comment.
const END_BYTES: u64 = 22 + 65_535;

/// A file in a zip file.
#[derive(Debug)]
pub(super) struct ZipEntry {
    pub name: String,
    /// Uncompressed size, bytes.
    pub bytes: u64,
    /// Offset and size of its compressed bytes.
    pub start: u64,
    pub packed_bytes: u64,
    pub is_deflated: bool,
    /// CRC-32 of the uncompressed bytes.
    pub crc: u32,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

impl ZipEntry {
    /// The only file with this extension.
    pub(super) fn find<R: Read + Seek>(
        reader: &mut R,
        ending: &str,
        context: &FileContext,
    ) -> Result<Self, HeightFileError> {
        let damaged = || context.damaged("the list of the zip file's contents is not one");
        let list = list_of(reader, context)?;
        let mut found: Option<(Self, u64)> = None;
        let mut rest = list.as_slice();
        while rest.starts_with(b"PK\x01\x02") {
            let lengths = [28, 30, 32].map(|at| u16_at(rest, at).map(usize::from));
            let [Some(name_length), Some(extra), Some(remark)] = lengths else {
                return Err(damaged());
            };
            let name = rest.get(46..46 + name_length).ok_or_else(damaged)?;
            let name = String::from_utf8_lossy(name).into_owned();
            let (entry, local) = Self::of(rest, name, context)?.ok_or_else(damaged)?;
            rest = rest
                .get(46 + name_length + extra + remark..)
                .unwrap_or_default();
            // macOS adds these files itself.
            if !entry.name.to_ascii_lowercase().ends_with(ending)
                || entry.name.starts_with("__MACOSX/")
            {
                continue;
            }
            if let Some((other, _)) = &found {
                return Err(context.rejected(
                    format!(
                        "holds {} and {}",
                        excerpt(&other.name),
                        excerpt(&entry.name)
                    ),
                    "one file of heights",
                    "unzip it, and give the files or their folder",
                ));
            }
            found = Some((entry, local));
        }
        let Some((mut entry, local)) = found else {
            return Err(context.rejected(
                format!("is a zip file without a file whose name ends in {ending}"),
                "a file of heights, or a zip file that holds one of SRTM",
                "unzip it",
            ));
        };
        let mut head = [0; 30];
        let read = reader
            .seek(SeekFrom::Start(local))
            .and_then(|_| reader.read_exact(&mut head));
        read.map_err(|error| context.reading(error))?;
        let after = [26, 28].map(|at| u16_at(&head, at).unwrap_or_default());
        if !head.starts_with(b"PK\x03\x04") {
            return Err(damaged());
        }
        entry.start = local + 30 + u64::from(after[0]) + u64::from(after[1]);
        Ok(entry)
    }

    /// Parses a directory entry; the offset is that of the local header. `None` if the entry is cut
    /// off.
    fn of(
        line: &[u8],
        name: String,
        context: &FileContext,
    ) -> Result<Option<(Self, u64)>, HeightFileError> {
        let numbers = || {
            Some((
                u16_at(line, 8)?,
                u16_at(line, 10)?,
                [16, 20, 24, 42].map(|at| u32_at(line, at).unwrap_or_default()),
            ))
        };
        let Some((flags, method, [crc, packed, bytes, local])) = numbers() else {
            return Ok(None);
        };
        let is_locked = flags & 1 != 0;
        if is_locked || !matches!(method, 0 | 8) || [packed, bytes, local].contains(&u32::MAX) {
            return Err(context.rejected(
                format!("holds {} in a form that is not read", excerpt(&name)),
                "a zip file below 4 GB, stored or deflated, without a password",
                "unzip it",
            ));
        }
        let entry = Self {
            name,
            bytes: u64::from(bytes),
            start: 0,
            packed_bytes: u64::from(packed),
            is_deflated: method == 8,
            crc,
        };
        Ok(Some((entry, u64::from(local))))
    }
}

/// The central directory.
fn list_of<R: Read + Seek>(
    reader: &mut R,
    context: &FileContext,
) -> Result<Vec<u8>, HeightFileError> {
    let reading = |error| context.reading(error);
    let length = reader.seek(SeekFrom::End(0)).map_err(reading)?;
    reader
        .seek(SeekFrom::Start(length.saturating_sub(END_BYTES)))
        .map_err(reading)?;
    let mut end = Vec::new();
    reader
        .take(END_BYTES)
        .read_to_end(&mut end)
        .map_err(reading)?;
    let at = end.windows(4).rposition(|mark| mark == b"PK\x05\x06");
    let end = at.map(|at| &end[at..]).unwrap_or_default();
    let (Some(bytes), Some(start)) = (u32_at(end, 12), u32_at(end, 16)) else {
        return Err(context.damaged("the zip file has no end"));
    };
    let (bytes, start) = (u64::from(bytes), u64::from(start));
    if bytes > LIST_BYTES || start > length {
        return Err(context.rejected(
            "is a zip file of very many files",
            "one that holds one file of heights",
            "unzip it",
        ));
    }
    reader.seek(SeekFrom::Start(start)).map_err(reading)?;
    let mut list = Vec::new();
    reader.take(bytes).read_to_end(&mut list).map_err(reading)?;
    Ok(list)
}
