//! PNG maps: grey, palette and colour, with 8 or 16 bits.

use super::{
    Extent, FileContext, FileKind, Opacity, RowSource, SampleKind, SourceInfo, SourceLimits,
    check_size,
};
use crate::error::BuildError;
use png::{BitDepth, DecodingError, Limits, Reader, Transformations};
use std::io::{BufRead, Seek};
use terrella_imagery::colour::Said;

/// Memory limit of the decoder: rows, palette, text. A row takes 65 536 × 4 × 2 bytes; it holds a
/// few of them.
const DECODER_BYTES: usize = 64 << 20;

/// Rows of a PNG file.
pub(super) struct PngRows<R: BufRead + Seek> {
    reader: Reader<R>,
    info: SourceInfo,
    context: FileContext,
    said: Said,
    /// Rows returned so far.
    given: u32,
    /// All texels of an interlaced map.
    whole: Option<Vec<u8>>,
}

impl<R: BufRead + Seek> PngRows<R> {
    pub(super) fn open(
        reader: R,
        context: FileContext,
        limits: SourceLimits,
        extent: Extent,
    ) -> Result<Self, BuildError> {
        let with_file = |error| decode_error(&context, error);
        let mut decoder = png::Decoder::new_with_limits(
            reader,
            Limits {
                bytes: DECODER_BYTES,
            },
        );
        // Palettes become colour, few bits become eight, a transparent colour becomes alpha.
        decoder.set_transformations(Transformations::EXPAND);
        decoder.set_ignore_text_chunk(true);
        let (width, height) = decoder.read_header_info().map_err(with_file)?.size();
        check_size(&context, width, height, extent)?;
        let mut reader = decoder.read_info().map_err(with_file)?;
        if reader.info().is_animated() {
            return Err(context.rejected("is an animation", "give a PNG with one picture"));
        }
        let said = Said::of_png(reader.info());
        context.check_turned(&said)?;
        let (colour, depth) = reader.output_color_type();
        let sample = if depth == BitDepth::Sixteen {
            SampleKind::U16
        } else {
            SampleKind::U8
        };
        let mut info = SourceInfo {
            file: FileKind::Png,
            width,
            height,
            channels: colour.samples(),
            sample,
            opacity: Opacity::of_channels(colour.samples()),
            buffer_bytes: 1 << 20,
        };
        let mut whole = None;
        if reader.info().interlaced {
            // Only the first pass covers the whole map.
            let bytes = info.row_bytes() as u64 * u64::from(height);
            if bytes > limits.buffer_bytes {
                return Err(context.too_large(
                    "an interlaced PNG cannot be read in strips: it",
                    bytes,
                    limits,
                    "save it without interlacing (`magick IN.png -interlace none OUT.png`) or allow more --memory",
                ));
            }
            info.buffer_bytes = bytes;
            // At most `limits.buffer_bytes`.
            let mut texels = vec![0; bytes as usize];
            reader.next_frame(&mut texels).map_err(with_file)?;
            // The rest must be intact too: checksums and the end chunk.
            reader.finish().map_err(with_file)?;
            whole = Some(texels);
        }
        Ok(Self {
            reader,
            info,
            context,
            said,
            given: 0,
            whole,
        })
    }
}

impl<R: BufRead + Seek> RowSource for PngRows<R> {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn colour_note(&self) -> Option<String> {
        self.said.note()
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        if let Some(whole) = &self.whole {
            self.context.take_row(whole, self.given, row)?;
        } else {
            let read = self.reader.read_row(row);
            if read
                .map_err(|error| decode_error(&self.context, error))?
                .is_none()
            {
                return Err(self.context.damaged("too few rows"));
            }
        }
        self.given += 1;
        if self.given == self.info.height && self.whole.is_none() {
            self.reader
                .finish()
                .map_err(|error| decode_error(&self.context, error))?;
        }
        if self.info.sample == SampleKind::U16 {
            let (pairs, _) = row.as_chunks_mut::<2>();
            for pair in pairs {
                *pair = u16::from_be_bytes(*pair).to_ne_bytes();
            }
        }
        Ok(())
    }
}

fn decode_error(context: &FileContext, error: DecodingError) -> BuildError {
    match error {
        DecodingError::IoError(error) => context.failed_read(error),
        DecodingError::LimitsExceeded => context.rejected(
            "has chunks beyond all measure",
            "strip it of everything but the picture",
        ),
        other => context.damaged(other),
    }
}
