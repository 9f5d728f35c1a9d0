//! Grounds and views that the tests share.

mod coverage;
mod extremes;
mod roots;
mod swimming;
mod tiles;

use super::*;
use crate::elevation::{Bounds, HeightRange};
use glam::{DMat3, DMat4, DVec4};

const R: f64 = 6.37e6;

/// Waves of one length over the whole Earth, or a single mountain: smooth, so that images of it can be predicted.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ground {
    Flat(f64),
    /// Mean height, amplitude and wave length, metres.
    Waves(f64, f64, f64),
    /// Latitude, longitude, height and radius in metres, over −10 m.
    Mountain(f64, f64, f64, f64),
}

impl Ground {
    /// Upper bound of the slope, metres per metre.
    pub fn steepest(&self) -> f64 {
        match *self {
            Self::Flat(_) => 0.0,
            // Three waves of a third, each with the slope 2π A/λ.
            Self::Waves(_, amplitude, length) => 1.01 * std::f64::consts::TAU * amplitude / length,
            // e^(−x²) falls by at most √(2/e).
            Self::Mountain(_, _, height, radius) => 0.9 * height / radius,
        }
    }
}

impl Elevation for Ground {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        match *self {
            Self::Flat(height_m) => height_m,
            Self::Waves(middle, amplitude, length) => {
                let n = Ellipsoid::normal(lat_rad, lon_rad);
                let k = std::f64::consts::TAU * R / length;
                let half = k * spacing_rad;
                let left = if half < 1e-3 {
                    1.0
                } else {
                    half.sin().abs() / half
                };
                let wave = |v: DVec3| (k * n.dot(v.normalize())).sin();
                let sum = wave(DVec3::new(1.0, 0.3, 0.2))
                    + wave(DVec3::new(-0.2, 1.0, 0.4))
                    + wave(DVec3::new(0.1, -0.3, 1.0));
                middle + amplitude * left * sum / 3.0
            }
            Self::Mountain(lat, lon, height, radius) => {
                let off =
                    Ellipsoid::normal(lat_rad, lon_rad).distance(Ellipsoid::normal(lat, lon)) * R;
                let wide = radius.hypot(spacing_rad * R);
                let part = radius / wide;
                height * part * part * (-(off / wide) * (off / wide)).exp() - 10.0
            }
        }
    }

    fn range_m(&self, bounds: &Bounds) -> HeightRange {
        let (low_m, high_m) = match *self {
            Self::Flat(height_m) => (height_m, height_m),
            Self::Waves(middle, amplitude, _) => {
                // From the height in the middle, by the steepest slope.
                let (lat, lon) = (
                    0.5 * (bounds.south_rad + bounds.north_rad),
                    bounds.west_rad + 0.5 * bounds.width_rad,
                );
                let center = Ellipsoid::normal(lat, lon);
                let angle = [bounds.south_rad, bounds.north_rad]
                    .map(|edge| center.distance(Ellipsoid::normal(edge, bounds.west_rad)))
                    .into_iter()
                    .fold(0.5 * bounds.width_rad * lat.cos(), f64::max);
                let rise = self.steepest() * angle * R * 1.01;
                let here = self.height_m(lat, lon, 0.0);
                let all_round = bounds.width_rad > 3.0;
                let (low, high) = (middle - amplitude, middle + amplitude);
                if all_round {
                    (low, high)
                } else {
                    (low.max(here - rise), high.min(here + rise))
                }
            }
            Self::Mountain(lat, lon, height, radius) => {
                // Beyond 6.5 radii the mountain is lower than a millimetre.
                let reach = 6.5 * radius / 6.37e6;
                let near = Bounds {
                    south_rad: bounds.south_rad - reach,
                    north_rad: bounds.north_rad + reach,
                    west_rad: bounds.west_rad - reach / lat.cos(),
                    width_rad: (bounds.width_rad + 2.0 * reach / lat.cos())
                        .min(std::f64::consts::TAU),
                };
                (
                    -10.0,
                    if near.contains(lat, lon) {
                        height
                    } else {
                        -9.9
                    },
                )
            }
        };
        HeightRange { low_m, high_m }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        match self {
            Self::Flat(_) => f64::INFINITY,
            _ => 1e-7,
        }
    }
}

/// A view given by plain numbers, degrees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub lat: f64,
    pub lon: f64,
    /// Height above the ground there.
    pub height_m: f64,
    /// Angle from straight down: 90 is level.
    pub pitch: f64,
    /// Angle from north, eastwards.
    pub heading: f64,
    pub roll: f64,
    /// Full vertical angle.
    pub fov: f64,
    /// Shift of the projection's centre, in half images.
    pub shift: (f64, f64),
}

pub(super) const LOOK: Look = Look {
    lat: 47.0,
    lon: 11.0,
    height_m: 4e5,
    pitch: 0.0,
    heading: 30.0,
    roll: 0.0,
    fov: 40.0,
    shift: (0.0, 0.0),
};

impl Look {
    pub fn place(&self) -> (f64, f64) {
        (self.lat.to_radians(), self.lon.to_radians())
    }

    pub fn view(&self, ground: &Ground) -> GroundView {
        let (lat_rad, lon_rad) = self.place();
        let height_m = ground.height_m(lat_rad, lon_rad, 0.0) + self.height_m;
        let eye_itrf_m = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic {
            lat_rad,
            lon_rad,
            height_m,
        });
        let up = Ellipsoid::normal(lat_rad, lon_rad);
        let east = DVec3::new(-lon_rad.sin(), lon_rad.cos(), 0.0);
        let north = up.cross(east);
        let (sin, cos) = self.heading.to_radians().sin_cos();
        let ahead = north * cos + east * sin;
        let right = east * cos - north * sin;
        let (sin, cos) = self.pitch.to_radians().sin_cos();
        let forward = ahead * sin - up * cos;
        let head = ahead * cos + up * sin;
        let (sin, cos) = self.roll.to_radians().sin_cos();
        let view_from_itrf =
            DMat3::from_cols(right * cos + head * sin, head * cos - right * sin, -forward)
                .transpose();
        let f = 1.0 / (0.5 * self.fov.to_radians()).tan();
        let aspect = 16.0 / 9.0;
        // Infinite reversed Z, shifted as off-centre projections are.
        let clip_from_view = DMat4::from_cols(
            DVec4::new(f / aspect, 0.0, 0.0, 0.0),
            DVec4::new(0.0, f, 0.0, 0.0),
            DVec4::new(self.shift.0, self.shift.1, 0.0, -1.0),
            DVec4::new(0.0, 0.0, 0.1, 0.0),
        );
        GroundView {
            eye_itrf_m,
            clip_from_eye: clip_from_view * DMat4::from_mat3(view_from_itrf),
            pixel_rad: self.fov.to_radians() / 720.0,
            tolerance_px: 1.0,
        }
    }
}
