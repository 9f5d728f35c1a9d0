//! Cameras: plain values for position, attitude and projection.

use crate::arguments::{matrix_3, matrix_4, vector, within};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_play::camera::Pose;

/// A camera for images of any size: an eye (Earth-fixed axes, metres), the viewing direction, and the up direction on screen, both of any
/// length. `fov_deg` is the vertical field of view.
#[pyclass(frozen, from_py_object, name = "Camera", module = "terrella", eq)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PyCamera(Lens);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Lens {
    /// A vertical field of view; the image's size gives the horizontal one.
    Looking { pose: Pose, fov_rad: f64 },
    /// A projection from the caller.
    Matrices(EyeView),
}

#[pymethods]
impl PyCamera {
    #[new]
    #[pyo3(signature = (eye_itrf_m, forward, up, *, fov_deg = 45.0))]
    fn new(
        eye_itrf_m: &Bound<'_, PyAny>,
        forward: &Bound<'_, PyAny>,
        up: &Bound<'_, PyAny>,
        fov_deg: f64,
    ) -> PyResult<Self> {
        let direction = |value, name| -> PyResult<DVec3> {
            let vector = vector(value, name)?;
            vector
                .try_normalize()
                .ok_or_else(|| PyValueError::new_err(format!("{name}: no direction")))
        };
        let pose = Pose {
            eye_itrf_m: vector(eye_itrf_m, "eye_itrf_m")?,
            forward: direction(forward, "forward")?,
            up: direction(up, "up")?,
        };
        let fov_rad = fov(fov_deg)?;
        Ok(Self(Lens::Looking { pose, fov_rad }))
    }

    /// A camera above a place (geodetic, WGS84). With heading 0 and pitch -90 it looks straight down, north upwards; heading turns it clockwise
    /// from north, pitch raises it, 0 is level. `fov_deg` is the vertical field of view.
    #[staticmethod]
    #[pyo3(
        signature = (lat_deg, lon_deg, height_m, *, heading_deg = 0.0, pitch_deg = -90.0, fov_deg = 45.0),
        // pyo3 writes no default for a negative number.
        text_signature = "(lat_deg, lon_deg, height_m, *, heading_deg=0.0, pitch_deg=-90.0, fov_deg=45.0)"
    )]
    fn geodetic(
        lat_deg: f64,
        lon_deg: f64,
        height_m: f64,
        heading_deg: f64,
        pitch_deg: f64,
        fov_deg: f64,
    ) -> PyResult<Self> {
        let place = Geodetic::from_degrees(
            within(lat_deg, "lat_deg", -90.0, 90.0)?,
            within(lon_deg, "lon_deg", -360.0, 360.0)?,
            within(height_m, "height_m", -1e4, 1e12)?,
        );
        let heading_rad = within(heading_deg, "heading_deg", -360.0, 360.0)?.to_radians();
        let pitch_rad = within(pitch_deg, "pitch_deg", -90.0, 90.0)?.to_radians();
        let pose = Pose::geodetic(place, &Ellipsoid::WGS84).facing(heading_rad, pitch_rad);
        let fov_rad = fov(fov_deg)?;
        Ok(Self(Lens::Looking { pose, fov_rad }))
    }

    /// A camera of a position, a rotation (3 × 3, from Earth-fixed axes to those of the view: x right, y up, -z forward) and a projection
    /// (4 × 4, to clip space with z from 0 to 1, nearer larger, y upwards).
    #[staticmethod]
    fn matrices(
        eye_itrf_m: &Bound<'_, PyAny>,
        view_from_itrf: &Bound<'_, PyAny>,
        clip_from_view: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let rotation = matrix_3(view_from_itrf, "view_from_itrf")?;
        let product = rotation * rotation.transpose();
        let off = (product - glam::DMat3::IDENTITY).to_cols_array();
        if off.iter().any(|off| off.abs() > 1e-6) || rotation.determinant() < 0.0 {
            return Err(PyValueError::new_err(
                "view_from_itrf: no rotation: its rows must be unit vectors at right angles, right-handed",
            ));
        }
        let clip_from_view: DMat4 = matrix_4(clip_from_view, "clip_from_view")?;
        if clip_from_view.determinant() == 0.0 {
            return Err(PyValueError::new_err("clip_from_view: it has no inverse"));
        }
        Ok(Self(Lens::Matrices(EyeView {
            eye_world: vector(eye_itrf_m, "eye_itrf_m")?,
            view_from_world: DQuat::from_mat3(&rotation),
            clip_from_view,
            itrf_from_world: DAffine3::IDENTITY,
        })))
    }

    /// Position of the eye: Earth-fixed axes, metres.
    #[getter]
    fn eye_itrf_m<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        let eye = match &self.0 {
            Lens::Looking { pose, .. } => pose.eye_itrf_m,
            Lens::Matrices(view) => view.eye_world,
        };
        numpy::PyArray1::from_slice(py, &eye.to_array())
    }

    /// Viewing direction: a unit vector in Earth-fixed axes.
    #[getter]
    fn forward<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        let forward = match &self.0 {
            Lens::Looking { pose, .. } => pose.forward,
            Lens::Matrices(view) => view.view_from_world.inverse() * DVec3::NEG_Z,
        };
        numpy::PyArray1::from_slice(py, &forward.to_array())
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        for number in self.numbers() {
            // Both zeros are equal.
            (number + 0.0).to_bits().hash(&mut hasher);
        }
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        match &self.0 {
            Lens::Looking { pose, fov_rad } => {
                let [eye, forward, up] =
                    [pose.eye_itrf_m, pose.forward, pose.up].map(|vector| vector.to_array());
                let fov_deg = fov_rad.to_degrees();
                format!("Camera({eye:?}, {forward:?}, {up:?}, fov_deg={fov_deg})")
            }
            Lens::Matrices(view) => {
                format!("<Camera of matrices at {:?}>", view.eye_world.to_array())
            }
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Vec<f64>,))> {
        let restored = py.get_type::<Self>().getattr("_restored")?;
        Ok((restored, (self.numbers(),)))
    }

    /// A camera of the numbers by which it is pickled, bit by bit.
    #[staticmethod]
    fn _restored(numbers: Vec<f64>) -> PyResult<Self> {
        let lens = match numbers.as_slice() {
            [pose @ .., fov_rad] if pose.len() == 9 => Lens::Looking {
                pose: Pose {
                    eye_itrf_m: DVec3::from_slice(pose),
                    forward: DVec3::from_slice(&pose[3..]),
                    up: DVec3::from_slice(&pose[6..]),
                },
                fov_rad: *fov_rad,
            },
            matrices if matrices.len() == 23 => Lens::Matrices(EyeView {
                eye_world: DVec3::from_slice(matrices),
                view_from_world: DQuat::from_slice(&matrices[3..]),
                clip_from_view: DMat4::from_cols_slice(&matrices[7..]),
                itrf_from_world: DAffine3::IDENTITY,
            }),
            other => {
                return Err(PyValueError::new_err(format!(
                    "numbers: {} are not those of a camera",
                    other.len()
                )));
            }
        };
        match numbers.iter().all(|number| number.is_finite()) {
            true => Ok(Self(lens)),
            false => Err(PyValueError::new_err("numbers: not finite")),
        }
    }
}

fn fov(fov_deg: f64) -> PyResult<f64> {
    Ok(within(fov_deg, "fov_deg", 1e-3, 179.0)?.to_radians())
}

impl PyCamera {
    /// The camera's values, in the order that [`Self::_restored`] reads.
    fn numbers(&self) -> Vec<f64> {
        match &self.0 {
            Lens::Looking { pose, fov_rad } => {
                let vectors = [pose.eye_itrf_m, pose.forward, pose.up];
                let numbers = vectors.iter().flat_map(|vector| vector.to_array());
                numbers.chain([*fov_rad]).collect()
            }
            Lens::Matrices(view) => {
                let turned = view.view_from_world.to_array();
                let clip = view.clip_from_view.to_cols_array();
                [&view.eye_world.to_array()[..], &turned, &clip].concat()
            }
        }
    }

    pub fn view(&self, aspect: f64) -> EyeView {
        match &self.0 {
            Lens::Looking { pose, fov_rad } => pose.view(*fov_rad, aspect),
            Lens::Matrices(view) => *view,
        }
    }
}
