//! Decodes strips and tiles of a TIFF for all supported compressions. Elevation and imagery share this code.
//!
//! | file | what |
//! |---|---|
//! | `alone.rs` | a strip or tile as a separate file |
//! | `pictures.rs` | JPEG and WebP |
//! | `lerc.rs` | LERC |
//! | `lzw.rs` | LZW |
//!
//! The `tiff` crate handles Deflate, PackBits and predictors. Sources: TIFF 6.0, with Technical Note 2 for JPEG. ZSTD and WebP
//! have registered numbers (libtiff's `tiff.h`). LERC has the tag `LercParameters` (libtiff's `tif_lerc.c`).

pub(in crate::elevation) mod alone;
mod lerc;
mod lzw;
mod pictures;
#[cfg(test)]
mod tests;

use alone::Alone;
use lerc::{LercError, Sample};
use pictures::PictureSize;
use std::io::{Read, Seek, SeekFrom};
use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, DecodingResult};
use tiff::tags::{ByteOrder, PlanarConfiguration, Tag};

/// Version of LERC, and the compression applied to its data.
const LERC_PARAMETERS: Tag = Tag::Unknown(50_674);

/// Allowance for tables and headers in the data of the smallest strips or tiles, bytes.
const MOST_EXTRA_BYTES: usize = 64 << 10;

/// TIFF's `PhotometricInterpretation`.
const WHITE_IS_ZERO: u16 = 0;
const RGB: u16 = 2;
const YCBCR: u16 = 6;

/// TIFF's `Predictor` value for none.
const NO_PREDICTOR: u16 = 1;

/// Why strips or tiles cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub enum TiffChunkError {
    /// The file cannot be read or is not a valid TIFF.
    #[error(transparent)]
    Tiff(#[from] TiffError),
    /// A strip or tile is damaged.
    #[error("{0}")]
    Damaged(String),
    /// An unsupported feature, as the end of a sentence that begins with the file.
    #[error("{0}")]
    Unsupported(String),
}

impl From<LercError> for TiffChunkError {
    fn from(error: LercError) -> Self {
        match error {
            LercError::Damaged(_) => Self::Damaged(error.to_string()),
            LercError::Unsupported(_) => Self::Unsupported(error.to_string()),
        }
    }
}

/// Compression of strips and tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Codec {
    /// Decoded by the `tiff` crate.
    OfCrate,
    Lzw,
    Zstd,
    Jpeg,
    WebP,
    Lerc(After),
}

/// Compression applied to LERC data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum After {
    Nothing,
    Deflate,
    Zstd,
}

impl Codec {
    /// The codec of TIFF's `Compression`; otherwise the name of the compression.
    fn of(compression: u16) -> Result<Self, String> {
        Ok(match compression {
            1 | 8 | 32_773 | 32_946 => Self::OfCrate,
            5 => Self::Lzw,
            7 => Self::Jpeg,
            34_887 => Self::Lerc(After::Nothing),
            50_000 => Self::Zstd,
            50_001 => Self::WebP,
            other => {
                return Err(match other {
                    2..=4 => "CCITT fax".to_string(),
                    6 => "JPEG of TIFF 6.0 (old-style)".to_string(),
                    33_003..=33_005 | 34_712 => "JPEG 2000".to_string(),
                    34_661 => "JBIG".to_string(),
                    34_676 | 34_677 => "SGI LogLuv".to_string(),
                    34_925 => "LZMA".to_string(),
                    50_002 | 52_546 => "JPEG XL".to_string(),
                    other => format!("method {other}"),
                });
            }
        })
    }
}

/// Decompresses ZSTD data of at most `most` bytes.
pub(in crate::elevation) fn zstd_bytes(
    data: &[u8],
    most: usize,
) -> Result<Vec<u8>, TiffChunkError> {
    zstd::bulk::decompress(data, most)
        .map_err(|error| TiffChunkError::Damaged(format!("ZSTD: {error}")))
}

/// Decompresses deflated data of at most `most` bytes.
fn deflated_bytes(data: &[u8], most: usize) -> Result<Vec<u8>, TiffChunkError> {
    let mut bytes = Vec::new();
    let stream = flate2::read::ZlibDecoder::new(data);
    stream
        .take(most as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| TiffChunkError::Damaged(format!("deflate: {error}")))?;
    match bytes.len() > most {
        true => Err(TiffChunkError::Damaged(
            "deflate: too many bytes".to_string(),
        )),
        false => Ok(bytes),
    }
}

/// The strips or tiles of an image.
#[derive(Clone, Debug)]
pub struct TiffChunks {
    codec: Codec,
    /// Format of a whole strip or tile.
    form: Alone,
    /// Strips or tiles per plane.
    per_plane: u32,
    photometric: u16,
    jpeg_tables: Option<Vec<u8>>,
    /// Whether the last of two or four samples is alpha.
    has_alpha: bool,
    /// Whether the `tiff` crate reads strips and tiles.
    is_of_crate: bool,
    /// Whether each sample of a pixel has separate strips or tiles.
    is_planar: bool,
    /// Samples per pixel that the `tiff` crate decodes. It omits colours without a meaning, such as infrared.
    given: u16,
    /// Samples per pixel that are passed on.
    kept: u16,
    /// Offset and length of each, if the `tiff` crate does not read them.
    places: Vec<(u64, u64)>,
}

/// Whether samples of this many bits share bytes.
fn share_bytes(bits: u16) -> bool {
    matches!(bits, 1..=7 | 9..=15)
}

impl TiffChunks {
    /// Inspects the current image of a file.
    ///
    /// # Errors
    /// [`TiffChunkError`] for an unsupported compression or an unsupported number of bits.
    pub fn of<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Self, TiffChunkError> {
        let mut number = |tag, usual: u16| -> Result<u16, TiffError> {
            let found = decoder.find_tag_unsigned_vec::<u16>(tag)?;
            Ok(found.and_then(|all| all.first().copied()).unwrap_or(usual))
        };
        let compression = number(Tag::Compression, 1)?;
        let bits = number(Tag::BitsPerSample, 1)?;
        let of_pixel = number(Tag::SamplesPerPixel, 1)?;
        let format = number(Tag::SampleFormat, 1)?;
        let photometric = number(Tag::PhotometricInterpretation, 1)?;
        let predictor = number(Tag::Predictor, NO_PREDICTOR)?;
        let planar = number(Tag::PlanarConfiguration, 1)?;
        let fill_order = number(Tag::FillOrder, 1)?;
        let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples)?;
        let extra = extra.unwrap_or_default();
        let has_alpha = matches!(extra.first(), Some(1 | 2));
        let after = decoder.find_tag_unsigned_vec::<u32>(LERC_PARAMETERS)?;
        let codec = match Codec::of(compression) {
            Ok(Codec::Lerc(_)) => Codec::Lerc(match after.and_then(|all| all.get(1).copied()) {
                None | Some(0) => After::Nothing,
                Some(1) => After::Deflate,
                Some(2) => After::Zstd,
                Some(other) => {
                    let cause = format!("is LERC compressed again by method {other}");
                    return Err(TiffChunkError::Unsupported(cause));
                }
            }),
            Ok(codec) => codec,
            Err(name) => {
                let cause = format!("is compressed by {name}");
                return Err(TiffChunkError::Unsupported(cause));
            }
        };
        let is_packed = share_bytes(bits);
        let is_read = matches!(bits, 8 | 16 | 32 | 64) || (is_packed && format == 1);
        if !is_read {
            let cause = format!("holds samples of {bits} bits");
            return Err(TiffChunkError::Unsupported(cause));
        }
        if fill_order != 1 {
            let cause = "has the bits of its bytes in reverse (FillOrder 2)";
            return Err(TiffChunkError::Unsupported(cause.to_string()));
        }
        let is_picture = matches!(codec, Codec::Jpeg | Codec::WebP);
        if is_picture && (bits, format) != (8, 1) {
            let cause = format!("holds {bits}-bit samples as JPEG or WebP");
            return Err(TiffChunkError::Unsupported(cause));
        }
        if is_packed && predictor != NO_PREDICTOR {
            let cause = format!("holds samples of {bits} bits with a predictor");
            return Err(TiffChunkError::Unsupported(cause));
        }
        if photometric == YCBCR && codec != Codec::Jpeg {
            let cause = "holds YCbCr colours that are not JPEG";
            return Err(TiffChunkError::Unsupported(cause.to_string()));
        }
        let is_planar = planar == PlanarConfiguration::Planar.to_u16();
        let (width, height) = decoder.dimensions()?;
        let (columns, rows) = decoder.chunk_dimensions();
        if columns == 0 || rows == 0 {
            let cause = "strips or tiles of no size".to_string();
            return Err(TiffChunkError::Damaged(cause));
        }
        let form = Alone {
            columns,
            rows,
            samples: if is_planar { 1 } else { of_pixel },
            bits,
            format,
            compression,
            predictor,
            is_big_endian: decoder.byte_order() == ByteOrder::BigEndian,
        };
        // The crate omits the others from its output.
        let given = match photometric == RGB && !is_planar {
            true => of_pixel.saturating_sub(extra.len() as u16) + u16::from(has_alpha),
            false => form.samples,
        };
        let jpeg_tables = match codec {
            Codec::Jpeg => decoder.find_tag(Tag::JPEGTables)?,
            _ => None,
        };
        let jpeg_tables = jpeg_tables.map(|tables| tables.into_u8_vec()).transpose()?;
        // The crate unpacks only these, and returns those below 8 bits packed.
        let is_of_crate = codec == Codec::OfCrate && matches!(bits, 1 | 2 | 4 | 8 | 16 | 32 | 64);
        let places = match is_of_crate {
            true => Vec::new(),
            false => places(decoder)?,
        };
        Ok(Self {
            codec,
            form,
            per_plane: width
                .div_ceil(columns)
                .saturating_mul(height.div_ceil(rows)),
            photometric,
            jpeg_tables,
            has_alpha: has_alpha && matches!(of_pixel, 2 | 4),
            is_of_crate,
            is_planar: is_planar && of_pixel > 1,
            given: given.min(form.samples),
            kept: given.min(form.samples),
            places,
        })
    }

    /// Whether colours are RGB although the file declares YCbCr.
    pub fn gives_rgb(&self) -> bool {
        self.photometric == YCBCR
    }

    /// Passes on only the first samples of a pixel, if they are interleaved.
    pub fn keep_first(&mut self, samples: u16) {
        if !self.is_planar {
            self.kept = self.kept.min(samples);
        }
    }

    /// Samples per pixel that are passed on, or per plane.
    pub fn kept(&self) -> u16 {
        self.kept
    }

    /// Whether each sample of a pixel has separate strips or tiles, plane after plane.
    pub fn is_planar(&self) -> bool {
        self.is_planar
    }

    /// Strips or tiles per plane.
    pub fn per_plane(&self) -> u32 {
        self.per_plane
    }

    /// Samples per stored pixel, or per plane.
    pub fn samples(&self) -> u16 {
        self.form.samples
    }

    /// Bits per stored sample. Samples of fewer than 8 bits are passed on as bytes, those of 9 to 15 as 16
    /// bits.
    pub fn bits(&self) -> u16 {
        self.form.bits
    }

    /// Extra memory of decoding, bytes, besides the data and the samples of a strip or tile of
    /// `chunk_bytes`.
    pub fn working_bytes(&self, chunk_bytes: u64) -> u64 {
        let places = 16 * self.places.len() as u64;
        places.saturating_add(match self.codec {
            Codec::OfCrate => 0,
            // The decompressed data, and a copy as a file.
            Codec::Lzw | Codec::Zstd => chunk_bytes.saturating_mul(2),
            // A copy of the data, and coefficients or lines of the decoder.
            Codec::Jpeg | Codec::WebP => chunk_bytes.saturating_mul(3),
            Codec::Lerc(_) => chunk_bytes.saturating_mul(3),
        })
    }

    /// The samples of a strip or tile inside the image: pixel by pixel, in native byte order. Samples of fewer than 8 bits are bytes,
    /// those of 9 to 15 have 16 bits.
    ///
    /// # Errors
    /// [`TiffChunkError`], before any allocation larger than a strip or tile.
    pub fn read<R: Read + Seek>(
        &self,
        decoder: &mut Decoder<R>,
        index: u32,
    ) -> Result<DecodingResult, TiffChunkError> {
        // The crate places strips or tiles of further planes below the image.
        let of_plane = index % self.per_plane.max(1);
        let (columns, rows) = decoder.chunk_data_dimensions(of_plane);
        let whole = match self.is_of_crate {
            true => {
                let chunk = decoder.read_chunk(index)?;
                let row = columns as usize * usize::from(self.given);
                match (chunk, self.is_packed()) {
                    (DecodingResult::U8(packed), true) => self.unpacked(&packed, row, rows),
                    (chunk, _) => cropped(chunk, (row, row), rows as usize)?,
                }
            }
            false => self.read_alone(decoder, index, (columns, rows))?,
        };
        let held = usize::from(match self.is_of_crate {
            true => self.given,
            false => self.form.samples,
        });
        match usize::from(self.kept) {
            kept if kept < held => {
                let pixels = columns as usize * rows as usize;
                cropped(whole, (held, kept), pixels)
            }
            _ => Ok(whole),
        }
    }

    /// All samples, inside the image, of a strip or tile that the `tiff` crate does not read.
    fn read_alone<R: Read + Seek>(
        &self,
        decoder: &mut Decoder<R>,
        index: u32,
        (columns, rows): (u32, u32),
    ) -> Result<DecodingResult, TiffChunkError> {
        // Strips are as wide as the image, and the last may have fewer rows; tiles are complete.
        let form = Alone {
            rows: match decoder.get_chunk_type() {
                ChunkType::Strip => rows,
                ChunkType::Tile => self.form.rows,
            },
            ..self.form
        };
        let data = self.data(decoder, index, &form)?;
        let samples = usize::from(form.samples);
        let row = (form.columns as usize * samples, columns as usize * samples);
        let whole = match (self.decoded(&data, &form)?, self.is_packed()) {
            (DecodingResult::U8(packed), true) => self.unpacked(&packed, row.0, form.rows),
            (whole, _) => whole,
        };
        cropped(whole, row, rows as usize)
    }

    fn is_packed(&self) -> bool {
        share_bytes(self.form.bits)
    }

    /// The data of a strip or tile.
    fn data<R: Read + Seek>(
        &self,
        decoder: &mut Decoder<R>,
        index: u32,
        form: &Alone,
    ) -> Result<Vec<u8>, TiffChunkError> {
        let damaged = |cause: &str| TiffChunkError::Damaged(cause.to_string());
        let place = self.places.get(index as usize);
        let (offset, length) = *place.ok_or_else(|| damaged("too few strips or tiles"))?;
        // Compressed data are at most slightly longer than the samples.
        let most = form.bytes().saturating_mul(2) + MOST_EXTRA_BYTES;
        if length > most as u64 {
            return Err(damaged("a strip or tile of more data than samples"));
        }
        let file = decoder.inner();
        let mut data = Vec::new();
        file.seek(SeekFrom::Start(offset))
            .and_then(|_| file.take(length).read_to_end(&mut data))
            .map_err(TiffError::from)?;
        match data.len() as u64 == length {
            true => Ok(data),
            false => Err(damaged("the file ends too early")),
        }
    }

    fn decoded(&self, data: &[u8], form: &Alone) -> Result<DecodingResult, TiffChunkError> {
        let size = PictureSize {
            columns: form.columns as usize,
            rows: form.rows as usize,
            samples: usize::from(form.samples),
        };
        let form = &match self.is_packed() {
            true => form.of_bytes(),
            false => *form,
        };
        match self.codec {
            Codec::OfCrate => Ok(self.counted_from_black(form.decode(data)?)),
            Codec::Lzw | Codec::Zstd => {
                let (plain, name) = match self.codec {
                    Codec::Lzw => (lzw::bytes(data, form.bytes())?, "LZW"),
                    _ => (zstd_bytes(data, form.bytes())?, "ZSTD"),
                };
                if plain.len() < form.bytes() {
                    let cause = format!("{name}: fewer bytes than samples");
                    return Err(TiffChunkError::Damaged(cause));
                }
                Ok(self.counted_from_black(form.uncompressed().decode(&plain)?))
            }
            Codec::Jpeg => {
                let tables = self.jpeg_tables.as_deref();
                let samples = pictures::jpeg(data, tables, self.photometric == YCBCR, size)?;
                Ok(self.counted_from_black(DecodingResult::U8(samples)))
            }
            Codec::WebP => Ok(DecodingResult::U8(pictures::webp(data, size)?)),
            Codec::Lerc(after) => {
                let most = form.bytes().saturating_mul(2) + MOST_EXTRA_BYTES;
                let plain = match after {
                    After::Nothing => None,
                    After::Deflate => Some(deflated_bytes(data, most)?),
                    After::Zstd => Some(zstd_bytes(data, most)?),
                };
                let data = plain.as_deref().unwrap_or(data);
                Ok(self.counted_from_black(self.lerc(data, size)?))
            }
        }
    }

    fn lerc(&self, data: &[u8], size: PictureSize) -> Result<DecodingResult, TiffChunkError> {
        use DecodingResult as To;
        Ok(match (self.form.format, self.form.bits) {
            (1, 8) => To::U8(self.raster(data, size, 0, u8::MAX)?),
            (2, 8) => To::I8(self.raster(data, size, 0, i8::MAX)?),
            (1, 16) => To::U16(self.raster(data, size, 0, u16::MAX)?),
            (2, 16) => To::I16(self.raster(data, size, 0, i16::MAX)?),
            (1, 32) => To::U32(self.raster(data, size, 0, u32::MAX)?),
            (2, 32) => To::I32(self.raster(data, size, 0, i32::MAX)?),
            (3, 32) => To::F32(self.raster(data, size, f32::NAN, 1.0)?),
            (3, 64) => To::F64(self.raster(data, size, f64::NAN, 1.0)?),
            (format, bits) => {
                let cause = format!("holds LERC of {bits}-bit samples of format {format}");
                return Err(TiffChunkError::Unsupported(cause));
            }
        })
    }

    /// Samples of LERC data. Missing pixels get the value `masked`; `opaque` is the alpha if the mask replaces a stored
    /// alpha.
    fn raster<T: Sample>(
        &self,
        data: &[u8],
        size: PictureSize,
        masked: T,
        opaque: T,
    ) -> Result<Vec<T>, TiffChunkError> {
        let raster = lerc::decode::<T>(data, (size.columns, size.rows))?;
        let (depth, samples) = (raster.depth, size.samples);
        let is_there = |n: usize| raster.is_there.as_ref().is_none_or(|all| all[n]);
        let is_alpha_masked = depth + 1 == samples && self.has_alpha;
        if depth != samples && !is_alpha_masked {
            let cause = format!("LERC data of {depth} samples in a file of {samples}");
            return Err(TiffChunkError::Damaged(cause));
        }
        let mut all = Vec::with_capacity(size.columns * size.rows * samples);
        for (n, pixel) in raster.samples.chunks_exact(depth).enumerate() {
            match is_there(n) {
                true => all.extend(pixel),
                false => all.extend(std::iter::repeat_n(masked, depth)),
            }
            if is_alpha_masked {
                all.push(if is_there(n) { opaque } else { masked });
            }
        }
        Ok(all)
    }

    /// Inverts integers that count from white to black, as the `tiff` crate does.
    fn counted_from_black(&self, samples: DecodingResult) -> DecodingResult {
        match samples {
            samples if self.photometric != WHITE_IS_ZERO => samples,
            DecodingResult::U8(all) => DecodingResult::U8(all.iter().map(|n| !n).collect()),
            DecodingResult::U16(all) => DecodingResult::U16(all.iter().map(|n| !n).collect()),
            samples => samples,
        }
    }

    /// Unpacks samples that share bytes; each row starts at a byte. Samples of fewer than 8 bits become
    /// bytes.
    fn unpacked(&self, packed: &[u8], row_samples: usize, rows: u32) -> DecodingResult {
        let bits = usize::from(self.form.bits);
        let row_bytes = (row_samples * bits).div_ceil(8).max(1);
        let rows = packed.chunks_exact(row_bytes).take(rows as usize);
        let mask = (1_u32 << bits) - 1;
        let samples = rows.flat_map(|row| {
            (0..row_samples).map(move |n| {
                let bit = n * bits;
                let byte = |at: usize| u32::from(row.get(bit / 8 + at).copied().unwrap_or(0));
                // At most 15 bits after 7 others.
                let window = byte(0) << 16 | byte(1) << 8 | byte(2);
                window >> (24 - bits - bit % 8) & mask
            })
        });
        match bits {
            1..8 => DecodingResult::U8(samples.map(|sample| sample as u8).collect()),
            _ => DecodingResult::U16(samples.map(|sample| sample as u16).collect()),
        }
    }
}

/// Offset and length of each strip or tile.
fn places<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Vec<(u64, u64)>, TiffChunkError> {
    let (offsets, lengths) = match decoder.get_chunk_type() {
        ChunkType::Strip => (Tag::StripOffsets, Tag::StripByteCounts),
        ChunkType::Tile => (Tag::TileOffsets, Tag::TileByteCounts),
    };
    let mut numbers = |tag| decoder.find_tag_unsigned_vec::<u64>(tag);
    let (offsets, lengths) = (numbers(offsets)?, numbers(lengths)?);
    let pairs = offsets.unwrap_or_default().into_iter();
    Ok(pairs.zip(lengths.unwrap_or_default()).collect())
}

/// The first samples of each row.
fn cropped(
    whole: DecodingResult,
    row: (usize, usize),
    rows: usize,
) -> Result<DecodingResult, TiffChunkError> {
    fn crop<T: Copy>(
        all: Vec<T>,
        (from, to): (usize, usize),
        rows: usize,
    ) -> Result<Vec<T>, TiffChunkError> {
        if to > from || from == 0 || all.len() < from * rows {
            let cause = "a strip or tile of too few samples".to_string();
            return Err(TiffChunkError::Damaged(cause));
        }
        match all.len() == to * rows {
            true => Ok(all),
            false => {
                let of_rows = all.chunks_exact(from).take(rows);
                Ok(of_rows.flat_map(|row| row[..to].iter().copied()).collect())
            }
        }
    }
    use DecodingResult as To;
    Ok(match whole {
        To::U8(all) => To::U8(crop(all, row, rows)?),
        To::I8(all) => To::I8(crop(all, row, rows)?),
        To::U16(all) => To::U16(crop(all, row, rows)?),
        To::I16(all) => To::I16(crop(all, row, rows)?),
        To::U32(all) => To::U32(crop(all, row, rows)?),
        To::I32(all) => To::I32(crop(all, row, rows)?),
        To::F32(all) => To::F32(crop(all, row, rows)?),
        To::F64(all) => To::F64(crop(all, row, rows)?),
        To::F16(all) => To::F16(crop(all, row, rows)?),
        To::U64(all) => To::U64(crop(all, row, rows)?),
        To::I64(all) => To::I64(crop(all, row, rows)?),
    })
}
