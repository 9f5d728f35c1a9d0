//! Checks that the scans of a JPEG contain the whole image.
//!
//! Decoders silently fill missing parts with grey as long as an end marker follows. The coded data are therefore checked here before decoding:
//! every block of every scan must be present, restart markers must be in order, nothing may be left over between the last block and the next
//! marker, and the scans of a progressive image must contain all bits of all coefficients. No sample is computed. Wrong bits that still decode
//! cannot be detected (ITU-T T.81).
//!
//! | file | content |
//! |---|---|
//! | `bits.rs` | bytes, and the bits of a scan up to its marker |
//! | `huffman.rs` | tables of codes |
//! | `frame.rs` | components, their blocks, and the bits received |
//! | `scan.rs` | a scan's blocks |

mod bits;
mod frame;
mod huffman;
mod scan;
#[cfg(test)]
mod tests;

use super::colour::Said;
use bits::Bytes;
use frame::Frame;
use huffman::Tables;
use scan::Scan;
use std::io::{self, Read};

/// Most bytes of a colour profile that are kept.
const PROFILE_BYTES: usize = 1 << 20;

/// Most scans of a picture. Encoders write ten or so; each costs a walk over all blocks.
const MAX_SCANS: u32 = 100;

/// Why a JPEG is not whole.
#[derive(Debug)]
pub enum Fault {
    /// It could not be read.
    Read(io::Error),
    /// It ends too early, or its data contradict themselves.
    Damaged(String),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
}

impl Fault {
    fn damaged(cause: impl Into<String>) -> Self {
        Self::Damaged(cause.into())
    }

    fn cut() -> Self {
        Self::damaged("the file ends too early")
    }
}

/// Walks a JPEG from its first byte to its end marker, and returns its colour metadata. Allocates eight bytes a block of a progressive image: the
/// size in its header must have been checked before.
pub fn check(reader: impl Read) -> Result<Said, Fault> {
    let mut walk = Walk::new(reader);
    walk.run()?;
    Ok(walk.said())
}

/// Colour metadata of a JPEG, from its segments up to the first scan.
pub(super) fn said(reader: impl Read) -> Result<Said, Fault> {
    let mut walk = Walk::new(reader);
    walk.header()?;
    Ok(walk.said())
}

/// How far a file has been walked.
struct Walk<R> {
    bytes: Bytes<R>,
    tables: Tables,
    frame: Option<Frame>,
    /// Coding units between two restart markers; 0 without any.
    restart_interval: u32,
    scans: u32,
    exif: Option<Vec<u8>>,
    profile: Vec<u8>,
}

impl<R: Read> Walk<R> {
    fn new(reader: R) -> Self {
        Self {
            bytes: Bytes::new(reader),
            tables: Tables::default(),
            frame: None,
            restart_interval: 0,
            scans: 0,
            exif: None,
            profile: Vec::new(),
        }
    }

    fn said(&self) -> Said {
        let profile = (!self.profile.is_empty()).then_some(self.profile.as_slice());
        Said::of_parts(self.exif.as_deref(), profile)
    }

    /// Takes the segments up to the first scan.
    fn header(&mut self) -> Result<(), Fault> {
        loop {
            match self.bytes.next_marker()? {
                0xD9 | 0xDA => return Ok(()),
                0x01 | 0xD0..=0xD8 => {}
                marker => self.segment(marker)?,
            }
        }
    }

    fn run(&mut self) -> Result<(), Fault> {
        let mut marker = self.bytes.next_marker()?;
        loop {
            marker = match marker {
                // End of image.
                0xD9 => return self.end(),
                // Start of scan.
                0xDA => self.scan()?,
                // Markers without a segment.
                0x01 | 0xD0..=0xD8 => self.bytes.next_marker()?,
                _ => {
                    self.segment(marker)?;
                    self.bytes.next_marker()?
                }
            };
        }
    }

    fn end(&self) -> Result<(), Fault> {
        let frame = self.frame.as_ref().filter(|_| self.scans > 0);
        frame
            .ok_or(Fault::damaged("it ends before any picture"))?
            .check_complete()
    }

    fn segment(&mut self, marker: u8) -> Result<(), Fault> {
        let segment = self.bytes.segment()?;
        match marker {
            0xC0..=0xC2 if self.frame.is_some() => {
                return Err(Fault::damaged("it has two frames"));
            }
            0xC0..=0xC2 => self.frame = Some(Frame::read(&segment, marker == 0xC2)?),
            0xC4 => self.tables.define(&segment)?,
            // Lossless, hierarchical or arithmetic.
            0xC3 | 0xC5..=0xCF => {
                return Err(Fault::damaged(format!(
                    "its coding (marker {marker:02X}) is none that decoders here know"
                )));
            }
            0xE1 => self.exif = self.exif.take().or_else(|| stripped(&segment, b"Exif\0\0")),
            0xE2 => {
                let piece = stripped(&segment, b"ICC_PROFILE\0").unwrap_or_default();
                // After its number and the total number.
                let piece = piece.get(2..).unwrap_or_default();
                if self.profile.len() + piece.len() <= PROFILE_BYTES {
                    self.profile.extend_from_slice(piece);
                }
            }
            0xDD => {
                let interval = segment.first_chunk().copied();
                let interval = interval.ok_or(Fault::damaged("a short restart segment"))?;
                self.restart_interval = u32::from(u16::from_be_bytes(interval));
            }
            _ => {}
        }
        Ok(())
    }

    /// Walks a scan, and gives the marker after it.
    fn scan(&mut self) -> Result<u8, Fault> {
        let header = self.bytes.segment()?;
        let frame = self.frame.as_mut();
        let frame = frame.ok_or(Fault::damaged("a scan before its frame"))?;
        self.scans += 1;
        if self.scans > MAX_SCANS {
            return Err(Fault::damaged(format!("more than {MAX_SCANS} scans")));
        }
        Scan::read(&header, frame, self.restart_interval)?.walk(
            frame,
            &self.tables,
            &mut self.bytes,
        )
    }
}

fn stripped(segment: &[u8], name: &[u8]) -> Option<Vec<u8>> {
    segment.strip_prefix(name).map(<[u8]>::to_vec)
}
