//! The Earth's figure, time, rotation and the Sun: everything in f64, nothing about drawing.
//!
//! Earth-fixed axes are ITRF: x to 0° E on the equator, z to the north pole.

mod bodies;
mod calendar;
mod ccsds;
mod earth_motion;
mod earth_orientation;
mod eclipse;
mod ellipsoid;
mod moon;
mod moon_shadow;
mod observer;
mod orientation;
mod rotation;
mod sun;
mod time;

pub use bodies::{
    ASTRONOMICAL_UNIT_M, earth_rotation_angle_rad, intermediate_from_gcrf, sun_position_gcrf_m,
};
pub use calendar::Calendar;
pub use ccsds::{TimeScale, ccsds_time, epoch_from_ccsds, epoch_from_tdb};
pub use earth_orientation::{EarthOrientation, EarthOrientationError};
pub use eclipse::uncovered;
pub use eclipse::{
    Illumination, SUN_RADIUS_M, illumination, shadow_margins_rad, sun_position_itrf_m,
};
pub use ellipsoid::{Ellipsoid, Geodetic};
pub use hifitime::{Duration, Epoch};
pub use moon::{MOON_RADIUS_M, moon_from_gcrf, moon_position_gcrf_m};
pub use moon_shadow::MoonShadow;
pub use observer::Observer;
pub use orientation::Orientation;
pub use rotation::{
    EARTH_ROTATION_RATE_RAD_S, gcrf_from_eme2000, gcrf_from_mod, gcrf_from_tod, itrf_from_gcrf,
    itrf_from_gcrf_oriented, itrf_from_gcrf_with_ut1, itrf_from_pef, itrf_from_teme,
    itrf_from_teme_with_ut1, pef_from_teme,
};
pub use sun::{SUN_RADIUS_RAD, subsolar_point, sun_direction_itrf, sun_direction_itrf_oriented};
pub use time::{TimeError, rfc3339, rfc3339_with_offset, utc_from_rfc3339, utc_from_text, utc_now};
pub use time::{tai_from_utc_day, utc_day};
