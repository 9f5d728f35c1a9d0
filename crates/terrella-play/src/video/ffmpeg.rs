//! The `ffmpeg` program, fed with raw frames through a pipe.

use super::{FilmFrame, FrameSink, VideoCodec, VideoFormat, write_error};
use crate::error::{PlayError, VideoError};
use crate::mp4::mp4_problem;
use crate::output::PendingFile;
use crate::written::Written;
use std::io::{Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::thread::JoinHandle;
use terrella::{Hdr, HdrTransfer};

/// Bytes of ffmpeg's standard error that are kept for a message.
const MAX_STDERR_BYTES: usize = 2_000;

/// The ffmpeg on the search path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FfmpegInstalled {
    /// An ffmpeg with the requested encoder.
    WithEncoder,
    WithoutEncoder,
    /// None.
    No,
}

/// Looks for ffmpeg and checks that it has an encoder.
pub fn find(encoder: &str) -> FfmpegInstalled {
    let answer = Command::new("ffmpeg")
        .args(["-hide_banner", "-loglevel", "error", "-encoders"])
        .stdin(Stdio::null())
        .output();
    match answer {
        Ok(answer) if answer.status.success() => {
            let text = String::from_utf8_lossy(&answer.stdout);
            if text
                .lines()
                .any(|line| line.split_whitespace().nth(1) == Some(encoder))
            {
                FfmpegInstalled::WithEncoder
            } else {
                FfmpegInstalled::WithoutEncoder
            }
        }
        _ => FfmpegInstalled::No,
    }
}

/// A video that ffmpeg is encoding.
pub struct Ffmpeg {
    process: Process,
    file: PendingFile,
    /// Frames that it was given.
    frames: u64,
    hdr: Option<Hdr>,
}

/// Colours of a video, in ffmpeg's words.
struct Colors {
    /// Format of the frames that ffmpeg is given, and of those that the encoder gets.
    formats: [&'static str; 2],
    /// The matrix, as the filter that converts calls it and as streams do.
    matrix: [&'static str; 2],
    primaries: &'static str,
    transfer: &'static str,
}

impl Colors {
    fn of(hdr: Option<Hdr>) -> Self {
        let Some(hdr) = hdr else {
            return Self {
                formats: ["rgba", "yuv420p"],
                matrix: ["bt709", "bt709"],
                primaries: "bt709",
                transfer: "bt709",
            };
        };
        Self {
            formats: ["rgb48be", "yuv420p10le"],
            matrix: ["bt2020", "bt2020nc"],
            primaries: "bt2020",
            transfer: match hdr.transfer {
                HdrTransfer::Pq => "smpte2084",
                HdrTransfer::Hlg => "arib-std-b67",
            },
        }
    }

    /// Converts with the matrix and tags frames: without it ffmpeg would convert with BT.601, and since version 8 it ignores the tags among its
    /// options.
    fn filter(&self) -> String {
        let ([_, format], [converted, matrix]) = (self.formats, self.matrix);
        let (primaries, transfer) = (self.primaries, self.transfer);
        format!(
            "scale=out_color_matrix={converted}:out_range=tv,format={format},setparams=colorspace={matrix}:color_primaries={primaries}:color_trc={transfer}:range=tv"
        )
    }
}

/// A running ffmpeg; it is stopped when this is dropped.
struct Process {
    child: Child,
    /// `None` once all frames are given.
    input: Option<ChildStdin>,
    /// Collects ffmpeg's messages, so that its pipe never fills up.
    stderr_text: Option<JoinHandle<String>>,
}

impl Ffmpeg {
    pub fn start(file: PendingFile, format: VideoFormat) -> Result<Self, PlayError> {
        let (width, height) = format.size;
        let codec = format.coding.codec;
        let crf = format.coding.quality().to_string();
        // Settings of the encoders, and the tag by which Apple's players recognise H.265.
        let own: &[&str] = match codec {
            VideoCodec::H264 => &["-preset", "medium"],
            VideoCodec::H265 => &[
                "-preset",
                "medium",
                "-tag:v",
                "hvc1",
                "-x265-params",
                "log-level=error",
            ],
            VideoCodec::Av1 => &["-preset", "6"],
        };
        let colors = Colors::of(format.hdr);
        let mut child = Command::new("ffmpeg")
            .args(["-hide_banner", "-loglevel", "error", "-y"])
            .args(["-f", "rawvideo", "-pix_fmt", colors.formats[0]])
            .args(["-s", &format!("{width}x{height}")])
            .args(["-r", &format.frame_rate_hz.to_string()])
            .args(["-i", "pipe:0", "-an"])
            .args(["-vf", &colors.filter()])
            .args(["-c:v", codec.encoder()])
            .args(own)
            .args(["-crf", &crf])
            .args(["-colorspace", colors.matrix[1]])
            .args(["-color_primaries", colors.primaries])
            .args(["-color_trc", colors.transfer, "-color_range", "tv"])
            .args(["-movflags", "+faststart", "-f", "mp4"])
            .arg(file.temporary())
            // SVT-AV1 logs independently of ffmpeg.
            .env("SVT_LOG", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|source| VideoError::Ffmpeg {
                path: file.target().into(),
                status: "did not start".into(),
                words: source.to_string(),
            })?;
        let stderr_text = child
            .stderr
            .take()
            .map(|stderr| std::thread::spawn(move || last_lines(stderr)));
        let process = Process {
            input: child.stdin.take(),
            child,
            stderr_text,
        };
        Ok(Self {
            process,
            file,
            frames: 0,
            hdr: format.hdr,
        })
    }

    /// Waits for ffmpeg to end, and reports how if that was not well. Answers what it said.
    fn wait(&mut self) -> Result<String, PlayError> {
        let process = &mut self.process;
        // Ends its input.
        drop(process.input.take());
        let status = process
            .child
            .wait()
            .map_err(|source| write_error(&self.file, source))?;
        let stderr_text = process
            .stderr_text
            .take()
            .and_then(|thread| thread.join().ok())
            .unwrap_or_default();
        match status.success() {
            true => Ok(stderr_text),
            false => Err(self.failed(status.to_string(), stderr_text)),
        }
    }

    /// Checks the file that ffmpeg left: where the disk was full it may have ended without an error.
    fn check(&self, stderr_text: String) -> Result<(), PlayError> {
        match mp4_problem(self.file.temporary(), self.frames) {
            None => Ok(()),
            Some(problem) => {
                Err(self.failed(format!("the video is incomplete: {problem}"), stderr_text))
            }
        }
    }

    fn failed(&self, status: String, words: String) -> PlayError {
        PlayError::Video(VideoError::Ffmpeg {
            path: self.file.target().into(),
            status,
            words: match words.is_empty() {
                true => "it said nothing".into(),
                false => words,
            },
        })
    }
}

impl FrameSink for Ffmpeg {
    fn push(&mut self, frame: &FilmFrame) -> Result<(), PlayError> {
        let written = match &mut self.process.input {
            Some(input) => {
                let hdr = self.hdr.and_then(|hdr| frame.picture.shown_hdr(&hdr));
                match hdr {
                    Some(hdr) => input.write_all(&hdr.codes),
                    None => input.write_all(frame.picture.shown().as_raw()),
                }
            }
            None => Ok(()),
        };
        match written {
            Ok(()) => {
                self.frames += 1;
                Ok(())
            }
            // It closed its end: its own words are better than "broken pipe".
            Err(source) => Err(match self.wait() {
                Err(error) => error,
                Ok(_) => write_error(&self.file, source),
            }),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<Written, PlayError> {
        let words = self.wait()?;
        self.check(words)?;
        let path = self.file.target().to_owned();
        self.file.commit()?;
        Ok(Written::file(path))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        drop(self.input.take());
        // Both fail harmlessly where it has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The end of a program's output, on one line.
fn last_lines(mut source: impl Read) -> String {
    let mut kept = Vec::new();
    let mut buffer = [0; 1024];
    while let Ok(count @ 1..) = source.read(&mut buffer) {
        kept.extend_from_slice(&buffer[..count]);
        let excess = kept.len().saturating_sub(MAX_STDERR_BYTES);
        kept.drain(..excess);
    }
    let text = String::from_utf8_lossy(&kept);
    let lines: Vec<_> = text
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty())
        .collect();
    lines.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_lines_are_kept() {
        assert_eq!(last_lines(&b"one\n\n two \n"[..]), "one; two");
        let long = vec![b'x'; 100_000];
        assert_eq!(last_lines(long.as_slice()).len(), MAX_STDERR_BYTES);
    }
}
