//! Eye positions of viewers.

use crate::elevation::Bounds;
use crate::elevation::tiles::NearEye;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Mutex;
use terrella_files::loaders::lock;
use terrella_frames::{Ellipsoid, Geodetic};

/// Mean radius of the Earth, metres: accurate enough for distances.
const RADIUS_M: f64 = 6_371_000.0;

/// Minimum distance, metres.
const NEAREST_M: f64 = 1.0;

/// Assumed maximum height of the ground, metres; distances are measured to it.
const GROUND_M: f64 = 6000.0;

/// An eye with its angular tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightEye {
    pub eye_itrf_m: DVec3,
    /// Samples that appear smaller than this need no refinement, radians.
    pub tolerance_rad: f64,
}

/// An eye and its geodetic position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EyePlace {
    eye: HeightEye,
    place: Geodetic,
}

impl EyePlace {
    /// `None` for an invalid position.
    pub fn from(eye: HeightEye) -> Option<Self> {
        let is_sound = eye.eye_itrf_m.is_finite()
            && eye.eye_itrf_m.length() > 1.0
            && eye.tolerance_rad.is_finite();
        let place = Ellipsoid::WGS84.geodetic_from_itrf(eye.eye_itrf_m);
        let is_place = place.lat_rad.is_finite() && place.lon_rad.is_finite();
        (is_sound && is_place).then_some(Self { eye, place })
    }

    pub fn tolerance_rad(&self) -> f64 {
        self.eye.tolerance_rad
    }

    /// The eye as readers of heights use it.
    pub fn near(&self) -> NearEye {
        NearEye {
            lat_rad: self.place.lat_rad,
            lon_rad: self.place.lon_rad,
            height_rad: (self.place.height_m - GROUND_M).max(NEAREST_M) / RADIUS_M,
            tolerance_rad: self.eye.tolerance_rad,
        }
    }

    /// Apparent size of the angle `spacing_rad` at the Earth's centre, at the nearest place of the bounds,
    /// radians.
    pub fn seen_rad(&self, bounds: &Bounds, spacing_rad: f64) -> f64 {
        let half_rad = 0.5 * bounds.width_rad;
        let middle_rad = bounds.west_rad + half_rad;
        let off_rad = (self.place.lon_rad - middle_rad + PI).rem_euclid(TAU) - PI;
        let lon_rad = middle_rad + off_rad.clamp(-half_rad, half_rad);
        let lat_rad = self.place.lat_rad.clamp(bounds.south_rad, bounds.north_rad);
        let normal = Ellipsoid::normal(lat_rad, lon_rad);
        let raised_m = self.place.height_m.clamp(0.0, GROUND_M);
        let near = Ellipsoid::WGS84.surface_point(normal) + normal * raised_m;
        spacing_rad * RADIUS_M / near.distance(self.eye.eye_itrf_m).max(NEAREST_M)
    }
}

/// Position of a viewer, held by that viewer.
#[derive(Debug, Default)]
pub struct HeightViewer(Mutex<Option<EyePlace>>);

impl HeightViewer {
    /// Sets the eye. An invalid position counts as no viewer.
    pub fn look(&self, eye: HeightEye) {
        *lock(&self.0) = EyePlace::from(eye);
    }

    pub(super) fn looks(&self) -> Option<EyePlace> {
        *lock(&self.0)
    }
}
