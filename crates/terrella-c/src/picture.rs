//! Formats of pictures in memory, and statistics of a drawn one.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::pointers::{buffer, row, text, write};
use half::f16;
use image::RgbaImage;
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::time::Duration;
use terrella::Drawing;
use terrella_play::PendingFile;

/// Pixel format of an image: a constant that begins with `TERRELLA_RGBA`.
pub type TerrellaFormat = u32;

/// The displayed image: red, green, blue in sRGB and opacity, one byte each.
pub const TERRELLA_RGBA8: TerrellaFormat = 0;
/// Linear scene-referred light (a white sheet that faces the Sun in space is 1): red, green, blue and an unused number, IEEE half floats.
pub const TERRELLA_RGBA16F: TerrellaFormat = 1;
/// The same as 32-bit floats.
pub const TERRELLA_RGBA32F: TerrellaFormat = 2;

/// Statistics of an image.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TerrellaDrawn {
    /// Triangles.
    pub triangles: u64,
    /// Tiles of a pack that did not arrive in time; coarser ones are drawn instead.
    pub missing_tiles: u64,
    /// The exposure value that was used, EV.
    pub exposure_ev: f64,
}

impl TerrellaDrawn {
    pub(crate) fn of(drawing: &Drawing) -> Self {
        Self {
            triangles: u64::from(drawing.stats.triangles),
            missing_tiles: drawing.missing.len() as u64,
            exposure_ev: drawing.stats.exposure_ev,
        }
    }
}

/// Writes the statistics of a drawing to `drawn`, unless it is null.
///
/// # Safety
/// `drawn` is null or points to writable memory.
pub(crate) unsafe fn tell_drawn(
    drawn: *mut TerrellaDrawn,
    drawing: &Drawing,
) -> Result<(), Failure> {
    if drawn.is_null() {
        return Ok(());
    }
    // SAFETY: the caller's promise.
    unsafe { write(drawn, "drawn", TerrellaDrawn::of(drawing)) }
}

pub(crate) fn wait(wait_s: f64) -> Result<Duration, Failure> {
    match (0.0..=86_400.0).contains(&wait_s) {
        true => Ok(Duration::from_secs_f64(wait_s)),
        false => Err(Failure::argument(format!(
            "wait_s: {wait_s} is not from 0 to 86400"
        ))),
    }
}

/// A source of displayed images and of linear light.
pub(crate) trait Draws {
    fn size(&self) -> (u32, u32);
    fn color(&mut self, rgba: &mut [u8]) -> Result<Drawing, Failure>;
    fn light(&mut self, light: &mut [f32]) -> Result<Drawing, Failure>;
}

/// Draws into a buffer from C.
///
/// # Safety
/// `pixels` is null or points to `bytes` bytes, which nobody else uses during the call; `drawn` is null or points to writable memory.
pub(crate) unsafe fn draw_into(
    source: &mut dyn Draws,
    format: TerrellaFormat,
    pixels: *mut c_void,
    bytes: usize,
    drawn: *mut TerrellaDrawn,
) -> Result<(), Failure> {
    let (width, height) = source.size();
    let texel = match format {
        TERRELLA_RGBA8 => 4,
        TERRELLA_RGBA16F => 8,
        TERRELLA_RGBA32F => 16,
        _ => {
            return Err(Failure::argument(format!(
                "format: {format} is none of the TERRELLA_RGBA formats"
            )));
        }
    };
    let needed = width as usize * height as usize * texel;
    if bytes != needed {
        return Err(Failure::argument(format!(
            "bytes: a picture of {width} × {height} pixels needs {needed} bytes in this format, not {bytes}"
        )));
    }
    let drawing = match format {
        TERRELLA_RGBA8 => {
            // SAFETY: the caller's promise: a buffer of this size.
            let rgba = unsafe { buffer(pixels.cast::<u8>(), needed, "pixels") }?;
            source.color(rgba)?
        }
        TERRELLA_RGBA32F => {
            // SAFETY: the caller's promise: a buffer of this size; alignment is checked.
            let light = unsafe { buffer(pixels.cast::<f32>(), needed / 4, "pixels") }?;
            source.light(light)?
        }
        _ => {
            // SAFETY: the caller's promise: a buffer of this size; alignment is checked.
            let halves = unsafe { buffer(pixels.cast::<u16>(), needed / 2, "pixels") }?;
            let mut light = vec![0.0; halves.len()];
            let drawing = source.light(&mut light)?;
            for (half, light) in halves.iter_mut().zip(light) {
                *half = f16::from_f32(light).to_bits();
            }
            drawing
        }
    };
    // SAFETY: the caller's promise.
    unsafe { tell_drawn(drawn, &drawing) }
}

/// Writes a picture of `TERRELLA_RGBA8` to a PNG file, without its opacity. The file is complete or does not exist; an existing file is
/// replaced.
///
/// # Safety
/// `path` ends with a zero byte; `rgba` points to width × height × 4 bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_write_png(
    path: *const c_char,
    rgba: *const u8,
    width: u32,
    height: u32,
) -> TerrellaStatus {
    answer(|| {
        // SAFETY: the caller's promise.
        let path = unsafe { text(path, "path") }?;
        let pixels = (width as usize)
            .checked_mul(height as usize)
            .filter(|pixels| *pixels > 0);
        let bytes = pixels
            .and_then(|pixels| pixels.checked_mul(4))
            .ok_or_else(|| {
                Failure::argument(format!(
                    "width, height: a picture of {width} × {height} pixels cannot be written; both must be at least 1, and their product must fit memory"
                ))
            })?;
        // SAFETY: the caller's promise: a buffer of this size.
        let rgba = unsafe { row(rgba, bytes, "rgba") }?;
        let write = PendingFile::create(Path::new(path), "pictures", "png").and_then(|file| {
            // The length matches the size.
            let rgba = RgbaImage::from_raw(width, height, rgba.to_vec()).unwrap_or_default();
            file.write_png(&rgba)
        });
        write.map_err(Failure::file)
    })
}
