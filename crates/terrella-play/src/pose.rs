//! Position and orientation of an eye over the globe: pure f64 functions.

use glam::DVec3;
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};

/// An eye, the direction it looks in, and the direction that is upwards on screen; both unit, across each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// ITRF, metres.
    pub eye_itrf_m: DVec3,
    /// Unit, ITRF axes.
    pub forward: DVec3,
    /// Unit, ITRF axes, at right angles to `forward`.
    pub up: DVec3,
}

/// The level directions of a place: vertical, and north and east along the ground.
///
/// At the poles north is the way along the place's meridian: at ±90° it points beyond the pole, as the limit of
/// latitudes nearby on that meridian does.
pub fn north_of(place: Geodetic) -> DVec3 {
    let (sin_lat, cos_lat) = place.lat_rad.sin_cos();
    let (sin_lon, cos_lon) = place.lon_rad.sin_cos();
    DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat)
}

impl Pose {
    /// Above a place, straight down, north upwards on screen.
    pub fn geodetic(place: Geodetic, ellipsoid: &Ellipsoid) -> Self {
        Self {
            eye_itrf_m: ellipsoid.itrf_from_geodetic(place),
            forward: -Ellipsoid::normal(place.lat_rad, place.lon_rad),
            up: north_of(place),
        }
    }

    /// A pose that looks straight down, north upwards, turned to `heading_rad` clockwise from north and raised to
    /// `pitch_rad` above the horizontal; 0 and −π/2 leave it as it is.
    pub fn facing(&self, heading_rad: f64, pitch_rad: f64) -> Self {
        let (vertical, north) = (-self.forward, self.up);
        let east = north.cross(vertical);
        let ahead = heading_rad.cos() * north + heading_rad.sin() * east;
        let (sin, cos) = pitch_rad.sin_cos();
        Self {
            eye_itrf_m: self.eye_itrf_m,
            forward: cos * ahead + sin * vertical,
            up: cos * vertical - sin * ahead,
        }
    }

    /// The view for the renderer. `aspect` is width over height.
    pub fn view(&self, fov_rad: f64, aspect: f64) -> EyeView {
        EyeView::itrf(self.eye_itrf_m, self.forward, self.up, fov_rad, aspect)
    }
}
