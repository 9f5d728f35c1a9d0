//! Checks that an MP4 is complete: ffmpeg may end without an error although the disk was full.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use terrella_files as files;

/// Path of boxes to the number of frames of a video.
const TO_SAMPLE_SIZES: [&[u8; 4]; 6] = [b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsz"];

/// What an MP4 of `frames` frames lacks, as text; `None` if it is complete. A file without an index of its frames is incomplete.
pub fn mp4_problem(path: &Path, frames: u64) -> Option<String> {
    match frames_in(path) {
        Ok(count) if count == frames => None,
        Ok(count) => Some(format!("it holds {count} of {frames} frames")),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Some("it is cut off".into()),
        Err(error) => Some(error.to_string()),
    }
}

/// The number of frames in an MP4 whose boxes are all there.
fn frames_in(path: &Path) -> io::Result<u64> {
    let mut file = files::open(path)?;
    let mut inside = 0..file.metadata()?.len();
    let kinds = boxes(&mut file, inside.clone())?;
    if !kinds.iter().any(|(kind, _)| kind == b"mdat") {
        return Err(incomplete("it is cut off"));
    }
    for kind in TO_SAMPLE_SIZES {
        let boxes = boxes(&mut file, inside)?;
        let found = boxes.into_iter().find(|(found, _)| found == kind);
        let (_, contents) = found.ok_or_else(|| incomplete("its index of frames is missing"))?;
        inside = contents;
    }
    // Version and flags, the common size or 0, and their number.
    file.seek(SeekFrom::Start(inside.start + 8))?;
    let mut count = [0; 4];
    file.read_exact(&mut count)?;
    Ok(u32::from_be_bytes(count).into())
}

/// The boxes in a part of a file, each with where its contents are.
fn boxes(file: &mut File, inside: Range<u64>) -> io::Result<Vec<([u8; 4], Range<u64>)>> {
    let mut found = Vec::new();
    let mut start = inside.start;
    while start < inside.end {
        let mut head = [0; 8];
        file.seek(SeekFrom::Start(start))?;
        file.read_exact(&mut head)?;
        let [a, b, c, d, kind @ ..] = head;
        let (head_bytes, bytes) = match u32::from_be_bytes([a, b, c, d]) {
            // The length has 64 bits and follows.
            1 => {
                let mut long = [0; 8];
                file.read_exact(&mut long)?;
                (16, u64::from_be_bytes(long))
            }
            bytes => (8, bytes.into()),
        };
        let end = start.checked_add(bytes);
        let end = end.filter(|end| bytes >= head_bytes && *end <= inside.end);
        let end = end.ok_or_else(|| incomplete("it is cut off"))?;
        found.push((kind, start + head_bytes..end));
        start = end;
    }
    Ok(found)
}

fn incomplete(why: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(kind: &[u8; 4], contents: &[u8]) -> Vec<u8> {
        let bytes = contents.len() as u32 + 8;
        [&bytes.to_be_bytes(), &kind[..], contents].concat()
    }

    fn video() -> Vec<u8> {
        let sizes = [0_u32, 0, 7].map(u32::to_be_bytes).concat();
        let index = TO_SAMPLE_SIZES
            .iter()
            .rev()
            .fold(sizes, |inner, kind| boxed(kind, &inner));
        let long = [
            &1_u32.to_be_bytes()[..],
            b"free",
            &20_u64.to_be_bytes(),
            b"long",
        ]
        .concat();
        [
            boxed(b"ftyp", b"isom"),
            long,
            index,
            boxed(b"mdat", &[0; 90]),
        ]
        .concat()
    }

    #[test]
    fn a_video_that_is_cut_anywhere_is_not_complete() {
        let root = tempfile::tempdir().expect("a folder");
        let path = root.path().join("a.mp4");
        let video = video();
        std::fs::write(&path, &video).expect("writes");
        assert_eq!(mp4_problem(&path, 7), None);
        let words = mp4_problem(&path, 8);
        assert_eq!(words.as_deref(), Some("it holds 7 of 8 frames"));
        for length in 0..video.len() {
            std::fs::write(&path, &video[..length]).expect("writes");
            assert!(mp4_problem(&path, 7).is_some(), "{length}");
        }
    }

    #[test]
    fn lengths_that_cannot_be_are_no_boxes() {
        let root = tempfile::tempdir().expect("a folder");
        let path = root.path().join("a.mp4");
        for head in [
            [&0_u32.to_be_bytes()[..], b"moov"].concat(),
            [&7_u32.to_be_bytes()[..], b"moov"].concat(),
            [&1_u32.to_be_bytes()[..], b"moov", &u64::MAX.to_be_bytes()].concat(),
        ] {
            std::fs::write(&path, head).expect("writes");
            assert!(mp4_problem(&path, 7).is_some());
        }
    }
}
