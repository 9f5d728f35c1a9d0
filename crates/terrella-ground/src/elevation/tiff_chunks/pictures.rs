//! Strips and tiles stored as images: JPEG with the file's tables, and WebP.

use super::TiffChunkError;
use image_webp::WebPDecoder;
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Size of an image in pixels, and samples per pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PictureSize {
    pub columns: usize,
    pub rows: usize,
    pub samples: usize,
}

impl PictureSize {
    fn bytes(&self) -> usize {
        self.columns * self.rows * self.samples
    }

    /// Rejects an image with another width, fewer rows or other samples before it is decoded.
    fn check(&self, found: (usize, usize, usize), what: &str) -> Result<(), TiffChunkError> {
        let (columns, rows, samples) = found;
        match columns == self.columns && rows == self.rows && samples == self.samples {
            true => Ok(()),
            false => Err(TiffChunkError::Damaged(format!(
                "{what} of {columns} x {rows} pixels of {samples} samples in a strip or tile of {} x {} of {}",
                self.columns, self.rows, self.samples
            ))),
        }
    }
}

/// Decodes a JPEG, with `tables` (TIFF's `JPEGTables`, a JPEG without an image) before it. Luminance and chrominance become RGB
/// if `is_ycbcr`; otherwise samples stay as stored.
pub(super) fn jpeg(
    data: &[u8],
    tables: Option<&[u8]>,
    is_ycbcr: bool,
    size: PictureSize,
) -> Result<Vec<u8>, TiffChunkError> {
    let damaged = |cause: String| TiffChunkError::Damaged(format!("JPEG: {cause}"));
    // Removes the tables' end marker and the image's start marker.
    let joined = match (tables, data.get(2..)) {
        (Some(tables), Some(picture)) if tables.len() >= 4 => {
            let mut joined = tables[..tables.len() - 2].to_vec();
            joined.extend(picture);
            joined
        }
        _ => data.to_vec(),
    };
    let options = DecoderOptions::new_safe()
        .set_strict_mode(true)
        .set_max_width(size.columns)
        .set_max_height(size.rows);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(joined), options);
    let error = |error: zune_jpeg::errors::DecodeErrors| damaged(error.to_string());
    decoder.decode_headers().map_err(error)?;
    let info = decoder
        .info()
        .ok_or_else(|| damaged("no header".to_string()))?;
    let found = (
        usize::from(info.width),
        usize::from(info.height),
        usize::from(info.components),
    );
    size.check(found, "a JPEG")?;
    let stored = decoder.input_colorspace();
    let wanted = match stored {
        Some(ColorSpace::YCbCr) if is_ycbcr => ColorSpace::RGB,
        Some(stored) => stored,
        None => return Err(damaged("no colours".to_string())),
    };
    decoder.set_options(options.jpeg_set_out_colorspace(wanted));
    let decoded = decoder.decode().map_err(error)?;
    match decoded.len() == size.bytes() {
        true => Ok(decoded),
        false => Err(damaged("too few samples".to_string())),
    }
}

/// Decodes a WebP of three samples, or of four with alpha.
pub(super) fn webp(data: &[u8], size: PictureSize) -> Result<Vec<u8>, TiffChunkError> {
    let error = |error: image_webp::DecodingError| {
        TiffChunkError::Damaged(format!(
            "WebP: {}",
            terrella_files::printable(&error.to_string())
        ))
    };
    let mut decoder = WebPDecoder::new(Cursor::new(data)).map_err(error)?;
    let (columns, rows) = decoder.dimensions();
    let stored = match decoder.has_alpha() {
        true => 4,
        false => 3,
    };
    // Encoders omit an alpha channel of full opacity.
    let is_opaque = stored == 3 && size.samples == 4;
    let samples = if is_opaque { 4 } else { stored };
    size.check((columns as usize, rows as usize, samples), "a WebP")?;
    decoder.set_memory_limit(size.bytes().saturating_mul(2).max(1 << 16));
    let mut decoded = vec![0; size.columns * size.rows * stored];
    decoder.read_image(&mut decoded).map_err(error)?;
    if !is_opaque {
        return Ok(decoded);
    }
    let opaque = |rgb: &[u8]| [rgb[0], rgb[1], rgb[2], u8::MAX];
    Ok(decoded.chunks_exact(3).flat_map(opaque).collect())
}
