//! A scene file, drawn into arrays at any instant.

use crate::camera::PyCamera;
use crate::errors::{SceneError, of_play};
use crate::feeds::states_of;
use crate::owned::Owned;
use crate::pictures::{self, Layers};
use crate::times::{PyEpoch, elapsed_of, epoch};
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella_orbit::Feed;
use terrella_play::clock::frame_epoch;
use terrella_play::scene::Scene;
use terrella_play::{DroppedLayer, ScenePictures, Shot, take_starter_files};

/// Reads a scene from `path`, or from `text` if it is given. `textures` supplies the files that the scene does not name.
pub fn read_scene(path: &Path, text: Option<&str>, textures: &Path) -> PyResult<Scene> {
    let read = match text {
        Some(text) => Scene::from_toml(text, path),
        None => Scene::load(path),
    };
    let mut scene = read.map_err(|error| SceneError::new_err(error.to_string()))?;
    take_starter_files(&mut scene, textures);
    Ok(scene)
}

/// A scene with a device of its own.
#[pyclass(frozen, subclass, name = "Scene", module = "terrella")]
pub struct PyScene {
    pictures: Owned<ScenePictures>,
    feeds: Vec<Arc<dyn Feed>>,
    scene: Scene,
    notices: Vec<String>,
    /// Name of the graphics adapter that renders.
    #[pyo3(get)]
    adapter: String,
    /// Width and height of the images, pixels.
    #[pyo3(get)]
    size: (u32, u32),
}

#[pymethods]
impl PyScene {
    #[new]
    #[pyo3(signature = (path, textures, *, text = None, size = None, adapter = None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        textures: PathBuf,
        text: Option<&str>,
        size: Option<(i64, i64)>,
        adapter: Option<String>,
    ) -> PyResult<Self> {
        let size = size.map(pictures::size).transpose()?;
        let pictures = py.detach(|| {
            let scene = read_scene(&path, text, &textures)?;
            ScenePictures::of_scene(scene, adapter.as_deref(), size).map_err(of_play)
        })?;
        let flight = pictures.flight();
        let mut notices = flight.scene().notices.clone();
        let dropped = flight.dropped_layers().map_err(of_play)?;
        notices.extend(dropped.into_iter().map(|DroppedLayer { layer, missing }| {
            format!("{layer}: left out, because a file is missing or corrupt: {missing}")
        }));
        Ok(Self {
            notices,
            feeds: flight
                .satellites()
                .iter()
                .map(|one| one.shared_feed())
                .collect(),
            scene: flight.scene().clone(),
            adapter: pictures.gpu().adapter.get_info().name,
            size: pictures.size(),
            pictures: Owned::new(pictures),
        })
    }

    /// Start of its playback.
    #[getter]
    fn start(&self) -> PyEpoch {
        PyEpoch(self.scene.time.start)
    }

    /// End of its playback.
    #[getter]
    fn end(&self) -> PyEpoch {
        PyEpoch(self.scene.time.end())
    }

    /// Frames a second of its playback.
    #[getter]
    fn frame_rate_hz(&self) -> f64 {
        self.scene.time.frame_rate_hz
    }

    /// Where the scene is not followed exactly, as sentences, with the layers that are left out.
    #[getter]
    fn notices(&self) -> Vec<String> {
        self.notices.clone()
    }

    /// Names of its satellites.
    #[getter]
    fn satellites(&self) -> Vec<String> {
        self.feeds
            .iter()
            .map(|feed| feed.name().to_owned())
            .collect()
    }

    /// The times of all frames of its playback.
    fn times(&self) -> Vec<PyEpoch> {
        let time = &self.scene.time;
        (0..time.frame_count())
            .map(|n| PyEpoch(frame_epoch(time, n)))
            .collect()
    }

    /// The displayed image at a time: height × width × 4 bytes (uint8).
    ///
    /// `time` is a time (see `Epoch`) or a `datetime.timedelta` after the start, which is the default.
    /// `camera` replaces the scene's camera: the spacecraft is then not drawn, and any date is allowed. `exposure_ev` replaces its exposure.
    #[pyo3(signature = (time = None, *, camera = None, exposure_ev = None))]
    fn color<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        camera: Option<PyCamera>,
        exposure_ev: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let (size, mut shot) = (self.size, self.shot(time, camera)?);
        shot.exposure_ev = exposure_ev;
        let rgba = self.pictures.with(py, |pictures| {
            let mut rgba = vec![0; pictures::pixels(size) * 4];
            pictures.draw_color(shot, &mut rgba).map_err(of_play)?;
            Ok(rgba)
        })?;
        pictures::color(py, size, rgba)
    }

    /// The light of an instant: height × width × 3 (float32), scene-referred and linear. Tracks are no light and are not in it.
    ///
    /// `time` is a time (see `Epoch`) or a `datetime.timedelta` after the start, which is the default.
    /// `camera` replaces the scene's camera: the spacecraft is then not drawn, and any date is allowed.
    #[pyo3(signature = (time = None, *, camera = None))]
    fn radiance<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        camera: Option<PyCamera>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (size, shot) = (self.size, self.shot(time, camera)?);
        let light = self.pictures.with(py, |pictures| {
            let mut light = vec![0.0; pictures::pixels(size) * 4];
            pictures.draw_light(shot, &mut light).map_err(of_play)?;
            Ok(light)
        })?;
        pictures::light(py, size, light)
    }

    /// Distance of the ground along the camera's axis, metres: height × width (float32), infinite where no ground is visible; without spacecraft.
    ///
    /// `time` is a time (see `Epoch`) or a `datetime.timedelta` after the start, which is the default.
    /// `camera` replaces the scene's camera: the spacecraft is then not drawn, and any date is allowed.
    #[pyo3(signature = (time = None, *, camera = None))]
    fn depth_m<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        camera: Option<PyCamera>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (size, shot) = (self.size, self.shot(time, camera)?);
        let depth = self.pictures.with(py, |pictures| {
            Ok(pictures.draw_truth(shot).map_err(of_play)?.0.depth_m())
        })?;
        pictures::plane(py, size, depth)
    }

    /// Truth layers by name, all or those named, without spacecraft: arrays of what each pixel shows.
    /// `lat_deg` and `lon_deg` are float64, the others float32.
    ///
    /// `time` is a time (see `Epoch`) or a `datetime.timedelta` after the start, which is the default.
    /// `camera` replaces the scene's camera: the spacecraft is then not drawn, and any date is allowed.
    #[pyo3(signature = (time = None, layers = None, *, camera = None))]
    fn truth<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        layers: Option<&Bound<'py, PyAny>>,
        camera: Option<PyCamera>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let layers = Layers::named(layers)?;
        let (size, shot) = (self.size, self.shot(time, camera)?);
        let values = self.pictures.with(py, |pictures| {
            Ok(layers.of(&pictures.draw_truth(shot).map_err(of_play)?.0))
        })?;
        layers.arrays(py, size, values)
    }

    /// The raw frame of the scene's sensor: height × width (uint16), in digital numbers, as `terrella frame --raw` writes it. The scene needs a
    /// [sensor] table.
    ///
    /// `time` is a time (see `Epoch`) or a `datetime.timedelta` after the start, which is the default.
    /// `camera` replaces the position and attitude of the scene's camera, and stands still while rows are exposed; the field of view is the
    /// sensor's.
    #[pyo3(signature = (time = None, *, camera = None))]
    fn raw<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        camera: Option<PyCamera>,
    ) -> PyResult<Bound<'py, PyArray2<u16>>> {
        let shot = self.shot(time, camera)?;
        let frame = self.pictures.with(py, |pictures| {
            Ok(pictures.draw_raw(shot).map_err(of_play)?.0)
        })?;
        pictures::plane(py, (frame.width, frame.height), frame.data)
    }

    /// Truth layers by name, all or those named, of the pixels of `raw`: through the sensor's lens, each row at its own instant.
    ///
    /// `time` is a time (see `Epoch`) or a `datetime.timedelta` after the start, which is the default. `camera` is that of `raw`.
    #[pyo3(signature = (time = None, layers = None, *, camera = None))]
    fn raw_truth<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        layers: Option<&Bound<'py, PyAny>>,
        camera: Option<PyCamera>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let layers = Layers::named(layers)?;
        let shot = self.shot(time, camera)?;
        let (size, values) = self.pictures.with(py, |pictures| {
            let size = pictures.sensor_size().map_err(of_play)?;
            let (values, _) = pictures
                .draw_raw_truth(shot, layers.wanted())
                .map_err(of_play)?;
            Ok((size, values))
        })?;
        layers.arrays(py, size, values)
    }

    /// Positions and velocities of the satellites, metres and metres a second: satellites × instants × 3 each. `frame` is itrf, teme, gcrf,
    /// eme2000 or pef, and velocities are those seen in it. Times outside a satellite's validity raise, or give NaN with outside="nan".
    #[pyo3(signature = (times, frame = "itrf", *, outside = "raise"))]
    fn propagate<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
        frame: &str,
        outside: &str,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let feeds: Vec<_> = self.feeds.iter().map(|feed| feed.as_ref()).collect();
        states_of(py, &feeds, times, frame, outside)
    }
}

impl PyScene {
    /// The image to draw.
    fn shot(&self, time: Option<&Bound<'_, PyAny>>, camera: Option<PyCamera>) -> PyResult<Shot> {
        let aspect = f64::from(self.size.0) / f64::from(self.size.1);
        Ok(Shot {
            view: camera.map(|camera| camera.view(aspect)),
            ..Shot::from(self.instant(time)?)
        })
    }

    /// An instant from Python: the scene's start by default, an instant, or a duration after the start.
    fn instant(&self, time: Option<&Bound<'_, PyAny>>) -> PyResult<Epoch> {
        let start = self.scene.time.start;
        match time {
            None => Ok(start),
            Some(time) if time.hasattr("total_seconds")? => Ok(start + elapsed_of(time, "time")?),
            Some(time) => epoch(time, "time"),
        }
    }
}
