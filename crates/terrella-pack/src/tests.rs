//! Tests of a build's parts, and of interrupted builds.

mod geometry;
mod parts;
mod shares;
pub(super) mod stopped;

use image::{ImageFormat, RgbImage};
use std::path::Path;

/// Bytes without pattern, the same at every run.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 0x2545_F491_4F6C_DD1Du64;
    (0..count)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 32) as u8
        })
        .collect()
}

/// Writes a colour map of noise.
fn write_day(path: &Path, width: u32) {
    let texels = noise((width * width / 2 * 3) as usize);
    let image = RgbImage::from_raw(width, width / 2, texels).expect("as many as it has");
    image
        .save_with_format(path, ImageFormat::Png)
        .expect("a writable folder");
}
