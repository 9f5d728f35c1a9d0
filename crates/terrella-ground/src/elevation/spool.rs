//! Heights of a file that does not fit into memory: read once from its beginning into a scratch file, and looked at through windows.
//!
//! | file | what |
//! |---|---|
//! | `store.rs` | rows of heights in a scratch file |
//! | `means.rs` | coarser levels, where there are holes to fill |
//! | `window.rs` | a part of the file in memory |
//!
//! What a window answers at the finest spacing is what a [`HeightGrid`](super::HeightGrid) of the same file answers, to the last bit: the
//! functions that average, fill and interpolate are the same. Holes are filled from all coarser levels, which takes a third as many
//! samples more in scratch files, and are believed as far as data within `LEFT` samples allow: a window reads so much more on all sides.

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

/// Bytes that are held for each column while a file is spooled: rows about a pole with their holes, or rows and parts of means.
const COLUMN_BYTES: u64 = 160;

/// Rows that are looked at together for holes.
const BAND_ROWS: usize = 16;

/// Why heights could not be spooled or looked at.
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
        /// What it would take.
        needed_bytes: u64,
        free_bytes: u64,
    },
    /// The host does not want it any more.
    #[error("stopped")]
    Stopped,
}

/// Where scratch files may be written, and whether to go on.
pub trait SpoolHost: Sync {
    /// Bytes that are free in a folder, where that is known.
    fn free_bytes(&self, folder: &Path) -> Option<u64>;
    /// So many rows are going to be read.
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
    /// Path of the first; further ones add to its name.
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

/// A file that has been looked at.
pub struct SpoolNeeds {
    /// Samples of a row, and rows.
    pub size: (u32, u32),
    /// What the file covers.
    pub bounds: Bounds,
    /// Where its samples lie.
    pub place: Placement,
    /// Bytes held while it is spooled.
    pub working_bytes: u64,
}

/// Looks at a file without reading its heights.
pub fn look(path: &Path) -> Result<SpoolNeeds, HeightFileError> {
    let reader = HeightReader::open(path)?;
    let georeference = reader.georeference()?;
    let place = Placement::new(&georeference).map_err(reader.rejection())?;
    reader.conversion()?;
    let size = reader.size();
    Ok(SpoolNeeds {
        size,
        bounds: place.bounds,
        place,
        working_bytes: reader.working_bytes() + u64::from(size.0) * COLUMN_BYTES,
    })
}

/// The outermost row on the side of a pole that a file reaches.
#[derive(Clone, Copy, Debug)]
struct Pole {
    height_m: f64,
    /// How far that is believed, 0…255.
    believed: f64,
    /// The row lies on the pole and has but one height.
    is_row: bool,
}

impl Pole {
    const NONE: Self = Self {
        height_m: 0.0,
        believed: 255.0,
        is_row: false,
    };
}

/// Heights of a file in a scratch file.
#[derive(Debug)]
pub struct HeightSpool {
    place: Placement,
    shape: LevelShape,
    store: Store,
    /// All heights are whole metres, and so are those of holes.
    is_whole: bool,
    /// The next coarser level without holes, where the finest has some.
    means: Option<(LevelShape, Store)>,
    range: HeightRange,
    /// North first.
    poles: [Pole; 2],
    /// The only height that there is, everywhere.
    uniform_m: Option<f64>,
    attribution: Option<String>,
}

/// Why a reading ended before its end.
enum Stop {
    Error(SpoolError),
    /// Heights that are not whole metres.
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
    /// Reads a file into scratch files whose names begin with the path `scratch`: 2 bytes a sample if all are whole metres, else 4, and
    /// another 1.4 while the means of a file with holes are made. They are removed with this.
    ///
    /// `above` is what the heights stand above where neither the file nor its sidecar says it.
    ///
    /// # Errors
    /// As those of a file that is held; a folder without room, or a host that stops.
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
        // Most files are of whole metres; others show it soon.
        match Self::spool(path, &scratch, Kept::Whole) {
            Err(Stop::NotWhole) => match Self::spool(path, &scratch, Kept::Float) {
                Err(Stop::Error(error)) => Err(error),
                // Floats take all.
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
        let place = Placement::new(&reader.georeference()?);
        let place = place.map_err(reader.rejection())?;
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
            // A last column that repeats the first is not kept.
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

    /// What stands at the pole beyond an outermost row.
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

    /// Whether some sample lies so far from data that what lies beneath the file counts.
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

    /// Where its heights lie.
    pub fn placement(&self) -> &Placement {
        &self.place
    }

    /// What the file covers.
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

    /// Step between heights that are held, metres; 0 where they are floating-point numbers.
    pub fn quantum_m(&self) -> f64 {
        match self.is_whole {
            true => 1.0,
            false => 0.0,
        }
    }

    /// Whom to name for the heights.
    pub fn attribution(&self) -> Option<&str> {
        self.attribution.as_deref()
    }
}
