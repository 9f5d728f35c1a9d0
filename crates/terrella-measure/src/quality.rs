//! What each reduction of quality saves and what it costs in error, and the ladder that follows.
//!
//! A search from the full quality down: every reduction that is left is tried on top of what is given up already, each timed interleaved
//! with the full quality in the same views and compared with its pictures, and the one that saves most for the error that
//! it adds is taken; then again from there. What is on the Pareto front of error and cost of all that was tried, and saves
//! enough, is a step of the [`QualityLadder`](terrella::QualityLadder).
//!
//! | file | what |
//! |---|---|
//! | `views.rs` | where it is seen from |
//! | `run.rs` | drawing, timing and comparing |
//! | `search.rs` | which reduction is taken next, and the ladder |
//! | `study.rs` | what is found, as tables and a chart |

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
/// A folder that cannot be written to, before anything is drawn; all that drawing can meet. After an interrupt the table of
/// what was measured is written anyway.
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
