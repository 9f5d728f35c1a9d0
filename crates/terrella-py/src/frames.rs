//! Axes, places and the Sun, for arrays of instants and positions.

use crate::arguments::vectors;
use crate::feeds::frame_named;
use crate::times::epochs;
use glam::DVec3;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use terrella::Sky;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Orientation};
use terrella_orbit::OrbitState;

fn array<'py>(
    py: Python<'py>,
    mut shape: Vec<usize>,
    rows: Vec<DVec3>,
) -> PyResult<Bound<'py, PyAny>> {
    shape.push(3);
    let numbers = rows.into_iter().flat_map(|row| row.to_array()).collect();
    Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any())
}

/// Instants for rows: one for all, or as many as there are.
fn fitting(epochs: Vec<Epoch>, count: usize) -> PyResult<Vec<Epoch>> {
    match epochs.len() {
        1 => Ok(vec![epochs[0]; count]),
        n if n == count => Ok(epochs),
        n => Err(PyValueError::new_err(format!(
            "times: {n} instants for {count} positions; give one, or as many"
        ))),
    }
}

/// Positions (… × 3, metres) and velocities (the same, metres a second, or None) in other axes: from `source` to `target`, each of itrf, teme,
/// gcrf, eme2000 and pef, at one time for all or one for each. Velocities are relative to the axes. UT1 = UTC, without polar
/// motion.
#[pyfunction]
#[pyo3(signature = (positions_m, velocities_m_s, times, *, source, target))]
fn transform<'py>(
    py: Python<'py>,
    positions_m: &Bound<'py, PyAny>,
    velocities_m_s: Option<&Bound<'py, PyAny>>,
    times: &Bound<'py, PyAny>,
    source: &str,
    target: &str,
) -> PyResult<(Bound<'py, PyAny>, Option<Bound<'py, PyAny>>)> {
    let (source, target) = (
        frame_named(source, "source")?,
        frame_named(target, "target")?,
    );
    let (shape, positions) = vectors(positions_m, "positions_m")?;
    let velocities = velocities_m_s
        .map(|value| vectors(value, "velocities_m_s"))
        .transpose()?;
    if let Some((other, _)) = velocities.as_ref().filter(|(other, _)| *other != shape) {
        return Err(PyValueError::new_err(format!(
            "velocities_m_s: axes {other:?} before the last, positions have {shape:?}"
        )));
    }
    let epochs = fitting(epochs(times, "times")?, positions.len())?;
    let has_velocities = velocities.is_some();
    let velocities =
        velocities.map_or_else(|| vec![DVec3::ZERO; positions.len()], |(_, rows)| rows);
    let states: Vec<_> = py.detach(|| {
        let rows = epochs.iter().zip(&positions).zip(&velocities);
        rows.map(|((epoch, position), velocity)| {
            let state = OrbitState {
                epoch: *epoch,
                frame: source,
                position_m: *position,
                velocity_m_s: *velocity,
            };
            state.in_frame(target, &Orientation::default())
        })
        .collect()
    });
    let positions = states.iter().map(|state| state.position_m).collect();
    let velocities = states.iter().map(|state| state.velocity_m_s).collect();
    let positions = array(py, shape.clone(), positions)?;
    let velocities = has_velocities
        .then(|| array(py, shape, velocities))
        .transpose()?;
    Ok((positions, velocities))
}

/// Latitude and longitude in degrees and height in metres (geodetic, WGS84) of Earth-fixed positions (… × 3, metres).
#[pyfunction]
fn geodetic_from_itrf<'py>(
    py: Python<'py>,
    positions_m: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, rows) = vectors(positions_m, "positions_m")?;
    let places = py.detach(|| {
        let places = rows
            .into_iter()
            .map(|row| Ellipsoid::WGS84.geodetic_from_itrf(row));
        places
            .map(|place| {
                DVec3::new(
                    place.lat_rad.to_degrees(),
                    place.lon_rad.to_degrees(),
                    place.height_m,
                )
            })
            .collect()
    });
    array(py, shape, places)
}

/// Earth-fixed positions, metres, of places: … × 3, latitude and longitude in degrees and height in metres (geodetic, WGS84).
#[pyfunction]
fn itrf_from_geodetic<'py>(
    py: Python<'py>,
    places: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, rows) = vectors(places, "places")?;
    if let Some(row) = rows.iter().find(|row| row.x.abs() > 90.0) {
        return Err(PyValueError::new_err(format!(
            "places: latitude {}° is not from -90 to 90",
            row.x
        )));
    }
    let positions = py.detach(|| {
        let places = rows
            .into_iter()
            .map(|row| Geodetic::from_degrees(row.x, row.y, row.z));
        places
            .map(|place| Ellipsoid::WGS84.itrf_from_geodetic(place))
            .collect()
    });
    array(py, shape, positions)
}

/// The Sun's position, Earth-fixed axes, metres: times × 3.
#[pyfunction]
fn sun_itrf_m<'py>(py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let epochs = epochs(times, "times")?;
    let count = epochs.len();
    let suns = py.detach(|| {
        let skies = epochs.into_iter().map(Sky::at);
        skies.map(|sky| sky.sun_itrf * sky.sun_distance_m).collect()
    });
    array(py, vec![count], suns)
}

pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(transform, module)?)?;
    module.add_function(wrap_pyfunction!(geodetic_from_itrf, module)?)?;
    module.add_function(wrap_pyfunction!(itrf_from_geodetic, module)?)?;
    module.add_function(wrap_pyfunction!(sun_itrf_m, module)?)
}
