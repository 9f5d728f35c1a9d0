//! Surfaces with relief against each other: the same ground, the same flights, error beside run time.
//!
//! | file | what |
//! |---|---|
//! | `paths.rs` | four flights |
//! | `test_grounds.rs` | what is flown over |
//! | `candidates.rs` | which surfaces, with which settings |
//! | `run.rs` | flying, timing and comparing |
//! | `study.rs` | what is found, and which surface to choose |
//! | `rows.rs`, `plots.rs`, `page.rs` | as a table, charts, and a page |

mod candidates;
mod page;
mod paths;
mod plots;
mod rows;
mod run;
mod study;
mod test_grounds;

pub use candidates::{Candidate, candidates};
pub use paths::SurfacePath;
pub use rows::{SURFACES_CSV_COLUMNS, Setting, SurfaceRow, surfaces_csv};
pub use study::SurfaceStudy;
pub use test_grounds::{TestGround, test_grounds};

use super::ChartError;
use super::html::PageError;
use super::output::OutputFolder;
use crate::Sky;
use crate::elevation::GridError;
use crate::globe::SurfaceKind;
use crate::gpu::GpuContext;
use crate::play::{Flight, OutputError, PlayError, Progress};
use run::FlightMeter;
use std::path::Path;

/// How a comparison is wanted.
#[derive(Clone, Debug)]
pub struct SurfacesRequest<'r> {
    /// The folder that it is written to; made if it is not there.
    pub folder: &'r Path,
    /// Each surface at its default alone.
    pub quick: bool,
    /// The surfaces; none takes all.
    pub only: &'r [SurfaceKind],
    /// Places of each flight, 1 or more.
    pub places: u32,
    /// Width and height of the frames that are timed, pixels.
    pub size: (u32, u32),
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurfacesError {
    /// Drawing.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// Heights that are made here.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Writing.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A chart.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// The page.
    #[error(transparent)]
    Page(#[from] PageError),
}

/// Width of the pictures that are held against the data, pixels.
const COMPARED_WIDTH: u32 = 320;

/// Flies everything and writes `surfaces.csv`, charts and `surfaces.html`. The scene gives maps, air and date.
///
/// # Errors
/// A folder that cannot be written to, before anything is drawn; all that drawing can meet.
pub fn compare_surfaces(
    flight: &Flight,
    request: &SurfacesRequest<'_>,
    progress: &dyn Progress,
) -> Result<SurfaceStudy, SurfacesError> {
    let folder = OutputFolder::open(request.folder)?;
    let gpu = pollster::block_on(GpuContext::open(request.adapter)).map_err(PlayError::from)?;
    progress.begin("loading maps and heights", None);
    let options = flight.earth_options(gpu.bc_support())?;
    let grounds = test_grounds(flight.scene())?;
    progress.end();
    let candidates = candidates(request.only, request.quick);
    let (width, height) = request.size;
    let compared_width = width.min(COMPARED_WIDTH);
    let compared_height =
        (u64::from(compared_width) * u64::from(height) / u64::from(width.max(1))).max(1);
    let meter = FlightMeter {
        gpu: &gpu,
        options: &options,
        sky: Sky::at(flight.scene().time.start),
        size: request.size,
        compared_size: (compared_width, compared_height as u32),
        places: request.places.max(1),
        progress,
    };
    let info = gpu.adapter.get_info();
    let mut study = SurfaceStudy {
        adapter: format!("{} ({})", info.name, info.backend),
        size: request.size,
        compared_size: meter.compared_size,
        places: meter.places,
        rows: Vec::new(),
        wanted: grounds.len() * SurfacePath::ALL.len() * candidates.len(),
    };
    progress.begin("flights", Some(study.wanted as u64));
    'all: for ground in &grounds {
        for path in SurfacePath::ALL {
            let exact = meter.exact(ground, path);
            for candidate in &candidates {
                let Some(row) = meter.fly(ground, path, candidate, &exact)? else {
                    break 'all;
                };
                study.rows.push(row);
                progress.step();
            }
            // What is complete stays, whatever comes.
            folder.write("surfaces.csv", surfaces_csv(&study.rows).as_bytes())?;
        }
    }
    progress.end();
    let plots = plots::plots(&study)?;
    for plot in &plots {
        folder.write(&format!("plots/{}.svg", plot.name), plot.svg.as_bytes())?;
    }
    folder.write("surfaces.html", page::page(&study, &plots)?.as_bytes())?;
    Ok(study)
}
