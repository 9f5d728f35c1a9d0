//! Video in MP4: H.264, H.265 or AV1 by `ffmpeg` if it is installed, else H.264 by the built-in encoder.
//!
//! Both write 4:2:0 in BT.709, limited range, tagged as such; for high dynamic range only ffmpeg is used, with 10 bits in BT.2020. The index comes
//! before the data, so that a browser can start playback immediately. Subsampled chroma requires an even width and height.

mod builtin;
mod ffmpeg;
mod yuv;

use super::error::{PlayError, VideoError};
use super::film::{FilmPicture, FrameRecord};
use super::output::{OutputError, PendingFile};
use super::written::Written;
use terrella::Hdr;

/// A frame of a film, drawn.
pub struct FilmFrame {
    /// Its record without the file.
    pub record: FrameRecord,
    /// The image.
    pub picture: FilmPicture,
}

/// Takes frames in their order.
pub trait FrameSink: Send {
    /// Takes the next frame.
    fn push(&mut self, frame: &FilmFrame) -> Result<(), PlayError>;
    /// Called after all frames: completes the file, renames it and describes it. A sink that is dropped without this call leaves no incomplete file
    /// under a final name.
    fn finish(self: Box<Self>) -> Result<Written, PlayError>;
}

/// Choice of a video encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EncoderChoice {
    /// `ffmpeg` with libx264 if it is on the search path, else the built-in one.
    #[default]
    Auto,
    /// `ffmpeg` with libx264, or an error.
    Ffmpeg,
    /// OpenH264 and an MP4 writer inside this program.
    Builtin,
}

/// How a video is coded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VideoCodec {
    /// H.264 (AVC): played everywhere.
    #[default]
    H264,
    /// H.265 (HEVC).
    H265,
    /// AV1.
    Av1,
}

impl VideoCodec {
    /// ffmpeg's encoder.
    fn encoder(self) -> &'static str {
        match self {
            Self::H264 => "libx264",
            Self::H265 => "libx265",
            Self::Av1 => "libsvtav1",
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::H264 => "h264",
            Self::H265 => "h265",
            Self::Av1 => "av1",
        }
    }

    /// The worst quality there is; 0 is the best.
    pub fn max_crf(self) -> u32 {
        match self {
            Self::H264 | Self::H265 => 51,
            Self::Av1 => 63,
        }
    }

    /// A quality at which losses are hard to see.
    fn default_crf(self) -> u32 {
        match self {
            Self::H264 => 18,
            Self::H265 => 20,
            Self::Av1 => 24,
        }
    }
}

/// Codec and quality of a video.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VideoCoding {
    /// How it is coded.
    pub codec: VideoCodec,
    /// The encoder's constant quality, 0 (best) to [`VideoCodec::max_crf`]; `None` is one at which losses are hard to see.
    pub crf: Option<u32>,
}

impl VideoCoding {
    /// The encoder's constant quality, by default that of the codec.
    fn quality(self) -> u32 {
        self.crf.unwrap_or(self.codec.default_crf())
    }
}

/// Size, rate and coding of a video.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VideoFormat {
    /// Width and height, pixels, both even.
    pub size: (u32, u32),
    /// Frames per second.
    pub frame_rate_hz: f64,
    /// Codec and quality.
    pub coding: VideoCoding,
    /// How light of high dynamic range is coded; `None` is a picture that any screen shows.
    pub hdr: Option<Hdr>,
}

/// Rejects sizes that no video can have.
pub fn check_size(size: (u32, u32)) -> Result<(), VideoError> {
    let (width, height) = size;
    if width % 2 == 0 && height % 2 == 0 {
        return Ok(());
    }
    Err(VideoError::OddSize {
        width,
        height,
        even_width: width.next_multiple_of(2),
        even_height: height.next_multiple_of(2),
    })
}

/// Least width and height of SVT-AV1's videos, pixels.
const AV1_LEAST: u32 = 64;

/// Rejects sizes that a codec's encoder does not write.
fn check_codec_size(format: VideoFormat) -> Result<(), VideoError> {
    let (width, height) = format.size;
    match format.coding.codec == VideoCodec::Av1 && width.min(height) < AV1_LEAST {
        true => Err(VideoError::Av1Size { width, height }),
        false => Ok(()),
    }
}

/// Begins a video: chooses the encoder and starts it. Answers its name too.
pub fn open_video(
    file: PendingFile,
    format: VideoFormat,
    choice: EncoderChoice,
) -> Result<(Box<dyn FrameSink>, String), PlayError> {
    check_size(format.size)?;
    check_codec_size(format)?;
    // Players of H.264 decode 8 bits.
    if format.hdr.is_some() && format.coding.codec == VideoCodec::H264 {
        return Err(VideoError::HdrCodec.into());
    }
    let encoder = format.coding.codec.encoder();
    let found = match choice {
        EncoderChoice::Builtin => ffmpeg::FfmpegInstalled::No,
        EncoderChoice::Auto | EncoderChoice::Ffmpeg => ffmpeg::find(encoder),
    };
    // Settings that the built-in encoder does not support are not dropped silently.
    let needs_ffmpeg = format.coding != VideoCoding::default();
    let remedy = way_without_ffmpeg(format, choice);
    match (choice, found) {
        (EncoderChoice::Ffmpeg | EncoderChoice::Auto, ffmpeg::FfmpegInstalled::WithEncoder) => {
            let name = format!("ffmpeg, {encoder}, quality {}", format.coding.quality());
            Ok((Box::new(ffmpeg::Ffmpeg::start(file, format)?), name))
        }
        (EncoderChoice::Builtin, _) if needs_ffmpeg => Err(VideoError::BuiltinCoding.into()),
        (EncoderChoice::Ffmpeg, ffmpeg::FfmpegInstalled::WithoutEncoder) => {
            Err(VideoError::NoEncoder { encoder, remedy }.into())
        }
        (EncoderChoice::Auto, ffmpeg::FfmpegInstalled::WithoutEncoder) if needs_ffmpeg => {
            Err(VideoError::NoEncoder { encoder, remedy }.into())
        }
        (EncoderChoice::Ffmpeg, ffmpeg::FfmpegInstalled::No) => {
            Err(VideoError::NoFfmpeg { remedy }.into())
        }
        (EncoderChoice::Auto, ffmpeg::FfmpegInstalled::No) if needs_ffmpeg => {
            Err(VideoError::NoFfmpeg { remedy }.into())
        }
        (EncoderChoice::Auto | EncoderChoice::Builtin, _) => {
            let name = "the built-in encoder, OpenH264".to_owned();
            Ok((
                Box::new(builtin::BuiltinEncoder::start(file, format)?),
                name,
            ))
        }
    }
}

/// How a video can be made without ffmpeg: by the built-in encoder, which has one codec and one quality.
fn way_without_ffmpeg(format: VideoFormat, choice: EncoderChoice) -> String {
    if format.hdr.is_some() {
        return "write frames with --frames".to_owned();
    }
    let options = match (format.coding.codec, format.coding.crf) {
        (VideoCodec::H264, None) => {
            return "choose --encoder builtin, which writes H.264".to_owned();
        }
        (VideoCodec::H264, Some(_)) => "--crf",
        (_, None) => "--codec",
        (_, Some(_)) => "--codec and --crf",
    };
    match choice {
        EncoderChoice::Auto => format!("leave {options} out"),
        _ => format!("leave {options} out and choose --encoder builtin"),
    }
}

fn write_error(file: &PendingFile, source: std::io::Error) -> PlayError {
    OutputError::write(file.target(), source).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_sizes_are_rejected_with_an_even_one() {
        check_size((64, 36)).expect("even");
        let rejected = check_size((641, 360)).expect_err("odd").to_string();
        assert!(rejected.contains("642 × 360"), "{rejected}");
        assert!(check_size((640, 361)).is_err());
        let of = |codec, size| {
            check_codec_size(VideoFormat {
                size,
                frame_rate_hz: 30.0,
                coding: VideoCoding { codec, crf: None },
                hdr: None,
            })
        };
        of(VideoCodec::H264, (32, 16)).expect("small");
        of(VideoCodec::Av1, (64, 64)).expect("the least");
        let rejected = of(VideoCodec::Av1, (640, 62)).expect_err("too low");
        assert!(rejected.to_string().contains("64 × 64"), "{rejected}");
    }

    #[test]
    fn the_way_without_ffmpeg_leaves_out_what_only_it_has() {
        let way = |codec, crf, choice| {
            let format = VideoFormat {
                size: (64, 36),
                frame_rate_hz: 30.0,
                coding: VideoCoding { codec, crf },
                hdr: None,
            };
            way_without_ffmpeg(format, choice)
        };
        let (auto, asked) = (EncoderChoice::Auto, EncoderChoice::Ffmpeg);
        assert_eq!(way(VideoCodec::H264, Some(20), auto), "leave --crf out");
        assert_eq!(way(VideoCodec::H265, None, auto), "leave --codec out");
        assert_eq!(
            way(VideoCodec::Av1, Some(20), asked),
            "leave --codec and --crf out and choose --encoder builtin"
        );
        let builtin = way(VideoCodec::H264, None, asked);
        assert!(builtin.starts_with("choose --encoder builtin"), "{builtin}");
    }
}
