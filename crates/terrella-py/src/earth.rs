//! The Earth on a device of its own, seen by a camera.

use crate::arguments::{matrix_3, matrix_4, vector, wait, within};
use crate::errors::{of_any, of_offscreen};
use crate::owned::Owned;
use crate::pictures::{self, Layers};
use crate::times::epoch;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use numpy::{PyArray2, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use terrella::LayerSelection;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions, Exposure, EyeView, OffscreenEarth, Sky, load_layers};
use terrella_play::camera::Pose;

/// Where the eye stands and how it looks, for pictures of any size: an eye (Earth-fixed axes, metres), the direction it looks in, and the one
/// that is upwards on screen, of any length. `fov_deg` is the vertical field of view.
#[pyclass(frozen, from_py_object, name = "Camera", module = "terrella")]
#[derive(Clone, Copy, Debug)]
pub struct PyCamera(Lens);

#[derive(Clone, Copy, Debug)]
enum Lens {
    /// A vertical field of view; the picture's size says how wide it is.
    Looking { pose: Pose, fov_rad: f64 },
    /// A projection of the caller's.
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
    #[pyo3(signature = (lat_deg, lon_deg, height_m, *, heading_deg = 0.0, pitch_deg = -90.0, fov_deg = 45.0))]
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

    /// The eye, Earth-fixed axes, metres.
    #[getter]
    fn eye_itrf_m<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        let eye = match &self.0 {
            Lens::Looking { pose, .. } => pose.eye_itrf_m,
            Lens::Matrices(view) => view.eye_world,
        };
        numpy::PyArray1::from_slice(py, &eye.to_array())
    }
}

fn fov(fov_deg: f64) -> PyResult<f64> {
    Ok(within(fov_deg, "fov_deg", 1e-3, 179.0)?.to_radians())
}

impl PyCamera {
    pub fn view(&self, aspect: f64) -> EyeView {
        match &self.0 {
            Lens::Looking { pose, fov_rad } => pose.view(*fov_rad, aspect),
            Lens::Matrices(view) => *view,
        }
    }
}

/// The Earth on a device of its own.
#[pyclass(frozen, subclass, name = "Earth", module = "terrella")]
pub struct PyEarth {
    earth: Owned<OffscreenEarth>,
    #[pyo3(get)]
    adapter: String,
    #[pyo3(get)]
    size: (u32, u32),
}

#[pymethods]
impl PyEarth {
    #[new]
    #[pyo3(signature = (size, textures, *, adapter = None, samples = 1, air = true, clouds = true, night_lights = true, exposure_ev = None))]
    #[expect(clippy::too_many_arguments, reason = "Python's are named")]
    fn new(
        py: Python<'_>,
        size: (i64, i64),
        textures: PathBuf,
        adapter: Option<String>,
        samples: u32,
        air: bool,
        clouds: bool,
        night_lights: bool,
        exposure_ev: Option<f64>,
    ) -> PyResult<Self> {
        let size = pictures::size(size)?;
        if !matches!(samples, 1 | 4) {
            return Err(PyValueError::new_err(format!(
                "samples: {samples} is neither 1 nor 4"
            )));
        }
        let exposure = exposure_ev.map_or(Exposure::default(), Exposure::Ev);
        let earth = py.detach(|| {
            let gpu = OffscreenEarth::open_gpu(adapter.as_deref()).map_err(of_offscreen)?;
            let wanted = LayerSelection {
                clouds,
                night_lights,
                ..LayerSelection::default()
            };
            let layers = load_layers(&textures, wanted).map_err(of_any)?;
            let mut options = EarthOptions::new(layers);
            options.samples = samples;
            options.exposure = exposure;
            if !air {
                options.atmosphere = Atmosphere::None;
            }
            OffscreenEarth::new(gpu, options, size).map_err(of_offscreen)
        })?;
        let adapter = earth.gpu().adapter.get_info().name;
        Ok(Self {
            earth: Owned::new(earth),
            adapter,
            size,
        })
    }

    /// The Earth as it is shown: height × width × 4 bytes (uint8), red, green, blue in sRGB and opacity.
    ///
    /// `time` is an instant (see `Epoch`); tiles of a pack are waited for at most `wait_s` seconds.
    #[pyo3(signature = (camera, time, *, wait_s = 30.0))]
    fn color<'py>(
        &self,
        py: Python<'py>,
        camera: &PyCamera,
        time: &Bound<'py, PyAny>,
        wait_s: f64,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let (size, sky, wait) = (self.size, Sky::at(epoch(time, "time")?), wait(wait_s)?);
        let rgba = self.earth.with(py, |earth| {
            let mut rgba = vec![0; pictures::pixels(size) * 4];
            let view = camera.view(earth.aspect());
            let drawn = earth.draw_color(&view, &sky, wait, &mut rgba);
            drawn.map_err(of_offscreen)?;
            Ok(rgba)
        })?;
        pictures::color(py, size, rgba)
    }

    /// The light of the Earth, scene-referred and linear: height × width × 3 (float32); a white sheet that faces the Sun in space is 1.
    /// No exposure, no tone curve; the light along the ray through each pixel's middle.
    ///
    /// `time` is an instant (see `Epoch`); tiles of a pack are waited for at most `wait_s` seconds.
    #[pyo3(signature = (camera, time, *, wait_s = 30.0))]
    fn radiance<'py>(
        &self,
        py: Python<'py>,
        camera: &PyCamera,
        time: &Bound<'py, PyAny>,
        wait_s: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (size, sky, wait) = (self.size, Sky::at(epoch(time, "time")?), wait(wait_s)?);
        let light = self.earth.with(py, |earth| {
            let mut light = vec![0.0; pictures::pixels(size) * 4];
            let view = camera.view(earth.aspect());
            let drawn = earth.draw_light(&view, &sky, wait, &mut light);
            drawn.map_err(of_offscreen)?;
            Ok(light)
        })?;
        pictures::light(py, size, light)
    }

    /// The distance of the ground along the camera's axis, metres: height × width (float32), infinite where no ground is seen.
    ///
    /// `time` is an instant (see `Epoch`); tiles of a pack are waited for at most `wait_s` seconds.
    #[pyo3(signature = (camera, time, *, wait_s = 30.0))]
    fn depth_m<'py>(
        &self,
        py: Python<'py>,
        camera: &PyCamera,
        time: &Bound<'py, PyAny>,
        wait_s: f64,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (size, sky, wait) = (self.size, Sky::at(epoch(time, "time")?), wait(wait_s)?);
        let depth = self.earth.with(py, |earth| {
            let view = camera.view(earth.aspect());
            let drawn = earth.draw_truth(&view, &sky, wait);
            Ok(drawn.map_err(of_offscreen)?.0.depth_m())
        })?;
        pictures::plane(py, size, depth)
    }

    /// Arrays by name of what is where each pixel looks: all truth layers, or those named. `terrella.truth_layers()` says what they are; NaN
    /// where there is none.
    ///
    /// `time` is an instant (see `Epoch`); tiles of a pack are waited for at most `wait_s` seconds.
    #[pyo3(signature = (camera, time, layers = None, *, wait_s = 30.0))]
    fn truth<'py>(
        &self,
        py: Python<'py>,
        camera: &PyCamera,
        time: &Bound<'py, PyAny>,
        layers: Option<Vec<String>>,
        wait_s: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let layers = Layers::named(layers)?;
        let (size, sky, wait) = (self.size, Sky::at(epoch(time, "time")?), wait(wait_s)?);
        let values = self.earth.with(py, |earth| {
            let view = camera.view(earth.aspect());
            let drawn = earth.draw_truth(&view, &sky, wait);
            Ok(layers.of(&drawn.map_err(of_offscreen)?.0))
        })?;
        layers.arrays(py, size, values)
    }
}
