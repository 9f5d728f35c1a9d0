//! Upload of a map in bands of rows: few copies are pending on the device, however large the map is.

use terrella_imagery::{LayerImage, MapBands, MapRows, TexelFormat};

/// Size of a band that is collected before it is written, bytes.
const BAND_BYTES: usize = 1 << 18;

/// Limit of pending copies, bytes, beyond which this thread waits for the device. It is low, as drivers keep the memory of copies.
const STAGED_BYTES: usize = 2 << 20;

/// A map whose rows are written to the GPU as they arrive.
pub(crate) struct MapUpload {
    bands: MapBands,
    writer: Writer,
}

struct Writer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    texture: wgpu::Texture,
    /// Size and format of the map.
    map: LayerImage,
    /// Bytes written since the last submission.
    staged: usize,
    bytes: u64,
}

impl MapUpload {
    /// For all mip levels of a map of this size and format. With `display_values` a colour map is read as stored instead of as linear light.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        label: &str,
        map: &LayerImage,
        display_values: bool,
    ) -> Self {
        let format = match map.format {
            TexelFormat::Rgba8Srgb if display_values => wgpu::TextureFormat::Rgba8Unorm,
            TexelFormat::Rgba8Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
            TexelFormat::R8Unorm => wgpu::TextureFormat::R8Unorm,
            TexelFormat::Rg8Snorm => wgpu::TextureFormat::Rg8Snorm,
        };
        let size = wgpu::Extent3d {
            width: map.width,
            height: map.height,
            depth_or_array_layers: 1,
        };
        let count = size.max_mips(wgpu::TextureDimension::D2);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size,
            mip_level_count: count,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            bands: MapBands::new(map, BAND_BYTES),
            writer: Writer {
                device: device.clone(),
                queue: queue.clone(),
                texture,
                map: map.without_texels(),
                staged: 0,
                bytes: 0,
            },
        }
    }

    /// Adds whole rows of a level, starting at row `first`. All rows of a band must come before those of the next.
    pub fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        let writer = &mut self.writer;
        self.bands.rows(level, first, texels, |level, first, band| {
            writer.write(level, first, band);
        });
    }

    /// The map after all rows of all levels have been added, and its size in bytes.
    pub fn finish(self) -> (wgpu::Texture, u64) {
        (self.writer.texture, self.writer.bytes)
    }
}

impl Writer {
    fn write(&mut self, level: usize, first: u32, rows: &[u8]) {
        let width = self.map.level_size(level).0;
        let row_bytes = width * self.map.format.texel_bytes() as u32;
        let count = rows.len() as u32 / row_bytes;
        let mut destination = self.texture.as_image_copy();
        destination.mip_level = level as u32;
        destination.origin.y = first;
        self.queue.write_texture(
            destination,
            rows,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row_bytes),
                rows_per_image: Some(count),
            },
            wgpu::Extent3d {
                width,
                height: count,
                depth_or_array_layers: 1,
            },
        );
        self.bytes += rows.len() as u64;
        self.staged += rows.len();
        if self.staged >= STAGED_BYTES {
            self.flush();
        }
    }

    /// Waits until the device has copied what was written.
    fn flush(&mut self) {
        let submission = self.queue.submit([]);
        self.staged = 0;
        // A lost device is reported elsewhere, and there is nothing left to wait for.
        let _ = self.device.poll(wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: None,
        });
    }
}

impl MapRows for MapUpload {
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        Self::rows(self, level, first, texels);
    }

    fn finish(self: Box<Self>) {}
}
