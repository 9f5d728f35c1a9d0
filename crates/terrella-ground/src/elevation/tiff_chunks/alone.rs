//! A strip or tile as a separate file: a single-strip image that the decoder reads like any other.

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::{TiffResult, tags::CompressionMethod};

/// Bytes of the header, and of a directory entry.
const HEADER_BYTES: u32 = 8;
const ENTRY_BYTES: u32 = 12;

/// Storage format of a strip or tile.
#[derive(Clone, Copy, Debug)]
pub(in crate::elevation) struct Alone {
    /// Pixels of a row, and rows.
    pub columns: u32,
    pub rows: u32,
    /// Samples per pixel, and bits per sample.
    pub samples: u16,
    pub bits: u16,
    /// TIFF's `SampleFormat`, `Compression` and `Predictor`.
    pub format: u16,
    pub compression: u16,
    pub predictor: u16,
    pub is_big_endian: bool,
}

impl Alone {
    /// The same without compression.
    pub fn uncompressed(self) -> Self {
        Self {
            compression: CompressionMethod::None.to_u16(),
            ..self
        }
    }

    /// The same as bytes, for samples that share them.
    pub fn of_bytes(self) -> Self {
        Self {
            columns: u32::try_from(self.row_bytes()).unwrap_or(u32::MAX),
            samples: 1,
            bits: 8,
            format: 1,
            ..self
        }
    }

    /// Bytes per stored row.
    pub fn row_bytes(&self) -> usize {
        let bits = u64::from(self.columns) * u64::from(self.samples) * u64::from(self.bits);
        // A longer row would not fit into memory anyway.
        usize::try_from(bits.div_ceil(8)).unwrap_or(usize::MAX)
    }

    /// Bytes of all rows.
    pub fn bytes(&self) -> usize {
        self.row_bytes().saturating_mul(self.rows as usize)
    }

    /// Decodes the data. Allocates the decoded size, and at most the data's size besides.
    pub fn decode(&self, data: &[u8]) -> TiffResult<DecodingResult> {
        let mut limits = Limits::default();
        limits.decoding_buffer_size = self.bytes();
        limits.intermediate_buffer_size = data.len();
        let file = std::io::Cursor::new(self.file(data));
        Decoder::new(file)?.with_limits(limits).read_chunk(0)
    }

    fn file(&self, data: &[u8]) -> Vec<u8> {
        // Callers check that it is below 2^29.
        let length = data.len() as u32;
        let entries = |strip_at: u32| {
            [
                (256, self.columns),
                (257, self.rows),
                (258, u32::from(self.bits)),
                (259, u32::from(self.compression)),
                // Values count from black.
                (262, 1),
                (273, strip_at),
                (277, u32::from(self.samples)),
                (278, self.rows),
                (279, length),
                (317, u32::from(self.predictor)),
                (339, u32::from(self.format)),
            ]
        };
        let count = entries(0).len() as u16;
        let strip_at = HEADER_BYTES + 2 + ENTRY_BYTES * u32::from(count) + 4;
        let mut file = Vec::with_capacity(strip_at as usize + data.len());
        file.extend(if self.is_big_endian { b"MM" } else { b"II" });
        let mut numbers = Numbers {
            file,
            is_big_endian: self.is_big_endian,
        };
        numbers.short(42);
        numbers.long(HEADER_BYTES);
        numbers.short(count);
        for (tag, value) in entries(strip_at) {
            numbers.short(tag);
            // One LONG.
            numbers.short(4);
            numbers.long(1);
            numbers.long(value);
        }
        numbers.long(0);
        let mut file = numbers.file;
        file.extend(data);
        file
    }
}

/// Numbers in the file's byte order.
struct Numbers {
    file: Vec<u8>,
    is_big_endian: bool,
}

impl Numbers {
    fn short(&mut self, value: u16) {
        self.file.extend(match self.is_big_endian {
            true => value.to_be_bytes(),
            false => value.to_le_bytes(),
        });
    }

    fn long(&mut self, value: u32) {
        self.file.extend(match self.is_big_endian {
            true => value.to_be_bytes(),
            false => value.to_le_bytes(),
        });
    }
}
