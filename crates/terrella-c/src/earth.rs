//! The Earth with its own device.

use crate::camera::TerrellaCamera;
use crate::failure::{Failure, TerrellaStatus, answer};
use crate::handles;
use crate::options::{TerrellaOptions, Wanted};
use crate::picture::{Draws, TerrellaDrawn, TerrellaFormat, draw_into, tell_drawn, wait};
use crate::pointers::{check_out, read, write};
use crate::time::TerrellaTime;
use crate::truth::{TerrellaLayerBuffer, WantedLayers, depth_buffer};
use std::ffi::c_void;
use std::time::Duration;
use terrella::{Drawing, EyeView, OffscreenEarth, Sky};

/// An Earth with its own device. An opaque handle. Any thread may use it; calls from several threads are serialised.
pub struct TerrellaEarth {
    _private: [u8; 0],
}

const KIND: &str = "an Earth";

/// Opens a graphics adapter and creates an Earth. Free it with `terrella_earth_free`. On failure `*earth` is unchanged.
///
/// # Safety
/// `options` points to options whose texts end with zero bytes; `earth` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_earth_new(
    options: *const TerrellaOptions,
    earth: *mut *mut TerrellaEarth,
) -> TerrellaStatus {
    answer(|| {
        check_out(earth, "earth")?;
        // SAFETY: the caller's promise.
        let wanted = unsafe { Wanted::read(options) }?;
        let gpu = OffscreenEarth::open_gpu(wanted.adapter.as_deref())?;
        let options = wanted.with_shared_maps(&gpu)?;
        let made = OffscreenEarth::new(gpu, options, wanted.size)?;
        // SAFETY: the caller's promise.
        unsafe { write(earth, "earth", handles::insert(KIND, made)) }
    })
}

/// Frees an Earth. A null or freed handle is an error. Any thread may call it, also while another one draws with this Earth: that call is
/// completed, and every later one is `TERRELLA_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_earth_free(earth: *mut TerrellaEarth) -> TerrellaStatus {
    answer(|| handles::remove(earth, KIND, "earth"))
}

/// Changes the size of the images. On failure the size stays.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_earth_resize(
    earth: *mut TerrellaEarth,
    width: u32,
    height: u32,
) -> TerrellaStatus {
    answer(|| {
        handles::with(earth, KIND, "earth", |earth: &mut OffscreenEarth| {
            Ok(earth.set_size((width, height))?)
        })
    })
}

/// Returns the size of the images, pixels. It waits while another thread draws with this Earth.
///
/// # Safety
/// Both point to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_earth_size(
    earth: *mut TerrellaEarth,
    width: *mut u32,
    height: *mut u32,
) -> TerrellaStatus {
    answer(|| {
        handles::with(earth, KIND, "earth", |earth: &mut OffscreenEarth| {
            let (wide, high) = earth.size();
            check_out(height, "height")?;
            // SAFETY: the caller's promise, here and below.
            unsafe { write(width, "width", wide) }?;
            // SAFETY: the same.
            unsafe { write(height, "height", high) }
        })
    })
}

struct View<'e> {
    earth: &'e mut OffscreenEarth,
    view: EyeView,
    sky: Sky,
    wait: Duration,
}

impl Draws for View<'_> {
    fn size(&self) -> (u32, u32) {
        self.earth.size()
    }

    fn color(&mut self, rgba: &mut [u8]) -> Result<Drawing, Failure> {
        Ok(self
            .earth
            .draw_color(&self.view, &self.sky, self.wait, rgba)?)
    }

    fn light(&mut self, light: &mut [f32]) -> Result<Drawing, Failure> {
        Ok(self
            .earth
            .draw_light(&self.view, &self.sky, self.wait, light)?)
    }
}

/// View and sky for a call.
///
/// # Safety
/// `camera` is null or points to a camera.
unsafe fn asked(
    camera: *const TerrellaCamera,
    time: TerrellaTime,
) -> Result<(EyeView, Sky), Failure> {
    // SAFETY: the caller's promise.
    let view = unsafe { read(camera, "camera") }?.view("camera")?;
    Ok((view, Sky::at(time.epoch("time")?)))
}

/// Draws a picture and writes it to `pixels`, rows from the top without padding: `bytes` is width × height × 4, 8 or 16 by its format. Any
/// other number is `TERRELLA_ARGUMENT`, and nothing is drawn or written. Waits for the device, and for tiles at most `wait_s` seconds. 0 draws
/// the tiles that have arrived, for real time. `drawn` may be null.
///
/// # Safety
/// `camera` points to a camera; `pixels` points to `bytes` bytes, which nobody else uses during the call; `drawn` is null or points to
/// writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_earth_draw(
    earth: *mut TerrellaEarth,
    camera: *const TerrellaCamera,
    time: TerrellaTime,
    wait_s: f64,
    format: TerrellaFormat,
    pixels: *mut c_void,
    bytes: usize,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        // SAFETY: the caller's promise.
        let (view, sky) = unsafe { asked(camera, time) }?;
        let wait = wait(wait_s)?;
        handles::with(earth, KIND, "earth", |earth: &mut OffscreenEarth| {
            let mut source = View {
                earth,
                view,
                sky,
                wait,
            };
            // SAFETY: the caller's promise.
            unsafe { draw_into(&mut source, format, pixels, bytes, drawn) }
        })
    })
}

/// Writes the distance of the ground along the camera's axis, metres, to `depth_m`: `count` is width × height, and any other number is
/// `TERRELLA_ARGUMENT`. Infinite where no ground is visible.
///
/// # Safety
/// `camera` points to a camera; `depth_m` points to `count` floats, which nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_earth_depth(
    earth: *mut TerrellaEarth,
    camera: *const TerrellaCamera,
    time: TerrellaTime,
    wait_s: f64,
    depth_m: *mut f32,
    count: usize,
) -> TerrellaStatus {
    answer(|| {
        // SAFETY: the caller's promise.
        let (view, sky) = unsafe { asked(camera, time) }?;
        let wait = wait(wait_s)?;
        handles::with(earth, KIND, "earth", |earth: &mut OffscreenEarth| {
            // SAFETY: the caller's promise.
            let to = unsafe { depth_buffer(depth_m, count, earth.size()) }?;
            let (truth, _) = earth.draw_truth(&view, &sky, wait)?;
            to.copy_from_slice(&truth.depth_m());
            Ok(())
        })
    })
}

/// Writes truth layers, each to its own buffer. The view is rendered once for all of them. A buffer of another size than the layer is
/// `TERRELLA_ARGUMENT`, and nothing is written. With a `count` of 0, `layers` may be null. `drawn` may be null.
///
/// # Safety
/// `camera` points to a camera; `layers` points to `count` values. Their texts end with zero bytes. Their buffers have the bytes that they
/// name, do not overlap, and nobody else uses them during the call. `drawn` is null or points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_earth_truth(
    earth: *mut TerrellaEarth,
    camera: *const TerrellaCamera,
    time: TerrellaTime,
    wait_s: f64,
    layers: *const TerrellaLayerBuffer,
    count: usize,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        // SAFETY: the caller's promise.
        let (view, sky) = unsafe { asked(camera, time) }?;
        let wait = wait(wait_s)?;
        handles::with(earth, KIND, "earth", |earth: &mut OffscreenEarth| {
            // SAFETY: the caller's promise.
            let wanted = unsafe { WantedLayers::read(layers, count, earth.size()) }?;
            let (truth, drawing) = earth.draw_truth(&view, &sky, wait)?;
            wanted.fill_from(&truth);
            // SAFETY: the caller's promise.
            unsafe { tell_drawn(drawn, &drawing) }
        })
    })
}
