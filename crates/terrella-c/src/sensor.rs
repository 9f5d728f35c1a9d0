//! The camera of a scene's `[sensor]` table: raw frames, and truth through its lens.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::picture::TerrellaDrawn;
use crate::pointers::{buffer, write};
use crate::scene::{TerrellaScene, with_scene};
use crate::time::TerrellaTime;
use crate::truth::{TerrellaLayerBuffer, WantedLayers};

/// Width and height of the sensor of a scene, pixels: those of its raw frames and their truth. A scene without a `[sensor]` table is
/// `TERRELLA_SCENE`.
///
/// # Safety
/// Both point to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_sensor_size(
    scene: *mut TerrellaScene,
    width: *mut u32,
    height: *mut u32,
) -> TerrellaStatus {
    answer(|| {
        with_scene(scene, |pictures| {
            let (wide, high) = pictures.sensor_size()?;
            // SAFETY: the caller's promise, here and below.
            unsafe { write(width, "width", wide) }?;
            // SAFETY: the same.
            unsafe { write(height, "height", high) }
        })
    })
}

/// Draws the raw frame of the sensor of a scene at an instant, by the scene's camera, and writes its numbers to `numbers`, rows from the
/// top: those of the converter, from 0 to 2^bits − 1, as `terrella frame --raw` writes them. `count` is width × height of the sensor, and any
/// other number is `TERRELLA_ARGUMENT`. Of `drawn`, which may be null, only `missing_tiles` is set.
///
/// # Safety
/// `numbers` points to `count` values, which nobody else uses during the call; `drawn` is null or points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_raw(
    scene: *mut TerrellaScene,
    time: TerrellaTime,
    numbers: *mut u16,
    count: usize,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        with_scene(scene, |pictures| {
            let (width, height) = pictures.sensor_size()?;
            let needed = width as usize * height as usize;
            if count != needed {
                return Err(Failure::argument(format!(
                    "count: a raw frame of {width} × {height} pixels has {needed} numbers, not {count}"
                )));
            }
            // SAFETY: the caller's promise.
            let to = unsafe { buffer(numbers, count, "numbers") }?;
            let (frame, missing) = pictures.draw_raw(epoch)?;
            to.copy_from_slice(&frame.data);
            // SAFETY: the caller's promise.
            unsafe { tell_missing(drawn, missing.len()) }
        })
    })
}

/// As `terrella_scene_truth` for the pixels of `terrella_scene_raw`: through the sensor's lens, each row at its own instant. Layers have
/// the sensor's size. Of `drawn`, which may be null, only `missing_tiles` is set.
///
/// # Safety
/// As `terrella_scene_truth`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_raw_truth(
    scene: *mut TerrellaScene,
    time: TerrellaTime,
    layers: *const TerrellaLayerBuffer,
    count: usize,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        with_scene(scene, |pictures| {
            let size = pictures.sensor_size()?;
            // SAFETY: the caller's promise.
            let wanted = unsafe { WantedLayers::read(layers, count, size) }?;
            let (values, missing) = pictures.draw_raw_truth(epoch, wanted.layers())?;
            wanted.fill(values);
            // SAFETY: the caller's promise.
            unsafe { tell_missing(drawn, missing.len()) }
        })
    })
}

/// # Safety
/// `drawn` is null or points to writable memory.
unsafe fn tell_missing(drawn: *mut TerrellaDrawn, missing: usize) -> Result<(), Failure> {
    if drawn.is_null() {
        return Ok(());
    }
    let reported = TerrellaDrawn {
        missing_tiles: missing as u64,
        ..TerrellaDrawn::default()
    };
    // SAFETY: the caller's promise.
    unsafe { write(drawn, "drawn", reported) }
}
