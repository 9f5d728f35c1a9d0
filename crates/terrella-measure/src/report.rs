//! Error against run time: cost and benefit of each setting of a scene.
//!
//! The scene is seen from several heights, one setting is changed at a time, and every image is compared with the true one. All other settings are
//! the scene's. The results are a table, charts, and a page.
//!
//! | file | content |
//! |---|---|
//! | `change.rs` | the swept settings |
//! | `run.rs` | drawing, timing and comparing |
//! | `truth.rs` | the true images |
//! | `geometry.rs` | errors of limb and geolocation |
//! | `rows.rs` | results as tables |
//! | `standalone.rs` | formulas, propagators and extreme views, which need no scene |
//! | `plots.rs`, `method_plots.rs` | results as charts |
//! | `page.rs`, `page_standalone.rs` and their templates | results as a page |
//! | `text.rs`, `format.rs` | results as sentences; number formatting |

mod change;
mod format;
mod geometry;
mod method_plots;
mod page;
mod page_standalone;
mod plots;
mod rows;
mod run;
mod standalone;
mod text;
mod truth;

pub use change::{PARAMETERS, SettingChange, SweepPlan, UnavailableSweep};
pub use method_plots::method_plots;
pub use plots::{Plot, plots};
pub use rows::{CSV_COLUMNS, MAX_GEOLOCATION_PX, MAX_SILHOUETTE_PX, SweepRow, csv, spread_csv};
pub use standalone::StandaloneStudy;

use crate::ChartError;
use crate::html::PageError;
use crate::output::OutputFolder;
use std::path::{Path, PathBuf};
use terrella::Subdivision;
use terrella_imagery::tile::TileError;
use terrella_play::{Flight, OutputError, PlayError, Progress};
use terrella_reference::ReferenceError;

/// How a report is wanted.
#[derive(Clone, Debug)]
pub struct ReportRequest<'r> {
    /// The folder that it is written to; made if it is not there. Files of an earlier report are replaced.
    pub folder: &'r Path,
    /// Fewer heights and values.
    pub quick: bool,
    /// The swept parameters of [`PARAMETERS`], besides the scene itself and without [`StandaloneStudy`]; empty sweeps all.
    pub sweeps: Vec<&'static str>,
    /// Width and height of the pictures, pixels.
    pub size: (u32, u32),
    /// How often each frame is timed, from 1.
    pub repeats: u32,
    /// N: the true picture has N × N rays a pixel.
    pub samples: u32,
    /// Heights of the eye, kilometres; `None` takes [`EYE_HEIGHTS`](crate::EYE_HEIGHTS).
    pub heights_km: Option<Vec<f64>>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Why there is no report, or no complete one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// Drawing.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// The true picture.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// The maps of the true picture, from a pack.
    #[error(transparent)]
    Maps(#[from] TileError),
    /// Writing.
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Chart(#[from] ChartError),
    #[error(transparent)]
    Page(#[from] PageError),
    /// A height is below the ground or is no number.
    #[error("a height of {0} km cannot be looked from; heights are from 1 to 1000000 km")]
    Height(f64),
    /// Stopped from outside.
    #[error(
        "interrupted after {done} of {wanted} measurements; {} holds those and says that it is partial",
        page.display()
    )]
    Interrupted {
        /// Rows that are complete.
        done: usize,
        /// Rows that were wanted.
        wanted: usize,
        page: PathBuf,
    },
}

/// Results of a measurement, and its settings.
#[derive(Clone, Debug)]
pub struct Study {
    /// Name of the scene's file.
    pub scene: String,
    /// The adapter's name and backend.
    pub adapter: String,
    /// Width and height of the pictures, pixels.
    pub size: (u32, u32),
    /// The scene's cells per block edge.
    pub subdivision: Subdivision,
    /// How often each frame was timed.
    pub repeats: u32,
    /// Rays along each side of a pixel of the true picture.
    pub samples: u32,
    /// Heights, kilometres.
    pub heights_km: Vec<f64>,
    /// Measured rows.
    pub rows: Vec<SweepRow>,
    /// Rows that were wanted; more than there are if it was stopped.
    pub wanted: usize,
    /// Whether it was stopped early.
    pub is_stopped: bool,
    /// Sweeps that are not possible here.
    pub unavailable: Vec<UnavailableSweep>,
    /// Further remarks for the reader, one sentence each.
    pub notes: Vec<String>,
    /// Heights of which the folder `pictures` holds the view, the true picture and their difference.
    pub pictured_km: Vec<f64>,
    /// Measurements that need no scene.
    pub standalone: StandaloneStudy,
}

/// Beyond, the Earth is a dot, kilometres.
const FAR_KM: f64 = 1e5;

impl Study {
    /// Whether everything requested is there.
    pub fn is_complete(&self) -> bool {
        !self.is_stopped && self.rows.len() >= self.wanted
    }

    /// The rows of the scene as it is, one for each height.
    pub fn scene_rows(&self) -> impl Iterator<Item = &SweepRow> {
        self.rows
            .iter()
            .filter(|row| row.change == SettingChange::Scene)
    }

    /// The values that a parameter was swept over, in order.
    pub fn values_of(&self, parameter: &str) -> Vec<String> {
        let mut values = Vec::new();
        for row in &self.rows {
            let value = row.change.value();
            if row.change.parameter() == parameter && !values.contains(&value) {
                values.push(value);
            }
        }
        values
    }

    pub fn row(&self, parameter: &str, value: &str, height_km: f64) -> Option<&SweepRow> {
        self.rows.iter().find(|row| {
            row.change.parameter() == parameter
                && row.height_km == height_km
                && row.change.value() == value
        })
    }

    /// At most this many of the measured heights, from the lowest to the highest at which the Earth is more than a few pixels large.
    fn some_heights(&self, count: usize) -> Vec<f64> {
        let mut heights: Vec<f64> = self.scene_rows().map(|row| row.height_km).collect();
        if heights.iter().any(|km| *km < FAR_KM) {
            heights.retain(|km| *km < FAR_KM);
        }
        let last = heights.len().saturating_sub(1);
        let steps = count.saturating_sub(1).max(1);
        let mut some: Vec<f64> = (0..count)
            .filter_map(|n| heights.get(n * last / steps).copied())
            .collect();
        some.dedup();
        some
    }

    /// The row that other meshes are compared with: the scene's own mesh, from the same sweep if possible.
    fn scene_mesh(&self, height_km: f64) -> Option<&SweepRow> {
        self.row("subdivision", &self.subdivision.to_string(), height_km)
            .or_else(|| self.row("scene", "as it is", height_km))
    }

    /// The tables as text for a terminal: a line for each height.
    pub fn summary(&self) -> String {
        text::summary(self)
    }
}

/// Measures a scene and writes the report. `print_line` gets text for the user as it becomes available.
///
/// # Errors
/// A folder that cannot be written to, before anything is drawn; all errors of drawing. After an interrupt the complete part is written anyway,
/// marked as partial, and [`ReportError::Interrupted`] is returned.
pub fn report(
    flight: &Flight,
    request: &ReportRequest<'_>,
    progress: &dyn Progress,
    print_line: &dyn Fn(&str),
) -> Result<Study, ReportError> {
    let folder = OutputFolder::open(request.folder)?;
    let study = run::run(flight, request, &folder, progress, print_line)?;
    write_tables(&folder, &study.rows)?;
    let standalone = &study.standalone;
    folder.write("methods.csv", standalone.methods_csv().as_bytes())?;
    folder.write("stability.csv", standalone.stability_csv().as_bytes())?;
    let mut plots = plots(&study)?;
    plots.extend(method_plots(&standalone.measurements)?);
    for plot in &plots {
        folder.write(&format!("plots/{}.svg", plot.name), plot.svg.as_bytes())?;
    }
    folder.write("index.html", page::page(&study, &plots)?.as_bytes())?;
    if !study.is_complete() {
        print_line(&study.summary());
        return Err(ReportError::Interrupted {
            done: study.rows.len(),
            wanted: study.wanted,
            page: request.folder.join("index.html"),
        });
    }
    Ok(study)
}

/// Writes the tables of rows.
fn write_tables(folder: &OutputFolder, rows: &[SweepRow]) -> Result<(), OutputError> {
    folder.write("measurements.csv", csv(rows).as_bytes())?;
    folder.write("spread.csv", spread_csv(rows).as_bytes())
}
