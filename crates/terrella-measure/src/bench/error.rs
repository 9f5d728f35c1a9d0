//! Errors of a harness run.

use crate::ChartError;
use std::path::PathBuf;
use terrella_play::{OutputError, PlayError};

/// Errors of a harness run, and its negative results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// Scene, adapter, maps or drawing.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A chart cannot be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// The baseline cannot be read.
    #[error("{}: the baseline cannot be read: {source}", path.display())]
    BaselineUnreadable {
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The baseline is no report of a complete run.
    #[error(
        "{}: is no baseline: {what}; make one with `terrella bench SCENE --json {}`",
        path.display(), path.display()
    )]
    NoBaseline {
        path: PathBuf,
        /// Why it is invalid.
        what: String,
    },
    /// The baseline is of something else.
    #[error(
        "{}: cannot be compared with this run: {what} is {there} there and {here} here; \
         compare like with like, or make a new baseline with --json",
        path.display()
    )]
    OtherBaseline {
        path: PathBuf,
        /// The difference.
        what: String,
        /// Its value in the baseline.
        there: String,
        /// Its value in this run.
        here: String,
    },
    /// The work was stopped from outside.
    #[error(
        "interrupted after {done} of {wanted} rows; what was written holds the complete rows and says that it is partial"
    )]
    Interrupted {
        /// Rows measured.
        done: usize,
        /// Rows wanted.
        wanted: usize,
    },
    /// More frames than are kept.
    #[error(
        "{frames} frames in each of {repeats} runs are more than 10 000 a row; give fewer --frames or --repeats"
    )]
    TooManyFrames {
        /// Frames in a run.
        frames: u32,
        /// Runs.
        repeats: u32,
    },
    /// Slower than the baseline.
    #[error(
        "{count} of {rows} rows are slower than the baseline, by more than {effect_pct:.0} % with all that their noise leaves open: {worst}"
    )]
    Slower {
        /// Rows that are slower.
        count: usize,
        /// Rows compared.
        rows: usize,
        /// The smallest effect that counts, per cent.
        effect_pct: f64,
        /// The worst row and its interval, as text.
        worst: String,
    },
}

impl BenchError {
    /// Whether the error is in the scene, and not on the machine.
    pub fn is_bad_scene(&self) -> bool {
        matches!(self, Self::Play(error) if error.is_bad_scene())
    }

    /// Whether the run succeeded and the frames are slower than before.
    pub fn is_slower(&self) -> bool {
        matches!(self, Self::Slower { .. })
    }
}
