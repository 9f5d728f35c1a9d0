//! Adjacent tiles of one size, read as one raster: one row of tiles is decoded at a time.

use super::archive::{Archive, MAX_TILE_FILE_BYTES, tile_name};
use super::row::{AlphaMeans, RasterRow, without_alpha};
use crate::error::BuildError;
use crate::source::{Extent, FileContext, SampleKind, SourceInfo, SourceLimits, read_extent};
use std::io::{Cursor, ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use terrella_files as files;

/// Longest side of a tile, texels.
pub const MAX_TILE_SIDE: u32 = 4096;

/// Damaged and missing tiles that are named; more are counted.
const MOST_NAMED: usize = 8;

/// Placeholders of a tile's column and row in a path, as in the addresses of `pack fetch`.
const COLUMN_WORDS: [&str; 3] = ["{column}", "{x}", "{TileCol}"];
const ROW_WORDS: [&str; 3] = ["{row}", "{y}", "{TileRow}"];

/// The row from the south, as TMS counts.
const SOUTH_ROW_WORD: &str = "{-y}";

/// Tiles of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct TileSet {
    /// Path of a tile, with placeholders for its row and column; or the archive of all tiles.
    pub path: PathBuf,
    /// The level of the tiles of a file that holds all.
    pub archive_level: Option<u8>,
    /// Texels of a tile's side.
    pub tile_size: u32,
    /// Columns of the grid that are there, from the west.
    pub columns: Range<u32>,
    /// Rows of the grid that are there, from the north.
    pub rows: Range<u32>,
    /// Rows of the whole grid.
    pub grid_rows: u32,
    /// Width of all columns on the Earth, texels: the last tile of a row may extend beyond it.
    pub width: u32,
}

impl TileSet {
    /// The file of a tile.
    pub fn file(&self, row: u32, column: u32) -> PathBuf {
        if let Some(level) = self.archive_level {
            return tile_name(&self.path, level, row, column);
        }
        let south_row = (self.grid_rows - 1).saturating_sub(row);
        let fill = |text: String, words: &[&str], number: u32| {
            let number = number.to_string();
            words
                .iter()
                .fold(text, |text, word| text.replace(word, &number))
        };
        let text = self.path.to_string_lossy().into_owned();
        let text = fill(text, &COLUMN_WORDS, column);
        let text = fill(text, &ROW_WORDS, row);
        fill(text, &[SOUTH_ROW_WORD], south_row).into()
    }

    /// The error in a tile path, for a grid of this many rows, if any.
    pub(super) fn path_complaint(path: &str, grid_rows: f64) -> Option<String> {
        let has = |words: &[&str]| words.iter().any(|word| path.contains(word));
        let is_south_row = path.contains(SOUTH_ROW_WORD);
        if !has(&COLUMN_WORDS) || !(has(&ROW_WORDS) || is_south_row) {
            return Some(
                "tiles must have {row} and {column} in its path, or {y} and {x}, or {-y}, the row from the south, and {x}"
                    .to_string(),
            );
        }
        // Where the last row reaches beyond the pole, rows from the south would begin elsewhere.
        (is_south_row && (grid_rows - grid_rows.round()).abs() > 1e-6).then(|| {
            "{-y} counts rows from the south, which tile_deg must divide: give {y} and rows from the north".to_string()
        })
    }

    /// Width and height of all tiles, texels.
    pub fn size(&self) -> (u32, u32) {
        let side = |range: &Range<u32>| (range.len() as u32).saturating_mul(self.tile_size);
        (side(&self.columns).min(self.width), side(&self.rows))
    }

    /// The first tile's kind of texels; tiles that are missing or damaged are skipped.
    fn probe(&self, limits: SourceLimits, archive: &mut Option<Archive>) -> Option<SourceInfo> {
        let all = self.rows.clone().flat_map(|row| {
            let columns = self.columns.clone();
            columns.map(move |column| (row, column))
        });
        all.into_iter().find_map(|(row, column)| {
            let path = self.file(row, column);
            let bytes = tile_bytes(archive, &path, (row, column)).ok()?;
            let rows = read_extent(Cursor::new(bytes), &path, limits, Extent::Piece).ok()?;
            Some(rows.info())
        })
    }
}

/// Rows of tiles.
pub(super) struct TileRows {
    set: TileSet,
    /// The file that holds all tiles.
    archive: Option<Archive>,
    alpha: AlphaMeans,
    limits: SourceLimits,
    info: SourceInfo,
    /// Rows given or left out so far.
    given: u32,
    /// The row of tiles that is held, from the first.
    held: Option<u32>,
    bytes: Vec<u8>,
    cover: Vec<u8>,
    /// Of each row of the tiles, whether all is there.
    is_whole: bool,
    missing: Left,
    damaged: Left,
}

/// Tiles that are left out.
#[derive(Default)]
struct Left {
    count: u64,
    named: Vec<String>,
}

impl Left {
    fn add(&mut self, name: String) {
        self.count += 1;
        if self.named.len() < MOST_NAMED {
            self.named.push(name);
        }
    }

    fn tell(&mut self, what: &str) -> Option<String> {
        let Self { count, named } = std::mem::take(self);
        let more = count - named.len() as u64;
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        (count > 0).then(|| format!("{count} {what}, left out: {}{more}", named.join("; ")))
    }
}

impl TileRows {
    /// Looks at the tiles; at least one must be readable.
    pub(super) fn open(
        set: &TileSet,
        alpha: AlphaMeans,
        limits: SourceLimits,
        description: &Path,
    ) -> Result<Self, BuildError> {
        let context = FileContext::new(description);
        let mut archive = match set.archive_level {
            Some(_) => Some(Archive::open(&set.path)?),
            None => None,
        };
        let Some(first) = set.probe(limits, &mut archive) else {
            return Err(context.rejected(
                format!(
                    "none of the {} tiles {} can be read",
                    set.columns.len() as u64 * set.rows.len() as u64,
                    set.path.display()
                ),
                "correct the path and the ranges of columns and rows, or fetch the tiles again",
            ));
        };
        let (width, height) = set.size();
        let channels = if first.channels >= 3 || first.sample == SampleKind::U8 {
            3
        } else {
            1
        };
        let texel_bytes = (channels * first.sample.bytes()) as u64 + 1;
        // A row of tiles, one tile as it is decoded and its file.
        let tile = u64::from(set.tile_size) * u64::from(set.tile_size) * 4 * texel_bytes;
        let held = u64::from(width) * u64::from(set.tile_size) * texel_bytes + tile;
        if held > limits.buffer_bytes {
            return Err(context.too_large(
                "a row of tiles",
                held,
                limits,
                "give a smaller region or a coarser level, or allow more --memory",
            ));
        }
        Ok(Self {
            info: SourceInfo {
                file: first.file,
                width,
                height,
                channels,
                sample: first.sample,
                opacity: None,
                buffer_bytes: held,
            },
            set: set.clone(),
            archive,
            alpha,
            limits,
            given: 0,
            held: None,
            bytes: Vec::new(),
            cover: Vec::new(),
            is_whole: false,
            missing: Left::default(),
            damaged: Left::default(),
        })
    }

    /// Size and texel format of all tiles.
    pub(super) fn info(&self) -> SourceInfo {
        self.info
    }

    /// Skips this many rows; tiles entirely in skipped rows are not read.
    pub(super) fn skip(&mut self, count: u32) {
        self.given += count;
    }

    /// Fills the next row.
    pub(super) fn next_row(&mut self, row: &mut RasterRow) -> Result<(), BuildError> {
        let tile_row = self.given / self.set.tile_size;
        if self.held != Some(tile_row) {
            self.read_tiles(tile_row)?;
            self.held = Some(tile_row);
        }
        // In range: the tiles of a row are held completely.
        let inside = (self.given % self.set.tile_size) as usize;
        let width = self.info.width as usize;
        let row_bytes = self.info.row_bytes();
        row.bytes.clear();
        row.bytes
            .extend_from_slice(&self.bytes[inside * row_bytes..][..row_bytes]);
        row.cover.clear();
        row.cover
            .extend_from_slice(&self.cover[inside * width..][..width]);
        row.is_whole = self.is_whole;
        self.given += 1;
        Ok(())
    }

    fn read_tiles(&mut self, tile_row: u32) -> Result<(), BuildError> {
        let rows = self.set.tile_size as usize;
        self.bytes.resize(rows * self.info.row_bytes(), 0);
        self.cover.clear();
        self.cover.resize(rows * self.info.width as usize, 0);
        self.is_whole = true;
        for place in 0..self.set.columns.len() as u32 {
            let (row, column) = (
                self.set.rows.start + tile_row,
                self.set.columns.start + place,
            );
            let path = self.set.file(row, column);
            match self.read_tile(&path, (row, column), place) {
                Ok(is_whole) => self.is_whole &= is_whole,
                Err(left_out) => {
                    self.is_whole = false;
                    match left_out {
                        BuildError::Unreadable { source, .. }
                            if source.kind() == ErrorKind::NotFound =>
                        {
                            self.missing.add(path.display().to_string());
                        }
                        error @ (BuildError::Damaged { .. } | BuildError::Source { .. }) => {
                            self.clear_tile(place);
                            self.damaged.add(error.to_string());
                        }
                        error => return Err(error),
                    }
                }
            }
        }
        Ok(())
    }

    /// A tile whose decoding fails in the middle counts as missing.
    fn clear_tile(&mut self, place: u32) {
        let (width, side) = (self.info.width as usize, self.set.tile_size as usize);
        let start = place as usize * side;
        for row in self.cover.chunks_exact_mut(width) {
            row[start..width.min(start + side)].fill(0);
        }
    }

    /// Reads a tile into its place; whether all of it is there.
    fn read_tile(&mut self, path: &Path, at: (u32, u32), place: u32) -> Result<bool, BuildError> {
        let context = FileContext::new(path);
        let side = self.set.tile_size as usize;
        let bytes = tile_bytes(&mut self.archive, path, at)?;
        let mut source = read_extent(Cursor::new(bytes), path, self.limits, Extent::Piece)?;
        let info = source.info();
        if (info.width, info.height) != (self.set.tile_size, self.set.tile_size) {
            return Err(context.damaged(format!(
                "it has {} x {} texels and must have {side} x {side}",
                info.width, info.height
            )));
        }
        if info.sample != self.info.sample {
            return Err(context.damaged(format!(
                "it holds {} texels and the others {} ones",
                info.sample, self.info.sample
            )));
        }
        let (row_bytes, width) = (self.info.row_bytes(), self.info.width as usize);
        let texel = self.info.channels * info.sample.bytes();
        let (start, mut is_whole) = (place as usize * side, true);
        let run = side.min(width - start);
        let (mut coded, mut row) = (vec![0; info.row_bytes()], RasterRow::default());
        for y in 0..side {
            source.next_row(&mut coded)?;
            without_alpha(&info, self.alpha, &coded, &mut row);
            let out = &mut self.bytes[y * row_bytes + start * texel..][..run * texel];
            let seen = row.bytes.len() / side * run;
            copy_channels(&row.bytes[..seen], out, texel, info.sample.bytes());
            self.cover[y * width + start..][..run].copy_from_slice(&row.cover[..run]);
            is_whole &= row.is_whole;
        }
        Ok(is_whole)
    }

    /// Remarks about omitted tiles since the last call.
    pub(super) fn notes(&mut self) -> Vec<String> {
        let missing = self.missing.tell("tiles are not there");
        missing
            .into_iter()
            .chain(self.damaged.tell("tiles are damaged"))
            .collect()
    }
}

/// Copies texels of `texel` bytes, or grey ones of `sample` bytes into each channel. Colour in a grey raster gives its first channel.
fn copy_channels(from: &[u8], to: &mut [u8], texel: usize, sample: usize) {
    if from.len() == to.len() {
        to.copy_from_slice(from);
        return;
    }
    let step = from.len() / (to.len() / texel);
    for (from, to) in from.chunks_exact(step).zip(to.chunks_exact_mut(texel)) {
        for channel in to.chunks_exact_mut(sample) {
            channel.copy_from_slice(&from[..sample]);
        }
    }
}

/// The file of a tile, by its row and column.
fn tile_bytes(
    archive: &mut Option<Archive>,
    path: &Path,
    (row, column): (u32, u32),
) -> Result<Vec<u8>, BuildError> {
    let unreadable = |error| FileContext::new(path).unreadable(error);
    match archive {
        None => read_file(path).map_err(unreadable),
        Some(archive) => archive
            .tile(row, column)?
            .ok_or_else(|| unreadable(ErrorKind::NotFound.into())),
    }
}

fn read_file(path: &Path) -> std::io::Result<Vec<u8>> {
    let file = files::open(path)?;
    let mut bytes = Vec::new();
    // A file truncated here is corrupt to its decoder.
    file.take(MAX_TILE_FILE_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}
