//! The frame-rate harness: the paper's Table 2 and beyond, each frame compared with its floor, and the cost of each layer.
//!
//! | file | content |
//! |---|---|
//! | `run` | the order of a run: files and baseline first, then rows, features, output |
//! | `rows` | one height along one path |
//! | `features` | the scene with one layer or effect switched off |
//! | `blocks` | the expected number of visible blocks, counted independently |
//! | `settings` | settings of a scene that affect the work of a frame |
//! | `report` | the JSON |
//! | `baseline`, `interval` | comparison of two reports, and its uncertainty |
//! | `table`, `plots` | human-readable output |
//!
//! Times of a shared or unknown machine cannot be compared with others. Each frame is therefore timed interleaved with its [`Floor`](super::Floor)
//! and a bare clear. The ratio of frame and floor is printed first, and compared with a baseline.

mod baseline;
mod blocks;
mod error;
mod features;
mod interval;
mod plots;
mod report;
mod rows;
mod run;
mod settings;
mod table;
#[cfg(test)]
mod tests;

pub use baseline::{Baseline, Comparison, RowChange};
pub use blocks::{BlockCounts, sees_block};
pub use error::BenchError;
pub use interval::Interval;
pub use report::{
    BenchReport, BenchRow, COURSE_HEIGHT_KM, Course, Feature, FeatureTimes, RowTimes, Unmeasured,
    VERSION,
};
pub use run::{BenchRequest, BenchRun, MAX_FRAMES, run_bench};
