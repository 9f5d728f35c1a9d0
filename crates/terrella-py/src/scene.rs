//! A scene file, drawn into arrays at any instant.

use crate::earth::PyCamera;
use crate::errors::{SceneError, of_play};
use crate::feeds::states_of;
use crate::owned::Owned;
use crate::pictures::{self, Layers};
use crate::times::{PyEpoch, elapsed_of, epoch};
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella_orbit::Feed;
use terrella_play::clock::frame_epoch;
use terrella_play::scene::Scene;
use terrella_play::{ScenePictures, Shot, take_starter_files};

/// A scene with a device of its own.
#[pyclass(frozen, subclass, name = "Scene", module = "terrella")]
pub struct PyScene {
    pictures: Owned<ScenePictures>,
    feeds: Vec<Arc<dyn Feed>>,
    scene: Scene,
    #[pyo3(get)]
    adapter: String,
    #[pyo3(get)]
    size: (u32, u32),
}

#[pymethods]
impl PyScene {
    #[new]
    #[pyo3(signature = (path, textures, *, size = None, adapter = None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        textures: PathBuf,
        size: Option<(i64, i64)>,
        adapter: Option<String>,
    ) -> PyResult<Self> {
        let size = size.map(pictures::size).transpose()?;
        let pictures = py.detach(|| {
            let mut scene =
                Scene::load(&path).map_err(|error| SceneError::new_err(error.to_string()))?;
            take_starter_files(&mut scene, &textures);
            ScenePictures::of_scene(scene, adapter.as_deref(), size).map_err(of_play)
        })?;
        let flight = pictures.flight();
        Ok(Self {
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

    /// The scene's first instant.
    #[getter]
    fn start(&self) -> PyEpoch {
        PyEpoch(self.scene.time.start)
    }

    /// Where its playback ends.
    #[getter]
    fn end(&self) -> PyEpoch {
        PyEpoch(self.scene.time.end())
    }

    /// Frames a second of its playback.
    #[getter]
    fn frame_rate_hz(&self) -> f64 {
        self.scene.time.frame_rate_hz
    }

    /// What is flown otherwise than the scene says, in sentences.
    #[getter]
    fn notices(&self) -> Vec<String> {
        self.scene.notices.clone()
    }

    /// Names of its satellites.
    #[getter]
    fn satellites(&self) -> Vec<String> {
        self.feeds
            .iter()
            .map(|feed| feed.name().to_owned())
            .collect()
    }

    /// The instants of all frames of its playback.
    fn times(&self) -> Vec<PyEpoch> {
        let time = &self.scene.time;
        (0..time.frame_count())
            .map(|n| PyEpoch(frame_epoch(time, n)))
            .collect()
    }

    /// An instant as it is shown: height × width × 4 bytes (uint8).
    ///
    /// `time` is an instant (see `Epoch`), or a `datetime.timedelta` after the start; without it the start.
    /// `camera` stands in place of the scene's, without the craft and at any date, `exposure_ev` in
    /// place of its exposure.
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
    /// `time` is an instant (see `Epoch`), or a `datetime.timedelta` after the start; without it the start.
    /// `camera` stands in place of the scene's, without the craft and at any date.
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

    /// The distance of the ground along the camera's axis, metres: height × width (float32), infinite where no ground is seen; without craft.
    ///
    /// `time` is an instant (see `Epoch`), or a `datetime.timedelta` after the start; without it the start.
    /// `camera` stands in place of the scene's, without the craft and at any date.
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

    /// Arrays by name of what is where each pixel looks, without craft: all truth layers, or those named.
    ///
    /// `time` is an instant (see `Epoch`), or a `datetime.timedelta` after the start; without it the start.
    /// `camera` stands in place of the scene's, without the craft and at any date.
    #[pyo3(signature = (time = None, layers = None, *, camera = None))]
    fn truth<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
        layers: Option<Vec<String>>,
        camera: Option<PyCamera>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let layers = Layers::named(layers)?;
        let (size, shot) = (self.size, self.shot(time, camera)?);
        let values = self.pictures.with(py, |pictures| {
            Ok(layers.of(&pictures.draw_truth(shot).map_err(of_play)?.0))
        })?;
        layers.arrays(py, size, values)
    }

    /// The raw frame of the scene's sensor at an instant: height × width (uint16), the numbers of its converter. The scene needs a [sensor] table;
    /// the frame is that of `terrella frame --raw`.
    ///
    /// `time` is an instant (see `Epoch`), or a `datetime.timedelta` after the start; without it the start.
    #[pyo3(signature = (time = None))]
    fn raw<'py>(
        &self,
        py: Python<'py>,
        time: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<u16>>> {
        let epoch = self.instant(time)?;
        let frame = self
            .pictures
            .with(py, |pictures| pictures.draw_raw(epoch).map_err(of_play))?;
        pictures::plane(py, (frame.width, frame.height), frame.data)
    }

    /// Positions and velocities of the satellites, metres and metres a second: satellites × instants × 3 each. `frame` is itrf, teme, gcrf,
    /// eme2000 or pef, and velocities are those seen in it. Instants at which a satellite is not known raise, or are NaN with outside="nan".
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
    /// What is pictured.
    fn shot(&self, time: Option<&Bound<'_, PyAny>>, camera: Option<PyCamera>) -> PyResult<Shot> {
        let aspect = f64::from(self.size.0) / f64::from(self.size.1);
        Ok(Shot {
            view: camera.map(|camera| camera.view(aspect)),
            ..Shot::from(self.instant(time)?)
        })
    }

    /// The instant that is meant: the scene's start, one of its own, or so long after its start.
    fn instant(&self, time: Option<&Bound<'_, PyAny>>) -> PyResult<Epoch> {
        let start = self.scene.time.start;
        match time {
            None => Ok(start),
            Some(time) if time.hasattr("total_seconds")? => Ok(start + elapsed_of(time, "time")?),
            Some(time) => epoch(time, "time"),
        }
    }
}
