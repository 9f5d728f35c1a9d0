//! Errors of the library as exceptions, with the same words.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use terrella::{EarthError, OffscreenError};
use terrella_orbit as orbit;
use terrella_play::PlayError;

create_exception!(terrella, Error, PyException, "An error of the library.");
create_exception!(
    terrella,
    SceneError,
    Error,
    "An invalid scene, or a time that it does not cover."
);
create_exception!(
    terrella,
    OrbitError,
    Error,
    "An invalid orbit file, or a time outside the validity of a satellite."
);
create_exception!(
    terrella,
    DeviceError,
    Error,
    "No graphics adapter, out of device memory, or a lost device."
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
        OffscreenError::Empty { .. }
        | OffscreenError::TooLarge { .. }
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
