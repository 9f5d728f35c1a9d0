//! Errors of the library as exceptions, with the same words.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use terrella::{EarthError, OffscreenError};
use terrella_orbit as orbit;
use terrella_play::PlayError;

create_exception!(
    terrella,
    Error,
    PyException,
    "What the library rejects or cannot do."
);
create_exception!(
    terrella,
    SceneError,
    Error,
    "A scene, or an instant asked of it, is at fault."
);
create_exception!(
    terrella,
    OrbitError,
    Error,
    "A file of orbits, or an instant at which a satellite is not known."
);
create_exception!(
    terrella,
    DeviceError,
    Error,
    "No adapter, or one that has no room or was lost."
);

pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("Error", py.get_type::<Error>())?;
    module.add("SceneError", py.get_type::<SceneError>())?;
    module.add("OrbitError", py.get_type::<OrbitError>())?;
    module.add("DeviceError", py.get_type::<DeviceError>())
}

pub fn of_play(error: PlayError) -> PyErr {
    let words = error.to_string();
    match error {
        PlayError::Orbit(_) => OrbitError::new_err(words),
        PlayError::Context(_) | PlayError::DeviceLost(_) => DeviceError::new_err(words),
        PlayError::Offscreen(error) => of_offscreen(error),
        PlayError::Earth(EarthError::Exposure(_)) => {
            PyValueError::new_err(format!("exposure_ev: {words}"))
        }
        error if error.is_bad_scene() => SceneError::new_err(words),
        _ => Error::new_err(words),
    }
}

pub fn of_offscreen(error: OffscreenError) -> PyErr {
    let words = error.to_string();
    match error {
        OffscreenError::Context(_) | OffscreenError::NoRoom { .. } | OffscreenError::Picture(_) => {
            DeviceError::new_err(words)
        }
        OffscreenError::Earth(EarthError::Exposure(_)) => {
            PyValueError::new_err(format!("exposure_ev: {words}"))
        }
        OffscreenError::NoPicture => PyValueError::new_err(format!("camera: {words}")),
        OffscreenError::TooLarge { .. }
        | OffscreenError::TooMuchMemory { .. }
        | OffscreenError::TruthTooLarge { .. } => PyValueError::new_err(format!("size: {words}")),
        _ => Error::new_err(words),
    }
}

pub fn of_orbit(error: &orbit::OrbitError) -> PyErr {
    OrbitError::new_err(error.to_string())
}

/// A motion that cannot begin, or not go on.
pub fn of_start(error: impl std::fmt::Display) -> PyErr {
    OrbitError::new_err(error.to_string())
}

/// Anything else, in its own words.
pub fn of_any(error: impl std::fmt::Display) -> PyErr {
    Error::new_err(error.to_string())
}
