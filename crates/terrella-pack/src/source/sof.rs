//! The header of a JPEG file up to its first scan: enough to decide whether it can be read in
//! strips.

use super::FileContext;
use crate::error::BuildError;
use std::io::{BufRead, ErrorKind, Seek, SeekFrom};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub width: u32,
    pub height: u32,
    /// Horizontal and vertical sampling of each component, 1…4.
    pub sampling: Vec<(u32, u32)>,
    /// One scan contains everything, row by row. Otherwise the coefficients of the whole map must be in
    /// memory.
    pub in_strips: bool,
}

impl Header {
    /// Rows and columns of texels that one coding unit covers.
    pub(super) fn unit(&self) -> (u32, u32) {
        let most = |of: fn(&(u32, u32)) -> u32| self.sampling.iter().map(of).max().unwrap_or(1);
        (8 * most(|s| s.1), 8 * most(|s| s.0))
    }

    /// Bytes of all coefficients: two per sample, in whole coding units.
    pub(super) fn coefficient_bytes(&self) -> u64 {
        let (rows, columns) = self.unit();
        let units = u64::from(self.height.div_ceil(rows)) * u64::from(self.width.div_ceil(columns));
        let blocks: u32 = self.sampling.iter().map(|(h, v)| h * v).sum();
        units * u64::from(blocks) * 128
    }
}

/// Reads the header; the reader's position is undefined afterwards.
pub(super) fn read_header<R: BufRead + Seek>(
    reader: &mut R,
    context: &FileContext,
) -> Result<Header, BuildError> {
    // The two bytes of start-of-image were already checked.
    reader
        .seek(SeekFrom::Start(2))
        .map_err(|error| context.unreadable(error))?;
    let mut header: Option<Header> = None;
    let mut is_progressive = false;
    loop {
        let marker = next_marker(reader, context)?;
        if matches!(marker, 0x01 | 0xD0..=0xD8) {
            continue;
        }
        if marker == 0xD9 {
            return Err(context.damaged("it ends before any picture"));
        }
        let length = usize::from(u16::from_be_bytes(bytes(reader, context)?));
        let Some(length) = length.checked_sub(2) else {
            return Err(context.damaged("a segment of no length"));
        };
        match marker {
            // Start of frame: Huffman or arithmetic, all kinds.
            0xC0..=0xC3 | 0xC5..=0xC7 | 0xC9..=0xCB | 0xCD..=0xCF => {
                if !matches!(marker, 0xC0..=0xC2) {
                    return Err(context.rejected(
                        "is a lossless, hierarchical or arithmetic JPEG",
                        "save it as a baseline JPEG or a PNG",
                    ));
                }
                is_progressive = marker == 0xC2;
                header = Some(frame(&segment(reader, length, context)?, context)?);
            }
            // Start of scan.
            0xDA => {
                let scan = segment(reader, length, context)?;
                let Some(mut header) = header else {
                    return Err(context.damaged("a scan before its frame"));
                };
                let components = scan.first().copied().map_or(0, usize::from);
                header.in_strips = !is_progressive && components == header.sampling.len();
                return Ok(header);
            }
            _ => {
                // At most 65 533 bytes.
                reader
                    .seek_relative(length as i64)
                    .map_err(|error| context.unreadable(error))?;
            }
        }
    }
}

fn frame(segment: &[u8], context: &FileContext) -> Result<Header, BuildError> {
    let [precision, h0, h1, w0, w1, count, components @ ..] = segment else {
        return Err(context.damaged("a short frame header"));
    };
    if *precision != 8 {
        return Err(context.rejected(
            format!("is a JPEG of {precision} bits"),
            "save it with 8 bits or as a PNG",
        ));
    }
    let sampling: Vec<_> = components
        .as_chunks::<3>()
        .0
        .iter()
        .map(|[_, factors, _]| (u32::from(factors >> 4), u32::from(factors & 15)))
        .collect();
    if sampling.len() != usize::from(*count)
        || sampling
            .iter()
            .any(|(h, v)| !(1..=4).contains(h) || !(1..=4).contains(v))
    {
        return Err(context.damaged("a frame header of wrong components"));
    }
    if !matches!(sampling.len(), 1 | 3) {
        return Err(context.rejected(
            format!("has {} components (CMYK?)", sampling.len()),
            "convert it to grey or sRGB",
        ));
    }
    Ok(Header {
        width: u32::from(u16::from_be_bytes([*w0, *w1])),
        height: u32::from(u16::from_be_bytes([*h0, *h1])),
        sampling,
        in_strips: false,
    })
}

/// The next marker's code; bytes between segments are skipped.
fn next_marker<R: BufRead>(reader: &mut R, context: &FileContext) -> Result<u8, BuildError> {
    loop {
        let [mut byte] = bytes(reader, context)?;
        while byte == 0xFF {
            [byte] = bytes(reader, context)?;
            if !matches!(byte, 0x00 | 0xFF) {
                return Ok(byte);
            }
        }
    }
}

fn segment<R: BufRead>(
    reader: &mut R,
    length: usize,
    context: &FileContext,
) -> Result<Vec<u8>, BuildError> {
    let mut segment = vec![0; length];
    fill(reader, &mut segment, context)?;
    Ok(segment)
}

fn bytes<const N: usize, R: BufRead>(
    reader: &mut R,
    context: &FileContext,
) -> Result<[u8; N], BuildError> {
    let mut bytes = [0; N];
    fill(reader, &mut bytes, context)?;
    Ok(bytes)
}

fn fill<R: BufRead>(
    reader: &mut R,
    bytes: &mut [u8],
    context: &FileContext,
) -> Result<(), BuildError> {
    reader.read_exact(bytes).map_err(|error| {
        if error.kind() == ErrorKind::UnexpectedEof {
            context.damaged("the file ends in its header")
        } else {
            context.unreadable(error)
        }
    })
}
