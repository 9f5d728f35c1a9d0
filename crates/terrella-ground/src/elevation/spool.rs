//! Reads an elevation file that exceeds the memory into a scratch file, in one pass, and gives access to it through windows.
//!
//! | file | what |
//! |---|---|
//! | `store.rs` | rows of heights in a scratch file |
//! | `means.rs` | coarser levels, where there are holes to fill |
//! | `window.rs` | a part of the file in memory |
//!
//! At the finest spacing a window returns the same heights as a [`HeightGrid`](super::HeightGrid) of the same file, to the last bit. Both
//! use the same functions to average, fill and interpolate. Holes are filled from all coarser levels, which add a third to the samples in
//! scratch files. Their confidence depends on data within `LEFT` samples, so a window reads that margin on all sides.

mod means;
mod store;
#[cfg(test)]
mod tests;
mod window;

pub use window::HeightWindow;

use super::geoid::VerticalDatum;
use super::grid::build::{KnownHeights, mean};
use super::grid::holes::{FILLED, LEFT, steps_to_data};
use super::grid::levels::{LevelShape, shapes};
use super::grid::placement::Placement;
use super::read::HeightReader;
use super::{Bounds, HeightFileError, HeightRange};
use std::io;
use std::path::{Path, PathBuf};
use store::{Kept, Store};
use window::Piece;

/// Bytes held per column while a file is spooled: rows around a pole with their holes, or rows and parts of means.
const COLUMN_BYTES: u64 = 160;

/// Rows that are searched together for holes.
const BAND_ROWS: usize = 16;

/// Why heights could not be spooled or read back.
#[derive(Debug, thiserror::Error)]
pub enum SpoolError {
    /// The file cannot be read.
    #[error(transparent)]
    Heights(#[from] HeightFileError),
    /// A scratch file could not be written or read.
    #[error("{}: {source}", path.display())]
    Scratch { path: PathBuf, source: io::Error },
    /// The disk has no room.
    #[error("{}: needs {needed_bytes} bytes and {free_bytes} are free", path.display())]
    NoRoom {
        /// The scratch file.
        path: PathBuf,
        /// Required bytes.
        needed_bytes: u64,
        free_bytes: u64,
    },
    /// The host cancelled the work.
    #[error("stopped")]
    Stopped,
}

/// Storage limits for scratch files, and progress and cancellation.
pub trait SpoolHost: Sync {
    /// Free bytes in a folder, if known.
    fn free_bytes(&self, folder: &Path) -> Option<u64>;
    /// This many rows will be read.
    fn begin(&self, rows: u64);
    /// A row has been read.
    fn step(&self);
    /// All rows have been read, or no more will be.
    fn end(&self);
    /// True once the work is no longer wanted.
    fn cancelled(&self) -> bool;
}

/// Scratch files of one spool.
struct Scratch<'a> {
    /// Path of the first file; others append to its name.
    path: &'a Path,
    above: Option<VerticalDatum>,
    host: &'a dyn SpoolHost,
}

impl Scratch<'_> {
    /// A new file, if there is room for it.
    fn store(&self, name: &str, size: (usize, usize), kept: Kept) -> Result<Store, SpoolError> {
        let mut file = self.path.file_name().unwrap_or_default().to_os_string();
        file.push("-");
        file.push(name);
        let path = self.path.with_file_name(file);
        let needed_bytes = Store::bytes_of(size, kept);
        let folder = self.path.parent().unwrap_or(Path::new("."));
        match self.host.free_bytes(folder) {
            Some(free_bytes) if free_bytes < needed_bytes => Err(SpoolError::NoRoom {
                path,
                needed_bytes,
                free_bytes,
            }),
            _ => Store::create(path, size, kept),
        }
    }

    fn go_on(&self) -> Result<(), SpoolError> {
        match self.host.cancelled() {
            true => Err(SpoolError::Stopped),
            false => Ok(()),
        }
    }
}

/// Requirements of a file.
pub struct SpoolNeeds {
    /// Samples of a row, and rows.
    pub size: (u32, u32),
    /// The bounds that the file covers.
    pub bounds: Bounds,
    /// Placement of its samples.
    pub place: Placement,
    /// Peak memory of spooling, bytes.
    pub working_bytes: u64,
}

/// Inspects a file without reading its heights.
pub fn look(path: &Path) -> Result<SpoolNeeds, HeightFileError> {
    let reader = HeightReader::open(path)?;
    let place = reader.placement()?;
    reader.conversion()?;
    let size = reader.size();
    Ok(SpoolNeeds {
        size,
        bounds: place.bounds,
        place,
        working_bytes: reader.working_bytes() + u64::from(size.0) * COLUMN_BYTES,
    })
}

/// The outermost row towards a pole that a file reaches.
#[derive(Clone, Copy, Debug)]
struct Pole {
    height_m: f64,
    /// Confidence of that height, 0…255.
    believed: f64,
    /// Whether the row is at the pole and has only one height.
    is_row: bool,
}

impl Pole {
    const NONE: Self = Self {
        height_m: 0.0,
        believed: 255.0,
        is_row: false,
    };
}

/// Heights of a file, stored in a scratch file.
#[derive(Debug)]
pub struct HeightSpool {
    place: Placement,
    shape: LevelShape,
    store: Store,
    /// Whether all heights are integer metres, filled holes included.
    is_whole: bool,
    /// The next coarser level without holes, if the finest has some.
    means: Option<(LevelShape, Store)>,
    range: HeightRange,
    /// North first.
    poles: [Pole; 2],
    /// The height of every sample, if it is uniform.
    uniform_m: Option<f64>,
    attribution: Option<String>,
}

/// Why reading ended early.
enum Stop {
    Error(SpoolError),
    /// Heights that are not integer metres.
    NotWhole,
}

impl From<SpoolError> for Stop {
    fn from(error: SpoolError) -> Self {
        Self::Error(error)
    }
}

impl From<HeightFileError> for Stop {
    fn from(error: HeightFileError) -> Self {
        Self::Error(error.into())
    }
}

impl HeightSpool {
    /// Reads a file into scratch files whose names begin with the path `scratch`. They take 2 bytes per sample if all heights are integer metres,
    /// else 4. Another 1.4 are in use while the means of a file with holes are built. Dropping this value removes the files.
    ///
    /// `above` is the vertical datum if neither the file nor its sidecar states one.
    ///
    /// # Errors
    /// As for a file in memory; a folder without room; a host that cancels.
    pub fn read(
        path: &Path,
        scratch: &Path,
        above: Option<VerticalDatum>,
        host: &dyn SpoolHost,
    ) -> Result<Self, SpoolError> {
        let scratch = Scratch {
            path: scratch,
            above,
            host,
        };
        // Most files hold integer metres; others show it early.
        match Self::spool(path, &scratch, Kept::Whole) {
            Err(Stop::NotWhole) => match Self::spool(path, &scratch, Kept::Float) {
                Err(Stop::Error(error)) => Err(error),
                // Float storage accepts every height.
                Err(Stop::NotWhole) => Err(SpoolError::Stopped),
                Ok(spool) => Ok(spool),
            },
            Err(Stop::Error(error)) => Err(error),
            Ok(spool) => Ok(spool),
        }
    }

    fn spool(path: &Path, scratch: &Scratch<'_>, kept: Kept) -> Result<Self, Stop> {
        let mut reader = HeightReader::open(path)?;
        reader.assume_above(scratch.above);
        let place = reader.placement()?;
        let conversion = reader.conversion()?;
        let attribution = reader.attribution();
        let rows = u64::from(reader.size().1);
        let shapes = shapes(&place.lattice);
        let (columns, shape) = (place.lattice.columns, shapes[0]);
        let store = scratch.store("rows", (columns, shape.rows), kept)?;
        let mut file = store.open()?;
        let (mut known, mut holes) = (KnownHeights::default(), 0_u64);
        scratch.host.begin(rows);
        let rejected = reader.rejection();
        let read = reader.read(&conversion, |row, column, heights_m| {
            if column == 0 {
                scratch.go_on()?;
                scratch.host.step();
            }
            // A last column that repeats the first is dropped.
            let count = columns.saturating_sub(column).min(heights_m.len());
            let heights_m = &mut heights_m[..count];
            known.add(heights_m);
            known.check().map_err(&rejected)?;
            holes += heights_m.iter().filter(|height| height.is_nan()).count() as u64;
            let is_whole = |height: &f32| height.is_nan() || height.fract() == 0.0;
            if kept == Kept::Whole && !heights_m.iter().all(is_whole) {
                return Err(Stop::NotWhole);
            }
            Ok(file.write(row, column, heights_m)?)
        });
        scratch.host.end();
        read?;
        drop(file);
        let range = known.range().map_err(&rejected)?;
        let means = match (holes, shapes.get(1)) {
            (0, _) | (_, None) => None,
            (_, Some(coarse)) => {
                let store = means::filled(&place, &shapes, &store, scratch)?;
                store.map(|store| (*coarse, store))
            }
        };
        let mut spool = Self {
            place,
            shape,
            store,
            is_whole: kept == Kept::Whole,
            means,
            range,
            poles: [Pole::NONE; 2],
            uniform_m: None,
            attribution,
        };
        if spool.is_flat() && !spool.has_left_hole(scratch)? {
            spool.uniform_m = Some(range.low_m);
        }
        let lattice = &spool.place.lattice;
        let poles = [
            (lattice.reaches_north, 0),
            (lattice.reaches_south, spool.shape.rows - 1),
        ];
        for (n, (reaches, row)) in poles.into_iter().enumerate() {
            if reaches {
                spool.poles[n] = spool.pole(row)?;
            }
        }
        Ok(spool)
    }

    /// The height at the pole beyond an outermost row.
    fn pole(&self, row: usize) -> Result<Pole, SpoolError> {
        let mut piece = Piece::filled(self, row..row + 1, 0, self.shape.columns)?;
        let is_row = self.place.lattice.is_pole(row);
        if is_row {
            let mean_m = mean(piece.heights_m.iter().copied()) as f32;
            piece.heights_m.fill(mean_m);
        }
        piece.round(self);
        let least = |believed: &Vec<u8>| believed.iter().copied().min();
        Ok(Pole {
            height_m: mean(piece.heights_m.iter().copied()),
            believed: f64::from(piece.believed.as_ref().and_then(least).unwrap_or(255)),
            is_row,
        })
    }

    /// Whether a sample is so far from data that the source beneath the file counts.
    fn has_left_hole(&self, scratch: &Scratch<'_>) -> Result<bool, SpoolError> {
        if self.means.is_none() {
            return Ok(false);
        }
        let (columns, rows) = (self.shape.columns, self.shape.rows);
        let mut file = self.store.open()?;
        let (mut heights_m, mut is_hole) = (vec![0.0; columns], Vec::new());
        for first in (0..rows).step_by(BAND_ROWS) {
            scratch.go_on()?;
            let from = first.saturating_sub(usize::from(LEFT));
            let upto = (first + BAND_ROWS + usize::from(LEFT)).min(rows);
            is_hole.clear();
            for row in from..upto {
                file.read(row, 0, &mut heights_m)?;
                is_hole.extend(heights_m.iter().map(|height| height.is_nan()));
            }
            let steps = steps_to_data(columns, self.shape.is_periodic, &is_hole);
            let own = (first - from) * columns..((first + BAND_ROWS).min(upto) - from) * columns;
            if steps[own].iter().any(|steps| *steps > FILLED) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Placement of its samples.
    pub fn placement(&self) -> &Placement {
        &self.place
    }

    /// The bounds that the file covers.
    pub fn bounds(&self) -> Bounds {
        self.place.bounds
    }

    /// Samples of a row, and rows.
    pub fn size(&self) -> (u32, u32) {
        self.place.size()
    }

    /// As [`HeightGrid::sample_bounds`](super::HeightGrid::sample_bounds).
    pub fn sample_bounds(&self) -> Bounds {
        self.place.sample_bounds()
    }

    /// As [`HeightGrid::finest_spacing_rad`](super::HeightGrid::finest_spacing_rad).
    pub fn finest_spacing_rad(&self) -> f64 {
        self.place.finest_rad
    }

    /// As [`HeightGrid::detail_rad`](super::HeightGrid::detail_rad).
    pub fn detail_rad(&self) -> f64 {
        self.place.detail_rad(self.uniform_m.is_some())
    }

    /// Whether every height is the same.
    pub fn is_flat(&self) -> bool {
        self.range.low_m == self.range.high_m
    }

    /// Lowest and highest sample.
    pub fn range(&self) -> HeightRange {
        self.range
    }

    /// Step between stored heights, metres; 0 for floating-point heights.
    pub fn quantum_m(&self) -> f64 {
        match self.is_whole {
            true => 1.0,
            false => 0.0,
        }
    }

    /// Credit for the heights.
    pub fn attribution(&self) -> Option<&str> {
        self.attribution.as_deref()
    }
}
