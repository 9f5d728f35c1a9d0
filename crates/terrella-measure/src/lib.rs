//! Measuring: how long a picture takes, how wrong it is, and where a formula stops being stable.
//!
//! | module | what |
//! |---|---|
//! | `viewpoints` | where frames are measured from: the heights of the paper's Table 2 and farther |
//! | `frame_timer` | frames and their floor, timed interleaved |
//! | `floor` | what a frame's texture samples cost alone |
//! | [`mod@bench`] | the frame-rate harness |
//! | [`mod@reference`] | the true picture: ray casting in f64 on the processor |
//! | [`numeric`] | formulas compared with arbitrary precision, methods compared by error and cost |
//! | [`extreme`] | pictures that nobody would ask for, and what they must show |
//! | [`clear_air`] | the air's light against tables of a radiative-transfer program |
//! | [`errors`] | how wrong a picture is: colours, places, silhouette |
//! | [`mod@report`] | error against run time over a scene's settings: tables, charts, a page |
//! | [`quality`] | what each reduction of quality saves and costs in error, and the ladder that follows |
//! | [`surfaces`] | surfaces with relief: error beside run time, holes, popping |
//! | [`terrain`] | trees over heights on their own: what they save, build times, storage |
//! | [`orbits`] | propagators: error beside run time |
//! | `machine` | where and when something is measured |
//! | `statistics`, `histogram`, `pareto` | medians, quartiles, jank; quantiles of many values; the Pareto front |
//! | `chart`, `axis`, `html`, `output` | measurements as charts, pages and tables, and the folder they are written to |

#![allow(missing_docs, reason = "names of measurements say what they are")]

mod axis;
#[cfg(test)]
#[path = "../../../tests/common/backends.rs"]
mod backends;
pub mod bench;
mod chart;
pub mod clear_air;
pub mod errors;
pub mod extreme;
mod floor;
mod frame_timer;
mod histogram;
mod html;
mod machine;
pub mod numeric;
pub mod orbits;
mod output;
mod pareto;
pub mod quality;
pub mod reference;
pub mod report;
mod statistics;
pub mod surfaces;
pub mod terrain;
mod viewpoints;

pub use chart::{Chart, ChartError, Point, Series};
pub use floor::Floor;
pub use frame_timer::{FrameTimer, FrameTimes};
pub use histogram::LogHistogram;
pub use html::PageError;
pub use pareto::pareto_front;
pub use statistics::{Quantiles, Quartiles, SortedSample, jank, median};
pub use viewpoints::{EYE_HEIGHTS, EyeHeight, GroundPath};
