//! JPEG maps, decoded by MozJPEG some lines at a time.
//!
//! libjpeg takes a file that ends too early for a grey one: it makes up an end and fills the rest. Two things tell it
//! from a whole file here. [`ScanReader`] answers a read beyond the end with an error. And it hands out the data of a
//! scan apart from the marker that ends them, so it is seen whether the decoder asks for that marker long before the
//! last row. Wrong bits that still decode cannot be told from a picture.

use super::sof::{Header, read_header};
use super::{
    Extent, FileContext, FileKind, RowSource, SampleKind, SourceInfo, SourceLimits, check_size,
};
use crate::imagery::build::error::BuildError;
use mozjpeg::Decompress;
use mozjpeg::decompress::DecompressStarted;
use std::cell::Cell;
use std::io::{BufRead, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;

/// Rows of a JPEG file.
pub(super) struct JpegRows<R: BufRead> {
    /// `None` after an error: the decoder is not to be used then.
    decoder: Option<DecompressStarted<ScanReader<R>>>,
    state: Rc<ScanState>,
    info: SourceInfo,
    context: FileContext,
    given: u32,
    /// The decoder may ask for the end of the scan so many rows before the last.
    early_rows: u32,
}

impl<R: BufRead + Seek> JpegRows<R> {
    pub(super) fn open(
        mut reader: R,
        context: FileContext,
        limits: SourceLimits,
        extent: Extent,
    ) -> Result<Self, BuildError> {
        let header = read_header(&mut reader, &context)?;
        check_size(&context, header.width, header.height, extent)?;
        let coefficients = header.coefficient_bytes();
        if !header.in_strips && coefficients > limits.buffer_bytes {
            return Err(context.too_large(
                "a progressive JPEG (or one of several scans) cannot be read in strips: it",
                coefficients,
                limits,
                "convert it to baseline (`jpegtran -outfile OUT.jpg IN.jpg` loses nothing) or allow more --memory",
            ));
        }
        reader
            .seek(SeekFrom::Start(0))
            .map_err(|error| context.unreadable(error))?;
        let state = Rc::new(ScanState::default());
        let reader = ScanReader::new(reader, Rc::clone(&state), &header);
        let channels = header.sampling.len();
        let started = guard(&context, &state, || {
            let decoder = Decompress::new_reader(reader)?;
            if channels == 1 {
                decoder.grayscale()
            } else {
                decoder.rgb()
            }
        })?;
        if (started.width(), started.height()) != (header.width as usize, header.height as usize) {
            return Err(context.damaged("two headers of different sizes"));
        }
        // The decoder holds two rows of coding units for smooth chroma and looks eight bytes ahead, in which at most
        // 32 units lie.
        let (unit_rows, unit_columns) = header.unit();
        let units_per_row = header.width.div_ceil(unit_columns);
        let early_rows = unit_rows * (4 + 32_u32.div_ceil(units_per_row));
        let row_bytes = header.width as u64 * channels as u64;
        let held = if header.in_strips {
            // Samples and coefficients of a few rows of units.
            8 * u64::from(unit_rows) * row_bytes
        } else {
            coefficients
        };
        Ok(Self {
            decoder: Some(started),
            state,
            info: SourceInfo {
                file: FileKind::Jpeg,
                width: header.width,
                height: header.height,
                channels,
                sample: SampleKind::U8,
                buffer_bytes: held,
            },
            context,
            given: 0,
            early_rows,
        })
    }
}

impl<R: BufRead> RowSource for JpegRows<R> {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        let Some(mut decoder) = self.decoder.take() else {
            return Err(self.context.damaged("read on after an error"));
        };
        let is_last = self.given + 1 == self.info.height;
        let decoder = guard(&self.context, &self.state, || {
            decoder.read_scanlines_into(row)?;
            if is_last {
                decoder.finish()?;
                return Ok(None);
            }
            Ok(Some(decoder))
        })?;
        if self.state.end_seen.get() && self.given + self.early_rows < self.info.height {
            return Err(self.context.damaged(format!(
                "the picture's data end at row {} of {}",
                self.given, self.info.height
            )));
        }
        self.decoder = decoder;
        self.given += 1;
        Ok(())
    }
}

/// Runs a step of the decoder, which reports errors by unwinding.
fn guard<T>(
    context: &FileContext,
    state: &ScanState,
    step: impl FnOnce() -> std::io::Result<T>,
) -> Result<T, BuildError> {
    // What the step held is dropped in it or given up by the caller.
    let done = catch_unwind(AssertUnwindSafe(step));
    if let Some(error) = state.error.take() {
        return Err(context.unreadable(error));
    }
    if state.ran_out.get() {
        return Err(context.damaged("the file ends too early"));
    }
    match done {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(context.damaged(error)),
        Err(panic) => Err(context.damaged(match panic.downcast::<String>() {
            Ok(message) => *message,
            Err(_) => "the decoder gave up".to_string(),
        })),
    }
}

/// What the reader reports past the decoder.
#[derive(Default)]
struct ScanState {
    /// The decoder asked for the marker after the scan's data.
    end_seen: Cell<bool>,
    /// It asked for more than the file has.
    ran_out: Cell<bool>,
    /// The system's words when reading failed.
    error: Cell<Option<std::io::Error>>,
}

const SCAN_BUFFER: usize = 1 << 16;

/// Hands a file to the decoder: the header as it is, then the first scan's data up to its end, then the rest.
struct ScanReader<R> {
    inner: R,
    state: Rc<ScanState>,
    buffer: Box<[u8]>,
    /// `buffer[start..safe]` may be handed out; `buffer[safe..end]` has been read and not looked at.
    start: usize,
    safe: usize,
    end: usize,
    /// Bytes still to hand out before the scan's data begin; `None` once nothing is looked at any more.
    header_left: Option<u64>,
}

impl<R: BufRead> ScanReader<R> {
    fn new(inner: R, state: Rc<ScanState>, header: &Header) -> Self {
        Self {
            inner,
            state,
            buffer: vec![0; SCAN_BUFFER].into_boxed_slice(),
            start: 0,
            safe: 0,
            end: 0,
            header_left: header.in_strips.then_some(header.scan_start),
        }
    }

    /// Reads until there are at least two bytes to look at or the file is at its end.
    fn top_up(&mut self) -> std::io::Result<()> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        (self.start, self.safe) = (0, 0);
        while self.end < 2 {
            match self.inner.read(&mut self.buffer[self.end..]) {
                Ok(0) => break,
                Ok(count) => self.end += count,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Length of the data before the first marker that ends a scan, or before a last byte that may begin one.
    fn scan_data(bytes: &[u8]) -> usize {
        let mut at = 0;
        while let Some(found) = bytes[at..].iter().position(|byte| *byte == 0xFF) {
            at += found;
            match bytes.get(at + 1) {
                None => return at,
                // A data byte 255, or a restart marker.
                Some(0x00 | 0xD0..=0xD7) => at += 2,
                // Padding.
                Some(0xFF) => at += 1,
                Some(_) => return at,
            }
        }
        bytes.len()
    }
}

impl<R: BufRead> Read for ScanReader<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let bytes = self.fill_buf()?;
        let count = bytes.len().min(out.len());
        out[..count].copy_from_slice(&bytes[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for ScanReader<R> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.start == self.safe {
            if self.end - self.start < 2 {
                self.top_up().map_err(|error| {
                    let kind = error.kind();
                    self.state.error.set(Some(error));
                    // The decoder takes this very kind for an end of file and goes on.
                    if kind == std::io::ErrorKind::UnexpectedEof {
                        std::io::Error::other("unreadable")
                    } else {
                        kind.into()
                    }
                })?;
            }
            let bytes = &self.buffer[self.start..self.end];
            if bytes.is_empty() {
                self.state.ran_out.set(true);
                return Err(std::io::Error::other("the file ends too early"));
            }
            let count = match self.header_left {
                None => bytes.len(),
                Some(left @ 1..) => bytes.len().min(usize::try_from(left).unwrap_or(usize::MAX)),
                Some(0) => match Self::scan_data(bytes) {
                    0 => {
                        self.state.end_seen.set(true);
                        self.header_left = None;
                        bytes.len()
                    }
                    count => count,
                },
            };
            self.safe = self.start + count;
        }
        Ok(&self.buffer[self.start..self.safe])
    }

    fn consume(&mut self, count: usize) {
        let count = count.min(self.safe - self.start);
        self.start += count;
        if let Some(left) = &mut self.header_left {
            *left = left.saturating_sub(count as u64);
        }
    }
}
