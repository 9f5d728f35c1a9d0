//! TIFF maps: strips or tiles, uncompressed, LZW, deflate or PackBits, also BigTIFF and GeoTIFF.

use super::{
    Extent, FileContext, FileKind, RowSource, SampleKind, SourceInfo, SourceLimits, check_size,
};
use crate::elevation::geo_tags::GeoTags;
use crate::files::printable;
use crate::imagery::build::error::BuildError;
use std::io::{BufRead, Seek};
use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::{PlanarConfiguration, Tag};
use tiff::{ColorType, TiffError};

/// Rows of a TIFF file.
pub(super) struct TiffRows<R: BufRead + Seek> {
    decoder: Decoder<R>,
    info: SourceInfo,
    context: FileContext,
    given: u32,
    /// Texels of a strip or tile, and how many of them lie side by side.
    chunk_rows: u32,
    chunk_columns: u32,
    chunks_across: u32,
    /// The rows of the chunks that the next row lies in.
    rows: Vec<u8>,
}

impl<R: BufRead + Seek> TiffRows<R> {
    pub(super) fn open(
        reader: R,
        context: FileContext,
        limits: SourceLimits,
        extent: Extent,
    ) -> Result<Self, BuildError> {
        let with_file = |error| decode_error(&context, error);
        let mut decoder = Decoder::new(reader).map_err(with_file)?;
        let (width, height) = decoder.dimensions().map_err(with_file)?;
        check_size(&context, width, height, extent)?;
        let colour = decoder.colortype().map_err(with_file)?;
        let (channels, bits) = match colour {
            ColorType::Gray(bits) => (1, bits),
            ColorType::GrayA(bits) => (2, bits),
            ColorType::RGB(bits) => (3, bits),
            ColorType::RGBA(bits) => (4, bits),
            ColorType::Multiband {
                bit_depth,
                num_samples: 2,
            } => (2, bit_depth),
            other => return Err(unfit(&context, format!("holds {other:?} texels"))),
        };
        let planar = decoder
            .find_tag_unsigned::<u16>(Tag::PlanarConfiguration)
            .map_err(with_file)?;
        if channels > 1 && planar == Some(PlanarConfiguration::Planar.to_u16()) {
            return Err(context.refused(
                "keeps its channels in separate planes",
                "rewrite it (`gdal_translate -co INTERLEAVE=PIXEL` or `tiffcp -p contig`)",
            ));
        }
        let format = decoder
            .find_tag_unsigned_vec::<u16>(Tag::SampleFormat)
            .map_err(with_file)?
            .and_then(|formats| formats.first().copied())
            .unwrap_or(1);
        let sample = match (bits, format) {
            (8, 1) => SampleKind::U8,
            (16, 1) => SampleKind::U16,
            (16, 2) => SampleKind::I16,
            (32, 3) => SampleKind::F32,
            _ => {
                return Err(unfit(
                    &context,
                    format!("holds {bits}-bit samples of format {format}"),
                ));
            }
        };
        if extent == Extent::WholeEarth
            && let Some(complaint) = GeoTags::read(&mut decoder).complaint(width, height)
        {
            return Err(context.refused(
                complaint,
                "warp it to the whole globe (`gdalwarp -t_srs EPSG:4326 -te -180 -90 180 90`)",
            ));
        }

        let (chunk_columns, chunk_rows) = decoder.chunk_dimensions();
        let is_tiled = decoder.get_chunk_type() == ChunkType::Tile;
        // A strip may claim more rows than the map has; a tile may be wider and higher than it.
        let chunk_rows = if is_tiled {
            chunk_rows
        } else {
            chunk_rows.min(height)
        };
        let texel_bytes = (channels * sample.bytes()) as u64;
        // Both below 2^32, at most 16 bytes a texel: no overflow.
        let across = u64::from(width.div_ceil(chunk_columns));
        let chunk_bytes = u64::from(chunk_columns)
            .saturating_mul(u64::from(chunk_rows))
            .saturating_mul(texel_bytes);
        let row_bytes = u64::from(width) * u64::from(chunk_rows.min(height)) * texel_bytes;
        let buffer_bytes = row_bytes.saturating_add(chunk_bytes.saturating_mul(2));
        if buffer_bytes > limits.buffer_bytes {
            return Err(context.too_large(
                "a row of its strips or tiles",
                buffer_bytes,
                limits,
                "rewrite it with smaller ones (`gdal_translate -co TILED=YES` or `tiffcp -r 16`) or allow more --memory",
            ));
        }
        let mut decoder_limits = Limits::default();
        // Below the caller's limit, so a usize.
        decoder_limits.decoding_buffer_size = chunk_bytes as usize;
        // Compressed data are at most a little longer than their texels.
        decoder_limits.intermediate_buffer_size = chunk_bytes as usize * 2 + 4096;
        Ok(Self {
            decoder: decoder.with_limits(decoder_limits),
            info: SourceInfo {
                file: FileKind::Tiff,
                width,
                height,
                channels,
                sample,
                buffer_bytes,
            },
            context,
            given: 0,
            chunk_rows,
            chunk_columns,
            // At most the width.
            chunks_across: across as u32,
            rows: vec![0; row_bytes as usize],
        })
    }

    /// Reads the row of strips or tiles from this row of texels on.
    fn read_chunks(&mut self, first_row: u32) -> Result<(), BuildError> {
        let row_bytes = self.info.row_bytes();
        let texel_bytes = self.info.channels * self.info.sample.bytes();
        let first_chunk = first_row / self.chunk_rows * self.chunks_across;
        for place in 0..self.chunks_across {
            let chunk = self.decoder.read_chunk(first_chunk + place);
            let chunk = chunk.map_err(|error| decode_error(&self.context, error))?;
            let bytes: &[u8] = match &chunk {
                DecodingResult::U8(values) => values,
                DecodingResult::U16(values) => bytemuck::cast_slice(values),
                DecodingResult::I16(values) => bytemuck::cast_slice(values),
                DecodingResult::F32(values) => bytemuck::cast_slice(values),
                _ => {
                    return Err(self
                        .context
                        .damaged("texels of another kind than its header says"));
                }
            };
            let (columns, rows) = self.decoder.chunk_data_dimensions(first_chunk + place);
            let rows = rows.min(self.info.height - first_row) as usize;
            let run = columns as usize * texel_bytes;
            let start = place as usize * self.chunk_columns as usize * texel_bytes;
            if bytes.len() < run * rows || start + run > row_bytes || run == 0 {
                return Err(self.context.damaged("a strip or tile of the wrong size"));
            }
            for (row, texels) in self
                .rows
                .chunks_exact_mut(row_bytes)
                .zip(bytes.chunks_exact(run).take(rows))
            {
                row[start..start + run].copy_from_slice(texels);
            }
        }
        Ok(())
    }
}

impl<R: BufRead + Seek> RowSource for TiffRows<R> {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        if self.given >= self.info.height {
            return Err(self.context.damaged("too few rows"));
        }
        let inside = (self.given % self.chunk_rows) as usize;
        if inside == 0 {
            self.read_chunks(self.given)?;
        }
        row.copy_from_slice(&self.rows[inside * row.len()..(inside + 1) * row.len()]);
        self.given += 1;
        Ok(())
    }
}

fn unfit(context: &FileContext, cause: String) -> BuildError {
    context.refused(
        cause,
        "convert it to grey or RGB of 8 or 16 bits (elevations also signed 16-bit or 32-bit float)",
    )
}

fn decode_error(context: &FileContext, error: TiffError) -> BuildError {
    match error {
        TiffError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            context.damaged("the file ends too early")
        }
        // The decoders of compressed data report damage this way.
        TiffError::IoError(error)
            if matches!(
                error.kind(),
                std::io::ErrorKind::InvalidData
                    | std::io::ErrorKind::InvalidInput
                    | std::io::ErrorKind::Other
            ) =>
        {
            context.damaged(printable(&error.to_string()))
        }
        TiffError::IoError(error) => context.unreadable(error),
        TiffError::UnsupportedError(error) => unfit(context, printable(&error.to_string())),
        TiffError::LimitsExceeded => context.refused(
            "has tags or strips beyond all measure",
            "rewrite it (`gdal_translate` or `tiffcp`)",
        ),
        other => context.damaged(printable(&other.to_string())),
    }
}
