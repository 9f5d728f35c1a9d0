//! Films that several processes draw into one folder: the painter of frames, and the writer of the folder's page.

use crate::errors::{SceneError, of_any, of_play};
use crate::owned::Owned;
use crate::pictures;
use crate::scene::read_scene;
use crate::times::PyEpoch;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use terrella::GpuContext;
use terrella::{Exposure, Pack, SurfaceKind};
use terrella_play::scene::{Scene, StartSource};
use terrella_play::{
    Existing, FilmFrames, FilmKey, FilmPainter, FilmRequest, Flight, FrameRange, FrameRecord,
    PictureFormat, PictureSettings, PlayError, SharedFolder, Shutter, checksum,
};

/// How the pictures of a film are made and kept, as the command's options say.
#[pyclass(frozen, from_py_object, name = "Pictures", module = "terrella")]
#[derive(Clone, Copy, Debug)]
pub struct PyPictures(PictureSettings);

#[pymethods]
impl PyPictures {
    #[new]
    #[pyo3(signature = (*, format = "png", alpha = false, supersample = None, shutter = None, subframes = 16, peak_cd_m2 = None))]
    fn new(
        format: &str,
        alpha: bool,
        supersample: Option<u32>,
        shutter: Option<f64>,
        subframes: u32,
        peak_cd_m2: Option<f64>,
    ) -> PyResult<Self> {
        let rejected = |words: String| Err(PyValueError::new_err(words));
        let format = match format {
            "png" => PictureFormat::Png,
            "png16" => PictureFormat::Png16,
            "exr" => PictureFormat::Exr,
            "pq" => PictureFormat::Pq,
            "hlg" => PictureFormat::Hlg,
            other => {
                return rejected(format!(
                    "format: {other:?} is none of png, png16, exr, pq, hlg"
                ));
            }
        };
        if let Some(n) = supersample.filter(|n| !PictureSettings::SUPERSAMPLES.contains(n)) {
            return rejected(format!("supersample: {n} is none of 1, 2, 4"));
        }
        if let Some(open) = shutter.filter(|open| !(*open > 0.0 && *open <= 1.0)) {
            return rejected(format!("shutter: {open} is not more than 0 and at most 1"));
        }
        let most = PictureSettings::MAX_SUBFRAMES;
        if !(1..=most).contains(&subframes) {
            return rejected(format!("subframes: {subframes} is not from 1 to {most}"));
        }
        Ok(Self(PictureSettings {
            format,
            alpha,
            supersample,
            shutter: shutter.map(|open| Shutter { open, subframes }),
            peak_cd_m2,
        }))
    }
}

/// A scene that several processes draw, each of which reads it for itself, with the maps that came along.
fn load(path: &Path, textures: &Path) -> PyResult<Scene> {
    let scene = read_scene(path, None, textures)?;
    if scene.time.start_from == StartSource::Clock {
        return Err(SceneError::new_err(format!(
            "{}: [time] start = \"now\": each process would begin at another instant; write the instant",
            path.display()
        )));
    }
    Ok(scene)
}

/// The same made ready.
fn open(path: &Path, textures: &Path) -> PyResult<Flight> {
    let scene = load(path, textures)?;
    if let Some(live) = scene.orbits.iter().find_map(|orbit| orbit.live.as_ref()) {
        return Err(of_play(PlayError::Live {
            scene: scene.path.clone(),
            listens_on: live.transport.to_string(),
            work: "no frame can be drawn by itself",
            remedy: "play it with the command `terrella`",
        }));
    }
    Flight::open(scene).map_err(of_play)
}

/// The frames of a scene's film, each as the command draws it.
#[pyclass(frozen, name = "FilmFrames", module = "terrella")]
pub struct PyFilmFrames {
    frames: Owned<(Flight, FilmFrames)>,
    settings: PictureSettings,
    #[pyo3(get)]
    adapter: String,
    /// Name and version of its driver.
    #[pyo3(get)]
    driver: String,
}

#[pymethods]
impl PyFilmFrames {
    #[new]
    #[pyo3(signature = (path, textures, pictures, *, size = None, adapter = None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        textures: PathBuf,
        pictures: PyPictures,
        size: Option<(i64, i64)>,
        adapter: Option<String>,
    ) -> PyResult<Self> {
        let size = size.map(pictures::size).transpose()?;
        let PyPictures(settings) = pictures;
        let (flight, gpu, frames) = py.detach(|| {
            let flight = open(&path, &textures)?;
            FilmPainter::check(&flight, &settings).map_err(|error| of_play(error.into()))?;
            let features = FilmPainter::features(&settings);
            let gpu = pollster::block_on(GpuContext::open_with(adapter.as_deref(), features));
            let gpu = gpu.map_err(|error| of_play(error.into()))?;
            let options = flight.uploaded_options(&gpu).map_err(of_play)?;
            let size = size.unwrap_or(flight.scene().output.size.into());
            let frames = FilmFrames::open(&flight, gpu.clone(), options, size, settings);
            Ok::<_, PyErr>((flight, gpu, frames.map_err(of_play)?))
        })?;
        let info = gpu.adapter.get_info();
        Ok(Self {
            frames: Owned::new((flight, frames)),
            settings,
            adapter: info.name,
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
        })
    }

    /// Draws a frame: the bytes of its file, what its page says of it (JSON, under the file name `file`), and the tiles that it lacks.
    fn draw<'py>(
        &self,
        py: Python<'py>,
        index: u64,
        file: &str,
    ) -> PyResult<(Bound<'py, PyBytes>, String, Vec<String>)> {
        let settings = &self.settings;
        let (bytes, record, missing) = self.frames.with(py, |(flight, frames)| {
            let count = flight.scene().time.frame_count();
            if index >= count {
                return Err(PyValueError::new_err(format!(
                    "index: there is no frame {index}; the film has {count}"
                )));
            }
            let drawn = frames.draw(flight, index).map_err(of_play)?;
            let bytes = drawn.picture.file(settings).map_err(of_any)?;
            let record = FrameRecord {
                file: file.to_owned(),
                bytes: bytes.len() as u64,
                blake3: checksum(&bytes),
                ..drawn.record
            };
            let missing: Vec<_> = drawn.missing.iter().map(ToString::to_string).collect();
            Ok((
                bytes,
                serde_json::to_string(&record).map_err(of_any)?,
                missing,
            ))
        })?;
        Ok((PyBytes::new(py, &bytes), record, missing))
    }
}

/// The folder of a film's frames and its page `frames.json`, compared with other runs, the command's among them.
#[pyclass(frozen, name = "FilmFolder", module = "terrella")]
pub struct PyFilmFolder(Mutex<Option<(Flight, SharedFolder)>>);

/// The locked folder.
type Held<'f> = MutexGuard<'f, Option<(Flight, SharedFolder)>>;

#[pymethods]
impl PyFilmFolder {
    #[new]
    #[pyo3(signature = (path, textures, folder, pictures, *, size = None, first = 0, end = None, existing = "reject"))]
    #[expect(clippy::too_many_arguments, reason = "Python's are named")]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        textures: PathBuf,
        folder: PathBuf,
        pictures: PyPictures,
        size: Option<(i64, i64)>,
        first: u64,
        end: Option<u64>,
        existing: &str,
    ) -> PyResult<Self> {
        let size = size.map(pictures::size).transpose()?;
        let existing = match existing {
            "reject" => Existing::Reject,
            "resume" => Existing::Resume,
            "overwrite" => Existing::Overwrite,
            other => {
                return Err(PyValueError::new_err(format!(
                    "existing: {other:?} is none of reject, resume, overwrite"
                )));
            }
        };
        let end = end.map(|end| end.to_string()).unwrap_or_default();
        let range: FrameRange = format!("{first}..{end}")
            .parse()
            .map_err(|_| PyValueError::new_err(format!("frames: {first}..{end} holds no frame")))?;
        let held = py.detach(|| {
            let flight = open(&path, &textures)?;
            let PyPictures(settings) = pictures;
            FilmPainter::check(&flight, &settings).map_err(|error| of_play(error.into()))?;
            let request = FilmRequest {
                folder: &folder,
                size: size.unwrap_or(flight.scene().output.size.into()),
                pictures: settings,
                range,
                existing,
            };
            let folder = SharedFolder::open(&flight, &request).map_err(of_play)?;
            Ok::<_, PyErr>((flight, folder))
        })?;
        Ok(Self(Mutex::new(Some(held))))
    }

    /// Frames of the whole film.
    #[getter]
    fn frame_count(&self) -> PyResult<u64> {
        self.with(|_, folder| Ok(folder.frame_count()))
    }

    /// The frames that are wanted: the first, and the one after the last.
    #[getter]
    fn wanted(&self) -> PyResult<(u64, u64)> {
        self.with(|_, folder| Ok((folder.wanted().start, folder.wanted().end)))
    }

    /// Those of the frames that are wanted that are there already.
    #[getter]
    fn kept(&self) -> PyResult<Vec<u64>> {
        self.with(|_, folder| Ok(folder.kept().collect()))
    }

    /// The adapter that drew the frames that are kept.
    #[getter]
    fn kept_adapter(&self) -> PyResult<Option<String>> {
        self.with(|_, folder| Ok(folder.kept_adapter().map(str::to_owned)))
    }

    /// Frames of a second of the film.
    #[getter]
    fn frame_rate_hz(&self) -> PyResult<f64> {
        self.with(|flight, _| Ok(flight.scene().time.frame_rate_hz))
    }

    /// Whether a frame hangs a little on those that the same renderer drew before: ground whose level of detail has a memory.
    #[getter]
    fn has_memory(&self) -> PyResult<bool> {
        self.with(|flight, _| {
            let relief = flight.scene().earth.relief.as_ref();
            Ok(relief.is_some_and(|relief| {
                !matches!(relief.surface, SurfaceKind::Blocks | SurfaceKind::Contours)
            }))
        })
    }

    /// The name of a frame's file.
    fn name(&self, index: u64) -> PyResult<String> {
        self.with(|_, folder| Ok(folder.name(index)))
    }

    /// Keeps a frame that an earlier run wrote and did not bring onto the page, if its file is whole. Before `begin`.
    fn adopt(&self, py: Python<'_>, record: &str) -> PyResult<bool> {
        py.detach(|| self.with(|_, folder| Ok(folder.adopt(record))))
    }

    /// Writes the page with what is kept; this adapter draws the others.
    fn begin(&self, adapter: &str) -> PyResult<()> {
        self.with(|flight, folder| folder.begin(flight, adapter).map_err(of_play))
    }

    /// Adds a frame that is written, as it was reported (JSON).
    fn add(&self, record: &str) -> PyResult<()> {
        self.with(|_, folder| folder.add(record).map_err(of_play))
    }

    /// Brings the page into its order and takes away what is half written.
    fn finish(&self) -> PyResult<()> {
        self.with(|flight, folder| folder.finish(flight).map_err(of_play))
    }

    /// Lets go of the folder.
    fn close(&self) {
        *self.held() = None;
    }
}

impl PyFilmFolder {
    fn held(&self) -> Held<'_> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<R>(&self, work: impl FnOnce(&Flight, &mut SharedFolder) -> PyResult<R>) -> PyResult<R> {
        match &mut *self.held() {
            Some((flight, folder)) => work(flight, folder),
            None => Err(PyValueError::new_err("folder: it is closed")),
        }
    }
}

/// What the pictures of a scene depend on besides their size, as JSON: the program, and checksums of the scene and of all files that they come
/// from.
#[pyfunction]
fn scene_key(py: Python<'_>, path: PathBuf, textures: PathBuf) -> PyResult<String> {
    py.detach(|| {
        let scene = load(&path, &textures)?;
        let key = FilmKey::new(&scene, scene.output.size.into(), PictureSettings::default());
        serde_json::to_string(&key.map_err(of_play)?).map_err(of_any)
    })
}

/// Whom to name for the maps of a scene's pack, in the words of its manifest; empty without a pack.
#[pyfunction]
fn scene_attribution(py: Python<'_>, path: PathBuf, textures: PathBuf) -> PyResult<Vec<String>> {
    py.detach(|| match load(&path, &textures)?.earth.pack {
        Some(pack) => {
            let pack = Pack::open(&pack.folder).map_err(of_any)?;
            Ok(pack.manifest().attribution.clone())
        }
        None => Ok(Vec::new()),
    })
}

/// The first instant of a scene's playback, and its end.
#[pyfunction]
fn scene_dates(py: Python<'_>, path: PathBuf, textures: PathBuf) -> PyResult<(PyEpoch, PyEpoch)> {
    let flight = py.detach(|| open(&path, &textures))?;
    let time = &flight.scene().time;
    Ok((PyEpoch(time.start), PyEpoch(time.end())))
}

/// The fixed exposure of a scene, exposure values; `None` if it is automatic.
#[pyfunction]
fn scene_exposure(py: Python<'_>, path: PathBuf, textures: PathBuf) -> PyResult<Option<f64>> {
    py.detach(|| match load(&path, &textures)?.output.exposure {
        Exposure::Ev(ev) => Ok(Some(ev)),
        Exposure::Auto => Ok(None),
    })
}

/// What an MP4 of so many frames lacks, in words; None where it is complete. ffmpeg may end without an error although the disk was full.
#[pyfunction]
fn mp4_problem(py: Python<'_>, path: PathBuf, frames: u64) -> Option<String> {
    py.detach(|| terrella_play::mp4_problem(&path, frames))
}

pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyPictures>()?;
    module.add_class::<PyFilmFrames>()?;
    module.add_class::<PyFilmFolder>()?;
    module.add_function(wrap_pyfunction!(mp4_problem, module)?)?;
    module.add_function(wrap_pyfunction!(scene_dates, module)?)?;
    module.add_function(wrap_pyfunction!(scene_attribution, module)?)?;
    module.add_function(wrap_pyfunction!(scene_exposure, module)?)?;
    module.add_function(wrap_pyfunction!(scene_key, module)?)
}
