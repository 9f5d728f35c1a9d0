//! The frame-rate harness: the paper's Table 2 and farther, each frame beside its floor, and what each layer costs.
//!
//! | file | what |
//! |---|---|
//! | `run` | the order of a run: files and baseline first, then rows, features, what is written |
//! | `rows` | one height along one path |
//! | `features` | the scene with one layer or effect switched off |
//! | `blocks` | how many blocks an eye should see, counted independently |
//! | `settings` | what of a scene bears on the work of a frame |
//! | `report` | the JSON |
//! | `baseline`, `interval` | two reports compared, and what their noise leaves open |
//! | `table`, `plots` | what a person reads |
//!
//! Times of a shared or unknown machine cannot be compared with others. So each frame is timed beside its
//! [`Floor`](super::Floor) and a bare clear, interleaved, and the ratio of frame and floor is what is printed first and what a
//! baseline is held to.

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
