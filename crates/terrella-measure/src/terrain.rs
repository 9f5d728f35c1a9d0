//! Terrain trees measured alone: savings, times of building, selection and drawing, and storage.
//!
//! | file | content |
//! |---|---|
//! | `field.rs` | elevation data: from files, or synthetic |
//! | [`quadtree`], [`contours`], [`patches`] | the trees |
//! | [`qbernstein`] | the basis of the patches |
//! | `workers.rs` | building in parts, on threads |
//! | `trees.rs` | trees of a field, built within a memory limit |
//! | `tables.rs` | the measurements |
//! | `draw.rs` | drawing the quadtree's triangles |
//! | `table.rs` | tables as text and CSV |

pub mod contours;
mod draw;
mod field;
pub mod patches;
pub mod qbernstein;
pub mod quadtree;
mod storage;
mod table;
mod tables;
#[cfg(test)]
mod tests;
mod trees;
mod workers;

pub use field::SyntheticGround;
pub use table::Table;

use super::output::OutputFolder;
use contours::{BudgetError, DemError};
use draw::Canvas;
use field::HeightField;
use patches::PatchError;
use qbernstein::QError;
use quadtree::TreeError;
use std::path::{Path, PathBuf};
use terrella::{ContextError, GpuContext};
use terrella_ground::elevation::HeightFileError;
use terrella_play::{OutputError, PendingFile, PlayError, Progress};
use trees::TreeBuilds;

/// The measured elevation data, the methods, and the output.
#[derive(Clone, Debug)]
pub struct TerrainRequest<'r> {
    /// Elevation files.
    pub files: &'r [PathBuf],
    /// A synthetic ground, after the files.
    pub synthetic: Option<SyntheticGround>,
    /// Tolerances of contours and patches, metres.
    pub tolerances_m: &'r [f64],
    /// Numbers of threads that building is timed with; trees that are not timed are built with the largest.
    pub threads: &'r [usize],
    /// Most memory that building one tree takes, bytes.
    pub memory_bytes: u64,
    /// Output folder of tables and images.
    pub output: Option<&'r Path>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Why a measurement stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TerrainError {
    /// Heights that cannot be read.
    #[error(transparent)]
    Heights(#[from] HeightFileError),
    /// Elevation data that these trees do not support.
    #[error("{}: {error}; cut out a part: `gdal_translate -projwin WEST NORTH EAST SOUTH IN OUT.tif`", path.display())]
    Field { path: PathBuf, error: DemError },
    /// A synthetic terrain, or a subsampled file, that these trees do not support.
    #[error("{ground}: {error}")]
    Ground { ground: String, error: DemError },
    /// The quadtree was rejected.
    #[error("{ground}: {error}")]
    Quadtree { ground: String, error: TreeError },
    /// The tree of contours was rejected.
    #[error("{ground}: {error}")]
    Contours { ground: String, error: BudgetError },
    /// The patches were rejected.
    #[error("{ground}: {error}")]
    Patches { ground: String, error: PatchError },
    /// A degree or q that no q-Bernstein basis has.
    #[error(transparent)]
    Basis(#[from] QError),
    /// The device failed, or a frame.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// A table or picture could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The user stopped it.
    #[error("interrupted; tables that were complete are kept")]
    Interrupted,
}

impl HeightField {
    fn rejected(&self, error: DemError) -> TerrainError {
        TerrainError::Ground {
            ground: self.name.clone(),
            error,
        }
    }
}

/// Measures all fields. `report` gets each table when it is complete.
///
/// # Errors
/// Files that cannot be read, a folder that cannot be written to, before anything is built; trees that exceed the memory limit; a lost device; an
/// interrupt. A missing adapter is a warning, and its columns stay empty; a missing adapter that was requested by name is an error.
pub fn measure_terrain(
    request: &TerrainRequest<'_>,
    progress: &dyn Progress,
    report: &mut dyn FnMut(&Table),
) -> Result<Vec<Table>, TerrainError> {
    let folder = request.output.map(OutputFolder::open).transpose()?;
    let trees = TreeBuilds {
        memory_bytes: request.memory_bytes,
        threads: request.threads.iter().copied().max().unwrap_or(1),
        progress,
    };
    progress.begin("reading heights", None);
    let files = request.files.iter().map(|path| HeightField::open(path));
    let mut fields = files.collect::<Result<Vec<_>, _>>()?;
    fields.extend(request.synthetic.map(HeightField::synthetic));
    progress.end();
    let mut canvas = canvas(request.adapter)?;
    let mut tables = Vec::new();
    let mut done = |table: Table| -> Result<(), TerrainError> {
        if let Some(folder) = &folder {
            folder.write(&format!("{}.csv", table.name), table.to_csv().as_bytes())?;
        }
        report(&table);
        tables.push(table);
        Ok(())
    };
    let mut table = tables::rates();
    for field in &fields {
        for (k, size) in field.sizes().iter().enumerate() {
            let is_pictured = k == 0 && request.output.is_some();
            let (row, picture) = tables::rate(&trees, size, canvas.as_mut(), is_pictured)?;
            table.rows.push(row);
            if let (Some(picture), Some(output)) = (picture, request.output) {
                let path = output.join(format!("pictures/{}.png", field.name));
                PendingFile::create(&path, "images", "png")?.write_png(&picture)?;
            }
        }
    }
    done(table)?;
    let mut table = tables::storage();
    for field in &fields {
        for size in field.sizes() {
            for tolerance_m in request.tolerances_m {
                table
                    .rows
                    .push(tables::stored(&trees, &size, *tolerance_m)?);
            }
        }
    }
    done(table)?;
    let mut table = tables::builds(request.threads);
    let tolerance_m = timed_tolerance_m(request.tolerances_m);
    for field in &fields {
        let rows = tables::built(&trees, field, tolerance_m, request.threads)?;
        table.rows.extend(rows);
    }
    done(table)?;
    let mut table = tables::orders();
    for field in &fields {
        table.rows.extend(tables::ordered(&trees, field)?);
    }
    done(table)?;
    for table in tables::conditions()? {
        done(table)?;
    }
    Ok(tables)
}

/// The tolerance that building is timed with: 5 m if it is among them, otherwise the first.
fn timed_tolerance_m(tolerances_m: &[f64]) -> f64 {
    let usual = tolerances_m.iter().find(|tolerance| **tolerance == 5.0);
    *usual.or(tolerances_m.first()).unwrap_or(&5.0)
}

/// The canvas; `None`, with a warning, if there is no adapter at all.
fn canvas(adapter: Option<&str>) -> Result<Option<Canvas>, TerrainError> {
    match pollster::block_on(GpuContext::open(adapter)) {
        Ok(gpu) => Ok(Some(Canvas::new(gpu))),
        Err(error @ ContextError::NoAdapter) => {
            tracing::warn!("frames are not timed: {error}");
            Ok(None)
        }
        Err(error) => Err(PlayError::from(error).into()),
    }
}
