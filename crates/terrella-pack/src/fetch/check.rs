//! Checks of an image before it is kept: its format, its size, and its completeness.

use super::source::Media;
use crate::error::BuildError;
use crate::source::{Extent, SourceLimits, open_extent};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use terrella_files as files;

/// Bytes at both ends of a file that are looked at. A JPEG may have much before its size.
const HEAD_BYTES: u64 = 256 << 10;
const TAIL_BYTES: u64 = 4096;

/// Most memory for the rows of a picture that is looked at, bytes.
const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 256 << 20,
};

/// An error in an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Complaint {
    /// It has been damaged on its way, and may come whole the next time.
    Damaged(String),
    /// It is another one than was described.
    Other(String),
}

impl Complaint {
    pub(super) fn text(self) -> String {
        match self {
            Self::Damaged(text) | Self::Other(text) => text,
        }
    }
}

/// The error in an image, if any. It is decoded completely; one that exceeds [`LIMITS`] is only checked at both ends. `size` is the required width
/// and height, texels.
pub(super) fn complaint(
    path: &Path,
    media: Media,
    size: Option<u32>,
) -> std::io::Result<Option<Complaint>> {
    let mut file = files::open(path)?;
    let length = file.metadata()?.len();
    let mut head = Vec::new();
    (&mut file).take(HEAD_BYTES).read_to_end(&mut head)?;
    let mut tail = Vec::new();
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL_BYTES)))?;
    file.take(TAIL_BYTES).read_to_end(&mut tail)?;
    Ok(of_ends(&head, &tail, media, size).or_else(|| undecoded(path, media)))
}

/// Passes each row of an image, and the number of bytes of a texel, to `each`, until that returns false.
fn rows(path: &Path, mut each: impl FnMut(&[u8], usize) -> bool) -> Result<(), BuildError> {
    let mut source = open_extent(path, LIMITS, Extent::Piece)?;
    let info = source.info();
    let mut row = vec![0; info.row_bytes()];
    let texel_bytes = info.channels * info.sample.bytes();
    for _ in 0..info.height {
        source.next_row(&mut row)?;
        if !each(&row, texel_bytes) {
            break;
        }
    }
    Ok(())
}

/// Decoding errors of an image that indicate damage. Files of lists may have formats that only `pack build` interprets.
fn undecoded(path: &Path, media: Media) -> Option<Complaint> {
    if media == Media::Tiff {
        return None;
    }
    match rows(path, |_, _| true) {
        Err(BuildError::Damaged { cause, .. }) => {
            Some(Complaint::Damaged(format!("it cannot be decoded: {cause}")))
        }
        _ => None,
    }
}

/// Whether all texels of a picture are one colour, as open sea and space are.
pub(super) fn is_plain_colour(path: &Path) -> bool {
    let (mut first, mut is_plain) = (Vec::new(), true);
    let read = rows(path, |row, texel_bytes| {
        let mut texels = row.chunks_exact(texel_bytes);
        if first.is_empty() {
            first.extend_from_slice(&row[..texel_bytes]);
        }
        is_plain &= texels.all(|texel| texel == first);
        is_plain
    });
    // A picture that cannot be read is reported where it is decoded.
    is_plain || read.is_err()
}

/// The same of a file's first and last bytes.
fn of_ends(head: &[u8], tail: &[u8], media: Media, size: Option<u32>) -> Option<Complaint> {
    let (is_kind, is_whole, found) = match media {
        Media::Png => (
            head.starts_with(b"\x89PNG\r\n\x1a\n"),
            tail.windows(8).any(|end| end == b"IEND\xae\x42\x60\x82"),
            png_size(head),
        ),
        Media::Jpeg => (
            head.starts_with(&[0xFF, 0xD8, 0xFF]),
            // Some writers pad the end.
            tail.iter()
                .rposition(|byte| *byte != 0)
                .is_some_and(|end| end > 0 && tail[end - 1..=end] == [0xFF, 0xD9]),
            jpeg_size(head),
        ),
        Media::Tiff => (
            matches!(
                head,
                [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..]
            ),
            true,
            None,
        ),
    };
    if !is_kind {
        let begin: String = head.iter().take(24).map(|byte| char::from(*byte)).collect();
        return Some(Complaint::Other(format!(
            "it is no {} but begins with {:?}",
            media.name(),
            begin.escape_debug().to_string()
        )));
    }
    if let Some(side) = size {
        match found {
            Some(found) if found == (side, side) => {}
            Some((width, height)) => {
                return Some(Complaint::Other(format!(
                    "it has {width} x {height} texels and must have {side} x {side}"
                )));
            }
            None => {
                let cause = "its header does not tell its size".to_string();
                return Some(Complaint::Other(cause));
            }
        }
    }
    (!is_whole).then(|| Complaint::Damaged("it breaks off".to_string()))
}

/// Width and height of a PNG by its header.
fn png_size(head: &[u8]) -> Option<(u32, u32)> {
    let number = |at: usize| Some(u32::from_be_bytes(head.get(at..at + 4)?.try_into().ok()?));
    (head.get(12..16)? == b"IHDR").then_some(())?;
    Some((number(16)?, number(20)?))
}

/// Width and height of a JPEG by its frame header (ITU-T T.81, B.2.2).
fn jpeg_size(head: &[u8]) -> Option<(u32, u32)> {
    let mut at = 2;
    loop {
        let [0xFF, marker] = *head.get(at..at + 2)? else {
            return None;
        };
        if marker == 0xFF {
            at += 1;
            continue;
        }
        let length = usize::from(u16::from_be_bytes(
            head.get(at + 2..at + 4)?.try_into().ok()?,
        ));
        let is_frame = matches!(marker, 0xC0..=0xCF) && !matches!(marker, 0xC4 | 0xC8 | 0xCC);
        if is_frame {
            let number = |at: usize| {
                Some(u32::from(u16::from_be_bytes(
                    head.get(at..at + 2)?.try_into().ok()?,
                )))
            };
            return Some((number(at + 7)?, number(at + 5)?));
        }
        if length < 2 {
            return None;
        }
        at += 2 + length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JPEG: &[u8] = include_bytes!("../../../../tests/data/maps/baseline.jpg");
    const PNG: &[u8] = include_bytes!("../../../../tests/data/maps/palette.png");

    fn said(bytes: &[u8], media: Media, size: Option<u32>) -> String {
        let tail = &bytes[bytes.len().saturating_sub(TAIL_BYTES as usize)..];
        of_ends(bytes, tail, media, size).map_or_else(String::new, Complaint::text)
    }

    #[test]
    fn whole_pictures_are_good() {
        assert_eq!(said(JPEG, Media::Jpeg, None), "");
        assert_eq!(said(PNG, Media::Png, None), "");
        let padded = [JPEG, &[0, 0, 0]].concat();
        assert_eq!(said(&padded, Media::Jpeg, None), "");
        assert_eq!(jpeg_size(JPEG), Some((64, 32)));
        assert_eq!(png_size(PNG), Some((64, 32)));
    }

    #[test]
    fn others_are_reported() {
        for (bytes, media, size, words) in [
            (JPEG, Media::Png, None, "no image/png"),
            (
                b"<html>".as_slice(),
                Media::Jpeg,
                None,
                "begins with \"<html>",
            ),
            (b"".as_slice(), Media::Png, None, "begins with"),
            (&JPEG[..JPEG.len() - 1], Media::Jpeg, None, "breaks off"),
            (&PNG[..PNG.len() - 4], Media::Png, None, "breaks off"),
            (
                JPEG,
                Media::Jpeg,
                Some(512),
                "64 x 32 texels and must have 512 x 512",
            ),
            (&PNG[..14], Media::Png, Some(8), "does not tell its size"),
        ] {
            let found = said(bytes, media, size);
            assert!(found.contains(words), "{words}: {found}");
        }
    }
}
