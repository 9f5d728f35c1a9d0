//! Measuring: how long a picture takes, how wrong it is, and where a formula stops being stable.
//!
//! | module | what |
//! |---|---|
//! | `stations` | where the harness looks from: the heights of the paper's Table 2 and farther |
//! | `rig` | an Earth on a test stand: frames and their floor, timed turn about |
//! | `floor` | the least that a frame could cost |
//! | [`mod@bench`] | the frame-rate harness |
//! | [`mod@reference`] | the true picture: ray casting in f64 on the processor |
//! | [`numeric`] | formulas held against arbitrary precision, methods compared by error and cost |
//! | [`extreme`] | pictures that nobody would ask for, and what they must show |
//! | [`errors`] | how wrong a picture is: colours, places, silhouette |
//! | [`mod@report`] | error against run time over a scene's settings: tables, charts, a page |
//! | [`surfaces`] | surfaces with relief: error beside run time, holes, popping |
//! | [`terrain`] | trees over heights on their own: what they save, build times, storage |
//! | [`orbits`] | propagators: error beside run time |
//! | `quantiles`, `pareto`, `chart`, `axis` | what is told of measurements |

mod axis;
pub mod bench;
mod chart;
pub mod errors;
pub mod extreme;
mod floor;
pub mod numeric;
pub mod orbits;
mod pareto;
mod quantiles;
pub mod reference;
pub mod report;
mod rig;
mod stations;
pub mod surfaces;
pub mod terrain;

pub use chart::{Chart, ChartError, Point, Series};
pub use floor::Floor;
pub use pareto::pareto_front;
pub use quantiles::{Quantiles, Spread, jank};
pub use rig::{Rig, Sample};
pub use stations::{GroundPath, STATIONS, Station};
