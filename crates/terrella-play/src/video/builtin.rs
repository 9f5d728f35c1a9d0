//! The built-in encoder: OpenH264 for the pictures, muxide for the MP4 around them.
//!
//! The MP4 writer keeps the encoded stream in memory until the end, because the index comes first in the file; that is
//! a few megabytes a minute, and bounded here.

use super::yuv::YuvPlanes;
use super::{FilmFrame, FrameSink, VideoFormat, write_error};
use crate::error::{PlayError, VideoError};
use crate::output::PendingFile;
use crate::written::Written;
use muxide::api::{Muxer, MuxerBuilder, VideoCodec};
use openh264::OpenH264API;
use openh264::encoder::{
    BitRate, Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange,
    RateControlMode, VuiConfig,
};
use std::fs::File;
use std::io::{BufWriter, Write};

/// The index holds 32-bit offsets; what is left below 4 GiB is room for the index itself.
const MAX_STREAM_BYTES: u64 = (1 << 32) - (1 << 27);
/// Aim for the size of the stream, bits for each pixel of each frame. A turning Earth on black comes out well below.
const BITS_PER_PIXEL: f64 = 0.15;
/// Seconds between frames that can be jumped to.
const KEY_FRAME_S: f64 = 2.0;

/// A video that is being encoded by this program.
pub struct BuiltinEncoder {
    encoder: Encoder,
    muxer: Muxer<BufWriter<File>>,
    planes: YuvPlanes,
    file: PendingFile,
    frame_rate_hz: f64,
    frames: u64,
    stream_bytes: u64,
    packet: Vec<u8>,
}

impl BuiltinEncoder {
    pub fn start(file: PendingFile, format: VideoFormat) -> Result<Self, PlayError> {
        let (width, height) = format.size;
        let (long, short) = (width.max(height), width.min(height));
        if long > 3840 || !(16..=2160).contains(&short) {
            return Err(VideoError::BuiltinSize { width, height }.into());
        }
        let failed = |cause: &dyn std::fmt::Display| VideoError::Builtin {
            path: file.target().into(),
            cause: cause.to_string(),
        };
        let rate = format.frame_rate_hz;
        let bits = f64::from(width) * f64::from(height) * rate * BITS_PER_PIXEL;
        let config = EncoderConfig::new()
            .bitrate(BitRate::from_bps(
                bits.clamp(200_000.0, 200_000_000.0) as u32
            ))
            .max_frame_rate(FrameRate::from_hz(rate as f32))
            // With frame skipping off it warns that it cannot hold a bit rate, which is not needed. See `quietly`.
            .rate_control_mode(RateControlMode::Quality)
            .qp(QpRange::new(10, 32))
            // A skipped frame would be one too few in the film.
            .skip_frames(false)
            .intra_frame_period(IntraFramePeriod::from_num_frames(
                (rate * KEY_FRAME_S) as u32,
            ))
            // One thread: the same frames give the same bytes, and drawing goes on beside it.
            .num_threads(1)
            .vui(VuiConfig::bt709());
        let mut encoder = Encoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(|error| failed(&error))?;
        let planes = YuvPlanes::new(width, height);
        // OpenH264 is set up with its first frame, and writes to standard error before its log level can be set: a discarded frame, while nothing
        // else runs yet.
        quietly(|| encoder.encode(&planes).map(drop)).map_err(|error| failed(&error))?;
        encoder.force_intra_frame();
        let muxer = MuxerBuilder::new(file.open()?)
            .video(VideoCodec::H264, width, height, rate)
            .with_fast_start(true)
            .build()
            .map_err(|error| failed(&error))?;
        Ok(Self {
            encoder,
            muxer,
            planes,
            file,
            frame_rate_hz: rate,
            frames: 0,
            stream_bytes: 0,
            packet: Vec::new(),
        })
    }

    fn failed(&self, cause: impl std::fmt::Display) -> PlayError {
        PlayError::Video(VideoError::Builtin {
            path: self.file.target().into(),
            cause: cause.to_string(),
        })
    }
}

impl FrameSink for BuiltinEncoder {
    fn push(&mut self, frame: &FilmFrame) -> Result<(), PlayError> {
        self.planes.fill(&frame.picture.shown());
        self.packet.clear();
        let kind = match self.encoder.encode(&self.planes) {
            Ok(stream) => {
                stream.write_vec(&mut self.packet);
                stream.frame_type()
            }
            Err(error) => return Err(self.failed(error)),
        };
        if self.packet.is_empty() {
            return Err(self.failed(format!("no data for frame {}", self.frames)));
        }
        self.stream_bytes += self.packet.len() as u64;
        if self.stream_bytes > MAX_STREAM_BYTES {
            return Err(PlayError::Video(VideoError::BuiltinLength {
                path: self.file.target().into(),
                limit_mib: MAX_STREAM_BYTES >> 20,
            }));
        }
        let time_s = self.frames as f64 / self.frame_rate_hz;
        let is_key = kind == FrameType::IDR;
        self.muxer
            .write_video(time_s, &self.packet, is_key)
            .map_err(|error| self.failed(error))?;
        self.frames += 1;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<Written, PlayError> {
        self.muxer
            .finish_in_place()
            .map_err(|error| self.failed(error))?;
        let Self { muxer, file, .. } = *self;
        muxer
            .into_writer()
            .flush()
            .map_err(|source| write_error(&file, source))?;
        let path = file.target().to_owned();
        file.commit()?;
        Ok(Written::file(path))
    }
}

/// Runs a function with standard error redirected to `/dev/null`, and restores it. If that fails, the messages are visible.
#[cfg(unix)]
fn quietly<T>(work: impl FnOnce() -> T) -> T {
    use rustix::stdio::{dup2_stderr, stderr};
    let kept = rustix::io::dup(stderr());
    let nowhere = File::options().write(true).open("/dev/null");
    let (Ok(kept), Ok(nowhere)) = (kept, nowhere) else {
        return work();
    };
    if let Err(error) = dup2_stderr(nowhere) {
        tracing::debug!("the encoder may speak: {error}");
        return work();
    }
    let done = work();
    // It worked the other way round.
    if let Err(error) = dup2_stderr(kept) {
        tracing::debug!("standard error stays closed: {error}");
    }
    done
}

/// Works; elsewhere there is no such way.
#[cfg(not(unix))]
fn quietly<T>(work: impl FnOnce() -> T) -> T {
    work()
}
