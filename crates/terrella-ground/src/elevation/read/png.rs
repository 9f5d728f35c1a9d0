//! Grey PNG of 8 or 16 bits; the sidecar states everything else.

use super::error::FileContext;
use super::missing::Missing;
use super::sidecar::ByteOrder;
use super::{Conversion, Header, HeightFileError};
use png::{BitDepth, ColorType, DecodingError, Limits, Reader, Transformations};
use std::io::{BufRead, Seek};

/// Memory limit of the decoder: rows and text. A row takes 2 bytes × 2^20; it holds a few of them.
const DECODER_BYTES: usize = 64 << 20;

/// A PNG file with a parsed header.
pub(super) struct Png<R: BufRead + Seek> {
    reader: Reader<R>,
    columns: usize,
    rows: usize,
    /// Whether samples are little-endian, or `None` for 8 bits.
    is_little: Option<bool>,
}

impl<R: BufRead + Seek> Png<R> {
    pub(super) fn open(
        reader: R,
        context: &FileContext,
        byte_order: Option<ByteOrder>,
    ) -> Result<(Self, Header), HeightFileError> {
        let reported = |error| png_error(context, error);
        let mut decoder = png::Decoder::new_with_limits(
            reader,
            Limits {
                bytes: DECODER_BYTES,
            },
        );
        decoder.set_transformations(Transformations::IDENTITY);
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let (columns, rows) = decoder.read_header_info().map_err(reported)?.size();
        let sides = 1..=crate::elevation::MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(context.grid(crate::elevation::GridError::Size { columns, rows }));
        }
        let reader = decoder.read_info().map_err(reported)?;
        let info = reader.info();
        let (colour, depth) = (info.color_type, info.bit_depth);
        let is_short = depth == BitDepth::Sixteen;
        if colour != ColorType::Grayscale || !(is_short || depth == BitDepth::Eight) {
            return Err(context.rejected(
                format!("holds {colour:?} samples of {} bits", depth as u8),
                "one height a sample, grey of 8 or 16 bits",
                "save it as 16-bit grey",
            ));
        }
        if info.interlaced || info.is_animated() {
            return Err(context.rejected(
                "is interlaced or an animation",
                "a PNG that is written row by row",
                format!(
                    "`magick {} -interlace none OUT.png`",
                    context.path().display()
                ),
            ));
        }
        let is_little = is_short.then_some(byte_order == Some(ByteOrder::Little));
        // The one level that a grey PNG may declare transparent.
        let transparent = info
            .trns
            .as_deref()
            .and_then(|level| match (level, is_little) {
                ([low, high, ..], Some(true)) => Some(f64::from(u16::from_le_bytes([*low, *high]))),
                ([high, low, ..], Some(false)) => {
                    Some(f64::from(u16::from_be_bytes([*high, *low])))
                }
                ([level], None) => Some(f64::from(*level)),
                _ => None,
            });
        let header = Header::of_size(columns, rows, Missing::of(transparent));
        let png = Self {
            reader,
            columns: columns as usize,
            rows: rows as usize,
            is_little,
        };
        Ok((png, header))
    }

    /// Peak memory of reading, bytes: two stored rows, and one in metres.
    pub fn working_bytes(&self) -> u64 {
        self.columns as u64 * (2 * 2 + 4) + (1 << 20)
    }

    /// Passes on all rows.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut heights_m = vec![0.0; self.columns];
        for number in 0..self.rows {
            let row = self
                .reader
                .next_row()
                .map_err(|error| png_error(context, error))?;
            let Some(row) = row else {
                return Err(context.damaged("too few rows").into());
            };
            let row = row.data();
            if let Some(is_little) = self.is_little {
                let (pairs, _) = row.as_chunks::<2>();
                for (height_m, pair) in heights_m.iter_mut().zip(pairs) {
                    let stored = if is_little {
                        u16::from_le_bytes(*pair)
                    } else {
                        u16::from_be_bytes(*pair)
                    };
                    *height_m = conversion.metres(f64::from(stored));
                }
            } else {
                for (height_m, stored) in heights_m.iter_mut().zip(row) {
                    *height_m = conversion.metres(f64::from(*stored));
                }
            }
            put(number, 0, &mut heights_m)?;
        }
        // The rest must be intact too: checksums and the end chunk.
        let end = self.reader.finish();
        Ok(end.map_err(|error| png_error(context, error))?)
    }
}

fn png_error(context: &FileContext, error: DecodingError) -> HeightFileError {
    match error {
        DecodingError::IoError(error) => context.reading(error),
        DecodingError::LimitsExceeded => context.rejected(
            "has chunks beyond all measure",
            "a picture and little else",
            "strip it of everything but the picture",
        ),
        other => context.damaged(other),
    }
}
