//! `terrella play`

use super::interruption::{do_first, stop_by_itself};
use super::picture_args::PictureArgs;
use super::progress::Bars;
use super::scene_args::{SatelliteArgs, SceneArgs, open_flight};
use super::serve::simulation_scene;
use super::values;
use super::{Cli, Common};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, ValueEnum};
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella_orbit::basilisk::Endpoint;
use terrella_play::scene::Setting;
use terrella_play::{
    EncoderChoice, Existing, ExportRequest, Flight, FrameRange, VideoCodec, VideoCoding,
    WindowRequest, export, play_in_window,
};

/// Arguments of `terrella play`.
#[derive(Debug, Args)]
pub struct PlayArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SatelliteArgs,
    /// The first instant, for example 2026-11-25T05:00:00Z, or now, instead of the scene's start
    #[arg(long, value_name = "UTC", value_parser = values::instant)]
    start: Option<Epoch>,
    /// How long the film or the playback is, in seconds of simulated time, instead of the scene's
    #[arg(long, value_name = "SECONDS", value_parser = values::simulated_seconds, conflicts_with = "listen")]
    duration: Option<f64>,
    /// Simulations of Basilisk: where they connect, instead of the scene's; without a scene the built-in one, config/basilisk.toml
    #[arg(long, value_name = "tcp://ADDRESS:PORT")]
    listen: Option<Endpoint>,
    /// Write every frame as a PNG into this folder instead of opening a window
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
    /// With --frames: accept a folder that is not empty, and replace frames in it
    #[arg(long, requires = "frames")]
    overwrite: bool,
    /// With --frames: go on with the film in this folder: frames of it that are whole are kept, the others drawn
    #[arg(long, requires = "frames", conflicts_with_all = ["overwrite", "video"])]
    resume: bool,
    /// Only these frames of the film, FIRST..END without the last, FIRST..=LAST with it; either number may be left out
    #[arg(long, value_name = "RANGE", value_parser = values::frame_range)]
    range: Option<FrameRange>,
    #[command(flatten)]
    pictures: PictureArgs,
    /// Write an MP4 video (H.264) instead of opening a window
    #[arg(long, value_name = "FILE.mp4")]
    video: Option<PathBuf>,
    /// With --video: the encoder
    #[arg(long, value_enum, default_value_t = Encoder::Auto, requires = "video")]
    encoder: Encoder,
    /// With --video: the codec; other than h264 needs ffmpeg
    #[arg(long, value_enum, default_value_t = Codec::H264, requires = "video")]
    codec: Codec,
    /// With --video: constant quality, 0 (best) to 51, of av1 to 63. Default: 18 (h264), 20 (h265), 24 (av1); needs ffmpeg
    #[arg(long, value_name = "N", requires = "video", value_parser = clap::value_parser!(u32).range(0..=63))]
    crf: Option<u32>,
    /// Width and height in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// Close the window after so many seconds
    #[arg(long, value_name = "N", value_parser = values::seconds, conflicts_with_all = ["frames", "video"])]
    for_seconds: Option<f64>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Encoder {
    /// ffmpeg with libx264 if it is installed, else the built-in one
    Auto,
    /// ffmpeg with libx264
    Ffmpeg,
    /// The built-in one (OpenH264), up to 3840x2160
    Builtin,
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
            simulation_scene(path, Some(listen), args.scene.strict, &args.scene.set)?
        }
        None => args.scene.load_with(names, duration.as_slice())?,
    };
    args.satellites.reject_scenes(&scene);
    if let Some(start) = args.start {
        if scene.is_live() {
            let message = "--start has no meaning in this scene, whose simulator gives the time";
            Cli::command()
                .error(ErrorKind::ArgumentConflict, message)
                .exit();
        }
        scene.begin(start)?;
    }
    let flight = open_flight(scene, Flight::open)?;
    // Whoever waits is answered before the program ends.
    if let Some(simulation) = flight.simulation() {
        do_first(simulation.stopper());
    }
    stop_by_itself();
    let bars = Bars::new(common.quiet);
    let adapter = common.adapter.as_deref();
    if args.frames.is_none() && args.video.is_none() {
        let request = WindowRequest {
            adapter,
            size: args.size,
            for_seconds: args.for_seconds,
        };
        return Ok(play_in_window(&flight, &request, &bars)?);
    }
    let request = ExportRequest {
        frames: args.frames.as_deref(),
        existing: match (args.overwrite, args.resume) {
            (true, _) => Existing::Overwrite,
            (_, true) => Existing::Resume,
            _ => Existing::Reject,
        },
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
    let reject = |kind, message: String| -> ! { Cli::command().error(kind, message).exit() };
    let pictures = &args.pictures;
    let range = args.range.map(|_| "--range");
    if let Some(name) = range.or(pictures.first_given())
        && args.frames.is_none()
        && args.video.is_none()
    {
        let message =
            format!("{name} is for frames that are written: give --frames or --video too");
        reject(ErrorKind::MissingRequiredArgument, message);
    }
    let codec = args.codec.codec();
    if args.crf.is_some_and(|crf| crf > codec.max_crf()) {
        let message = format!(
            "--crf is 0 to {} with --codec {}",
            codec.max_crf(),
            codec.name()
        );
        reject(ErrorKind::ValueValidation, message);
    }
    if pictures.format.is_some() && args.frames.is_none() {
        let message = "--format is for pictures: give --frames too".to_owned();
        reject(ErrorKind::MissingRequiredArgument, message);
    }
    if pictures.alpha && args.video.is_some() {
        let message = "--alpha is for pictures: videos have none; write --frames alone".to_owned();
        reject(ErrorKind::ArgumentConflict, message);
    }
}
