//! Heights of the ground: what surfaces with relief are made from.
//!
//! Heights are metres above the ellipsoid. Data that are given above mean sea level are taken as they are: the geoid lies
//! within 107 m of WGS84, and no surface here tells the two apart.

use crate::frames::Ellipsoid;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A rectangle of geodetic latitude and longitude, radians. It may cross the date line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Latitude of the southern edge, −π/2…π/2.
    pub south_rad: f64,
    /// Latitude of the northern edge, not below [`Self::south_rad`].
    pub north_rad: f64,
    /// Longitude of the western edge; any turn.
    pub west_rad: f64,
    /// From there to the eastern edge, 0…2π.
    pub width_rad: f64,
}

impl Bounds {
    /// The whole Earth.
    pub const GLOBE: Self = Self {
        south_rad: -0.5 * PI,
        north_rad: 0.5 * PI,
        west_rad: -PI,
        width_rad: TAU,
    };

    /// Whether a place lies inside or on the edge.
    pub fn contains(&self, lat_rad: f64, lon_rad: f64) -> bool {
        (self.south_rad..=self.north_rad).contains(&lat_rad)
            && (lon_rad - self.west_rad).rem_euclid(TAU) <= self.width_rad
    }
}

/// Lowest and highest of some heights, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightRange {
    /// Lowest.
    pub low_m: f64,
    /// Highest.
    pub high_m: f64,
}

/// A source of heights. Every answer is finite: where there are no data, a source says what it takes in their place.
pub trait Elevation: Send + Sync {
    /// Height at a geodetic place, metres, averaged over about `spacing_rad` of ground to each side (an angle at the Earth's
    /// centre); 0 asks for the finest there is. Continuous in the place. Longitude may be of any turn, and a latitude
    /// beyond a pole is taken as the pole's.
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64;

    /// Lowest and highest height that [`Self::height_m`] answers inside the bounds, at any spacing. May be too wide, never
    /// too narrow.
    fn range_m(&self, bounds: &Bounds) -> HeightRange;

    /// Angle between neighbouring samples of the finest data at a place, radians; infinite where heights do not vary.
    fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64;

    /// Rise of the ground to the east and to the north, metres per metre, between places `spacing_rad` to each side.
    fn slope(&self, ellipsoid: &Ellipsoid, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> DVec2 {
        let step_rad = spacing_rad.max(self.finest_spacing_rad(lat_rad, lon_rad));
        if !step_rad.is_finite() {
            return DVec2::ZERO;
        }
        let height = |lat: f64, lon: f64| self.height_m(lat, lon, spacing_rad);
        // Along the parallel as far as along the meridian; near a pole at most a quarter turn.
        let along_rad = (step_rad / lat_rad.cos().max(1e-9)).min(0.5 * PI);
        let (south, north) = (
            (lat_rad - step_rad).max(-0.5 * PI),
            (lat_rad + step_rad).min(0.5 * PI),
        );
        let at = |lat, lon| -> DVec3 { ellipsoid.surface_point(Ellipsoid::normal(lat, lon)) };
        let east_m = at(lat_rad, lon_rad + along_rad).distance(at(lat_rad, lon_rad - along_rad));
        let north_m = at(north, lon_rad).distance(at(south, lon_rad));
        let rise = DVec2::new(
            height(lat_rad, lon_rad + along_rad) - height(lat_rad, lon_rad - along_rad),
            height(north, lon_rad) - height(south, lon_rad),
        );
        rise / DVec2::new(east_m.max(1e-3), north_m.max(1e-3))
    }
}
