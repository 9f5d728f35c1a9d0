//! Error against run time: what each setting of a scene costs and what it buys.
//!
//! The scene is seen from the heights of the stations, each setting changed by itself, and every picture is held against
//! the true one. Every setting but the swept one is the scene's. From this come a table, charts, and a page.
//!
//! | file | what |
//! |---|---|
//! | `change.rs` | what is swept |
//! | `run.rs` | drawing, timing and comparing |
//! | `rows.rs` | what is found, as tables |
//! | `numbers.rs` | formulas, propagators and extreme views, which need no scene |
//! | `plots.rs` | as charts |
//! | `page.rs`, `words.rs` | as a page |

mod change;
mod numbers;
mod page;
mod plots;
mod rows;
mod run;
mod words;

pub use change::{Change, Plan, Unavailable};
pub use numbers::{Numbers, method_plots};
pub(in crate::measure) use page::STYLE;
pub use plots::{Plot, plots};
pub use rows::{CSV_HEADER, GEOLOCATION_MOST_PX, Row, SILHOUETTE_MOST_PX, csv, spread_csv};
pub(in crate::measure) use words::escaped;

use crate::Subdivision;
use crate::measure::ChartError;
use crate::measure::reference::{ReferenceError, StillError};
use crate::play::{Flight, OutputError, PendingFile, PlayError, Progress};
use std::path::{Path, PathBuf};

/// How a report is wanted.
#[derive(Clone, Debug)]
pub struct ReportRequest<'r> {
    /// The folder that it is written to; made if it is not there. Files of an earlier report are replaced.
    pub folder: &'r Path,
    /// Fewer heights and values.
    pub quick: bool,
    /// Width and height of the pictures, pixels.
    pub size: (u32, u32),
    /// How often each frame is timed, from 1.
    pub repeats: u32,
    /// N: the true picture has N × N rays a pixel.
    pub samples: u32,
    /// Heights of the eye, kilometres; `None` takes the stations'.
    pub heights_km: Option<Vec<f64>>,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Why there is no report, or none that is complete.
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
    Maps(#[from] StillError),
    /// Writing.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A chart.
    #[error(transparent)]
    Chart(#[from] ChartError),
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
        /// The page.
        page: PathBuf,
    },
}

/// What was measured, and with what.
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
    /// What was found.
    pub rows: Vec<Row>,
    /// Rows that were wanted; more than there are if it was stopped.
    pub wanted: usize,
    /// Whether it was stopped before the end.
    pub is_stopped: bool,
    /// What could not be swept here.
    pub unavailable: Vec<Unavailable>,
    /// What the reader must know besides, a sentence each.
    pub notes: Vec<String>,
    /// Heights of which the folder `pictures` holds the view, the true picture and their difference.
    pub pictured_km: Vec<f64>,
    /// What needs no scene.
    pub numbers: Numbers,
}

/// Beyond, the Earth is a dot, kilometres.
const FAR_KM: f64 = 1e5;

impl Study {
    /// Whether everything that was wanted is there.
    pub fn is_complete(&self) -> bool {
        !self.is_stopped && self.rows.len() >= self.wanted
    }

    /// The rows of the scene as it is, one for each height.
    pub fn scene_rows(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.change == Change::Scene)
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

    /// A row by parameter, value and height.
    pub fn row(&self, parameter: &str, value: &str, height_km: f64) -> Option<&Row> {
        self.rows.iter().find(|row| {
            row.change.parameter() == parameter
                && row.height_km == height_km
                && row.change.value() == value
        })
    }

    /// At most so many of the heights that are measured, from the lowest to the highest of which the Earth is more than a
    /// few pixels large.
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

    /// What other meshes are held against: the scene's own mesh, measured in the sweep beside them where it is there.
    fn scene_mesh(&self, height_km: f64) -> Option<&Row> {
        self.row("subdivision", &self.subdivision.to_string(), height_km)
            .or_else(|| self.row("scene", "as it is", height_km))
    }

    /// The tables as text for a terminal: a line for each height.
    pub fn summary(&self) -> String {
        words::summary(self)
    }
}

/// Measures a scene and writes the report. `tell` is given lines for the user as they come.
///
/// # Errors
/// A folder that cannot be written to, before anything is drawn; all that drawing can meet. After an interrupt what was
/// complete is written all the same, marked as partial, and [`ReportError::Interrupted`] is answered.
pub fn report(
    flight: &Flight,
    request: &ReportRequest<'_>,
    progress: &dyn Progress,
    tell: &dyn Fn(&str),
) -> Result<Study, ReportError> {
    let folder = Folder::open(request.folder)?;
    let study = run::run(flight, request, &folder, progress, tell)?;
    folder.write_tables(&study)?;
    let numbers = &study.numbers;
    folder.write("methods.csv", numbers.methods_csv().as_bytes())?;
    folder.write("stability.csv", numbers.stability_csv().as_bytes())?;
    let mut plots = plots(&study)?;
    plots.extend(method_plots(&numbers.measurements)?);
    for plot in &plots {
        folder.write(&format!("plots/{}.svg", plot.name), plot.svg.as_bytes())?;
    }
    folder.write("index.html", page::page(&study, &plots).as_bytes())?;
    if !study.is_complete() {
        tell(&study.summary());
        return Err(ReportError::Interrupted {
            done: study.rows.len(),
            wanted: study.wanted,
            page: request.folder.join("index.html"),
        });
    }
    Ok(study)
}

/// Where a report goes.
pub(in crate::measure) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folders and sees whether files can be made in each.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        for folder in [
            path.to_path_buf(),
            path.join("plots"),
            path.join("pictures"),
        ] {
            if folder.exists() && !folder.is_dir() {
                return Err(OutputError::InTheWay {
                    path: folder,
                    found: "a file",
                });
            }
            std::fs::create_dir_all(&folder).map_err(|source| OutputError::Write {
                path: folder.clone(),
                source,
            })?;
        }
        let opened = Self { path: path.into() };
        for name in [
            "index.html",
            "measurements.csv",
            "plots/try.svg",
            "pictures/try.png",
        ] {
            opened.pending(name)?;
        }
        Ok(opened)
    }

    /// Begins a file; its extension is whatever its name says.
    fn pending(&self, name: &str) -> Result<PendingFile, OutputError> {
        let (what, extension) = match name.rsplit_once('.') {
            Some((_, "csv")) => ("tables", "csv"),
            Some((_, "svg")) => ("charts", "svg"),
            Some((_, "png")) => ("pictures", "png"),
            _ => ("pages", "html"),
        };
        PendingFile::create(&self.path.join(name), what, extension)
    }

    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        self.pending(name)?.write_whole(contents)
    }

    fn write_tables(&self, study: &Study) -> Result<(), OutputError> {
        self.write("measurements.csv", csv(&study.rows).as_bytes())?;
        self.write("spread.csv", spread_csv(&study.rows).as_bytes())
    }
}
