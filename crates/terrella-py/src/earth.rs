//! The Earth, seen by a camera. Earths of a program share device and maps.

use crate::arguments::wait;
use crate::camera::PyCamera;
use crate::errors::{of_any, of_offscreen, of_play};
use crate::owned::Owned;
use crate::pictures::{self, Layers};
use crate::scene::read_scene;
use crate::times::epoch;
use numpy::{PyArray2, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use terrella::{
    Atmosphere, CityLights, EarthOptions, Exposure, GpuContext, LayerSelection, OffscreenEarth, Sky,
};
use terrella_play::shared_options;

/// The Earth of a folder of maps, or as the tables of a scene's text describe it (`scene`: the path that messages
/// name, and the text).
#[pyclass(frozen, subclass, name = "Earth", module = "terrella")]
pub struct PyEarth {
    earth: Owned<OffscreenEarth>,
    /// Name of the graphics adapter that renders.
    #[pyo3(get)]
    adapter: String,
    /// Width and height of the images, pixels.
    #[pyo3(get)]
    size: (u32, u32),
}

#[pymethods]
impl PyEarth {
    #[new]
    #[pyo3(signature = (
        size, textures, *, adapter = None, samples = 1, air = true, clouds = true, night_lights = true, detail = true,
        directional_reflectance = true, exposure_ev = None, scene = None
    ))]
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
        detail: bool,
        directional_reflectance: bool,
        exposure_ev: Option<f64>,
        scene: Option<(PathBuf, String)>,
    ) -> PyResult<Self> {
        let size = pictures::size(size)?;
        if !matches!(samples, 1 | 4) {
            return Err(PyValueError::new_err(format!(
                "samples: {samples} is neither 1 nor 4"
            )));
        }
        let exposure = exposure_ev.map_or(Exposure::default(), Exposure::Ev);
        let plain = |gpu: &GpuContext| {
            let wanted = LayerSelection {
                clouds,
                night_lights,
                ..LayerSelection::default()
            };
            let maps = OffscreenEarth::shared_layers(gpu, &textures, wanted);
            let (layers, uploaded) = maps.map_err(of_any)?;
            let mut options = EarthOptions::new(layers);
            options.uploaded = uploaded;
            options.light.detail = detail;
            options.light.directional_reflectance = directional_reflectance;
            if detail && night_lights {
                options.city_lights = CityLights::load(textures.as_path()).map_err(of_any)?;
            }
            options.samples = samples;
            options.exposure = exposure;
            if !air {
                options.atmosphere = Atmosphere::None;
            }
            Ok::<_, PyErr>(options)
        };
        let earth = py.detach(|| {
            let gpu = OffscreenEarth::open_gpu(adapter.as_deref()).map_err(of_offscreen)?;
            let options = match scene {
                Some((path, text)) => {
                    let scene = read_scene(&path, Some(&text), &textures)?;
                    shared_options(&scene, &gpu).map_err(of_play)?
                }
                None => plain(&gpu)?,
            };
            OffscreenEarth::new(gpu, options, size).map_err(of_offscreen)
        })?;
        let adapter = earth.gpu().adapter.get_info().name;
        Ok(Self {
            earth: Owned::new(earth),
            adapter,
            size,
        })
    }

    /// The displayed image: height × width × 4 bytes (uint8), red, green, blue in sRGB and opacity.
    ///
    /// `time` is a time (see `Epoch`). The call waits for tiles of a pack for at most `wait_s` seconds.
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
    /// `time` is a time (see `Epoch`). The call waits for tiles of a pack for at most `wait_s` seconds.
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

    /// Distance of the ground along the camera's axis, metres: height × width (float32), infinite where no ground is visible.
    ///
    /// `time` is a time (see `Epoch`). The call waits for tiles of a pack for at most `wait_s` seconds.
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

    /// Truth layers by name, all or those named: arrays of what each pixel shows, NaN without a value. `terrella.truth_layers()` explains them.
    /// `lat_deg` and `lon_deg` are float64, the others float32.
    ///
    /// `time` is a time (see `Epoch`). The call waits for tiles of a pack for at most `wait_s` seconds.
    #[pyo3(signature = (camera, time, layers = None, *, wait_s = 30.0))]
    fn truth<'py>(
        &self,
        py: Python<'py>,
        camera: &PyCamera,
        time: &Bound<'py, PyAny>,
        layers: Option<&Bound<'py, PyAny>>,
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
