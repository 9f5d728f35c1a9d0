//! TIFF maps: strips or tiles, with the compressions of [`tiff_chunks`](terrella_ground::elevation::tiff_chunks), with one plane or several. BigTIFF
//! and GeoTIFF are included.
//!
//! | file | what |
//! |---|---|
//! | `recoded.rs` | palettes presented to the decoder as grey |
//! | `gaps.rs` | texels without data |

mod gaps;
mod recoded;
#[cfg(test)]
mod tests;

use super::{
    Extent, FileContext, FileKind, Opacity, RowSource, SampleKind, SourceInfo, SourceLimits,
    check_size, complaint_of,
};
use crate::error::BuildError;
use gaps::Gaps;
use recoded::Recoded;
use std::io::{BufRead, Seek};
use terrella_files::printable;
use terrella_ground::elevation::geo_tags::GeoTags;
use terrella_ground::elevation::tiff_chunks::{TiffChunkError, TiffChunks};
use terrella_imagery::colour::Said;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::{CompressionMethod, PlanarConfiguration, Tag};
use tiff::{ColorType, TiffError};

/// Minimum size limit of a tag, bytes, if strips and tiles are smaller.
const MOST_TAG_BYTES: usize = 64 << 10;

/// Rows of a TIFF file.
pub(super) struct TiffRows<R: BufRead + Seek> {
    decoder: Decoder<Recoded<R>>,
    info: SourceInfo,
    context: FileContext,
    said: Said,
    stored: Stored,
    /// Decodes strips and tiles.
    coded: TiffChunks,
    chunks: Chunks,
    gaps: Gaps,
    given: u32,
    /// Stored rows of the chunks that contain the next row.
    rows: Vec<u8>,
}

/// Texels as the file stores them.
struct Stored {
    channels: usize,
    sample: SampleKind,
    /// Bits per sample in the file; fewer than 8 are read as bytes, and 9 to 15 as 16 bits.
    bits: u8,
    /// The first three channels are assumed to be red, green and blue; the file does not declare
    /// them.
    is_presumed: bool,
    /// Whether each channel has separate strips or tiles.
    is_planar: bool,
    /// Colours of the stored indices.
    palette: Option<Vec<[u8; 3]>>,
}

/// Strips or tiles.
#[derive(Clone, Copy)]
struct Chunks {
    /// Size in texels.
    columns: u32,
    rows: u32,
    /// Chunks per row, and per plane.
    across: u32,
    per_plane: u32,
}

impl Stored {
    fn texel_bytes(&self) -> usize {
        self.channels * self.sample.bytes()
    }

    /// Whether samples have fewer bits than their container, and are not palette indices.
    fn is_narrow(&self) -> bool {
        let bits = 8 * self.sample.bytes();
        usize::from(self.bits) < bits && self.palette.is_none()
    }

    /// Stretches samples of fewer bits to the full range.
    fn stretch(&self, samples: &mut [u8]) {
        let most = (1_u32 << self.bits) - 1;
        let stretched = |value: u32, full: u32| (value.min(most) * full + most / 2) / most;
        match self.sample {
            SampleKind::U8 => {
                for value in samples {
                    *value = stretched(u32::from(*value), u32::from(u8::MAX)) as u8;
                }
            }
            _ => {
                let (values, _) = samples.as_chunks_mut::<2>();
                for value in values {
                    let wide = u32::from(u16::from_ne_bytes(*value));
                    *value = (stretched(wide, u32::from(u16::MAX)) as u16).to_ne_bytes();
                }
            }
        }
    }

    /// Reads the header, and rejects unsupported features.
    fn of<R: BufRead + Seek>(
        decoder: &mut Decoder<Recoded<R>>,
        coded: &TiffChunks,
        has_palette: bool,
        context: &FileContext,
    ) -> Result<Self, BuildError> {
        let with_file = |error| decode_error(context, error);
        let colour = decoder.colortype().map_err(with_file)?;
        let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples);
        let extras = extra.map_err(with_file)?.unwrap_or_default();
        let extra = extras.first().copied();
        let mut is_presumed = false;
        let (channels, bits) = match colour {
            ColorType::Gray(bits) => (1, bits),
            ColorType::GrayA(bits) => (2, bits),
            ColorType::RGB(bits) => (3, bits),
            ColorType::RGBA(bits) => (4, bits),
            // Decoded as RGB.
            ColorType::YCbCr(bits @ 8) if coded.gives_rgb() => (3, bits),
            // 1 and 2 are alpha.
            ColorType::Multiband {
                bit_depth,
                num_samples: 2,
            } if matches!(extra, None | Some(1 | 2)) => (2, bit_depth),
            // GDAL writes 16-bit colours this way by default.
            ColorType::Multiband {
                bit_depth,
                num_samples: count @ (3 | 4),
            } if are_colours(&extras) => {
                is_presumed = true;
                let has_alpha = count == 4 && matches!(extras.last(), Some(1 | 2));
                (if has_alpha { 4 } else { 3 }, bit_depth)
            }
            ColorType::Multiband { num_samples, .. } => {
                return Err(context.rejected(
                    format!("has {num_samples} channels and does not say that they are colours"),
                    "if the first three are red, green and blue, `gdal_translate -b 1 -b 2 -b 3 -co PHOTOMETRIC=RGB IN OUT.tif`; else choose one (`-b 1`)",
                ));
            }
            other => {
                return Err(unfit(
                    context,
                    format!("holds colours of the kind {}", kind(other)),
                ));
            }
        };
        let palette = match has_palette {
            true => Some(palette(decoder, (channels, bits), context)?),
            false => None,
        };
        let planar = decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration);
        let planar = planar.map_err(with_file)? == Some(PlanarConfiguration::Planar.to_u16());
        let format = decoder
            .find_tag_unsigned_vec::<u16>(Tag::SampleFormat)
            .map_err(with_file)?
            .and_then(|formats| formats.first().copied())
            .unwrap_or(1);
        let sample = match (bits, format) {
            (1..=8, 1) => SampleKind::U8,
            (9..=16, 1) => SampleKind::U16,
            (16, 2) => SampleKind::I16,
            (32, 3) => SampleKind::F32,
            _ => {
                return Err(unfit(
                    context,
                    format!("holds {bits}-bit samples of format {format}"),
                ));
            }
        };
        Ok(Self {
            channels,
            sample,
            bits,
            is_presumed,
            is_planar: channels > 1 && planar,
            palette,
        })
    }
}

/// Whether the second and third sample of a grey pixel can be colours: neither is alpha.
fn are_colours(extras: &[u16]) -> bool {
    !extras.iter().take(2).any(|kind| matches!(kind, 1 | 2))
}

/// The colours of a palette with indices of 1 to 8 bits.
fn palette<R: BufRead + Seek>(
    decoder: &mut Decoder<Recoded<R>>,
    (channels, bits): (usize, u8),
    context: &FileContext,
) -> Result<Vec<[u8; 3]>, BuildError> {
    let map = decoder.find_tag_unsigned_vec::<u16>(Tag::ColorMap);
    let map = map.map_err(|error| decode_error(context, error))?;
    let map = map.unwrap_or_default();
    if channels != 1 || bits > 8 {
        return Err(context.rejected(
            format!("has a palette of {bits}-bit numbers"),
            "write its colours out (`gdal_translate -expand rgb IN OUT`)",
        ));
    }
    let count = 1 << bits;
    if map.len() != 3 * count {
        return Err(context.damaged(format!("a palette of {} numbers", map.len())));
    }
    // Colours have 16 bits; some old writers used 8.
    let shift = if map.iter().all(|value| *value < 256) {
        0
    } else {
        8
    };
    let at = |n: usize| (map[n] >> shift) as u8;
    Ok((0..count)
        .map(|n| [at(n), at(count + n), at(2 * count + n)])
        .collect())
}

impl Chunks {
    fn of<R: BufRead + Seek>(decoder: &mut Decoder<Recoded<R>>, width: u32, height: u32) -> Self {
        let (columns, rows) = decoder.chunk_dimensions();
        // A strip may claim more rows than the map has; a tile may be larger than the map.
        let rows = match decoder.get_chunk_type() {
            ChunkType::Tile => rows,
            ChunkType::Strip => rows.min(height),
        };
        // Neither is 0; the decoder rejected that.
        let across = width.div_ceil(columns);
        Self {
            columns,
            rows,
            across,
            per_plane: across.saturating_mul(height.div_ceil(rows)),
        }
    }
}

impl<R: BufRead + Seek> TiffRows<R> {
    pub(super) fn open(
        reader: R,
        context: FileContext,
        limits: SourceLimits,
        extent: Extent,
    ) -> Result<Self, BuildError> {
        let with_file = |error| decode_error(&context, error);
        let (reader, has_palette) =
            Recoded::new(reader).map_err(|error| context.unreadable(error))?;
        let mut decoder = Decoder::new(reader).map_err(with_file)?;
        let (width, height) = decoder.dimensions().map_err(with_file)?;
        check_size(&context, width, height, extent)?;
        let coded = TiffChunks::of(&mut decoder);
        let mut coded = coded.map_err(|error| chunk_error(&context, error))?;
        let stored = Stored::of(&mut decoder, &coded, has_palette, &context)?;
        // At most 4.
        coded.keep_first(stored.channels as u16);
        if extent == Extent::WholeEarth
            && let Some(complaint) = complaint_of(&GeoTags::read(&mut decoder), width, height)
        {
            return Err(context.rejected(
                complaint,
                "warp it to the whole globe (`gdalwarp -t_srs EPSG:4326 -te -180 -90 180 90`)",
            ));
        }
        let said = said(&mut decoder).map_err(with_file)?;
        context.check_turned(&said)?;

        let chunks = Chunks::of(&mut decoder, width, height);
        let texel_bytes = stored.texel_bytes() as u64;
        let chunk_bytes = u64::from(chunks.columns)
            .saturating_mul(u64::from(chunks.rows))
            .saturating_mul(texel_bytes);
        let row_bytes = u64::from(width) * u64::from(chunks.rows.min(height)) * texel_bytes;
        let needed = row_bytes
            .saturating_add(chunk_bytes.saturating_mul(2))
            .saturating_add(coded.working_bytes(chunk_bytes));
        let check = |needed: u64| {
            match needed > limits.buffer_bytes {
            true => Err(context.too_large(
                "a row of its strips or tiles",
                needed,
                limits,
                "rewrite it with smaller ones (`gdal_translate -co TILED=YES` or `tiffcp -r 16`) or allow more --memory",
            )),
            false => Ok(()),
        }
        };
        check(needed)?;
        let mut decoder_limits = Limits::default();
        // Below the caller's limit, so it fits a usize. Tags of small tiles are longer than their
        // texels.
        decoder_limits.decoding_buffer_size = (chunk_bytes as usize).max(MOST_TAG_BYTES);
        // Compressed data are at most slightly longer than their texels.
        let stored_bytes =
            chunk_bytes as usize / stored.channels * usize::from(coded.samples().max(1));
        decoder_limits.intermediate_buffer_size = stored_bytes.max(chunk_bytes as usize) * 2 + 4096;
        // Offsets and lengths of all strips or tiles.
        decoder_limits.ifd_value_size = 64 << 20;
        let mut decoder = decoder.with_limits(decoder_limits);
        let gaps = Gaps::find(&mut decoder, (width, height), &context)?;
        if let Some(complaint) =
            short_chunk(&mut decoder, &coded, chunks, height, &gaps).map_err(with_file)?
        {
            return Err(context.damaged(complaint));
        }
        let needed = needed.saturating_add(gaps.working_bytes(chunks.rows));
        check(needed)?;
        let colours = match (&stored.palette, stored.channels) {
            (Some(_), _) => 3,
            (None, channels) => channels,
        };
        let opacity =
            Opacity::of_channels(colours).or(gaps.are_possible().then_some(Opacity::Mask));
        Ok(Self {
            decoder,
            info: SourceInfo {
                file: FileKind::Tiff,
                width,
                height,
                channels: colours + usize::from(opacity == Some(Opacity::Mask)),
                sample: stored.sample,
                opacity,
                buffer_bytes: needed,
            },
            context,
            said,
            stored,
            coded,
            chunks,
            gaps,
            given: 0,
            rows: vec![0; row_bytes as usize],
        })
    }

    /// Reads the row of strips or tiles that starts at this row of texels.
    fn read_chunks(&mut self, first_row: u32) -> Result<(), BuildError> {
        let planes = if self.stored.is_planar {
            self.stored.channels
        } else {
            1
        };
        let first_chunk = first_row / self.chunks.rows * self.chunks.across;
        for place in 0..self.chunks.across {
            for plane in 0..planes {
                // Below 2^32: the file lists all planes.
                let chunk = plane as u32 * self.chunks.per_plane + first_chunk + place;
                if self.gaps.is_absent(chunk) {
                    continue;
                }
                self.read_chunk(chunk, place, plane, first_row)?;
            }
        }
        Ok(())
    }

    /// Reads a strip or tile into its position among the rows.
    fn read_chunk(
        &mut self,
        chunk: u32,
        place: u32,
        plane: usize,
        first_row: u32,
    ) -> Result<(), BuildError> {
        let decoded = self.coded.read(&mut self.decoder, chunk);
        let decoded = decoded.map_err(|error| chunk_error(&self.context, error))?;
        let bytes: &[u8] = match &decoded {
            DecodingResult::U8(values) => values,
            DecodingResult::U16(values) => bytemuck::cast_slice(values),
            DecodingResult::I16(values) => bytemuck::cast_slice(values),
            DecodingResult::F32(values) => bytemuck::cast_slice(values),
            _ => {
                let cause = "texels of another kind than its header says";
                return Err(self.context.damaged(cause));
            }
        };
        let texel_bytes = self.stored.texel_bytes();
        let piece_bytes = match self.stored.is_planar {
            true => self.stored.sample.bytes(),
            false => texel_bytes,
        };
        let row_bytes = self.info.width as usize * texel_bytes;
        let (columns, _) = self.decoder.chunk_data_dimensions(chunk);
        let rows = self.chunks.rows.min(self.info.height - first_row) as usize;
        let run = columns as usize * piece_bytes;
        let start = place as usize * self.chunks.columns as usize * texel_bytes;
        if bytes.len() < run * rows
            || run == 0
            || start + columns as usize * texel_bytes > row_bytes
        {
            return Err(self.context.damaged("a strip or tile of the wrong size"));
        }
        let out = self.rows.chunks_exact_mut(row_bytes);
        for (row, texels) in out.zip(bytes.chunks_exact(run).take(rows)) {
            let row = &mut row[start..start + columns as usize * texel_bytes];
            if piece_bytes == texel_bytes {
                row.copy_from_slice(texels);
                continue;
            }
            let samples = texels.chunks_exact(piece_bytes);
            for (texel, sample) in row.chunks_exact_mut(texel_bytes).zip(samples) {
                texel[plane * piece_bytes..][..piece_bytes].copy_from_slice(sample);
            }
        }
        Ok(())
    }

    /// Writes one of the held rows, with the palette's colours and its opacity.
    fn write(&mut self, inside: usize, row: &mut [u8]) -> Result<(), BuildError> {
        let stored_bytes = self.info.width as usize * self.stored.texel_bytes();
        let stored = &mut self.rows[inside * stored_bytes..][..stored_bytes];
        if self.gaps.are_possible() {
            let first_chunk = self.given / self.chunks.rows * self.chunks.across;
            let place = (first_chunk, self.chunks.columns);
            self.gaps
                .look(&mut self.decoder, self.given, place, &self.context)?;
            let Stored {
                channels, sample, ..
            } = self.stored;
            let colours = channels - usize::from(matches!(channels, 2 | 4));
            self.gaps.take_no_data(sample, stored, channels, colours);
        }
        // The no-data value refers to stored values.
        if self.stored.is_narrow() {
            self.stored.stretch(stored);
        }
        if !self.gaps.are_possible() && self.stored.palette.is_none() {
            row.copy_from_slice(stored);
            return Ok(());
        }
        let (size, sample_bytes) = (self.stored.texel_bytes(), self.stored.sample.bytes());
        let out = row.chunks_exact_mut(self.info.channels * sample_bytes);
        let texels = stored.chunks_exact(size).zip(&self.gaps.is_there);
        let full = full(self.stored.sample);
        for (out, (texel, is_there)) in out.zip(texels) {
            if !is_there {
                out.fill(0);
                continue;
            }
            match &self.stored.palette {
                Some(palette) => out[..3].copy_from_slice(&palette[usize::from(texel[0])]),
                None => out[..size].copy_from_slice(texel),
            }
            if self.info.opacity == Some(Opacity::Mask) {
                let colours = out.len() - sample_bytes;
                out[colours..].copy_from_slice(&full[..sample_bytes]);
            }
        }
        Ok(())
    }
}

/// The bytes of a fully opaque sample.
fn full(sample: SampleKind) -> [u8; 4] {
    match sample {
        SampleKind::F32 => 1f32.to_ne_bytes(),
        SampleKind::U8 | SampleKind::U16 | SampleKind::I16 => [0xFF; 4],
    }
}

/// Orientation and colours stated in the tags.
fn said<R: BufRead + Seek>(decoder: &mut Decoder<Recoded<R>>) -> Result<Said, TiffError> {
    let orientation = decoder.find_tag_unsigned::<u16>(Tag::Orientation)?;
    // A profile beyond the decoder's limits causes a warning, but the image is accepted.
    let profile = decoder.get_tag_u8_vec(Tag::IccProfile).ok();
    Ok(Said {
        orientation,
        ..Said::of_parts(None, profile.as_deref())
    })
}

/// The complaint about uncompressed strips and tiles with fewer bytes than texels: reading them would continue into
/// others.
fn short_chunk<R: BufRead + Seek>(
    decoder: &mut Decoder<Recoded<R>>,
    coded: &TiffChunks,
    chunks: Chunks,
    height: u32,
    gaps: &Gaps,
) -> Result<Option<String>, TiffError> {
    let none = CompressionMethod::None.to_u16();
    let compression = decoder.find_tag_unsigned::<u16>(Tag::Compression)?;
    if compression.is_some_and(|compression| compression != none) {
        return Ok(None);
    }
    let is_strip = decoder.get_chunk_type() == ChunkType::Strip;
    let lengths = decoder.find_tag_unsigned_vec::<u64>(match is_strip {
        true => Tag::StripByteCounts,
        false => Tag::TileByteCounts,
    })?;
    let samples = u64::from(coded.samples());
    let row_bits = u64::from(chunks.columns) * samples * u64::from(coded.bits());
    let row_bytes = row_bits.div_ceil(8);
    let is_short = |(n, length): &(u32, u64)| {
        let first_row = n % chunks.per_plane / chunks.across * chunks.rows;
        let rows = match is_strip {
            true => chunks.rows.min(height - first_row),
            false => chunks.rows,
        };
        *length < row_bytes * u64::from(rows) && !gaps.is_absent(*n)
    };
    let short = (0_u32..).zip(lengths.unwrap_or_default()).find(is_short);
    Ok(short
        .map(|(n, length)| format!("strip or tile {n} has {length} bytes, fewer than its texels")))
}

impl<R: BufRead + Seek> RowSource for TiffRows<R> {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn colour_note(&self) -> Option<String> {
        self.said.note().or_else(|| {
            self.stored.is_presumed.then(|| {
                "does not say that its channels are colours: the first three are taken for red, green and blue; say so \
                 (`gdal_translate -co PHOTOMETRIC=RGB IN OUT.tif`), or choose others (`-b 3 -b 2 -b 1`)"
                    .to_string()
            })
        })
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        if self.given >= self.info.height {
            return Err(self.context.damaged("too few rows"));
        }
        let inside = (self.given % self.chunks.rows) as usize;
        if inside == 0 {
            self.read_chunks(self.given)?;
        }
        self.write(inside, row)?;
        self.given += 1;
        Ok(())
    }
}

/// The name of unsupported colours.
fn kind(colour: ColorType) -> &'static str {
    match colour {
        ColorType::CMYK(_) | ColorType::CMYKA(_) => "CMYK",
        ColorType::Lab(_) => "CIE L*a*b*",
        ColorType::YCbCr(_) => "YCbCr",
        ColorType::Palette(_) => "palette",
        _ => "unknown",
    }
}

fn unfit(context: &FileContext, cause: String) -> BuildError {
    context.rejected(
        cause,
        "convert it to grey or RGB of 8 or 16 bits (elevations also signed 16-bit or 32-bit float); a palette by `gdal_translate -expand rgb`",
    )
}

fn chunk_error(context: &FileContext, error: TiffChunkError) -> BuildError {
    match error {
        TiffChunkError::Tiff(error) => decode_error(context, error),
        TiffChunkError::Damaged(cause) => context.damaged(cause),
        TiffChunkError::Unsupported(cause) => context.rejected(
            cause,
            "write it with deflate (`gdal_translate -co COMPRESS=DEFLATE -co PREDICTOR=2 IN OUT.tif`), samples of odd bits with `-co NBITS=16`",
        ),
    }
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
        TiffError::LimitsExceeded => context.rejected(
            "has tags or strips beyond all measure",
            "rewrite it (`gdal_translate` or `tiffcp`)",
        ),
        other => context.damaged(printable(&other.to_string())),
    }
}
