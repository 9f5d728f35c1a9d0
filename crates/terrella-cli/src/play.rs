//! `terrella play`

use super::interruption::{do_first, stop_by_itself};
use super::picture_args::PictureArgs;
use super::progress::Bars;
use super::scene_args::{SatelliteArgs, SceneArgs, begin, open_flight};
use super::serve::simulation_scene;
use super::values;
use super::{Common, reject_usage};
use clap::error::ErrorKind;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella_orbit::basilisk::Endpoint;
use terrella_play::scene::Setting;
use terrella_play::{
    EncoderChoice, Existing, ExportRequest, Flight, FrameRange, RawFilmRequest, RawFormat,
    VideoCodec, VideoCoding, WindowRequest, export, play_in_window, write_raw_film,
};

/// The subcommand, for messages about its usage.
const NAME: &str = "play";

/// Arguments of `terrella play`.
#[derive(Debug, Args)]
pub struct PlayArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SatelliteArgs,
    /// Start time in UTC, for example 2026-11-25T05:00:00Z, "2026-11-25 05:00" or 2026-11-25, or now [default: the scene's]
    #[arg(long, value_name = "TIME", value_parser = values::instant)]
    start: Option<Epoch>,
    /// Length of the film or playback in seconds of simulated time [default: the scene's]
    #[arg(long, value_name = "SECONDS", value_parser = values::simulated_seconds, conflicts_with = "listen")]
    duration: Option<f64>,
    /// Address that Basilisk simulations connect to [default: the scene's]; without a scene, plays the built-in config/basilisk.toml
    #[arg(long, value_name = "tcp://ADDRESS:PORT")]
    listen: Option<Endpoint>,
    /// Write every frame as an image into this folder instead of opening a window
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
    /// Write the raw frame of the scene's [sensor] for every frame into this folder instead of opening a window, each with its parameters as JSON
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["frames", "video", "size"])]
    raw: Option<PathBuf>,
    /// With --raw: the format of raw frames
    #[arg(long, value_enum, default_value_t = Raw::Tiff, requires = "raw")]
    raw_format: Raw,
    /// With --frames or --raw: accept a folder that is not empty, and replace frames in it
    #[arg(long)]
    overwrite: bool,
    /// With --frames or --raw: resume the film in this folder: keep complete frames and render the missing ones
    #[arg(long, conflicts_with_all = ["overwrite", "video"])]
    resume: bool,
    /// Render only these frames: FIRST..END excludes END, FIRST..=LAST includes LAST; either number may be omitted
    #[arg(long, value_name = "RANGE", value_parser = values::frame_range)]
    range: Option<FrameRange>,
    #[command(flatten)]
    pictures: PictureArgs,
    /// Write an MP4 video instead of opening a window
    #[arg(long, value_name = "FILE.mp4")]
    video: Option<PathBuf>,
    /// With --video: the encoder
    #[arg(long, value_enum, default_value_t = Encoder::Auto, requires = "video")]
    encoder: Encoder,
    /// With --video: the codec; h265 and av1 need ffmpeg
    #[arg(long, value_enum, default_value_t = Codec::H264, requires = "video")]
    codec: Codec,
    /// With --video: constant quality of ffmpeg's encoders, 0 (best) to 51, for av1 to 63 [default: 18 for h264, 20 for h265, 24 for av1]
    #[arg(long, value_name = "N", requires = "video", value_parser = clap::value_parser!(u32).range(0..=63))]
    crf: Option<u32>,
    /// Width and height in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// Close the window after this many seconds
    #[arg(long, value_name = "N", value_parser = values::seconds, conflicts_with_all = ["frames", "raw", "video"])]
    for_seconds: Option<f64>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Encoder {
    /// ffmpeg if it is installed, otherwise builtin
    Auto,
    /// The installed ffmpeg
    Ffmpeg,
    /// Built-in OpenH264, up to 3840x2160
    Builtin,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Raw {
    /// 16-bit greyscale TIFF
    Tiff,
    /// 16-bit greyscale PNG
    Png,
    /// NumPy array
    Npy,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Codec {
    /// H.264 (AVC), which plays everywhere
    H264,
    /// H.265 (HEVC)
    H265,
    /// AV1
    Av1,
}

impl Codec {
    fn codec(self) -> VideoCodec {
        match self {
            Self::H264 => VideoCodec::H264,
            Self::H265 => VideoCodec::H265,
            Self::Av1 => VideoCodec::Av1,
        }
    }
}

/// Opens the window, or writes frames and video.
pub fn run(args: &PlayArgs, common: &Common) -> anyhow::Result<()> {
    reject_conflicts(args);
    let names = &args.satellites.satellite;
    let duration = args
        .duration
        .map(|seconds| Setting::new("time", "duration_s", seconds));
    let mut scene = match &args.listen {
        Some(listen) => {
            let path = args.scene.path.as_deref();
            simulation_scene(
                path,
                Some(listen),
                args.scene.strict,
                &args.scene.settings.set,
            )?
        }
        None => args.scene.load_with(names, duration.as_slice())?,
    };
    args.satellites.reject_scenes(NAME, &scene);
    if let Some(start) = args.start {
        begin(NAME, &mut scene, start)?;
    }
    let flight = open_flight(scene, Flight::open)?;
    // Whoever waits is answered before the program ends.
    if let Some(simulation) = flight.simulation() {
        do_first(simulation.stopper());
    }
    stop_by_itself();
    let bars = Bars::new(common.quiet);
    let adapter = common.adapter.as_deref();
    let existing = match (args.overwrite, args.resume) {
        (true, _) => Existing::Overwrite,
        (_, true) => Existing::Resume,
        _ => Existing::Reject,
    };
    if let Some(folder) = &args.raw {
        let request = RawFilmRequest {
            folder,
            existing,
            format: match args.raw_format {
                Raw::Tiff => RawFormat::Tiff,
                Raw::Png => RawFormat::Png,
                Raw::Npy => RawFormat::Npy,
            },
            range: args.range.unwrap_or_default(),
            adapter,
        };
        return Ok(write_raw_film(&flight, &request, &bars)?);
    }
    if args.frames.is_none() && args.video.is_none() {
        let request = WindowRequest {
            // Without its own path it makes no films from the window.
            program: std::env::current_exe().ok(),
            adapter,
            size: args.size,
            for_seconds: args.for_seconds,
        };
        return Ok(play_in_window(&flight, &request, &bars)?);
    }
    let request = ExportRequest {
        frames: args.frames.as_deref(),
        existing,
        pictures: args.pictures.settings(),
        range: args.range.unwrap_or_default(),
        video: args.video.as_deref(),
        encoder: match args.encoder {
            Encoder::Auto => EncoderChoice::Auto,
            Encoder::Ffmpeg => EncoderChoice::Ffmpeg,
            Encoder::Builtin => EncoderChoice::Builtin,
        },
        coding: VideoCoding {
            codec: args.codec.codec(),
            crf: args.crf,
        },
        size: args.size,
        adapter,
    };
    Ok(export(&flight, &request, &bars)?)
}

/// Ends the program, as clap does, where options have no meaning together.
fn reject_conflicts(args: &PlayArgs) {
    let reject = |kind, message: String| -> ! { reject_usage(NAME, kind, message) };
    let pictures = &args.pictures;
    let existing = [("--overwrite", args.overwrite), ("--resume", args.resume)];
    let existing = existing.into_iter().find(|(_, is_given)| *is_given);
    if let Some((name, _)) = existing.filter(|_| args.frames.is_none() && args.raw.is_none()) {
        let message = format!("{name} needs --frames or --raw");
        reject(ErrorKind::MissingRequiredArgument, message);
    }
    if let (Some(name), Some(_)) = (pictures.first_given(), &args.raw) {
        let message = format!("{name} conflicts with --raw, whose frames the [sensor] describes");
        reject(ErrorKind::ArgumentConflict, message);
    }
    let range = args.range.filter(|_| args.raw.is_none());
    let range = range.map(|_| "--range");
    if let Some(name) = range.or(pictures.first_given())
        && args.frames.is_none()
        && args.video.is_none()
    {
        let message = match name {
            "--range" => "--range needs --frames, --raw or --video".to_owned(),
            name => format!("{name} needs --frames or --video"),
        };
        reject(ErrorKind::MissingRequiredArgument, message);
    }
    let codec = args.codec.codec();
    if args.crf.is_some_and(|crf| crf > codec.max_crf()) {
        let message = format!(
            "--crf must be from 0 to {} with --codec {}",
            codec.max_crf(),
            codec.name()
        );
        reject(ErrorKind::ValueValidation, message);
    }
    // Videos show the same image for all other formats.
    let is_hdr = pictures.settings().hdr().is_some();
    if let Some(format) = pictures.format
        && !is_hdr
        && args.frames.is_none()
    {
        let name = format.to_possible_value();
        let name = name.as_ref().map_or("", |value| value.get_name());
        let message = format!(
            "--format {name} is for --frames: a video has the same colours with png, png16 and exr; leave --format out, or choose pq or hlg"
        );
        reject(ErrorKind::ArgumentConflict, message);
    }
    if pictures.alpha && args.video.is_some() {
        let message =
            "--alpha needs --frames without --video: videos have no alpha channel".to_owned();
        reject(ErrorKind::ArgumentConflict, message);
    }
}
