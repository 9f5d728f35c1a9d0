//! Bytes of a file, and the bits of a scan up to its marker.

use super::Fault;
use std::io::Read;

const BUFFER_BYTES: usize = 1 << 16;

/// Reads bytes one by one.
pub(super) struct Bytes<R> {
    inner: R,
    buffer: Box<[u8]>,
    at: usize,
    end: usize,
}

impl<R: Read> Bytes<R> {
    pub fn new(inner: R) -> Self {
        Self {
            inner,
            buffer: vec![0; BUFFER_BYTES].into_boxed_slice(),
            at: 0,
            end: 0,
        }
    }

    /// `None` at the end of the file.
    #[inline]
    fn next(&mut self) -> Result<Option<u8>, Fault> {
        if self.at == self.end {
            self.fill()?;
        }
        let byte = self.buffer[..self.end].get(self.at).copied();
        self.at += usize::from(byte.is_some());
        Ok(byte)
    }

    /// The next eight bytes as a number, if none of them is FF and so all are data; `None` if unknown.
    #[inline]
    fn word(&self) -> Option<u64> {
        const ONES: u64 = u64::from_ne_bytes([0x01; 8]);
        const TOPS: u64 = u64::from_ne_bytes([0x80; 8]);
        let next = self.buffer[..self.end].get(self.at..)?.first_chunk()?;
        let word = u64::from_be_bytes(*next);
        // A byte of zeros in the complement borrows into its top bit, which it has not itself.
        let has_ff = (!word).wrapping_sub(ONES) & word & TOPS != 0;
        (!has_ff).then_some(word)
    }

    #[cold]
    fn fill(&mut self) -> Result<(), Fault> {
        (self.at, self.end) = (0, 0);
        loop {
            match self.inner.read(&mut self.buffer) {
                Ok(count) => {
                    self.end = count;
                    return Ok(());
                }
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn needed(&mut self) -> Result<u8, Fault> {
        self.next()?.ok_or_else(Fault::cut)
    }

    /// The next marker's code. Bytes between segments are skipped: no picture depends on them.
    pub fn next_marker(&mut self) -> Result<u8, Fault> {
        loop {
            let mut byte = self.needed()?;
            while byte == 0xFF {
                byte = self.needed()?;
                if !matches!(byte, 0x00 | 0xFF) {
                    return Ok(byte);
                }
            }
        }
    }

    /// The contents of a segment, at most 65 533 bytes.
    pub fn segment(&mut self) -> Result<Vec<u8>, Fault> {
        let length = u16::from_be_bytes([self.needed()?, self.needed()?]);
        let length = length
            .checked_sub(2)
            .ok_or(Fault::damaged("a segment of no length"))?;
        (0..length).map(|_| self.needed()).collect()
    }
}

/// The bits of a scan. Inside a scan a byte FF is followed by 00; anything else is a marker.
pub(super) struct Bits<'a, R> {
    bytes: &'a mut Bytes<R>,
    /// The next bits, the first at the top; zeros after the last.
    window: u64,
    count: u32,
    /// The marker that the data end at.
    marker: Option<u8>,
    is_at_end: bool,
}

impl<'a, R: Read> Bits<'a, R> {
    pub fn new(bytes: &'a mut Bytes<R>) -> Self {
        Self {
            bytes,
            window: 0,
            count: 0,
            marker: None,
            is_at_end: false,
        }
    }

    /// Reads on until more than 56 bits are at hand, or the data are over.
    #[inline]
    fn fill(&mut self) -> Result<(), Fault> {
        if let Some(word) = self.bytes.word()
            && self.marker.is_none()
            && self.count <= 56
        {
            let bytes = (64 - self.count) / 8;
            self.count += 8 * bytes;
            // Nothing is left of the bytes that have no room.
            let rest = u64::MAX.checked_shr(self.count).unwrap_or(0);
            self.window |= word >> (self.count - 8 * bytes) & !rest;
            self.bytes.at += bytes as usize;
            return Ok(());
        }
        while self.count <= 56 && self.marker.is_none() && !self.is_at_end {
            match self.bytes.next()? {
                Some(0xFF) => self.fill_marked()?,
                Some(byte) => self.push(byte),
                None => self.is_at_end = true,
            }
        }
        Ok(())
    }

    #[inline]
    fn push(&mut self, byte: u8) {
        self.window |= u64::from(byte) << (56 - self.count);
        self.count += 8;
    }

    /// After a byte FF: a data byte 255, or a marker with any number of FF before it.
    #[cold]
    fn fill_marked(&mut self) -> Result<(), Fault> {
        let mut byte = self.bytes.next()?;
        while byte == Some(0xFF) {
            byte = self.bytes.next()?;
        }
        match byte {
            Some(0x00) => self.push(0xFF),
            Some(marker) => self.marker = Some(marker),
            None => self.is_at_end = true,
        }
        Ok(())
    }

    /// The next 16 bits, zeros beyond the last.
    #[inline]
    pub fn peek_16(&mut self) -> Result<u16, Fault> {
        if self.count < 16 {
            self.fill()?;
        }
        Ok((self.window >> 48) as u16)
    }

    /// The next 32 bits at the top, zeros beyond the last.
    #[inline]
    pub fn peek_32(&mut self) -> Result<u64, Fault> {
        if self.count < 32 {
            self.fill()?;
        }
        Ok(self.window)
    }

    /// Skips at most 32 bits. False if there are not as many.
    #[inline]
    #[must_use]
    pub fn skip(&mut self, count: u32) -> bool {
        let is_there = count <= self.count;
        if is_there {
            self.window <<= count;
            self.count -= count;
        }
        is_there
    }

    /// The value of at most 16 bits; `None` if there are not as many.
    #[inline]
    pub fn take(&mut self, count: u32) -> Result<Option<u32>, Fault> {
        let value = u32::from(self.peek_16()?) >> (16 - count);
        Ok(self.skip(count).then_some(value))
    }

    /// The marker after the data, of which less than a byte may be left, and no bit from then on.
    pub fn end(&mut self) -> Result<u8, Fault> {
        self.fill()?;
        if self.count >= 8 {
            return Err(Fault::damaged("its data do not end with their last block"));
        }
        (self.window, self.count) = (0, 0);
        self.marker.take().ok_or_else(Fault::cut)
    }
}
