//! Pixels of a TIFF without data: omitted strips and tiles, and pixels excluded by an internal mask.
//!
//! Sources: TIFF 6.0, sections 7 (`NewSubfileType`) and 8 (`PhotometricInterpretation` 4). Omitted strips and tiles follow the option `SPARSE_OK` of
//! GDAL's driver, which writes offset 0 and length 0 for them.

use super::tiff_chunks::{alone::Alone, zstd_bytes};
use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};
use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, IfdDecoder};
use tiff::tags::{CompressionMethod, IfdPointer, Tag};

/// Bits of `NewSubfileType`: a smaller copy of another image, a mask of another image.
const REDUCED: u64 = 1;
const MASK: u64 = 4;

/// Maximum number of directories that are searched.
const MOST_DIRECTORIES: usize = 4096;

/// Maximum size of a mask's strip or tile, bytes.
const CHUNK_BYTES: usize = 256 << 20;

/// Why the pixels without data could not be determined.
#[derive(Debug, thiserror::Error)]
pub enum TiffGapError {
    /// The file cannot be read or is not a valid TIFF.
    #[error(transparent)]
    Tiff(#[from] TiffError),
    /// The file is damaged.
    #[error("{0}")]
    Damaged(&'static str),
    /// An unsupported mask.
    #[error("{0}")]
    Mask(String),
}

/// The strips or tiles of the current image that the file omits; empty if it has all.
///
/// # Errors
/// [`TiffGapError`] if one has the offset of the file's header.
pub fn absent_chunks<R: Read + Seek>(
    decoder: &mut Decoder<R>,
) -> Result<Option<Vec<bool>>, TiffGapError> {
    let (offsets, lengths) = match decoder.get_chunk_type() {
        ChunkType::Strip => (Tag::StripOffsets, Tag::StripByteCounts),
        ChunkType::Tile => (Tag::TileOffsets, Tag::TileByteCounts),
    };
    let places = places(&mut decoder.image_ifd(), offsets, lengths)?;
    let absent: Vec<bool> = places.iter().map(|place| *place == (0, 0)).collect();
    Ok(absent.contains(&true).then_some(absent))
}

/// Offset and length of each strip or tile.
fn places(
    tags: &mut IfdDecoder<'_>,
    offsets: Tag,
    lengths: Tag,
) -> Result<Vec<(u64, u64)>, TiffGapError> {
    let mut numbers = |tag| tags.find_tag_unsigned_vec::<u64>(tag);
    let offsets = numbers(offsets)?.unwrap_or_default();
    let lengths = numbers(lengths)?.unwrap_or_default();
    if offsets.len() != lengths.len() {
        return Err(TiffGapError::Damaged("offsets without lengths"));
    }
    let places: Vec<_> = offsets.into_iter().zip(lengths).collect();
    match places.iter().any(|(at, bytes)| *at == 0 && *bytes > 0) {
        true => Err(TiffGapError::Damaged(
            "a strip or tile that begins at the file's header",
        )),
        false => Ok(places),
    }
}

/// The mask of a file's first image: 0 where a pixel has no data.
pub struct TiffMask {
    columns: usize,
    chunk_columns: usize,
    chunk_rows: usize,
    rows: usize,
    /// 1 or 8.
    bits: usize,
    compression: u16,
    predictor: u16,
    places: Vec<(u64, u64)>,
    /// Decoded strips or tiles.
    held: BTreeMap<usize, Vec<u8>>,
}

impl TiffMask {
    /// Finds the mask of the first image, whose size is given, in all directories. Masks of smaller copies are skipped.
    ///
    /// # Errors
    /// [`TiffGapError`], also for a mask of another size or with an unsupported compression.
    pub fn find<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        size: (u32, u32),
    ) -> Result<Option<Self>, TiffGapError> {
        for pointer in directories(decoder)? {
            let directory = decoder.read_directory(pointer)?;
            let mut tags = decoder.read_directory_tags(&directory);
            let kind = tags.find_tag_unsigned::<u64>(Tag::NewSubfileType)?;
            if kind.is_some_and(|kind| kind & MASK != 0 && kind & REDUCED == 0) {
                return Self::new(&mut tags, size).map(Some);
            }
        }
        Ok(None)
    }

    /// The current image of a file as the mask of an image of this size in another file, as GDAL's `.msk`.
    ///
    /// # Errors
    /// As [`Self::find`].
    pub fn of_file<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        size: (u32, u32),
    ) -> Result<Self, TiffGapError> {
        Self::new(&mut decoder.image_ifd(), size)
    }

    fn new(tags: &mut IfdDecoder<'_>, (columns, rows): (u32, u32)) -> Result<Self, TiffGapError> {
        let rejected = |what: String| Err(TiffGapError::Mask(what));
        let mut number = |tag, usual: u32| -> Result<u32, TiffGapError> {
            Ok(tags.find_tag_unsigned::<u32>(tag)?.unwrap_or(usual))
        };
        let size = (number(Tag::ImageWidth, 0)?, number(Tag::ImageLength, 0)?);
        if size != (columns, rows) {
            return rejected(format!(
                "a mask of {} x {} pixels over an image of {columns} x {rows}",
                size.0, size.1
            ));
        }
        let bits = number(Tag::BitsPerSample, 1)?;
        if !matches!(bits, 1 | 8) || number(Tag::SamplesPerPixel, 1)? != 1 {
            return rejected(format!("a mask of {bits} bits or of several channels"));
        }
        if number(Tag::FillOrder, 1)? != 1 {
            return rejected("a mask whose bits run backwards".to_string());
        }
        let (compression, predictor) = (number(Tag::Compression, 1)?, number(Tag::Predictor, 1)?);
        let tile = (number(Tag::TileWidth, 0)?, number(Tag::TileLength, 0)?);
        let strip_rows = number(Tag::RowsPerStrip, rows)?.min(rows);
        let is_tiled = tile.0 > 0;
        let (across, down) = match is_tiled {
            true => tile,
            false => (columns, strip_rows),
        };
        let (chunk_columns, chunk_rows) = (across as usize, down as usize);
        if chunk_rows == 0 {
            return Err(TiffGapError::Damaged("a mask in strips of no size"));
        }
        let bits = bits as usize;
        let row_bytes = (chunk_columns * bits).div_ceil(8);
        if row_bytes.saturating_mul(chunk_rows) > CHUNK_BYTES {
            return rejected("a mask in strips or tiles of more than 256 MB".to_string());
        }
        let places = match is_tiled {
            true => places(tags, Tag::TileOffsets, Tag::TileByteCounts)?,
            false => places(tags, Tag::StripOffsets, Tag::StripByteCounts)?,
        };
        let (columns, rows) = (columns as usize, rows as usize);
        if places.len() != columns.div_ceil(chunk_columns) * rows.div_ceil(chunk_rows) {
            return Err(TiffGapError::Damaged("a mask of too few strips or tiles"));
        }
        Ok(Self {
            columns,
            chunk_columns,
            chunk_rows,
            rows,
            bits,
            // A number beyond 16 bits is not a supported method.
            compression: u16::try_from(compression).unwrap_or(u16::MAX),
            predictor: u16::try_from(predictor).unwrap_or(u16::MAX),
            places,
            held: BTreeMap::new(),
        })
    }

    /// Peak memory while an image in strips or tiles of `image_chunk_rows` rows is read from first row to last, bytes.
    pub fn working_bytes(&self, image_chunk_rows: usize) -> u64 {
        let across = self.columns.div_ceil(self.chunk_columns) as u64;
        let down = (image_chunk_rows.div_ceil(self.chunk_rows) + 1) as u64;
        let chunk = (self.row_bytes() * self.chunk_rows) as u64;
        (across * down + 2) * chunk + 16 * self.places.len() as u64
    }

    /// Drops decoded parts above a row.
    pub fn forget_above(&mut self, row: usize) {
        let across = self.columns.div_ceil(self.chunk_columns);
        let first = row / self.chunk_rows * across;
        self.held = self.held.split_off(&first);
    }

    /// Whether the pixels of a row, from a column on, have data.
    ///
    /// # Errors
    /// [`TiffGapError`] if the mask cannot be read or decoded.
    pub fn row<R: Read + Seek>(
        &mut self,
        decoder: &mut Decoder<R>,
        row: usize,
        first_column: usize,
        is_there: &mut [bool],
    ) -> Result<(), TiffGapError> {
        let across = self.columns.div_ceil(self.chunk_columns);
        let (width, bits, row_bytes) = (self.chunk_columns, self.bits, self.row_bytes());
        let in_chunk = row % self.chunk_rows * row_bytes;
        for (n, is_there) in is_there.iter_mut().enumerate() {
            let column = first_column + n;
            let number = row / self.chunk_rows * across + column / width;
            let bytes = match self.held.get(&number) {
                Some(bytes) => bytes,
                None => {
                    let bytes = self.decode(decoder, number)?;
                    self.held.entry(number).or_insert(bytes)
                }
            };
            let x = column % width;
            *is_there = match bits {
                1 => bytes[in_chunk + x / 8] & (0x80 >> (x % 8)) != 0,
                _ => bytes[in_chunk + x] != 0,
            };
        }
        Ok(())
    }

    fn row_bytes(&self) -> usize {
        (self.chunk_columns * self.bits).div_ceil(8)
    }

    /// Decodes a strip or tile; one that the file omits masks everything.
    fn decode<R: Read + Seek>(
        &self,
        decoder: &mut Decoder<R>,
        number: usize,
    ) -> Result<Vec<u8>, TiffGapError> {
        let (offset, length) = self.places[number];
        let whole = self.row_bytes() * self.chunk_rows;
        if (offset, length) == (0, 0) {
            return Ok(vec![0; whole]);
        }
        let rows = match self.chunk_columns == self.columns {
            // The last strip may end with the image.
            true => self.chunk_rows.min(self.rows - number * self.chunk_rows),
            false => self.chunk_rows,
        };
        // Compressed data are at most slightly longer.
        if length > 2 * whole as u64 + 4096 {
            return Err(TiffGapError::Damaged("a strip or tile of a mask too long"));
        }
        let reader = decoder.inner();
        let mut data = Vec::new();
        reader
            .seek(SeekFrom::Start(offset))
            .and_then(|_| reader.take(length).read_to_end(&mut data))
            .map_err(TiffError::from)?;
        if data.len() as u64 != length {
            return Err(TiffGapError::Damaged("the file ends inside its mask"));
        }
        let alone = Alone {
            columns: self.chunk_columns as u32,
            rows: rows as u32,
            samples: 1,
            bits: self.bits as u16,
            format: 1,
            compression: self.compression,
            predictor: self.predictor,
            is_big_endian: false,
        };
        let decoded = match self.compression == CompressionMethod::ZSTD.to_u16() {
            true => {
                let data = zstd_bytes(&data, alone.bytes())
                    .map_err(|_| TiffGapError::Damaged("a mask of damaged ZSTD data"))?;
                alone.uncompressed().decode(&data)?
            }
            false => alone.decode(&data)?,
        };
        let DecodingResult::U8(mut bytes) = decoded else {
            return Err(TiffGapError::Damaged("a mask of unknown numbers"));
        };
        if bytes.len() < self.row_bytes() * rows {
            return Err(TiffGapError::Damaged("a mask of too few pixels"));
        }
        bytes.resize(whole, 0);
        Ok(bytes)
    }
}

/// All directories after the first, and the subdirectories of the first.
fn directories<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Vec<IfdPointer>, TiffGapError> {
    let own = decoder.find_tag(Tag::SubIfd)?;
    // A tag of a type that is not a directory is skipped; no reader would follow it.
    let mut found = own.map_or_else(Vec::new, |own| own.into_ifd_vec().unwrap_or_default());
    let mut seen: Vec<u64> = Vec::new();
    let mut next = decoder.ifd_pointer();
    while let Some(pointer) = next {
        let place = seen.binary_search(&pointer.0);
        let Err(place) = place else {
            return Err(TiffGapError::Damaged("directories in a circle"));
        };
        seen.insert(place, pointer.0);
        if seen.len() + found.len() > MOST_DIRECTORIES {
            return Err(TiffGapError::Damaged("more than 4096 directories"));
        }
        if seen.len() > 1 {
            found.push(pointer);
        }
        next = decoder.read_directory(pointer)?.next();
    }
    Ok(found)
}
