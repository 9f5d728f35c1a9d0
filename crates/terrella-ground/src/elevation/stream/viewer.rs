//! Where heights are looked at from.

use crate::elevation::Bounds;
use crate::elevation::tiles::NearEye;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Mutex;
use terrella_files::loaders::lock;
use terrella_frames::{Ellipsoid, Geodetic};

/// Mean radius of the Earth, metres: good enough to say what is near.
const RADIUS_M: f64 = 6_371_000.0;

/// Nothing is taken for nearer than this, metres.
const NEAREST_M: f64 = 1.0;

/// Ground may stand as high, metres: it is as near as if it did.
const GROUND_M: f64 = 6000.0;

/// An eye, and how exactly it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightEye {
    pub eye_itrf_m: DVec3,
    /// Samples that are seen smaller need not be finer, radians.
    pub tolerance_rad: f64,
}

/// An eye and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EyePlace {
    eye: HeightEye,
    place: Geodetic,
}

impl EyePlace {
    /// `None` of what is no place.
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

    /// As whoever reads heights knows it.
    pub fn near(&self) -> NearEye {
        NearEye {
            lat_rad: self.place.lat_rad,
            lon_rad: self.place.lon_rad,
            height_rad: (self.place.height_m - GROUND_M).max(NEAREST_M) / RADIUS_M,
            tolerance_rad: self.eye.tolerance_rad,
        }
    }

    /// How large the angle `spacing_rad` at the Earth's centre is seen where the bounds are nearest, radians.
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

/// A place that heights are looked at from, held by who looks.
#[derive(Debug, Default)]
pub struct HeightViewer(Mutex<Option<EyePlace>>);

impl HeightViewer {
    /// Looks from here from now on; what is no place is nobody.
    pub fn look(&self, eye: HeightEye) {
        *lock(&self.0) = EyePlace::from(eye);
    }

    pub(super) fn looks(&self) -> Option<EyePlace> {
        *lock(&self.0)
    }
}
