//! Measurements: the time and the errors of images, and the stability of formulas.
//!
//! | module | content |
//! |---|---|
//! | `viewpoints` | positions of the eye: the heights of the paper's Table 2 and beyond |
//! | `frame_timer` | frames and their floor, timed interleaved |
//! | `floor` | the cost of a frame's texture samples alone |
//! | [`mod@bench`] | the frame-rate harness |
//! | [`numeric`] | formulas compared with arbitrary precision, methods compared by error and cost |
//! | [`extreme`] | extreme views, and their expected results |
//! | [`clear_air`] | the air's light, compared with tables of a radiative-transfer program |
//! | [`errors`] | errors of an image: colours, geolocation, silhouette |
//! | [`mod@report`] | error against run time over a scene's settings: tables, charts, a page |
//! | [`quality`] | saving and error of each quality reduction, and the resulting ladder |
//! | [`surfaces`] | terrain surfaces: error against run time, holes, popping |
//! | `still` | one image by the reference renderer, `terrella_reference`, into a file |
//! | [`terrain`] | terrain trees alone: savings, build times, storage |
//! | [`orbits`] | propagators: error against run time |
//! | `machine` | machine, source and time of a measurement |
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
pub mod report;
mod statistics;
mod still;
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
pub use still::{ReferenceRequest, ReferenceStats, StillError, write_reference_still};
pub use viewpoints::{EYE_HEIGHTS, EyeHeight, GroundPath};
