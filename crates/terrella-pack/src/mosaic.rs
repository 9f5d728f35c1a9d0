//! Several maps as one: georeferenced files and tiles, layered over one another, on one grid of latitudes and longitudes.
//!
//! | file | content |
//! |---|---|
//! | `description.rs` | the description of a mosaic: a TOML file, or a folder |
//! | `virtual_raster.rs` | GDAL's `.vrt` as such a description, and windows of files |
//! | `archive.rs`, `archive_part.rs` | tile archives, MBTiles and PMTiles, and such a file as a part |
//! | `place.rs`, `georeference.rs` | position of a part, sources of the georeference, and coordinate systems |
//! | `target.rs`, `axis.rs` | the target grid, and the sources of its texels |
//! | `raster.rs`, `tiles.rs`, `row.rs`, `texels.rs` | rows of a file or of tiles, and their texels as numbers |
//! | `held.rs` | maps that run from south to north, and projected ones |
//! | `piece.rs`, `compose.rs` | a part on the grid; all parts layered |
//! | `matching.rs` | colours of a part scaled to those beneath it |
//!
//! Parts are read once, from north to south, with a few rows of each in memory. A row of one part whose texels coincide with the grid is copied
//! byte for byte; all others are averaged or interpolated in linear light. Damaged parts and tiles are left out and reported. Missing parts, and
//! parts without georeference, are errors.

mod archive;
mod archive_part;
mod axis;
mod compose;
mod description;
mod georeference;
mod held;
mod matching;
mod piece;
mod place;
mod raster;
mod row;
mod target;
#[cfg(test)]
mod tests;
mod texels;
mod tiles;
mod virtual_raster;

pub(crate) use archive::is_archive;
#[cfg(feature = "fetch")]
pub(crate) use description::syntax_complaint;
pub use description::{Description, MAX_DESCRIPTION_BYTES, MOSAIC_FILE, Part, PartSource};
pub(super) use georeference::check_whole_earth;
pub use georeference::{Stated, world_place};
pub use place::{Bounds, Crs, MERCATOR_END_DEG, RasterPlacement, Window};
pub use target::Target;
pub use texels::Encoding;
pub use tiles::TileSet;

use super::error::BuildError;
use super::source::{
    FileContext, MAX_PIECE_SIDE, MAX_SOURCE_HEIGHT, MIN_SOURCE_HEIGHT, RowSource, SampleKind,
    SourceInfo, SourceLimits, files_beside,
};
use compose::Composer;
use piece::Piece;
use std::path::{Path, PathBuf};
use texels::{TexelKind, Writer};

/// A checked mosaic: all parts exist and are georeferenced.
#[derive(Clone, Debug)]
pub struct Mosaic {
    path: PathBuf,
    description: Description,
    pieces: Vec<Piece>,
    target: Target,
    kind: TexelKind,
    info: SourceInfo,
    notes: Vec<String>,
}

impl Mosaic {
    /// Opens the mosaic at a path, a description or a folder, for the whole Earth or a part of it.
    ///
    /// # Errors
    /// [`BuildError`] with the part and the remedy.
    pub fn open(
        path: &Path,
        window: Option<&Bounds>,
        limits: SourceLimits,
    ) -> Result<Self, BuildError> {
        let description = Description::read(path)?;
        Self::of(description, path, window, limits)
    }

    /// Looks at the parts of a description; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn of(
        description: Description,
        path: &Path,
        window: Option<&Bounds>,
        limits: SourceLimits,
    ) -> Result<Self, BuildError> {
        let context = FileContext::new(path);
        let mut notes = Vec::new();
        let mut pieces = Vec::new();
        for part in &description.parts {
            match Piece::look(part, path, limits) {
                Ok(piece) => pieces.push(piece),
                Err(error @ BuildError::Damaged { .. }) => {
                    notes.push(format!("{error}; it is left out"));
                }
                Err(error) => return Err(error),
            }
        }
        if description.is_unordered {
            // The coarsest is lowest; equal ones are in order of their names.
            pieces.sort_by(|a, b| b.place.column_deg.total_cmp(&a.place.column_deg));
        }
        let Some(first) = pieces.first() else {
            return Err(
                context.rejected("has no part that is whole", "copy or fetch its files again")
            );
        };
        let sample = first.kind().sample;
        let kind = TexelKind {
            channels: pieces
                .iter()
                .map(|piece| piece.kind().channels)
                .max()
                .unwrap_or(1),
            sample,
        };
        let other = pieces.iter().find(|piece| {
            let is_integer = matches!(sample, SampleKind::U16 | SampleKind::I16);
            piece.kind().sample != sample || (is_integer && piece.info.file != first.info.file)
        });
        if let Some(other) = other {
            return Err(FileContext::new(other.part.from.name()).rejected(
                format!(
                    "holds {} texels of another kind of file or number than the other parts",
                    other.kind().sample
                ),
                "convert all parts of a mosaic to one kind",
            ));
        }
        if kind.is_colour() && matches!(sample, SampleKind::I16 | SampleKind::F32) {
            return Err(context.rejected(
                format!("holds {sample} colour"),
                "convert it to 8 or 16 bits",
            ));
        }
        let finest_deg = pieces
            .iter()
            .map(|piece| piece.place.column_deg)
            .fold(360.0, f64::min);
        let target = target(&description, window, finest_deg, &context)?;
        check_worth(&pieces, &target, &context)?;
        let buffer_bytes = most_bytes(&pieces, &target);
        if buffer_bytes > limits.buffer_bytes {
            return Err(context.too_large(
                "its parts that lie side by side",
                buffer_bytes,
                limits,
                "give fewer or smaller parts, a smaller width, or allow more --memory",
            ));
        }
        notes.extend(matching::match_pieces(&mut pieces, kind, path, limits)?);
        Ok(Self {
            info: SourceInfo {
                file: pieces[0].info.file,
                width: target.columns,
                height: target.rows,
                channels: kind.channels,
                sample,
                opacity: None,
                buffer_bytes,
            },
            path: path.to_path_buf(),
            description,
            pieces,
            target,
            kind,
            notes,
        })
    }

    /// Size and texels of the map that it is.
    pub fn info(&self) -> SourceInfo {
        self.info
    }

    /// The grid of that map.
    pub fn target(&self) -> Target {
        self.target
    }

    /// Its name, if given.
    pub fn name(&self) -> Option<&str> {
        self.description.name.as_deref()
    }

    /// Whose data it is.
    pub fn attribution(&self) -> &[String] {
        &self.description.attribution
    }

    /// Remarks about parts that were left out or changed when it was opened.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Differences of parts' colours from sRGB, according to their files.
    pub(super) fn colour_notes(&self) -> impl Iterator<Item = String> + '_ {
        self.pieces.iter().filter_map(|piece| {
            let note = piece.colour_note.as_ref()?;
            Some(format!("{}: {note}", piece.part.from.name().display()))
        })
    }

    /// All its files; for tiles the existing ones, for files also those beside them.
    pub(super) fn files(&self) -> impl Iterator<Item = PathBuf> + '_ {
        self.description.parts.iter().flat_map(|part| {
            let files: Box<dyn Iterator<Item = PathBuf>> = match &part.from {
                PartSource::File(path, _) | PartSource::Placed(path, ..) => {
                    Box::new(std::iter::once(path.clone()).chain(files_beside(path)))
                }
                PartSource::Tiles(set, _) if set.archive_level.is_some() => {
                    Box::new(std::iter::once(set.path.clone()))
                }
                PartSource::Tiles(set, _) => Box::new(set.rows.clone().flat_map(move |row| {
                    set.columns.clone().map(move |column| set.file(row, column))
                })),
            };
            files
        })
    }

    /// The files of its parts whose numbers mean what they are, not a code of colours.
    pub(super) fn plain_files(&self) -> impl Iterator<Item = &Path> {
        self.pieces
            .iter()
            .filter_map(|piece| match &piece.part.from {
                PartSource::File(path, _) | PartSource::Placed(path, ..)
                    if piece.part.encoding.is_none() =>
                {
                    Some(path.as_path())
                }
                _ => None,
            })
    }

    /// Its identity: a text that differs whenever its texels may differ.
    pub(super) fn identity(&self) -> String {
        format!("{:?} {:?}", self.description, self.target)
    }

    /// Its rows.
    pub fn rows(&self, limits: SourceLimits) -> MosaicRows {
        MosaicRows {
            given: 0,
            writer: Writer::new(self.kind, self.description.fill.as_deref()),
            state: Composer::new(
                self.pieces.clone(),
                self.target,
                self.kind,
                self.path.clone(),
                limits,
            ),
            info: self.info,
            empty: 0,
            reported: false,
        }
    }
}

/// Number of columns below which the size is not checked: the work takes seconds.
const UNPROVEN_COLUMNS: u32 = 8192;

/// So many times as wide a map may be made as its finest part would make it. More is interpolation and nothing else.
const MOST_ENLARGED: f64 = 8.0;

/// Largest ratio of target texels to source texels. Small parts of a very fine map would take hours and fill almost nothing of it.
const MOST_MADE: u64 = 4096;

/// Rejects a map that is far too large for its parts.
fn check_worth(pieces: &[Piece], target: &Target, context: &FileContext) -> Result<(), BuildError> {
    let texels = |width: u32, height: u32| u64::from(width) * u64::from(height);
    let given: u64 = pieces
        .iter()
        .map(|piece| texels(piece.info.width, piece.info.height))
        .sum();
    let made = texels(target.columns, target.rows);
    if target.columns <= UNPROVEN_COLUMNS || made / MOST_MADE <= given {
        return Ok(());
    }
    Err(context.rejected(
        format!(
            "would be a map of {} x {} texels, and its parts have {given} in all",
            target.columns, target.rows
        ),
        "give it a smaller width, or correct the parts' bounds, or lay them over a finer map of the whole Earth",
    ))
}

/// The grid: the requested width, or as fine as the finest part.
fn target(
    description: &Description,
    window: Option<&Bounds>,
    finest_deg: f64,
    context: &FileContext,
) -> Result<Target, BuildError> {
    let texel_deg = match description.width {
        Some(width) => {
            let heights = MIN_SOURCE_HEIGHT..=MAX_SOURCE_HEIGHT;
            if window.is_none() && (width % 2 != 0 || !heights.contains(&(width / 2))) {
                return Err(context.rejected(
                    format!("has a width of {width} texels"),
                    format!(
                        "give an even number from {} to {}",
                        2 * MIN_SOURCE_HEIGHT,
                        2 * MAX_SOURCE_HEIGHT
                    ),
                ));
            }
            360.0 / f64::from(width.max(1))
        }
        None => finest_deg,
    };
    let natural = 360.0 / finest_deg;
    if let Some(width) = description.width
        && width > UNPROVEN_COLUMNS
        && f64::from(width) > MOST_ENLARGED * natural
    {
        return Err(context.rejected(
            format!(
                "has a width of {width} texels, and its finest part would make a map of {natural:.0}"
            ),
            format!("give a width of {MOST_ENLARGED} times that at most, or leave it out"),
        ));
    }
    let Some(window) = window else {
        if description.width.is_none() && natural > 1.001 * f64::from(2 * MAX_SOURCE_HEIGHT) {
            return Err(context.rejected(
                format!("its finest part would make a map of {natural:.0} texels round the Earth"),
                format!(
                    "correct that part's bounds, or give a width of {} texels at most: \
                     the part is then averaged",
                    2 * MAX_SOURCE_HEIGHT
                ),
            ));
        }
        return Ok(Target::earth_of(texel_deg));
    };
    let part = Target::part(window, texel_deg);
    let sides = 1..=MAX_PIECE_SIDE;
    if !sides.contains(&part.columns) || !sides.contains(&part.rows) {
        return Err(context.rejected(
            format!(
                "would have {} x {} texels in that region",
                part.columns, part.rows
            ),
            format!(
                "give a smaller region or a coarser level: at most {MAX_PIECE_SIDE} texels a side"
            ),
        ));
    }
    Ok(part)
}

/// The most bytes that pieces hold that are open at the same time.
fn most_bytes(pieces: &[Piece], target: &Target) -> u64 {
    let mut changes: Vec<(u32, i64)> = pieces
        .iter()
        .flat_map(|piece| {
            let (first, end) = piece.rows(target);
            // Bounded by the limit of each reader.
            let bytes = piece.bytes(target) as i64;
            [(first, bytes), (end.max(first + 1), -bytes)]
        })
        .collect();
    changes.sort_unstable();
    let (mut now, mut most) = (0_i64, 0_i64);
    for (_, change) in changes {
        now = now.saturating_add(change);
        most = most.max(now);
    }
    // The target row: values, weights and remaining visibility.
    most as u64 + u64::from(target.columns) * 20
}

/// Rows of a mosaic.
pub struct MosaicRows {
    state: Composer,
    writer: Writer,
    info: SourceInfo,
    given: u32,
    /// Texels that no part covers.
    empty: u64,
    reported: bool,
}

impl RowSource for MosaicRows {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        if !self.state.plain(self.given, row)? {
            self.state.row(self.given)?;
            self.empty += self
                .state
                .weights
                .iter()
                .filter(|weight| **weight == 0.0)
                .count() as u64;
            self.writer
                .write(&self.state.values, &self.state.weights, row);
        }
        self.given += 1;
        Ok(())
    }

    fn notes(&mut self) -> Vec<String> {
        let mut notes = self.state.notes();
        if self.given == self.info.height && self.empty > 0 && !self.reported {
            self.reported = true;
            let all = u64::from(self.info.width) * u64::from(self.info.height);
            notes.push(format!(
                "{:.2} % of the map lie in no part of the mosaic and are filled; a coarser map below all parts would cover them",
                100.0 * self.empty as f64 / all as f64
            ));
        }
        notes
    }
}
