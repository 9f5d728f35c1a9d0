//! Saving and error of each quality reduction, and the resulting ladder.
//!
//! A greedy search from full quality downwards. Each remaining reduction is tried in addition to those already applied, timed interleaved with full
//! quality in the same views, and compared with its images. The one with the largest saving per added error is taken, and the search continues from
//! there. Combinations on the Pareto front of error and cost that save enough become steps of the [`QualityLadder`](terrella::QualityLadder).
//!
//! | file | content |
//! |---|---|
//! | `views.rs` | the views |
//! | `run.rs` | drawing, timing and comparing |
//! | `search.rs` | choice of the next reduction, and the ladder |
//! | `study.rs` | results as tables and a chart |

mod run;
mod search;
mod study;
mod views;

pub use search::{Combination, ladder_of};
pub use study::QualityStudy;

use super::ChartError;
use super::output::OutputFolder;
use std::path::Path;
use terrella_play::{Flight, OutputError, PlayError, Progress};

/// How a study is wanted.
#[derive(Clone, Debug)]
pub struct QualityRequest<'r> {
    /// The folder that it is written to; made if it is not there.
    pub folder: &'r Path,
    /// Width and height of the pictures, pixels.
    pub size: (u32, u32),
    /// How often each combination is timed over all views, from 1.
    pub repeats: u32,
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum QualityError {
    /// Drawing.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// Writing.
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// Stopped by the user.
    #[error("stopped after {done} combinations; {path} has them, and no ladder was written")]
    Interrupted {
        /// Combinations that were measured.
        done: usize,
        /// The table.
        path: String,
    },
}

/// Measures a scene's reductions and writes `quality.csv` (every combination), `ladder.csv` (the steps, for `[quality] ladder`) and a
/// chart.
///
/// # Errors
/// A folder that cannot be written to, before anything is drawn; all errors of drawing. After an interrupt the table of complete measurements is
/// written anyway.
pub fn study_quality(
    flight: &Flight,
    request: &QualityRequest<'_>,
    progress: &dyn Progress,
) -> Result<QualityStudy, QualityError> {
    let folder = OutputFolder::open(request.folder)?;
    let study = run::run(flight, request, progress)?;
    folder.write("quality.csv", study.csv().as_bytes())?;
    if study.is_stopped {
        return Err(QualityError::Interrupted {
            done: study.combinations.len(),
            path: request.folder.join("quality.csv").display().to_string(),
        });
    }
    folder.write("ladder.csv", study.ladder_text().as_bytes())?;
    folder.write("plots/quality.svg", study.chart().to_svg()?.as_bytes())?;
    Ok(study)
}
