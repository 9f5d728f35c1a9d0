//! Imagery packs that several processes build.

use crate::arguments::within;
use crate::errors::{Error, of_any};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use terrella::{MapLayer, Storage};
use terrella_pack::{
    BuildError, BuildOptions, BuildProgress, BuildShare, Relief, SLOPE_EXAGGERATION, begin_shares,
    build, build_share,
};

/// A share as a Python tuple: the map's name, its first column, the column after its last, its texels, its missing tiles.
type Share = (String, u32, u32, u64, u64);

/// A pack that is built from maps, as `terrella pack build` does.
#[pyclass(frozen, name = "PackBuild", module = "terrella")]
pub struct PyPackBuild(BuildOptions);

/// Shows nothing, and stops where Python was interrupted.
struct Interruptible;

impl BuildProgress for Interruptible {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {}
    fn end(&self) {}
    fn cancelled(&self) -> bool {
        Python::attach(|py| py.check_signals().is_err())
    }
}

#[pymethods]
impl PyPackBuild {
    #[new]
    #[pyo3(signature = (out, day, *, clouds = None, normals = None, elevation = None, night_lights = None, water = None, name = None,
        attribution = Vec::new(), storage = "both", pixels = Vec::new(), exaggeration = None, elevation_offset_m = None, memory_mb = 512.0,
        threads = None, restart = false))]
    #[expect(clippy::too_many_arguments, reason = "Python's are named")]
    fn new(
        out: PathBuf,
        day: PathBuf,
        clouds: Option<PathBuf>,
        normals: Option<PathBuf>,
        elevation: Option<PathBuf>,
        night_lights: Option<PathBuf>,
        water: Option<PathBuf>,
        name: Option<String>,
        attribution: Vec<String>,
        storage: &str,
        pixels: Vec<(String, Vec<u32>)>,
        exaggeration: Option<f64>,
        elevation_offset_m: Option<f64>,
        memory_mb: f64,
        threads: Option<usize>,
        restart: bool,
    ) -> PyResult<Self> {
        let rejected = |words: String| PyValueError::new_err(words);
        let storages = match storage {
            "plain" => vec![Storage::Plain],
            "bc" => vec![Storage::Bc],
            "both" => Storage::ALL.to_vec(),
            other => {
                return Err(rejected(format!(
                    "storage: {other:?} is none of plain, bc, both"
                )));
            }
        };
        if elevation.is_none() && (exaggeration.is_some() || elevation_offset_m.is_some()) {
            return Err(rejected(
                "exaggeration, elevation_offset_m: they are for elevation, and there is none"
                    .into(),
            ));
        }
        let relief = match (elevation, normals) {
            (Some(_), Some(_)) => {
                return Err(rejected("elevation, normals: give one of them".into()));
            }
            (Some(path), None) => Some(Relief::Elevation {
                path,
                offset_m: elevation_offset_m,
                exaggeration: exaggeration.unwrap_or(SLOPE_EXAGGERATION),
            }),
            (None, normals) => normals.map(Relief::Normals),
        };
        let pixels = pixels
            .into_iter()
            .map(|(name, levels)| Ok((layer(&name)?, levels)))
            .collect::<PyResult<_>>()?;
        Ok(Self(BuildOptions {
            clouds,
            relief,
            night_lights,
            water,
            name,
            attribution,
            storages,
            pixels,
            memory_bytes: (within(memory_mb, "memory_mb", 1.0, 1e6)? * 1e6) as u64,
            threads,
            restart,
            ..BuildOptions::new(day, out)
        }))
    }

    /// Begins the build, or continues with one that was stopped, for so many workers: the shares of which tiles lack, the costliest first, and how
    /// many tiles the pack has.
    fn begin(&self, py: Python<'_>, workers: u32) -> PyResult<(Vec<Share>, u64)> {
        let plan = py.detach(|| begin_shares(&self.0, workers, &()));
        let plan = plan.map_err(of_build)?;
        let shares = plan.shares.into_iter().map(|share| {
            let name = share.layer.name().to_owned();
            let columns = share.columns;
            (name, columns.start, columns.end, share.cost, share.missing)
        });
        Ok((shares.collect(), plan.tiles))
    }

    /// Makes the tiles of a share that are not there; answers how many there were to make.
    fn make(&self, py: Python<'_>, map: &str, first: u32, end: u32) -> PyResult<u64> {
        let share = BuildShare {
            layer: layer(map)?,
            columns: first..end,
            cost: 0,
            missing: 0,
        };
        py.detach(|| build_share(&self.0, &share, &Interruptible))
            .map_err(of_build)
    }

    /// Makes what is left and writes the manifest.
    fn finish(&self, py: Python<'_>) -> PyResult<()> {
        let built = py.detach(|| build(&self.0, &Interruptible));
        built.map(|_| ()).map_err(of_build)
    }
}

fn layer(name: &str) -> PyResult<MapLayer> {
    MapLayer::from_name(name).ok_or_else(|| {
        let known = MapLayer::ALL.map(MapLayer::name).join(", ");
        PyValueError::new_err(format!("there is no map {name:?}; it is one of {known}"))
    })
}

fn of_build(error: BuildError) -> PyErr {
    let words = error.to_string();
    match error {
        // With the OS error number, by which Python recognises a full disk.
        BuildError::Write { path, source } => match source.raw_os_error() {
            Some(number) => PyOSError::new_err((number, source.to_string(), path)),
            None => Error::new_err(words),
        },
        BuildError::Option { .. } | BuildError::Pixels { .. } | BuildError::Memory { .. } => {
            PyValueError::new_err(words)
        }
        error => of_any(error),
    }
}
