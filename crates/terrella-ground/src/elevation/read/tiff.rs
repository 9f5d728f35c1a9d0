//! GeoTIFF and TIFF with a sidecar or a world file: one band of any number type, in strips or tiles.

mod bands;

use super::error::FileContext;
use super::geo_keys::{FilePlacement, HeightTags};
use super::missing::Missing;
use super::{Conversion, Header, HeightFileError};
use crate::elevation::geo_tags::GeoTags;
use crate::elevation::tiff_chunks::{TiffChunkError, TiffChunks};
use crate::elevation::tiff_gaps::{TiffGapError, TiffMask, absent_chunks};
use crate::elevation::warp::{AROUND, Warp};
use crate::elevation::{GridError, MAX_SIDE};
use bands::{Bands, opaque};
use std::io::{BufRead, Seek};
use terrella_files::{excerpt, printable};
use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

/// Maximum size of a strip or tile, bytes.
const CHUNK_BYTES: u64 = 256 << 20;

/// GDAL's XML metadata.
const GDAL_METADATA: Tag = Tag::Unknown(42_112);

/// A TIFF file with a parsed header.
pub(super) struct Tiff<R: BufRead + Seek> {
    decoder: Decoder<R>,
    chunks: TiffChunks,
    columns: usize,
    rows: usize,
    chunk_columns: usize,
    chunk_rows: usize,
    bands: Bands,
    /// Interleaved samples per pixel in a strip or tile.
    stride: usize,
    /// Whether the file omits each strip or tile.
    absent: Option<Vec<bool>>,
    mask: Option<TiffMask>,
}

impl<R: BufRead + Seek> Tiff<R> {
    pub(super) fn open(
        reader: R,
        context: &FileContext,
        band: Option<u16>,
    ) -> Result<(Self, Header), HeightFileError> {
        let reported = |error| tiff_error(context, error);
        let mut decoder = Decoder::new(reader).map_err(reported)?;
        let (columns, rows) = decoder.dimensions().map_err(reported)?;
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(context.grid(GridError::Size { columns, rows }));
        }
        let bands = Bands::of(&mut decoder, band, context)?;
        let photometric = decoder.find_tag_unsigned::<u16>(Tag::PhotometricInterpretation);
        if photometric.map_err(reported)? == Some(0) {
            // The decoder would invert the values.
            return Err(unsupported(
                context,
                "counts from white to black".to_string(),
            ));
        }
        let tags = HeightTags {
            geo: GeoTags::read(&mut decoder),
            gdal: decoder
                .get_tag_ascii_string(GDAL_METADATA)
                .unwrap_or_default(),
            band: bands.height,
        };
        let mut plain = None;
        let (georeference, is_south_first, warp) = match tags
            .georeference(columns, rows, context)?
        {
            None => (None, false, None),
            Some(FilePlacement::Geographic(place, is_south_first)) => {
                (Some(place), is_south_first, None)
            }
            Some(FilePlacement::Projected(grid)) => {
                let warp = Warp::beyond(grid, AROUND).map_err(|cause| context.unwarped(cause))?;
                (Some(warp.place), false, Some(warp))
            }
            Some(FilePlacement::Plain(grid)) => {
                plain = Some(grid);
                (None, false, None)
            }
        };
        let number = |text: &str| text.trim_matches(['\0', ' ', '\n']).parse::<f64>().ok();
        let no_data = match decoder.find_tag(Tag::GdalNodata).map_err(reported)? {
            Some(value) => {
                let text = value.into_string().map_err(reported)?;
                let shown = excerpt(&text);
                Some(number(&text).ok_or_else(|| {
                    context.rejected(
                        format!("has the no-data value {shown:?}"),
                        "a number",
                        format!(
                            "`gdal_edit.py -a_nodata -32768 {}`",
                            context.path().display()
                        ),
                    )
                })?)
            }
            None => None,
        };
        let header = Header {
            columns,
            rows,
            georeference,
            plain,
            warp,
            is_south_first,
            unit: tags.unit(context)?,
            scale: tags.gdal_item("scale").and_then(number),
            offset: tags.gdal_item("offset").and_then(number),
            above: tags.above(),
            missing: Missing::of(no_data),
        };

        let (chunk_columns, chunk_rows) = decoder.chunk_dimensions();
        if chunk_columns == 0 || chunk_rows == 0 {
            return Err(context.damaged("strips or tiles of no size"));
        }
        // A strip may claim more rows than the image has; a tile may be larger than the image.
        let chunk_rows = match decoder.get_chunk_type() {
            ChunkType::Tile => chunk_rows,
            ChunkType::Strip => chunk_rows.min(rows),
        };
        let mut limits = Limits::default();
        // Offsets and lengths of the tiles of the largest grid, 16 bytes each.
        limits.ifd_value_size = 64 << 20;
        limits.decoding_buffer_size = limits.ifd_value_size;
        let mut decoder = decoder.with_limits(limits.clone());
        let chunks = TiffChunks::of(&mut decoder).map_err(|error| chunk_error(context, error))?;
        let stride = chunks.kept();
        let chunk_bytes = u64::from(chunk_columns)
            .saturating_mul(u64::from(chunk_rows))
            .saturating_mul(bands.sample_bytes() * u64::from(chunks.samples()));
        if chunk_bytes > CHUNK_BYTES {
            return Err(context.rejected(
                format!("has strips or tiles of {} MB", chunk_bytes / 1_000_000),
                format!("at most {} MB", CHUNK_BYTES / 1_000_000),
                format!(
                    "`gdal_translate -co TILED=YES {} OUT.tif`",
                    context.path().display()
                ),
            ));
        }
        let last = bands.height.max(bands.alpha.unwrap_or(0));
        if !chunks.is_planar() && last >= stride {
            let cause = format!("has {} channels, of which it says no use", bands.count);
            return Err(unsupported(context, cause));
        }
        let absent = absent_chunks(&mut decoder);
        let mask = TiffMask::find(&mut decoder, (columns, rows));
        // At most `CHUNK_BYTES`. Compressed data are only slightly longer.
        limits.decoding_buffer_size = chunk_bytes as usize;
        limits.intermediate_buffer_size = chunk_bytes as usize * 2 + 4096;
        let decoder = decoder.with_limits(limits);
        let tiff = Self {
            absent: absent.map_err(|error| gap_error(context, error))?,
            mask: mask.map_err(|error| gap_error(context, error))?,
            decoder,
            chunks,
            columns: columns as usize,
            rows: rows as usize,
            chunk_columns: chunk_columns as usize,
            chunk_rows: chunk_rows as usize,
            bands,
            stride: usize::from(stride),
        };
        Ok((tiff, header))
    }

    /// Peak memory of reading, bytes: a decoded strip or tile, its data, all offsets and lengths, and the same for a mask.
    pub fn working_bytes(&self) -> u64 {
        let pixels = (self.chunk_columns * self.chunk_rows) as u64;
        let chunk = pixels * self.bands.sample_bytes() * u64::from(self.chunks.samples());
        let of_alpha = match self.bands.alpha {
            Some(_) => chunk + pixels,
            None => 0,
        };
        let across = self.columns.div_ceil(self.chunk_columns) as u64;
        let down = self.rows.div_ceil(self.chunk_rows) as u64;
        let mask = |mask: &TiffMask| mask.working_bytes(self.chunk_rows);
        let of_mask = self.mask.as_ref().map_or(0, mask);
        let of_chunks = self.chunks.working_bytes(chunk);
        let of_places = across * down * 17 * u64::from(self.bands.count);
        let of_row = self.columns as u64 * 5 + (1 << 20);
        // 64-bit integers become floats of the same width.
        let of_floats = if self.bands.bits == 64 { chunk } else { 0 };
        2 * chunk + of_floats + of_places + of_row + of_mask + of_chunks + of_alpha
    }

    /// Notice about the choice of a band.
    pub fn note(&self, context: &FileContext) -> Option<String> {
        self.bands.note(context)
    }

    /// Whether samples use fewer bits than their bytes hold; an image would be stretched to the full
    /// range.
    pub fn is_narrow(&self) -> bool {
        u64::from(self.bands.bits) < 8 * self.bands.sample_bytes()
    }

    /// Rows of a strip or tile.
    pub fn chunk_rows(&self) -> usize {
        self.chunk_rows
    }

    /// Passes on all samples, strip by strip or tile by tile, each row by row.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let across = self.columns.div_ceil(self.chunk_columns);
        let down = self.rows.div_ceil(self.chunk_rows);
        let mut heights_m = vec![0.0; self.chunk_columns.min(self.columns)];
        for number in 0..across * down {
            let first = (
                number / across * self.chunk_rows,
                number % across * self.chunk_columns,
            );
            // Tiles may extend beyond the image.
            let size = (
                self.chunk_columns.min(self.columns - first.1),
                self.chunk_rows.min(self.rows - first.0),
            );
            let row = &mut heights_m[..size.0];
            let height_at = self.index(number, self.bands.height);
            let is_absent =
                |absent: &Vec<bool>| absent.get(height_at).is_some_and(|absent| *absent);
            if self.absent.as_ref().is_some_and(is_absent) {
                for of_chunk in 0..size.1 {
                    row.fill(f32::NAN);
                    put(first.0 + of_chunk, first.1, row)?;
                }
                continue;
            }
            let chunk = self.chunk(height_at, size, context)?;
            let opaque = self.opaque(&chunk, number, size, context)?;
            let mut gaps = Gaps {
                decoder: &mut self.decoder,
                mask: self.mask.as_mut(),
                is_there: vec![true; size.0],
            };
            gaps.begin(first.0);
            let mut put_row = |of_chunk: usize, heights_m: &mut [f32]| {
                let row = first.0 + of_chunk;
                gaps.cut(row, first.1, heights_m)
                    .map_err(|error| gap_error(context, error))?;
                if let Some(opaque) = opaque.as_ref().and_then(|all| all.get(of_chunk * size.0..)) {
                    for (height_m, is_opaque) in heights_m.iter_mut().zip(opaque) {
                        if !is_opaque {
                            *height_m = f32::NAN;
                        }
                    }
                }
                put(row, first.1, heights_m)
            };
            let offset = match self.chunks.is_planar() {
                true => 0,
                false => usize::from(self.bands.height),
            };
            let of = Samples {
                size,
                stride: self.stride,
                offset,
            };
            let is_whole = match &chunk {
                DecodingResult::U8(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::I8(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::U16(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::I16(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::U32(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::I32(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::F32(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::F64(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::F16(all) => of.convert_rows(all, conversion, row, &mut put_row),
                DecodingResult::U64(all) => {
                    let all: Vec<_> = all.iter().map(|value| *value as f64).collect();
                    of.convert_rows(&all, conversion, row, &mut put_row)
                }
                DecodingResult::I64(all) => {
                    let all: Vec<_> = all.iter().map(|value| *value as f64).collect();
                    of.convert_rows(&all, conversion, row, &mut put_row)
                }
            }?;
            if !is_whole {
                let cause = "a strip or tile of too few samples";
                return Err(context.damaged(cause).into());
            }
        }
        Ok(())
    }

    /// The index of a band's strip or tile in the file.
    fn index(&self, number: usize, band: u16) -> usize {
        match self.chunks.is_planar() {
            true => usize::from(band) * self.chunks.per_plane() as usize + number,
            false => number,
        }
    }

    /// Where the alpha of a strip or tile permits heights; `None` without alpha.
    fn opaque(
        &mut self,
        heights: &DecodingResult,
        number: usize,
        size: (usize, usize),
        context: &FileContext,
    ) -> Result<Option<Vec<bool>>, HeightFileError> {
        let Some(alpha) = self.bands.alpha else {
            return Ok(None);
        };
        if !self.chunks.is_planar() {
            return Ok(Some(opaque(heights, self.stride, usize::from(alpha))));
        }
        let index = self.index(number, alpha);
        let is_absent = |absent: &Vec<bool>| absent.get(index).is_some_and(|absent| *absent);
        if self.absent.as_ref().is_some_and(is_absent) {
            return Ok(Some(vec![false; size.0 * size.1]));
        }
        Ok(Some(opaque(&self.chunk(index, size, context)?, 1, 0)))
    }

    /// Decodes a strip or tile with this many columns and rows inside the image.
    fn chunk(
        &mut self,
        number: usize,
        (columns, rows): (usize, usize),
        context: &FileContext,
    ) -> Result<DecodingResult, HeightFileError> {
        // Below 2^32: a chunk holds at least one sample.
        let index = number as u32;
        let chunk = self.chunks.read(&mut self.decoder, index);
        let chunk = chunk.map_err(|error| chunk_error(context, error))?;
        let of_plane = index % self.chunks.per_plane().max(1);
        let (width, height) = self.decoder.chunk_data_dimensions(of_plane);
        match width as usize == columns && height as usize >= rows && columns > 0 {
            true => Ok(chunk),
            false => Err(context.damaged("a strip or tile of the wrong size")),
        }
    }
}

/// Missing samples in the rows of a strip or tile.
struct Gaps<'a, R: BufRead + Seek> {
    decoder: &'a mut Decoder<R>,
    mask: Option<&'a mut TiffMask>,
    is_there: Vec<bool>,
}

impl<R: BufRead + Seek> Gaps<'_, R> {
    /// Announces that no earlier row follows.
    fn begin(&mut self, row: usize) {
        if let Some(mask) = &mut self.mask {
            mask.forget_above(row);
        }
    }

    /// Turns masked samples of a row into holes.
    fn cut(
        &mut self,
        row: usize,
        first_column: usize,
        heights_m: &mut [f32],
    ) -> Result<(), TiffGapError> {
        let Some(mask) = &mut self.mask else {
            return Ok(());
        };
        mask.row(self.decoder, row, first_column, &mut self.is_there)?;
        for (height_m, is_there) in heights_m.iter_mut().zip(&self.is_there) {
            if !is_there {
                *height_m = f32::NAN;
            }
        }
        Ok(())
    }
}

/// Samples of a strip or tile of several bands.
struct Samples {
    /// Columns and rows.
    size: (usize, usize),
    /// Samples per pixel, and the index of the height.
    stride: usize,
    offset: usize,
}

impl Samples {
    /// Converts the height samples and passes on each row. Returns whether there were enough.
    fn convert_rows<T: Copy + Into<f64>, E>(
        &self,
        values: &[T],
        conversion: &Conversion,
        heights_m: &mut [f32],
        put_row: &mut impl FnMut(usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<bool, E> {
        let (width, height) = self.size;
        let row_samples = width * self.stride;
        if values.len() < row_samples * height {
            return Ok(false);
        }
        for (row, values) in values.chunks_exact(row_samples).take(height).enumerate() {
            match self.stride {
                1 => {
                    for (height_m, value) in heights_m.iter_mut().zip(values) {
                        *height_m = conversion.metres((*value).into());
                    }
                }
                stride => {
                    let pixels = values.chunks_exact(stride);
                    for (height_m, pixel) in heights_m.iter_mut().zip(pixels) {
                        let value = pixel
                            .get(self.offset)
                            .map_or(f64::NAN, |value| (*value).into());
                        *height_m = conversion.metres(value);
                    }
                }
            }
            put_row(row, heights_m)?;
        }
        Ok(true)
    }
}

fn unsupported(context: &FileContext, cause: String) -> HeightFileError {
    context.rejected(
        cause,
        "bands of whole numbers of 8 to 64 bits or of floats of 16 to 64, uncompressed or by LZW, deflate, PackBits, ZSTD, LERC or JPEG",
        format!(
            "`gdal_translate -b 1 -ot Float32 -co COMPRESS=DEFLATE {} OUT.tif`",
            context.path().display()
        ),
    )
}

fn chunk_error(context: &FileContext, error: TiffChunkError) -> HeightFileError {
    match error {
        TiffChunkError::Tiff(error) => tiff_error(context, error),
        TiffChunkError::Damaged(cause) => context.damaged(cause),
        TiffChunkError::Unsupported(cause) => unsupported(context, cause),
    }
}

fn gap_error(context: &FileContext, error: TiffGapError) -> HeightFileError {
    match error {
        TiffGapError::Tiff(TiffError::UnsupportedError(error)) => mask_rejected(
            context,
            format!("a mask that is not read: {}", printable(&error.to_string())),
        ),
        TiffGapError::Tiff(error) => tiff_error(context, error),
        TiffGapError::Damaged(cause) => context.damaged(cause),
        TiffGapError::Mask(cause) => mask_rejected(context, cause),
    }
}

fn mask_rejected(context: &FileContext, cause: String) -> HeightFileError {
    context.rejected(
        format!("has {cause}"),
        "a mask of 1 or 8 bits as large as the image, uncompressed or by LZW, deflate, PackBits or ZSTD",
        format!(
            "write what it masks as no data: `gdalwarp -dstnodata -32768 {} OUT.tif`",
            context.path().display()
        ),
    )
}

fn tiff_error(context: &FileContext, error: TiffError) -> HeightFileError {
    match error {
        TiffError::IoError(error) => context.reading(error),
        TiffError::UnsupportedError(error) => unsupported(context, printable(&error.to_string())),
        TiffError::LimitsExceeded => context.rejected(
            "has tags or strips beyond all measure",
            "those of a picture",
            format!(
                "rewrite it: `gdal_translate {} OUT.tif`",
                context.path().display()
            ),
        ),
        other => context.damaged(printable(&other.to_string())),
    }
}
