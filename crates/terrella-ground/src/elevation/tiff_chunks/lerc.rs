//! LERC, versions 2.3 to 2.6: rasters packed within a stated error (Esri's specification and its reference implementation,
//! github.com/Esri/lerc, Apache-2.0: `Lerc2.h`, `BitStuffer2.cpp`, `Huffman.cpp`).
//!
//! | file | what |
//! |---|---|
//! | `bits.rs` | packed whole numbers |
//! | `huffman.rs` | codes of bytes |
//!
//! A blob has a header, a mask of valid pixels, and blocks of pixels. A block stores offsets from its lowest value in steps of
//! twice the error. The lossless floats of LERC 4 (`FPL`), which libtiff never writes, are rejected.

mod bits;
mod huffman;

use bits::{Bytes, Words};
use huffman::Codes;

/// Supported versions.
const VERSIONS: std::ops::RangeInclusive<i32> = 3..=6;

/// Bytes of a blob before the range of its checksum.
const UNCHECKED_BYTES: usize = 14;

/// Why a blob cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(super) enum LercError {
    #[error("LERC data: {0}")]
    Damaged(&'static str),
    #[error("is LERC of an unsupported kind: {0}")]
    Unsupported(&'static str),
}

/// A sample of a raster.
pub(super) trait Sample: Copy + Default + PartialOrd + 'static {
    /// Its number in LERC's list of types.
    const TYPE: i32;
    const BYTES: usize;
    /// Converts as C does.
    fn of(value: f64) -> Self;
    fn get(self) -> f64;
    fn read(bytes: &[u8]) -> Self;
}

macro_rules! samples {
    ($($type:ty, $number:literal;)*) => {$(
        impl Sample for $type {
            const TYPE: i32 = $number;
            const BYTES: usize = size_of::<$type>();
            fn of(value: f64) -> Self {
                value as Self
            }
            fn get(self) -> f64 {
                f64::from(self)
            }
            fn read(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<$type>()];
                own.copy_from_slice(bytes);
                Self::from_le_bytes(own)
            }
        }
    )*};
}

samples! {
    i8, 0; u8, 1; i16, 2; u16, 3; i32, 4; u32, 5; f32, 6; f64, 7;
}

/// A decoded raster.
pub(super) struct Raster<T> {
    /// Samples per pixel.
    pub depth: usize,
    /// By pixel, row by row; samples of masked pixels are 0.
    pub samples: Vec<T>,
    /// Which pixels are valid, if not all.
    pub is_there: Option<Vec<bool>>,
}

struct Header {
    version: i32,
    columns: usize,
    rows: usize,
    depth: usize,
    valid: usize,
    block_side: usize,
    max_error: f64,
    lowest: f64,
    highest: f64,
}

impl Header {
    /// Reads and checks a header. `bytes` then holds the rest of the blob.
    fn read<T: Sample>(bytes: &mut Bytes<'_>, size: (usize, usize)) -> Result<Self, LercError> {
        let blob = bytes.0;
        if bytes.take(6)? != b"Lerc2 " {
            return Err(match blob.starts_with(b"CntZImage ") {
                true => LercError::Unsupported("version 1"),
                false => LercError::Damaged("no header"),
            });
        }
        let version = bytes.i32()?;
        if !VERSIONS.contains(&version) {
            return Err(LercError::Unsupported("a version other than 2.3 to 2.6"));
        }
        let checksum = bytes.i32()?;
        let (rows, columns) = (bytes.i32()?, bytes.i32()?);
        let depth = if version >= 4 { bytes.i32()? } else { 1 };
        let (valid, block_side) = (bytes.i32()?, bytes.i32()?);
        let (blob_bytes, kind) = (bytes.i32()?, bytes.i32()?);
        if version >= 6 {
            // Further blobs, a flag for a no-data value, a flag for integers, two reserved bytes.
            bytes.take(8)?;
        }
        let (max_error, lowest, highest) = (bytes.f64()?, bytes.f64()?, bytes.f64()?);
        if version >= 6 {
            bytes.take(16)?;
        }
        let of = |number: i32| usize::try_from(number).unwrap_or(0);
        if (of(columns), of(rows)) != size || rows < 0 || columns < 0 {
            return Err(LercError::Damaged("another size than its strip or tile"));
        }
        if kind != T::TYPE {
            return Err(LercError::Damaged("another type than the file's"));
        }
        let pixels = size.0 * size.1;
        if !(1..=4).contains(&depth) || valid < 0 || of(valid) > pixels || block_side < 1 {
            return Err(LercError::Damaged("a header that contradicts itself"));
        }
        if !(max_error.is_finite() && max_error >= 0.0) || lowest > highest {
            return Err(LercError::Damaged("no error or no range"));
        }
        let end = of(blob_bytes);
        let header_bytes = blob.len() - bytes.0.len();
        if end < header_bytes || end > blob.len() {
            return Err(LercError::Damaged("the data end too early"));
        }
        // Two's complement of the same 32 bits.
        if fletcher32(&blob[UNCHECKED_BYTES..end]) != checksum as u32 {
            return Err(LercError::Damaged("its checksum differs"));
        }
        bytes.0 = &blob[header_bytes..end];
        Ok(Self {
            version,
            columns: size.0,
            rows: size.1,
            depth: of(depth),
            valid: of(valid),
            block_side: of(block_side),
            max_error,
            lowest,
            highest,
        })
    }
}

/// Fletcher's checksum of 16-bit words, as the reference implementation computes it.
fn fletcher32(bytes: &[u8]) -> u32 {
    let (mut sum1, mut sum2) = (0xFFFF_u32, 0xFFFF_u32);
    let fold = |sum: u32| (sum & 0xFFFF) + (sum >> 16);
    for run in bytes.chunks(2 * 359) {
        for word in run.chunks(2) {
            let low = word.get(1).copied().unwrap_or(0);
            sum1 += u32::from(word[0]) << 8 | u32::from(low);
            sum2 += sum1;
        }
        (sum1, sum2) = (fold(sum1), fold(sum2));
    }
    fold(sum2) << 16 | fold(sum1)
}

/// Decodes the first blob of these bytes. It must have this size, columns by rows. Allocates the samples, and at most twice their
/// bytes besides.
///
/// # Errors
/// [`LercError`] for damaged data and for unsupported features.
pub(super) fn decode<T: Sample>(data: &[u8], size: (usize, usize)) -> Result<Raster<T>, LercError> {
    let mut bytes = Bytes(data);
    let header = Header::read::<T>(&mut bytes, size)?;
    let is_there = mask(&mut bytes, &header)?;
    let pixels = header.columns * header.rows;
    let raster = Raster {
        depth: header.depth,
        samples: vec![T::default(); pixels * header.depth],
        is_there: (header.valid < pixels).then_some(is_there.clone()),
    };
    let mut blob = Blob {
        header,
        is_there,
        raster,
        highest: Vec::new(),
    };
    blob.read(&mut bytes)?;
    Ok(blob.raster)
}

/// Which pixels are valid.
fn mask(bytes: &mut Bytes<'_>, header: &Header) -> Result<Vec<bool>, LercError> {
    let pixels = header.columns * header.rows;
    let length = usize::try_from(bytes.i32()?).map_err(|_| LercError::Damaged("a mask"))?;
    let mut packed = Bytes(bytes.take(length)?);
    if header.valid == 0 || header.valid == pixels {
        return Ok(vec![header.valid > 0; pixels]);
    }
    let whole = pixels.div_ceil(8);
    let mut bits = Vec::with_capacity(whole);
    while bits.len() < whole {
        let count = i16::from_le_bytes(packed.array()?);
        let run = usize::from(count.unsigned_abs());
        if count == i16::MIN || run == 0 || run > whole - bits.len() {
            return Err(LercError::Damaged("a mask of the wrong length"));
        }
        match count > 0 {
            true => bits.extend(packed.take(run)?),
            false => bits.resize(bits.len() + run, packed.u8()?),
        }
    }
    let is_there = |n: usize| bits[n / 8] & (0x80 >> (n % 8)) != 0;
    let is_there: Vec<bool> = (0..pixels).map(is_there).collect();
    match is_there.iter().filter(|is_there| **is_there).count() == header.valid {
        true => Ok(is_there),
        false => Err(LercError::Damaged("a mask of another count of pixels")),
    }
}

/// A blob during decoding.
struct Blob<T> {
    header: Header,
    is_there: Vec<bool>,
    raster: Raster<T>,
    /// Highest value of each sample of a pixel, if the blob states it.
    highest: Vec<f64>,
}

/// Columns and rows of a block.
struct Block {
    columns: std::ops::Range<usize>,
    rows: std::ops::Range<usize>,
}

impl<T: Sample> Blob<T> {
    fn read(&mut self, bytes: &mut Bytes<'_>) -> Result<(), LercError> {
        if self.header.valid == 0 {
            return Ok(());
        }
        if self.header.lowest == self.header.highest {
            self.fill(&vec![self.header.lowest; self.header.depth]);
            return Ok(());
        }
        if self.header.version >= 4 {
            let mut ranges = || -> Result<Vec<f64>, LercError> {
                let values = bytes.take(self.header.depth * T::BYTES)?;
                Ok(values.chunks(T::BYTES).map(|b| T::read(b).get()).collect())
            };
            let lowest = ranges()?;
            self.highest = ranges()?;
            if lowest == self.highest {
                self.fill(&lowest);
                return Ok(());
            }
        }
        if bytes.u8()? != 0 {
            return self.read_plain(bytes);
        }
        let whole_bytes = T::BYTES == 1 && self.header.max_error == 0.5;
        let whole_floats =
            self.header.version >= 6 && T::TYPE >= f32::TYPE && self.header.max_error == 0.0;
        if whole_bytes || whole_floats {
            match bytes.u8()? {
                0 => {}
                1 if whole_bytes => return self.read_differences(bytes),
                2 if whole_bytes && self.header.version >= 4 => return self.read_codes(bytes),
                3 if whole_floats => {
                    return Err(LercError::Unsupported("lossless floats of LERC 4"));
                }
                _ => return Err(LercError::Damaged("an unknown way of encoding")),
            }
        }
        self.read_blocks(bytes)
    }

    /// Gives all pixels the same samples.
    fn fill(&mut self, values: &[f64]) {
        let pixels = self.raster.samples.chunks_exact_mut(self.header.depth);
        for (pixel, _) in pixels
            .zip(&self.is_there)
            .filter(|(_, is_there)| **is_there)
        {
            for (sample, value) in pixel.iter_mut().zip(values) {
                *sample = T::of(*value);
            }
        }
    }

    /// Reads uncompressed samples.
    fn read_plain(&mut self, bytes: &mut Bytes<'_>) -> Result<(), LercError> {
        let pixels = self.raster.samples.chunks_exact_mut(self.header.depth);
        for (pixel, _) in pixels
            .zip(&self.is_there)
            .filter(|(_, is_there)| **is_there)
        {
            for sample in pixel {
                *sample = T::read(bytes.take(T::BYTES)?);
            }
        }
        Ok(())
    }

    /// The value of a byte code; signed types subtract half of their range.
    fn of_code(code: u8) -> f64 {
        match T::TYPE == i8::TYPE {
            true => f64::from(code) - 128.0,
            false => f64::from(code),
        }
    }

    /// Reads bytes as Huffman codes.
    fn read_codes(&mut self, bytes: &mut Bytes<'_>) -> Result<(), LercError> {
        let codes = Codes::read(bytes)?;
        let mut words = Words::new(bytes.0);
        let pixels = self.raster.samples.chunks_exact_mut(self.header.depth);
        for (pixel, _) in pixels
            .zip(&self.is_there)
            .filter(|(_, is_there)| **is_there)
        {
            for sample in pixel {
                *sample = T::of(Self::of_code(codes.next(&mut words)?));
            }
        }
        Ok(())
    }

    /// Reads codes of differences to the pixel on the left, or else to the one above.
    fn read_differences(&mut self, bytes: &mut Bytes<'_>) -> Result<(), LercError> {
        let codes = Codes::read(bytes)?;
        let mut words = Words::new(bytes.0);
        let (columns, depth) = (self.header.columns, self.header.depth);
        // Differences wrap around.
        let wrapped = |value: f64| match T::TYPE == i8::TYPE {
            true => T::of(f64::from(value as i32 as i8)),
            false => T::of(f64::from(value as i32 as u8)),
        };
        for of_pixel in 0..depth {
            let mut before = 0.0;
            for n in 0..self.is_there.len() {
                if !self.is_there[n] {
                    continue;
                }
                let has_left = n % columns > 0 && self.is_there[n - 1];
                if !has_left && n >= columns && self.is_there[n - columns] {
                    before = self.raster.samples[(n - columns) * depth + of_pixel].get();
                }
                let sample = wrapped(Self::of_code(codes.next(&mut words)?) + before);
                self.raster.samples[n * depth + of_pixel] = sample;
                before = sample.get();
            }
        }
        Ok(())
    }

    fn read_blocks(&mut self, bytes: &mut Bytes<'_>) -> Result<(), LercError> {
        let (side, columns, rows) = (
            self.header.block_side,
            self.header.columns,
            self.header.rows,
        );
        for row in (0..rows).step_by(side) {
            for column in (0..columns).step_by(side) {
                let block = Block {
                    columns: column..columns.min(column.saturating_add(side)),
                    rows: row..rows.min(row.saturating_add(side)),
                };
                for of_pixel in 0..self.header.depth {
                    self.read_block(&block, of_pixel, bytes)?;
                }
            }
        }
        Ok(())
    }

    fn read_block(
        &mut self,
        block: &Block,
        of_pixel: usize,
        bytes: &mut Bytes<'_>,
    ) -> Result<(), LercError> {
        let options = bytes.u8()?;
        let is_version_5 = self.header.version >= 5;
        let pattern = if is_version_5 { 14 } else { 15 };
        // Four bits of the column after its lowest 3: they count blocks of 8.
        if usize::from(options >> 2) & pattern != (block.columns.start >> 3) & pattern {
            return Err(LercError::Damaged("a block out of order"));
        }
        let is_difference = is_version_5 && options & 4 != 0;
        if is_difference && of_pixel == 0 {
            return Err(LercError::Damaged("a difference to no sample"));
        }
        let kind = options & 3;
        let offset = match kind {
            0 | 2 => 0.0,
            _ => offset::<T>(bytes, options >> 6, is_difference)?,
        };
        if kind == 0 && is_difference {
            return Err(LercError::Damaged("a difference of plain samples"));
        }
        let (width, height) = (block.columns.len(), block.rows.len());
        let steps = match kind {
            1 => bytes.packed(width * height)?,
            _ => Vec::new(),
        };
        let is_whole = steps.len() == width * height;
        let highest = match self.highest.get(of_pixel) {
            Some(highest) if self.header.depth > 1 => *highest,
            _ => self.header.highest,
        };
        let (scale, depth) = (2.0 * self.header.max_error, self.header.depth);
        let mut next = steps.iter();
        for row in block.rows.clone() {
            for column in block.columns.clone() {
                let n = row * self.header.columns + column;
                let mut step = 0.0;
                if kind == 1 && (is_whole || self.is_there[n]) {
                    let of_pixel = next.next();
                    step = f64::from(*of_pixel.ok_or(LercError::Damaged("too few numbers"))?);
                }
                if !self.is_there[n] {
                    continue;
                }
                let place = n * depth + of_pixel;
                self.raster.samples[place] = match kind {
                    0 => T::read(bytes.take(T::BYTES)?),
                    _ => {
                        let before = match is_difference {
                            true => self.raster.samples[place - 1].get(),
                            false => 0.0,
                        };
                        match kind {
                            2 => T::of(before),
                            _ => T::of((offset + step * scale + before).min(highest)),
                        }
                    }
                };
            }
        }
        Ok(())
    }
}

/// The lowest value of a block, stored in the smallest type that holds it.
fn offset<T: Sample>(
    bytes: &mut Bytes<'_>,
    code: u8,
    is_difference: bool,
) -> Result<f64, LercError> {
    let own = match is_difference && T::TYPE < f32::TYPE {
        true => i32::TYPE,
        false => T::TYPE,
    };
    let code = i32::from(code);
    let kind = match own {
        // Short, int; unsigned short, unsigned int.
        2 | 4 => own - code,
        3 | 5 => own - 2 * code,
        6 if code > 0 => [i16::TYPE, u8::TYPE][usize::from(code > 1)],
        7 if code > 0 => own - 2 * code + 1,
        _ => own,
    };
    fn value<T: Sample>(bytes: &mut Bytes<'_>) -> Result<f64, LercError> {
        Ok(T::read(bytes.take(T::BYTES)?).get())
    }
    match kind {
        0 => value::<i8>(bytes),
        1 => value::<u8>(bytes),
        2 => value::<i16>(bytes),
        3 => value::<u16>(bytes),
        4 => value::<i32>(bytes),
        5 => value::<u32>(bytes),
        6 => value::<f32>(bytes),
        7 => value::<f64>(bytes),
        _ => Err(LercError::Damaged("an offset of unknown type")),
    }
}
