//! WebP maps, lossy and lossless, decoded as a whole: the format has no independent rows.

use super::{
    Extent, FileContext, FileKind, Opacity, RowSource, SampleKind, SourceInfo, SourceLimits,
    check_size,
};
use crate::error::BuildError;
use image_webp::{DecodingError, WebPDecoder};
use std::io::{BufRead, Seek};
use terrella_files::printable;

/// Rows of a WebP file.
pub(super) struct WebPRows {
    info: SourceInfo,
    context: FileContext,
    texels: Vec<u8>,
    given: u32,
}

impl WebPRows {
    pub(super) fn open<R: BufRead + Seek>(
        reader: R,
        context: FileContext,
        limits: SourceLimits,
        extent: Extent,
    ) -> Result<Self, BuildError> {
        let with_file = |error| decode_error(&context, error);
        let mut decoder = WebPDecoder::new(reader).map_err(with_file)?;
        let (width, height) = decoder.dimensions();
        check_size(&context, width, height, extent)?;
        if decoder.is_animated() {
            return Err(context.rejected("is an animation", "give a WebP with one picture"));
        }
        let channels = if decoder.has_alpha() { 4 } else { 3 };
        let mut info = SourceInfo {
            file: FileKind::WebP,
            width,
            height,
            channels,
            sample: SampleKind::U8,
            opacity: Opacity::of_channels(channels),
            buffer_bytes: 0,
        };
        let bytes = info.row_bytes() as u64 * u64::from(height);
        // The image, and the decoder's planes before conversion to colours.
        info.buffer_bytes = 3 * bytes;
        if info.buffer_bytes > limits.buffer_bytes {
            return Err(context.too_large(
                "WebP cannot be read in strips: it",
                info.buffer_bytes,
                limits,
                "convert it (`magick IN.webp OUT.png`) or allow more --memory",
            ));
        }
        // Below the caller's limit, so it fits a usize.
        decoder.set_memory_limit(2 * bytes as usize + (1 << 16));
        let mut texels = vec![0; bytes as usize];
        decoder.read_image(&mut texels).map_err(with_file)?;
        Ok(Self {
            info,
            context,
            texels,
            given: 0,
        })
    }
}

impl RowSource for WebPRows {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        self.context.take_row(&self.texels, self.given, row)?;
        self.given += 1;
        Ok(())
    }
}

fn decode_error(context: &FileContext, error: DecodingError) -> BuildError {
    match error {
        DecodingError::IoError(error) => context.failed_read(error),
        DecodingError::MemoryLimitExceeded => context.rejected(
            "has chunks beyond all measure",
            "convert it (`magick IN.webp OUT.png`)",
        ),
        other => context.damaged(printable(&other.to_string())),
    }
}
