//! Maps that a worker sends to the page: bands of rows, a call of a function for each.

use js_sys::{Array, Function, Uint8Array};
use wasm_bindgen::prelude::JsValue;

/// Size of a band, bytes: a message takes a millisecond or two.
pub const BAND_BYTES: usize = 1 << 20;

/// Level of the call after the last band of a map.
pub const END: i32 = -1;

/// Calls `take` with a band: number of the map, its width and height, level, first row, and texels.
///
/// # Errors
/// What it throws.
pub fn post(
    take: &Function,
    map: u32,
    (width, height): (u32, u32),
    level: i32,
    first: u32,
    texels: &[u8],
) -> Result<(), JsValue> {
    let arguments = Array::new();
    for number in [map, width, height] {
        arguments.push(&number.into());
    }
    arguments.push(&level.into());
    arguments.push(&first.into());
    arguments.push(&Uint8Array::from(texels));
    take.apply(&JsValue::NULL, &arguments).map(drop)
}
