//! The textures of images in memory, and their size limits.

use super::error::OffscreenError;
use crate::gpu::{Development, FrameTargets, GpuContext, PassFormat, TruthTargets};

/// Limit of the textures and the read-back buffer of one image together, MiB.
pub const MAX_PICTURE_MIB: u64 = 4096;

/// `wanted` samples a pixel if the adapter supports them for this colour format and our depth format, else 1.
pub fn supported_samples(adapter: &wgpu::Adapter, color: wgpu::TextureFormat, wanted: u32) -> u32 {
    let does = |format| {
        let flags = adapter.get_texture_format_features(format).flags;
        flags.sample_count_supported(wanted)
    };
    if wanted <= 1 || (does(color) && does(FrameTargets::DEPTH)) {
        return wanted.max(1);
    }
    tracing::warn!(
        "{} does not do {wanted} samples a pixel; edges are drawn with one",
        adapter.get_info().name
    );
    1
}

/// Size of the textures of a frame with 8 bits a channel, bytes: colour, its samples if there are several a pixel, and their depth.
fn target_bytes((width, height): (u32, u32), samples: u32) -> u64 {
    let multisampled = if samples > 1 { u64::from(samples) } else { 0 };
    u64::from(width) * u64::from(height) * 4 * (1 + multisampled + u64::from(samples))
}

/// Size of the textures for an image of 8 bits a channel, rendered by a pass of this format at full size, bytes: the image, its depth, samples if
/// there are several, and with development after the pass the light and its bloom.
pub fn picture_bytes(size: (u32, u32), pass: &PassFormat) -> u64 {
    let (width, height) = size;
    let pixels = u64::from(width) * u64::from(height);
    match pass.development {
        Development::InPass => target_bytes(size, pass.samples),
        Development::AfterPass => {
            // Light takes twice the bytes of an 8-bit image, in its texture and in its samples; the image has its own depth.
            let color = target_bytes(size, pass.samples) - 4 * pixels * u64::from(pass.samples);
            let depth = 4 * pixels * u64::from(pass.samples);
            target_bytes(size, 1) + 2 * color + depth + pass.bloom.texture_bytes(size)
        }
    }
}

/// Rejects images whose textures and read-back buffer would take more than [`MAX_PICTURE_MIB`].
pub fn check_memory(size: (u32, u32), pass: &PassFormat) -> Result<(), OffscreenError> {
    let ((width, height), samples) = (size, pass.samples);
    let pixel = u64::from(pass.color.block_copy_size(None).unwrap_or(4));
    let pixels = u64::from(width) * u64::from(height);
    let copies = match pass.development {
        // Twice the bytes for the light with its samples, then the image and its depth.
        Development::AfterPass => 8 * u64::from(samples.max(1)) + 8,
        // Light is also copied as 32-bit floats.
        Development::InPass if pixel > 4 => pixel + 2 * 16,
        Development::InPass => 0,
    };
    let mib = (target_bytes(size, samples) + pixels * (4 + copies)) >> 20;
    if mib <= MAX_PICTURE_MIB {
        return Ok(());
    }
    Err(OffscreenError::TooMuchMemory {
        width,
        height,
        samples,
        mib,
        limit_mib: MAX_PICTURE_MIB,
    })
}

/// Largest part of the truth layers that is read back and processed at once, bytes.
const TRUTH_BAND_BYTES: u64 = 64 << 20;

/// Rejects truth layers whose textures would take more than [`MAX_PICTURE_MIB`].
pub fn check_truth_memory((width, height): (u32, u32)) -> Result<(), OffscreenError> {
    let pixels = u64::from(width) * u64::from(height);
    let mib = (pixels * TruthTargets::PIXEL_BYTES + TRUTH_BAND_BYTES) >> 20;
    match mib <= MAX_PICTURE_MIB {
        true => Ok(()),
        false => Err(OffscreenError::TruthTooLarge {
            width,
            height,
            mib,
            limit_mib: MAX_PICTURE_MIB,
        }),
    }
}

/// The textures of truth layers, or an error if the device is out of memory.
pub fn new_truth_targets(
    gpu: &GpuContext,
    size: (u32, u32),
) -> Result<TruthTargets, OffscreenError> {
    made(gpu, size, || TruthTargets::new(&gpu.device, size))
}

/// Rejects images that are empty or larger than the device supports.
pub fn check_size(gpu: &GpuContext, (width, height): (u32, u32)) -> Result<(), OffscreenError> {
    check_not_empty((width, height))?;
    let limit = gpu.device.limits().max_texture_dimension_2d;
    match (1..=limit).contains(&width) && (1..=limit).contains(&height) {
        true => Ok(()),
        false => Err(OffscreenError::TooLarge {
            width,
            height,
            adapter: gpu.adapter.get_info().name,
            limit,
        }),
    }
}

fn check_not_empty((width, height): (u32, u32)) -> Result<(), OffscreenError> {
    match width > 0 && height > 0 {
        true => Ok(()),
        false => Err(OffscreenError::Empty { width, height }),
    }
}

/// Rejects buffers whose length does not match an image with so many numbers a pixel.
pub fn check_length(
    (width, height): (u32, u32),
    channels: usize,
    got: usize,
) -> Result<(), OffscreenError> {
    let needed = width as usize * height as usize * channels;
    match got == needed {
        true => Ok(()),
        false => Err(OffscreenError::Length {
            width,
            height,
            needed,
            got,
        }),
    }
}

pub(super) fn made<T>(
    gpu: &GpuContext,
    size: (u32, u32),
    make: impl FnOnce() -> T,
) -> Result<T, OffscreenError> {
    check_size(gpu, size)?;
    // Without the scopes, a device that is out of memory would abort the program.
    let memory = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let validation = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let targets = make();
    let rejected = pollster::block_on(validation.pop());
    let full = pollster::block_on(memory.pop());
    match full.or(rejected) {
        None => Ok(targets),
        Some(cause) => Err(OffscreenError::NoRoom {
            width: size.0,
            height: size.1,
            adapter: gpu.adapter.get_info().name,
            cause: cause.to_string(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_picture_fits_with_one_sample_and_not_with_four() {
        let check = |size, samples, color| {
            let pass = PassFormat {
                color,
                further: &[],
                samples,
                depth: FrameTargets::REVERSED_DEPTH,
                development: Development::InPass,
                tone: Default::default(),
                bloom: Default::default(),
                grade: Default::default(),
            };
            check_memory(size, &pass)
        };
        let (shown, light) = (FrameTargets::COLOR, wgpu::TextureFormat::Rgba32Float);
        assert!(check((1280, 720), 4, shown).is_ok());
        assert!(check((16_384, 16_384), 1, shown).is_ok());
        let rejected = check((16_384, 16_384), 4, shown).expect_err("too much");
        assert!(rejected.to_string().contains("samples = 1"), "{rejected}");
        assert!(check((4096, 4096), 1, light).is_ok());
        assert!(check((16_384, 16_384), 1, light).is_err());
    }

    #[test]
    fn an_empty_picture_is_not_too_large() {
        assert!(check_not_empty((1, 1)).is_ok());
        for size in [(0, 180), (320, 0), (0, 0)] {
            let rejected = check_not_empty(size).expect_err("empty").to_string();
            assert!(rejected.contains("at least 1"), "{rejected}");
        }
    }

    #[test]
    fn truth_that_no_memory_holds_is_rejected() {
        assert!(check_truth_memory((8192, 8192)).is_ok());
        let rejected = check_truth_memory((16_384, 16_384)).expect_err("too much");
        assert!(rejected.to_string().contains("16384"), "{rejected}");
    }
}
