//! Upload of a map in bands of rows: few copies are pending on the device, however large the map is.

use terrella_imagery::{LayerImage, MapRows, TexelFormat};

/// Size of a band that is collected before it is written, bytes.
const BAND_BYTES: usize = 1 << 18;

/// Limit of pending copies, bytes, beyond which this thread waits for the device. It is low, as drivers keep the memory of copies.
const STAGED_BYTES: usize = 2 << 20;

/// A map whose rows are written to the GPU as they arrive.
pub(crate) struct MapUpload {
    device: wgpu::Device,
    queue: wgpu::Queue,
    texture: wgpu::Texture,
    levels: Vec<LevelUpload>,
    /// Bytes written since the last submission.
    staged: usize,
    bytes: u64,
}

/// A mip level that is being uploaded band by band.
struct LevelUpload {
    width: u32,
    height: u32,
    row_bytes: usize,
    /// Number of rows in a band; the last may have fewer.
    band_rows: u32,
    /// Rows of the current band, each at its place.
    band: Vec<u8>,
    /// Number of rows received.
    came: u32,
}

impl LevelUpload {
    fn new((width, height): (u32, u32), texel_bytes: usize) -> Self {
        let row_bytes = width as usize * texel_bytes;
        Self {
            width,
            height,
            row_bytes,
            band_rows: (BAND_BYTES / row_bytes).max(1) as u32,
            band: Vec::new(),
            came: 0,
        }
    }

    /// First row of the band that contains a row, and number of its rows.
    fn band_of(&self, row: u32) -> (u32, u32) {
        let first = row / self.band_rows * self.band_rows;
        (first, self.band_rows.min(self.height.saturating_sub(first)))
    }
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
        let levels = (0..count as usize)
            .map(|level| LevelUpload::new(map.level_size(level), map.format.texel_bytes()));
        Self {
            device: device.clone(),
            queue: queue.clone(),
            texture,
            levels: levels.collect(),
            staged: 0,
            bytes: 0,
        }
    }

    /// Adds whole rows of a level, starting at row `first`. All rows of a band must come before those of the next.
    pub fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        let Some(row_bytes) = self.levels.get(level).map(|place| place.row_bytes) else {
            return;
        };
        let (mut number, mut left) = (first, texels);
        while let Some(place) = self.levels.get_mut(level)
            && !left.is_empty()
            && number < place.height
        {
            let (begin, rows) = place.band_of(number);
            let whole = rows as usize * row_bytes;
            // A whole band is written directly; a partial one is collected.
            if number == begin && place.came == 0 && left.len() >= whole {
                let (band, rest) = left.split_at(whole);
                self.write(level, begin, band);
                (number, left) = (begin + rows, rest);
                continue;
            }
            let (row, rest) = left.split_at(row_bytes.min(left.len()));
            place.band.resize(whole, 0);
            let at = (number - begin) as usize * row_bytes;
            place.band[at..at + row.len()].copy_from_slice(row);
            place.came += 1;
            if place.came == rows {
                place.came = 0;
                let band = std::mem::take(&mut place.band);
                self.write(level, begin, &band);
                if let Some(place) = self.levels.get_mut(level) {
                    place.band = band;
                }
            }
            (number, left) = (number + 1, rest);
        }
    }

    fn write(&mut self, level: usize, first: u32, rows: &[u8]) {
        let Some(place) = self.levels.get(level) else {
            return;
        };
        let count = (rows.len() / place.row_bytes) as u32;
        let mut destination = self.texture.as_image_copy();
        destination.mip_level = level as u32;
        destination.origin.y = first;
        self.queue.write_texture(
            destination,
            rows,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(place.row_bytes as u32),
                rows_per_image: Some(count),
            },
            wgpu::Extent3d {
                width: place.width,
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

    /// The map after all rows of all levels have been added, and its size in bytes.
    pub fn finish(self) -> (wgpu::Texture, u64) {
        (self.texture, self.bytes)
    }
}

impl MapRows for MapUpload {
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        Self::rows(self, level, first, texels);
    }

    fn finish(self: Box<Self>) {}
}
