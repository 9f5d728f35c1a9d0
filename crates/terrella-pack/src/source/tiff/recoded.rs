//! A TIFF whose first directory appears with another photometric interpretation. The decoder rejects palettes, but accepts
//! grey images of the same bytes (TIFF 6.0, sections 2, 5 and 8; BigTIFF).

use std::io::{self, Read, Seek, SeekFrom};

const PHOTOMETRIC: u16 = 262;
const COLOR_MAP: u16 = 320;
const PALETTE: u16 = 3;
const BLACK_IS_ZERO: u16 = 1;

/// A file with up to two replaced bytes.
pub(super) struct Recoded<R> {
    inner: R,
    at: u64,
    patch: Option<(u64, [u8; 2])>,
}

impl<R: Read + Seek> Recoded<R> {
    /// The file unchanged, or with palette indices as grey. Also returns whether it has a palette. The decoder reports
    /// errors in the first directory.
    pub fn new(mut inner: R) -> io::Result<(Self, bool)> {
        let patch = grey_patch(&mut inner).ok().flatten();
        inner.seek(SeekFrom::Start(0))?;
        let recoded = Self {
            inner,
            at: 0,
            patch,
        };
        Ok((recoded, patch.is_some()))
    }
}

/// Position of the palette's photometric value in the first directory, and the bytes for grey. Grey with a palette counts as a palette, as
/// in GDAL.
fn grey_patch<R: Read + Seek>(file: &mut R) -> io::Result<Option<(u64, [u8; 2])>> {
    let mut head = [0; 8];
    file.seek(SeekFrom::Start(0))?;
    file.read_exact(&mut head)?;
    let mut numbers = Numbers {
        file,
        is_little: head[0] == b'I',
        is_wide: head[2..4].contains(&43),
    };
    let start = match numbers.is_wide {
        true => numbers.read(8)?,
        false => {
            numbers.file.seek(SeekFrom::Start(4))?;
            numbers.read(4)?
        }
    };
    numbers.file.seek(SeekFrom::Start(start))?;
    let (count_bytes, entry_bytes, value_at) = match numbers.is_wide {
        true => (8, 20, 12),
        false => (2, 12, 8),
    };
    let count = numbers.read(count_bytes)?.min(u64::from(u16::MAX));
    let mut grey_at = None;
    for n in 0..count {
        let entry = start
            .saturating_add(count_bytes as u64)
            .saturating_add(n * entry_bytes);
        numbers.file.seek(SeekFrom::Start(entry))?;
        match numbers.read(2)? {
            tag if tag == u64::from(COLOR_MAP) => return Ok(grey_at),
            tag if tag == u64::from(PHOTOMETRIC) => {}
            _ => continue,
        }
        // Writers never use types other than SHORT here.
        let is_short = numbers.read(2)? == 3;
        let value_at = entry.saturating_add(value_at);
        numbers.file.seek(SeekFrom::Start(value_at))?;
        let named = numbers.read(2)?;
        let is_palette = is_short && named == u64::from(PALETTE);
        let grey = match numbers.is_little {
            true => BLACK_IS_ZERO.to_le_bytes(),
            false => BLACK_IS_ZERO.to_be_bytes(),
        };
        if is_palette {
            return Ok(Some((value_at, grey)));
        }
        grey_at = (is_short && named == u64::from(BLACK_IS_ZERO)).then_some((value_at, grey));
    }
    Ok(None)
}

/// Numbers in the file's byte order.
struct Numbers<'a, R> {
    file: &'a mut R,
    is_little: bool,
    is_wide: bool,
}

impl<R: Read> Numbers<'_, R> {
    fn read(&mut self, bytes: usize) -> io::Result<u64> {
        let mut number = [0; 8];
        self.file.read_exact(&mut number[..bytes])?;
        if !self.is_little {
            number[..bytes].reverse();
        }
        Ok(u64::from_le_bytes(number))
    }
}

impl<R: Read> Read for Recoded<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(out)?;
        if let Some((start, bytes)) = self.patch {
            for (place, byte) in (start..).zip(bytes) {
                let at = place.checked_sub(self.at);
                let at = at.and_then(|at| usize::try_from(at).ok());
                if let Some(slot) = at.and_then(|at| out[..count].get_mut(at)) {
                    *slot = byte;
                }
            }
        }
        self.at += count as u64;
        Ok(count)
    }
}

impl<R: Seek> Seek for Recoded<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.inner.seek(to)?;
        Ok(self.at)
    }
}
