//! The largest terms of ELP/MPP02 (J. Chapront and G. Francou 2003, A&A 404, 735) with its constants for DE405.
//!
//! The terms are those of the npm package `astronomia` 4.2.0 (`data/elpMppDeFull.js`, MIT, © 2013 Sonia Keys, © 2016 commenthol), truncated at
//! 0.012″ in longitude, 0.010″ in latitude and 35 m; terms that grow with time, at the same values per century. A row is a term: its amplitude, and
//! the phase's polynomial in Julian centuries of TDB from J2000, radians.

mod distance;
mod latitude;
mod longitude;

pub(super) use distance::{DISTANCE, DISTANCE_T};
pub(super) use latitude::{LATITUDE, LATITUDE_T};
pub(super) use longitude::{LONGITUDE, LONGITUDE_T};
