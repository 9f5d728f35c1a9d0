//! The native part of the Python package `terrella`, which `python/terrella` is built on.
//!
//! Long calls release the interpreter. The library writes each returned array once and passes it to NumPy without a copy.

// Its classes are named in Python.
#![allow(unnameable_types)]

mod arguments;
mod camera;
mod earth;
mod errors;
mod feeds;
mod film;
mod foreign;
mod frames;
mod logging;
mod motions;
mod owned;
mod packs;
mod passes;
mod pictures;
mod scene;
mod times;
mod units;

use pyo3::prelude::*;

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    logging::begin();
    errors::add(module)?;
    module.add_class::<times::PyEpoch>()?;
    module.add_class::<camera::PyCamera>()?;
    module.add_class::<earth::PyEarth>()?;
    module.add_class::<scene::PyScene>()?;
    module.add_class::<feeds::PySatellites>()?;
    module.add_class::<feeds::PyCatalogue>()?;
    module.add_class::<feeds::PyEphemerides>()?;
    module.add_class::<feeds::PyParameterMessages>()?;
    module.add_class::<motions::PyKeplerOrbit>()?;
    module.add_class::<motions::PyIntegratedOrbit>()?;
    film::add(module)?;
    module.add_class::<packs::PyPackBuild>()?;
    frames::add(module)?;
    times::add(module)?;
    pictures::add(module)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
