//! Reading data back from the device.

use super::GpuFault;
use std::ops::Range;
use std::time::Duration;
use wgpu::{MapMode, PollType, SubmissionIndex};

/// Why an image could not be read back.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The device was lost or the copy failed.
    #[error("the picture could not be read back from the device: {0}")]
    ReadBack(String),
    /// The data to be read was not drawn, because of a device error.
    #[error(transparent)]
    Fault(#[from] GpuFault),
}

/// The texels of a texture (usage `COPY_SRC`), rows without padding. Waits for the device for at most `patience`.
pub(crate) fn read_rows(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    texel_bytes: u32,
    patience: Option<Duration>,
) -> Result<Vec<u8>, PictureError> {
    let lines = 0..texture.height();
    read_part(device, queue, texture, texel_bytes, &lines, patience)
}

/// As [`read_rows`], for some of the rows, without a time limit.
pub(super) fn read_lines(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    texel_bytes: u32,
    lines: &Range<u32>,
) -> Result<Vec<u8>, PictureError> {
    match lines.is_empty() {
        true => Ok(Vec::new()),
        false => read_part(device, queue, texture, texel_bytes, lines, None),
    }
}

fn read_part(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    texel_bytes: u32,
    lines: &Range<u32>,
    patience: Option<Duration>,
) -> Result<Vec<u8>, PictureError> {
    let bytes = (texel_bytes * texture.width()) as usize * lines.len();
    let mut pixels: Vec<u8> = Vec::with_capacity(bytes);
    each_row(
        device,
        queue,
        texture,
        texel_bytes,
        lines,
        patience,
        &mut |row| {
            pixels.extend_from_slice(row);
        },
    )?;
    Ok(pixels)
}

/// Passes some rows of a texture to the callback, without padding, directly from the device's buffer.
pub(super) fn each_row(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    texel_bytes: u32,
    lines: &Range<u32>,
    patience: Option<Duration>,
    take: &mut dyn FnMut(&[u8]),
) -> Result<(), PictureError> {
    let (width, height) = (texture.width(), lines.end - lines.start);
    let padded = (texel_bytes * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella read back"),
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
        label: Some("terrella read back"),
    });
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d {
                y: lines.start,
                ..wgpu::Origin3d::ZERO
            },
            ..texture.as_image_copy()
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(height),
            },
        },
        wgpu::Extent3d {
            height,
            ..texture.size()
        },
    );
    let index = queue.submit([encoder.finish()]);
    let limit = patience.map(|patience| (index, patience));
    let mapped = map(device, &buffer, limit).map_err(PictureError::ReadBack)?;
    let row = (texel_bytes * width) as usize;
    for line in mapped.chunks_exact(padded as usize) {
        take(&line[..row]);
    }
    Ok(())
}

/// Maps a buffer (usage `MAP_READ`) after the submission that writes it is complete. With a limit, waits only for that submission, and at most for
/// that time.
pub(super) fn map(
    device: &wgpu::Device,
    buffer: &wgpu::Buffer,
    limit: Option<(SubmissionIndex, Duration)>,
) -> Result<wgpu::BufferView, String> {
    if cfg!(target_family = "wasm") {
        return Err("a web page cannot wait for the device".into());
    }
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(MapMode::Read, .., move |result| {
        // The receiver lives until the end of this function; if it is gone, no one waits.
        let _ = sender.send(result);
    });
    let patience = limit.as_ref().map(|(_, patience)| *patience);
    let wait = match limit {
        None => PollType::wait_indefinitely(),
        Some((index, patience)) => PollType::Wait {
            submission_index: Some(index),
            timeout: Some(patience),
        },
    };
    device.poll(wait).map_err(|error| error.to_string())?;
    let mapped = match patience {
        None => receiver.recv().map_err(|error| error.to_string())?,
        Some(patience) => receiver
            .recv_timeout(patience)
            .map_err(|error| error.to_string())?,
    };
    mapped.map_err(|error| error.to_string())?;
    buffer
        .get_mapped_range(..)
        .map_err(|error| error.to_string())
}
