//! Truth layers: their names, and their values at the pixels.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::pointers::{buffer, row, text, write};
use std::ffi::{CString, c_char, c_void};
use std::sync::LazyLock;
use terrella::{LayerDtype, LayerValues, TRUTH_LAYERS, TruthLayer, TruthPicture};

/// Description of a truth layer. Its texts are never freed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TerrellaLayer {
    /// Its name.
    pub name: *const c_char,
    /// The unit of its numbers, "1" if they have none.
    pub unit: *const c_char,
    /// What they mean.
    pub what: *const c_char,
    /// Numbers per pixel.
    pub components: u32,
    /// Bytes of a number: 4 for float, 8 for double.
    pub number_bytes: u32,
}

/// A requested truth layer and your buffer for it: row by row from the top, NaN where there is no value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TerrellaLayerBuffer {
    /// Its name.
    pub name: *const c_char,
    /// Buffer for its numbers, float or double as the layer says.
    pub values: *mut c_void,
    /// Bytes of that buffer: width × height × components × number_bytes.
    pub bytes: usize,
}

/// Name, unit and meaning of each layer, for C.
static TEXTS: LazyLock<Vec<[CString; 3]>> = LazyLock::new(|| {
    let text = |text: &str| CString::new(text).unwrap_or_default();
    let layers = TRUTH_LAYERS.iter();
    layers
        .map(|layer| [layer.name, layer.unit, layer.what].map(text))
        .collect()
});

fn number_bytes(layer: &TruthLayer) -> usize {
    match layer.dtype {
        LayerDtype::F32 => 4,
        LayerDtype::F64 => 8,
    }
}

/// The number of truth layers.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_layer_count() -> usize {
    TRUTH_LAYERS.len()
}

/// The description of the truth layer with this index, from 0.
///
/// # Safety
/// `layer` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_layer(index: usize, layer: *mut TerrellaLayer) -> TerrellaStatus {
    answer(|| {
        let (Some(found), Some([name, unit, what])) = (TRUTH_LAYERS.get(index), TEXTS.get(index))
        else {
            return Err(Failure::argument(format!(
                "index: {index} is not below {}",
                TRUTH_LAYERS.len()
            )));
        };
        let reported = TerrellaLayer {
            name: name.as_ptr(),
            unit: unit.as_ptr(),
            what: what.as_ptr(),
            components: found.components() as u32,
            number_bytes: number_bytes(found) as u32,
        };
        // SAFETY: the caller's promise.
        unsafe { write(layer, "layer", reported) }
    })
}

/// The requested layers, checked before anything is drawn.
pub(crate) struct WantedLayers<'c> {
    layers: Vec<&'static TruthLayer>,
    values: Vec<Values<'c>>,
}

enum Values<'c> {
    F32(&'c mut [f32]),
    F64(&'c mut [f64]),
}

impl<'c> WantedLayers<'c> {
    /// Reads the layers that C requests for an image of this size.
    ///
    /// # Safety
    /// `wanted` is null or points to `count` values; their texts end with zero bytes; their buffers have the given number of bytes, do not overlap,
    /// and nobody else uses them during the call.
    pub unsafe fn read(
        wanted: *const TerrellaLayerBuffer,
        count: usize,
        (width, height): (u32, u32),
    ) -> Result<Self, Failure> {
        // SAFETY: the caller's promise.
        let wanted = unsafe { row(wanted, count, "layers") }?;
        let (mut layers, mut values) = (Vec::new(), Vec::new());
        for (n, one) in wanted.iter().enumerate() {
            // SAFETY: the caller's promise about its texts.
            let name = unsafe { text(one.name, &format!("layers[{n}].name")) }?;
            let Some(layer) = TRUTH_LAYERS.iter().find(|layer| layer.name == name) else {
                let known: Vec<_> = TRUTH_LAYERS.iter().map(|layer| layer.name).collect();
                return Err(Failure::argument(format!(
                    "layers[{n}].name: there is no truth layer {name:?}; there are {}",
                    known.join(", ")
                )));
            };
            let numbers = width as usize * height as usize * layer.components();
            let needed = numbers * number_bytes(layer);
            if one.bytes != needed {
                return Err(Failure::argument(format!(
                    "layers[{n}].bytes: {name} of {width} × {height} pixels needs {needed} bytes, not {}",
                    one.bytes
                )));
            }
            let named = format!("layers[{n}].values");
            let to = one.values;
            values.push(match layer.dtype {
                LayerDtype::F32 => {
                    // SAFETY: the caller's promise: a buffer of this size; alignment is checked.
                    let numbers = unsafe { buffer(to.cast(), numbers, &named) };
                    Values::F32(numbers?)
                }
                LayerDtype::F64 => {
                    // SAFETY: the same.
                    let numbers = unsafe { buffer(to.cast(), numbers, &named) };
                    Values::F64(numbers?)
                }
            });
            layers.push(layer);
        }
        Ok(Self { layers, values })
    }

    /// The requested layers, in order.
    pub fn layers(&self) -> &[&'static TruthLayer] {
        &self.layers
    }

    /// Writes the layers' values at the pixels of an image.
    pub fn fill_from(self, truth: &TruthPicture) {
        let values = truth.layers(&self.layers);
        self.fill(values);
    }

    /// Writes the layers' values, given in the order of [`Self::layers`].
    pub fn fill(self, values: Vec<LayerValues>) {
        for (to, from) in self.values.into_iter().zip(values) {
            match (to, from) {
                (Values::F32(to), LayerValues::F32(from)) => to.copy_from_slice(&from),
                (Values::F64(to), LayerValues::F64(from)) => to.copy_from_slice(&from),
                // The layer's type selects both.
                (Values::F32(_), LayerValues::F64(_)) | (Values::F64(_), LayerValues::F32(_)) => {}
            }
        }
    }
}

/// The caller's buffer for depth, checked for its size.
///
/// # Safety
/// `depth_m` is null or points to `count` floats, which nobody else uses during the call.
pub(crate) unsafe fn depth_buffer<'c>(
    depth_m: *mut f32,
    count: usize,
    (width, height): (u32, u32),
) -> Result<&'c mut [f32], Failure> {
    let needed = width as usize * height as usize;
    if count != needed {
        return Err(Failure::argument(format!(
            "count: a picture of {width} × {height} pixels has {needed} depths, not {count}"
        )));
    }
    // SAFETY: the caller's promise.
    unsafe { buffer(depth_m, count, "depth_m") }
}
