//! Video: H.264 in MP4, by `ffmpeg` where it is installed, else by the built-in encoder.
//!
//! Both write 4:2:0 in BT.709, limited range, tagged as such, with the index before the data so that a browser can
//! begin to play at once. Half-size colour needs an even width and height.

mod builtin;
mod ffmpeg;
mod yuv;

use super::error::{PlayError, VideoError};
use super::film::FrameRecord;
use super::output::{OutputError, PendingFile};
use image::RgbaImage;

/// A frame of a film, drawn.
pub struct FilmFrame {
    /// What its page says of it, but for its file.
    pub record: FrameRecord,
    /// What is shown.
    pub picture: RgbaImage,
}

/// Takes frames in their order.
pub trait FrameSink: Send {
    /// Takes the next frame.
    fn push(&mut self, frame: &FilmFrame) -> Result<(), PlayError>;
    /// All frames were given: completes what is written and gives it its name. A sink that is dropped without it
    /// leaves no incomplete file under a final name.
    fn finish(self: Box<Self>) -> Result<(), PlayError>;
}

/// What encodes a video.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EncoderChoice {
    /// `ffmpeg` with libx264 if the search path has it, else the built-in one.
    #[default]
    Auto,
    /// `ffmpeg` with libx264, or an error.
    Ffmpeg,
    /// OpenH264 and an MP4 writer inside this program.
    Builtin,
}

/// Size and rate of a video.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VideoFormat {
    /// Width and height, pixels, both even.
    pub size: (u32, u32),
    /// Frames per second.
    pub frame_rate_hz: f64,
}

/// Refuses sizes that no video can have.
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

/// Begins a video: chooses the encoder and starts it.
pub fn open_video(
    file: PendingFile,
    format: VideoFormat,
    choice: EncoderChoice,
) -> Result<Box<dyn FrameSink>, PlayError> {
    check_size(format.size)?;
    let found = match choice {
        EncoderChoice::Builtin => ffmpeg::FfmpegInstalled::No,
        EncoderChoice::Auto | EncoderChoice::Ffmpeg => ffmpeg::find(),
    };
    match (choice, found) {
        (EncoderChoice::Ffmpeg | EncoderChoice::Auto, ffmpeg::FfmpegInstalled::WithX264) => {
            tracing::info!("encoding with ffmpeg, libx264");
            Ok(Box::new(ffmpeg::Ffmpeg::start(file, format)?))
        }
        (EncoderChoice::Ffmpeg, ffmpeg::FfmpegInstalled::WithoutX264) => {
            Err(VideoError::NoX264.into())
        }
        (EncoderChoice::Ffmpeg, ffmpeg::FfmpegInstalled::No) => Err(VideoError::NoFfmpeg.into()),
        (EncoderChoice::Auto | EncoderChoice::Builtin, _) => {
            tracing::info!("encoding with the built-in encoder, OpenH264");
            Ok(Box::new(builtin::BuiltinEncoder::start(file, format)?))
        }
    }
}

fn write_error(file: &PendingFile, source: std::io::Error) -> PlayError {
    OutputError::write(file.target(), source).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_sizes_are_refused_with_an_even_one() {
        check_size((64, 36)).expect("even");
        let refused = check_size((641, 360)).expect_err("odd").to_string();
        assert!(refused.contains("642 × 360"), "{refused}");
        assert!(check_size((640, 361)).is_err());
    }
}
