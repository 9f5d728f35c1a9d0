//! JPEG maps, decoded by MozJPEG a few lines at a time.
//!
//! libjpeg silently fills missing parts of a file with grey. The reader therefore checks the whole file before decoding; see [`jpeg`].

use super::sof::read_header;
use super::{
    Extent, FileContext, FileKind, RowSource, SampleKind, SourceInfo, SourceLimits, check_size,
};
use crate::error::BuildError;
use mozjpeg::Decompress;
use mozjpeg::decompress::DecompressStarted;
use std::cell::Cell;
use std::io::{BufRead, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;
use terrella_imagery::colour::Said;
use terrella_imagery::jpeg::{self, Fault};

/// Rows of a JPEG file.
pub(super) struct JpegRows<R: BufRead> {
    /// `None` after an error: the decoder must not be used then.
    decoder: Option<DecompressStarted<WatchedReader<R>>>,
    state: Rc<ReadState>,
    info: SourceInfo,
    context: FileContext,
    said: Said,
    given: u32,
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
        let said = check_whole(&mut reader, &context)?;
        context.check_turned(&said)?;
        rewind(&mut reader, &context)?;
        let state = Rc::new(ReadState::default());
        let reader = WatchedReader {
            inner: reader,
            state: Rc::clone(&state),
        };
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
        let row_bytes = header.width as u64 * channels as u64;
        let held = if header.in_strips {
            // Samples and coefficients of a few rows of coding units.
            8 * u64::from(header.unit().0) * row_bytes
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
                opacity: None,
                buffer_bytes: held,
            },
            context,
            said,
            given: 0,
        })
    }
}

fn rewind<R: Seek>(reader: &mut R, context: &FileContext) -> Result<(), BuildError> {
    let done = reader.seek(SeekFrom::Start(0));
    done.map(drop).map_err(|error| context.unreadable(error))
}

/// Checks the whole file.
fn check_whole<R: BufRead + Seek>(
    reader: &mut R,
    context: &FileContext,
) -> Result<Said, BuildError> {
    rewind(reader, context)?;
    jpeg::check(reader).map_err(|fault| match fault {
        Fault::Read(error) => context.unreadable(error),
        Fault::Damaged(cause) => context.damaged(cause),
    })
}

impl<R: BufRead> RowSource for JpegRows<R> {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn colour_note(&self) -> Option<String> {
        self.said.note()
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        let Some(mut decoder) = self.decoder.take() else {
            return Err(self.context.damaged("read on after an error"));
        };
        let is_last = self.given + 1 == self.info.height;
        self.decoder = guard(&self.context, &self.state, || {
            decoder.read_scanlines_into(row)?;
            if is_last {
                decoder.finish()?;
                return Ok(None);
            }
            Ok(Some(decoder))
        })?;
        self.given += 1;
        Ok(())
    }
}

/// Runs a step of the decoder, which reports errors by unwinding.
fn guard<T>(
    context: &FileContext,
    state: &ReadState,
    step: impl FnOnce() -> std::io::Result<T>,
) -> Result<T, BuildError> {
    // The step drops what it holds, or the caller discards it.
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

/// Reader state that bypasses the decoder.
#[derive(Default)]
struct ReadState {
    /// The decoder requested more than the file has, although it was complete before.
    ran_out: Cell<bool>,
    /// The system's error when reading failed.
    error: Cell<Option<std::io::Error>>,
}

/// Passes a file to the decoder, which treats some errors as the end of the file and invents the
/// rest.
struct WatchedReader<R> {
    inner: R,
    state: Rc<ReadState>,
}

impl<R: BufRead> Read for WatchedReader<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let bytes = self.fill_buf()?;
        let count = bytes.len().min(out.len());
        out[..count].copy_from_slice(&bytes[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for WatchedReader<R> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        match self.inner.fill_buf() {
            Ok([]) => {
                self.state.ran_out.set(true);
                Err(std::io::Error::other("the file ends too early"))
            }
            Ok(bytes) => Ok(bytes),
            Err(error) => {
                self.state.error.set(Some(error));
                Err(std::io::Error::other("unreadable"))
            }
        }
    }

    fn consume(&mut self, count: usize) {
        self.inner.consume(count);
    }
}
