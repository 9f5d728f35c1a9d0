//! Target of a scene's camera, kept in the image centre.

use super::pose::Pose;
use crate::scene::{LookAt, Scene, SceneError};
use glam::DVec3;
use terrella::frames::{Ellipsoid, Geodetic};

/// Target of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LookTarget {
    /// The Sun's middle.
    Sun,
    /// The Moon's middle.
    Moon,
    /// The satellite that cameras fly with.
    Followed,
    /// Another satellite, by its place in the scene.
    Other(usize),
    /// A point, ITRF, metres.
    Point(DVec3),
}

impl LookTarget {
    /// The target in a scene with satellites of these names; `None` if the camera's mode sets the viewing direction.
    ///
    /// # Errors
    /// If the scene has no satellite with the name, or none at all, or the camera is on board of it.
    pub fn of(scene: &Scene, names: &[&str], followed: usize) -> Result<Option<Self>, SceneError> {
        let Some(target) = &scene.camera.look_at else {
            return Ok(None);
        };
        Ok(Some(match target {
            LookAt::Sun => Self::Sun,
            LookAt::Moon => Self::Moon,
            LookAt::Place([lat_deg, lon_deg, height_km]) => {
                let place = Geodetic::from_degrees(*lat_deg, *lon_deg, height_km * 1e3);
                let ellipsoid = scene.earth.figure.ellipsoid();
                Self::Point(ellipsoid.itrf_from_geodetic(place))
            }
            LookAt::Satellite(name) => match scene.looked_at(name.as_deref(), names, followed)? {
                index if index == followed => Self::Followed,
                index => Self::Other(index),
            },
        }))
    }
}

impl Pose {
    /// Turned to a point, the vertical of the eye's place upwards on screen; as it is where the point is the eye itself.
    pub(super) fn looking_at(&self, point_itrf_m: DVec3, ellipsoid: &Ellipsoid) -> Self {
        let Some(forward) = (point_itrf_m - self.eye_itrf_m).try_normalize() else {
            return *self;
        };
        let place = ellipsoid.geodetic_from_itrf(self.eye_itrf_m);
        let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        // Straight up or down what was upwards stays so.
        let upwards = [vertical, self.up, self.forward];
        let across = upwards.map(|up| up.reject_from_normalized(forward));
        let up = across.into_iter().find(|up| up.length() > 1e-6);
        Self {
            eye_itrf_m: self.eye_itrf_m,
            forward,
            up: up.and_then(DVec3::try_normalize).unwrap_or(self.up),
        }
    }

    /// Turned clockwise about the direction of view.
    pub(super) fn rolled(&self, roll_rad: f64) -> Self {
        let (sin, cos) = roll_rad.sin_cos();
        let right = self.forward.cross(self.up);
        Self {
            up: cos * self.up + sin * right,
            ..*self
        }
    }
}
