//! The Earth's figure, time, rotation and the Sun: everything in f64, nothing about drawing.
//!
//! Earth-fixed axes are ITRF: x to 0° E on the equator, z to the north pole.

mod ellipsoid;
mod rotation;
mod sun;
mod time;

pub use ellipsoid::{Ellipsoid, Geodetic};
pub use hifitime::Epoch;
pub use rotation::{itrf_from_gcrf, itrf_from_teme};
pub use sun::sun_direction_itrf;
pub use time::{rfc3339, utc_from_rfc3339};
