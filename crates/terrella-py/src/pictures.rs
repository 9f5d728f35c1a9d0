//! Images as arrays, and as PNG.

use crate::errors::of_any;
use numpy::ndarray::{Array2, Array3};
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PySlice};
use terrella::{LayerValues, TRUTH_LAYERS, TruthLayer, TruthPicture};
use terrella_play::png_bytes;

/// Longest side of an image, in pixels, that is requested from any device.
const LONGEST_SIDE_PX: i64 = 65_536;

/// Checks width and height from Python.
pub fn size((width, height): (i64, i64)) -> PyResult<(u32, u32)> {
    let side = |side: i64| match (1..=LONGEST_SIDE_PX).contains(&side) {
        true => Ok(side as u32),
        false => Err(PyValueError::new_err(format!(
            "size: {side} is not from 1 to {LONGEST_SIDE_PX} pixels"
        ))),
    };
    Ok((side(width)?, side(height)?))
}

/// The number of pixels of an image.
pub fn pixels((width, height): (u32, u32)) -> usize {
    width as usize * height as usize
}

/// Height × width × 4 bytes, passed on without a copy.
pub fn color(
    py: Python<'_>,
    (width, height): (u32, u32),
    rgba: Vec<u8>,
) -> PyResult<Bound<'_, PyArray3<u8>>> {
    let shape = (height as usize, width as usize, 4);
    Ok(Array3::from_shape_vec(shape, rgba)
        .map_err(of_any)?
        .into_pyarray(py))
}

/// Height × width × 3 floats: a view of red, green and blue in an array of four channels.
pub fn light(
    py: Python<'_>,
    (width, height): (u32, u32),
    light: Vec<f32>,
) -> PyResult<Bound<'_, PyAny>> {
    let shape = (height as usize, width as usize, 4);
    let all = Array3::from_shape_vec(shape, light)
        .map_err(of_any)?
        .into_pyarray(py);
    all.get_item((py.Ellipsis(), PySlice::new(py, 0, 3, 1)))
}

/// Height × width values of one kind, such as depths or a converter's numbers, rows from the top.
pub fn plane<T: Element>(
    py: Python<'_>,
    (width, height): (u32, u32),
    values: Vec<T>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let shape = (height as usize, width as usize);
    Ok(Array2::from_shape_vec(shape, values)
        .map_err(of_any)?
        .into_pyarray(py))
}

/// The requested truth layers.
pub struct Layers(Vec<&'static TruthLayer>);

impl Layers {
    /// The layers with these names; all of them by default.
    pub fn named(names: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(names) = names else {
            return Ok(Self(TRUTH_LAYERS.iter().collect()));
        };
        // A text is no list of names: its letters would be.
        let names: Vec<String> = names.extract().map_err(|_| {
            PyTypeError::new_err(format!(
                "layers: pass a list of names, for example [\"lat_deg\"], not {names:?}"
            ))
        })?;
        let found = names.iter().map(|name| {
            let layer = TRUTH_LAYERS.iter().find(|layer| layer.name == name);
            layer.ok_or_else(|| {
                let known: Vec<_> = TRUTH_LAYERS.iter().map(|layer| layer.name).collect();
                PyValueError::new_err(format!(
                    "layers: there is no truth layer {name:?}; there are {}",
                    known.join(", ")
                ))
            })
        });
        Ok(Self(found.collect::<PyResult<_>>()?))
    }

    /// The requested layers, in order.
    pub fn wanted(&self) -> &[&'static TruthLayer] {
        &self.0
    }

    /// Their values.
    pub fn of(&self, truth: &TruthPicture) -> Vec<LayerValues> {
        truth.layers(&self.0)
    }

    /// The same as arrays by name.
    pub fn arrays<'py>(
        &self,
        py: Python<'py>,
        size: (u32, u32),
        values: Vec<LayerValues>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let arrays = PyDict::new(py);
        for (layer, values) in self.0.iter().zip(values) {
            let shape: Vec<usize> = layer.shape(size).iter().map(|n| *n as usize).collect();
            match values {
                LayerValues::F32(values) => {
                    arrays.set_item(layer.name, PyArray1::from_vec(py, values).reshape(shape)?)?;
                }
                LayerValues::F64(values) => {
                    arrays.set_item(layer.name, PyArray1::from_vec(py, values).reshape(shape)?)?;
                }
            }
        }
        Ok(arrays)
    }
}

/// Name, unit, type and meaning of every truth layer.
#[pyfunction]
fn truth_layers() -> Vec<(&'static str, &'static str, &'static str, &'static str)> {
    let layers = TRUTH_LAYERS.iter();
    layers
        .map(|layer| (layer.name, layer.unit, layer.dtype.name(), layer.what))
        .collect()
}

/// A picture as the bytes of a PNG file.
#[pyfunction(name = "png")]
fn png_of<'py>(py: Python<'py>, color: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
    let color: PyReadonlyArray3<'_, u8> = color.extract().map_err(|_| {
        PyTypeError::new_err("color: an array of height × width × 4 bytes (uint8) is needed")
    })?;
    let array = color.as_array();
    let (height, width, channels) = array.dim();
    let (Ok(wide), Ok(high), 4) = (u32::try_from(width), u32::try_from(height), channels) else {
        return Err(PyValueError::new_err(format!(
            "color: an array of height × width × 4 bytes is needed, not {height} × {width} × {channels}"
        )));
    };
    let rgba = array.as_standard_layout();
    let bytes = match rgba.as_slice() {
        Some(rgba) => py
            .detach(|| png_bytes((wide, high), rgba))
            .map_err(of_any)?,
        None => return Err(PyValueError::new_err("color: the array has no order")),
    };
    Ok(PyBytes::new(py, &bytes))
}

pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(png_of, module)?)?;
    module.add_function(wrap_pyfunction!(truth_layers, module)?)
}
