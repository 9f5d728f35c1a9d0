//! Arguments from Python: checked, with errors that name them.

use crate::units::in_unit_of;
use glam::{DMat3, DMat4, DVec3};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Limit on the numbers that one call accepts.
const MAX_NUMBERS: usize = 1 << 28;

pub fn numpy<'py>(py: Python<'py>) -> PyResult<Bound<'py, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module = NUMPY.get_or_try_init(py, || Ok::<_, PyErr>(py.import("numpy")?.unbind()))?;
    Ok(module.bind(py).clone())
}

/// Whole and other numbers as an array of 64-bit floats: its axes and its numbers, row by row. Quantities with a unit are converted to the
/// unit in which `name` ends.
pub fn numbers(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, Vec<f64>)> {
    let np = numpy(value.py())?;
    let wrong =
        |error: PyErr| PyTypeError::new_err(format!("{name}: no array of numbers: {error}"));
    let plain = in_unit_of(value, name)?;
    let value = plain.as_ref().unwrap_or(value);
    let array = np.call_method1("asarray", (value,)).map_err(wrong)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "i" | "u" | "f") {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "{name}: an array of numbers is needed, not of {dtype}"
        )));
    }
    let array = np.call_method1("ascontiguousarray", (array, "float64"))?;
    let array = array
        .cast::<PyArrayDyn<f64>>()
        .map_err(|error| wrong(error.into()))?;
    if array.len() > MAX_NUMBERS {
        return Err(PyValueError::new_err(format!(
            "{name}: {} numbers are more than the {MAX_NUMBERS} that one call takes",
            array.len()
        )));
    }
    Ok((
        array.shape().to_vec(),
        array.to_vec().map_err(|error| wrong(error.into()))?,
    ))
}

/// The same, of this shape and finite.
fn shaped(value: &Bound<'_, PyAny>, name: &str, shape: &[usize]) -> PyResult<Vec<f64>> {
    // A scalar stands for itself: `ascontiguousarray` gives it an axis.
    let (found, numbers) = numbers(value, name)?;
    if found != shape {
        return Err(PyValueError::new_err(format!(
            "{name}: an array of shape {} is needed, not {}",
            shape_text(shape),
            shape_text(&found)
        )));
    }
    if let Some(wrong) = numbers.iter().find(|number| !number.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "{name}: {wrong} is no finite number"
        )));
    }
    Ok(numbers)
}

fn shape_text(shape: &[usize]) -> String {
    let axes: Vec<_> = shape.iter().map(usize::to_string).collect();
    match axes.len() {
        1 => format!("({},)", axes[0]),
        _ => format!("({})", axes.join(", ")),
    }
}

pub fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<DVec3> {
    Ok(DVec3::from_slice(&shaped(value, name, &[3])?))
}

/// A matrix whose rows are the array's rows.
pub fn matrix_3(value: &Bound<'_, PyAny>, name: &str) -> PyResult<DMat3> {
    let numbers = shaped(value, name, &[3, 3])?;
    let rows = numbers.as_chunks::<3>().0;
    Ok(DMat3::from_cols_array_2d(&[rows[0], rows[1], rows[2]]).transpose())
}

/// A matrix whose rows are the array's rows.
pub fn matrix_4(value: &Bound<'_, PyAny>, name: &str) -> PyResult<DMat4> {
    let numbers = shaped(value, name, &[4, 4])?;
    let rows = numbers.as_chunks::<4>().0;
    Ok(DMat4::from_cols_array_2d(&[rows[0], rows[1], rows[2], rows[3]]).transpose())
}

/// Rows of three numbers, and the axes before the last. Rows that are not finite stay so.
pub fn vectors(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<usize>, Vec<DVec3>)> {
    let (mut shape, numbers) = numbers(value, name)?;
    if shape.pop() != Some(3) {
        return Err(PyValueError::new_err(format!(
            "{name}: the last axis must have 3 numbers"
        )));
    }
    let rows = numbers.as_chunks::<3>().0.iter();
    Ok((shape, rows.map(|row| DVec3::from_array(*row)).collect()))
}

/// A finite number in a range.
pub fn within(value: f64, name: &str, least: f64, most: f64) -> PyResult<f64> {
    match (least..=most).contains(&value) {
        true => Ok(value),
        false => Err(PyValueError::new_err(format!(
            "{name}: {value} is not from {least} to {most}"
        ))),
    }
}

/// Seconds that may be waited.
pub fn wait(seconds: f64) -> PyResult<std::time::Duration> {
    let seconds = within(seconds, "wait_s", 0.0, 86_400.0)?;
    Ok(std::time::Duration::from_secs_f64(seconds))
}
