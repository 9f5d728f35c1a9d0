//! Progress of a build, line by line, so that it can be continued after any interruption.
//!
//! ```text
//! terrella build 1
//! <fingerprint of maps and options>
//! plain day 1350 0 123456 <checksum>
//! plain day 2700/2 0/3 123456 <checksum>
//! heights 0 37 120 23456 <checksum> <lowest> <highest>
//! ```
//!
//! Storage, map, texels per block, block, bytes; for levels that are cut into parts also the number of parts along a block's side, and the part.
//! For elevation tiles level, row and column, bytes, and the bits of the lowest and the highest elevation.
//!
//! A line without a line feed, or with invalid content, was truncated: it and all lines after it do not count.

use super::error::BuildError;
use super::locked_journal::{LockedJournal, read_text};
use super::tile_name::TileName;
use std::fs::{self, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_imagery::pack::{HeightPlace, HeightRecord, TileFile};
use terrella_imagery::tile::{MapLayer, Storage};

/// Name of the journal in the pack's folder.
pub(super) const JOURNAL_FILE: &str = "build.journal";

/// File name of the journal for a share of a build, which a separate process makes.
pub(super) fn share_journal_file(share: &str) -> String {
    format!("build-{share}.journal")
}

/// Whether a file name is that of a share's journal.
pub(super) fn is_share_journal(name: &str) -> bool {
    name.starts_with("build-") && name.ends_with(".journal")
}

const FIRST_LINE: &str = "terrella build 1";

/// First word of a line about an elevation tile.
const HEIGHTS: &str = "heights";

/// A line of the journal.
pub(super) enum Noted {
    Tile(TileName, TileFile),
    Heights(HeightRecord),
}

/// The open, locked journal.
pub(super) struct Journal {
    path: PathBuf,
    lines: LockedJournal,
}

impl Journal {
    /// Opens or makes the one of this name and locks it.
    pub(super) fn open(dir: &Path, name: &str) -> Result<Self, BuildError> {
        let path = dir.join(name);
        match LockedJournal::open(&path) {
            Ok(lines) => Ok(Self { path, lines }),
            Err(TryLockError::WouldBlock) => Err(BuildError::Busy {
                path: dir.to_path_buf(),
            }),
            Err(TryLockError::Error(source)) => Err(BuildError::Write { path, source }),
        }
    }

    /// The tiles recorded in the journal of another process or run; none if it belongs to another build.
    pub(super) fn tiles_of(path: &Path, fingerprint: &str) -> Vec<Noted> {
        match files::open(path).and_then(|mut file| read_text(&mut file)) {
            Ok((text, _)) if begins_with(&text, fingerprint) => parse_all(&text).0,
            _ => Vec::new(),
        }
    }

    /// Whether no tile of any build was ever noted: it is empty, or the beginning of a journal of this build was cut off.
    pub(super) fn is_empty(&self, fingerprint: &str) -> bool {
        self.lines.is_empty(&beginning(fingerprint))
    }

    /// Whether it belongs to this build.
    pub(super) fn has_fingerprint(&self, fingerprint: &str) -> bool {
        begins_with(self.lines.text(), fingerprint)
    }

    /// Empties it and begins a build.
    pub(super) fn begin(&mut self, fingerprint: &str) -> Result<(), BuildError> {
        let begun = self.lines.begin(&beginning(fingerprint));
        begun.map_err(|error| self.fail(error))
    }

    /// The tiles recorded when it was opened. A truncated line is removed, so that new lines start correctly.
    pub(super) fn tiles(&mut self) -> Vec<Noted> {
        let (tiles, good) = parse_all(self.lines.text());
        self.lines.cut(good);
        tiles
    }

    /// Notes a tile.
    pub(super) fn note(&mut self, name: TileName, file: TileFile) -> Result<(), BuildError> {
        let checksum = hex(file);
        let (pixels, block) = (name.pixels, name.block);
        let place = match name.parts {
            1 => format!("{pixels} {block}"),
            parts => format!("{pixels}/{parts} {block}/{}", name.part),
        };
        let line = format!(
            "{} {} {place} {} {checksum}\n",
            name.storage.name(),
            name.layer.name(),
            file.bytes
        );
        self.append(&line)
    }

    /// Records an elevation tile.
    pub(super) fn note_heights(&mut self, record: &HeightRecord) -> Result<(), BuildError> {
        let HeightPlace { level, row, column } = record.place;
        let [low, high] = [record.low_m, record.high_m].map(f32::to_bits);
        let (bytes, checksum) = (record.file.bytes, hex(record.file));
        self.append(&format!(
            "{HEIGHTS} {level} {row} {column} {bytes} {checksum} {low:08x} {high:08x}\n"
        ))
    }

    fn append(&mut self, line: &str) -> Result<(), BuildError> {
        let appended = self.lines.append(line);
        appended.map_err(|error| self.fail(error))
    }

    pub(super) fn sync(&self) -> Result<(), BuildError> {
        self.lines.sync().map_err(|error| self.fail(error))
    }

    fn fail(&self, source: io::Error) -> BuildError {
        BuildError::Write {
            path: self.path.clone(),
            source,
        }
    }

    /// The build is over.
    pub(super) fn remove(self) -> Result<(), BuildError> {
        fs::remove_file(&self.path).map_err(|error| self.fail(error))
    }
}

fn beginning(fingerprint: &str) -> String {
    format!("{FIRST_LINE}\n{fingerprint}\n")
}

fn begins_with(text: &str, fingerprint: &str) -> bool {
    text.starts_with(&beginning(fingerprint))
}

/// The records of a journal, and the length of its valid part in bytes.
fn parse_all(text: &str) -> (Vec<Noted>, usize) {
    let mut tiles = Vec::new();
    let mut good = 0;
    for (n, line) in text.split_inclusive('\n').enumerate() {
        let Some(whole) = line.strip_suffix('\n') else {
            break;
        };
        if n >= 2 {
            let Some(tile) = parse(whole) else { break };
            tiles.push(tile);
        }
        good += line.len();
    }
    (tiles, good)
}

fn hex(file: TileFile) -> String {
    let bytes = file.checksum.iter();
    bytes.map(|byte| format!("{byte:02x}")).collect()
}

fn parse(line: &str) -> Option<Noted> {
    let words: Vec<&str> = line.split(' ').collect();
    if let [HEIGHTS, level, row, column, bytes, digits, low, high] = words.as_slice() {
        let height_m = |bits: &str| u32::from_str_radix(bits, 16).ok().map(f32::from_bits);
        return Some(Noted::Heights(HeightRecord {
            place: HeightPlace {
                level: level.parse().ok()?,
                row: row.parse().ok()?,
                column: column.parse().ok()?,
            },
            file: parse_file(bytes, digits)?,
            low_m: height_m(low)?,
            high_m: height_m(high)?,
        }));
    }
    let [storage, layer, pixels, block, bytes, digits] = words.as_slice() else {
        return None;
    };
    let storage = Storage::ALL
        .into_iter()
        .find(|kind| kind.name() == *storage)?;
    let (pixels, parts) = pixels.split_once('/').unwrap_or((pixels, "1"));
    let (block, part) = block.split_once('/').unwrap_or((block, "0"));
    let name = TileName {
        storage,
        layer: MapLayer::from_name(layer)?,
        pixels: pixels.parse().ok()?,
        parts: parts.parse().ok()?,
        block: block.parse().ok()?,
        part: part.parse().ok()?,
    };
    // Only a valid tile.
    name.path()?;
    Some(Noted::Tile(name, parse_file(bytes, digits)?))
}

fn parse_file(bytes: &str, digits: &str) -> Option<TileFile> {
    let mut checksum = [0; 16];
    if digits.len() != 32 || !digits.is_ascii() {
        return None;
    }
    for (n, byte) in checksum.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&digits[2 * n..2 * n + 2], 16).ok()?;
    }
    let bytes = bytes.parse().ok()?;
    Some(TileFile { bytes, checksum })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TILES: [&str; 2] = [
        "plain day 1350 0 123456 000102030405060708090a0b0c0d0e0f\n",
        "heights 0 37 120 23456 000102030405060708090a0b0c0d0e0f 00000000 3f800000\n",
    ];

    /// Cut off anywhere, with or without what a power failure leaves behind it.
    #[test]
    fn a_cut_journal_keeps_the_lines_before_the_cut() {
        let root = tempfile::tempdir().expect("a folder");
        let path = root.path().join(JOURNAL_FILE);
        let head = beginning("abc");
        let text = [&head, TILES[0], TILES[1]].concat();
        let ends = [head.len() + TILES[0].len(), text.len()];
        for length in 0..=text.len() {
            for tail in [&b""[..], b"\0\0\0", b"\xff\xfe\n"] {
                fs::write(&path, [&text.as_bytes()[..length], tail].concat()).expect("writes");
                let noted = ends.iter().filter(|end| length >= **end).count();
                assert_eq!(Journal::tiles_of(&path, "abc").len(), noted, "{length}");
                let mut journal = Journal::open(root.path(), JOURNAL_FILE).expect("opens");
                assert_eq!(
                    journal.has_fingerprint("abc"),
                    length >= head.len(),
                    "{length}"
                );
                let is_cut_head = tail.is_empty() && length <= head.len();
                assert_eq!(journal.is_empty("abc"), is_cut_head, "{length}");
                if !journal.has_fingerprint("abc") {
                    continue;
                }
                // Records added from now on are valid the next time.
                assert_eq!(journal.tiles().len(), noted, "{length}");
                journal.append(TILES[0]).expect("notes");
                drop(journal);
                assert_eq!(Journal::tiles_of(&path, "abc").len(), noted + 1, "{length}");
            }
        }
    }

    #[test]
    fn a_journal_of_another_build_is_not_empty() {
        let root = tempfile::tempdir().expect("a folder");
        fs::write(root.path().join(JOURNAL_FILE), beginning("other")).expect("writes");
        let journal = Journal::open(root.path(), JOURNAL_FILE).expect("opens");
        assert!(!journal.has_fingerprint("abc") && !journal.is_empty("abc"));
    }
}
