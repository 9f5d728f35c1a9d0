//! `terrella play`

use super::progress::{Bars, stop_on_interrupt, stop_on_interrupt_with};
use super::serve::simulation_scene;
use super::values;
use super::{Cli, Common};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, ValueEnum};
use std::path::PathBuf;
use terrella::basilisk::Endpoint;
use terrella::internals::play::{
    EncoderChoice, Existing, ExportRequest, Flight, FrameRange, WindowRequest, export,
    play_in_window,
};

/// Arguments of `terrella play`.
#[derive(Debug, Args)]
pub struct PlayArgs {
    /// The scene file
    #[arg(required_unless_present = "listen")]
    scene: Option<PathBuf>,
    /// Simulations of Basilisk: where they connect, instead of the scene's; without a scene the built-in one, config/basilisk.toml
    #[arg(long, value_name = "tcp://ADDRESS:PORT")]
    listen: Option<Endpoint>,
    /// Refuse files of orbits in which anything is spoilt; else bad states and records are listed and passed over
    #[arg(long)]
    strict: bool,
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
    /// Write an MP4 video (H.264) instead of opening a window
    #[arg(long, value_name = "FILE.mp4")]
    video: Option<PathBuf>,
    /// With --video: the encoder
    #[arg(long, value_enum, default_value_t = Encoder::Auto, requires = "video")]
    encoder: Encoder,
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

/// Opens the window, or writes frames and video.
pub fn run(args: &PlayArgs, common: &Common) -> anyhow::Result<()> {
    refuse_conflicts(args);
    let scene = simulation_scene(args.scene.as_deref(), args.listen.as_ref(), args.strict)?;
    let flight = Flight::open(scene)?;
    // Whoever waits is answered before the program ends.
    if let Some(simulation) = flight.simulation() {
        stop_on_interrupt_with(Some(simulation.stopper()));
    } else if args.frames.is_some() || args.video.is_some() {
        stop_on_interrupt();
    }
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
            _ => Existing::Refuse,
        },
        range: args.range.unwrap_or_default(),
        video: args.video.as_deref(),
        encoder: match args.encoder {
            Encoder::Auto => EncoderChoice::Auto,
            Encoder::Ffmpeg => EncoderChoice::Ffmpeg,
            Encoder::Builtin => EncoderChoice::Builtin,
        },
        size: args.size,
        adapter,
    };
    Ok(export(&flight, &request, &bars)?)
}

/// Ends the program, as clap does, where options have no meaning together.
fn refuse_conflicts(args: &PlayArgs) {
    if args.range.is_some() && args.frames.is_none() && args.video.is_none() {
        let message = "--range is for frames that are written: give --frames or --video too";
        Cli::command()
            .error(ErrorKind::MissingRequiredArgument, message)
            .exit()
    }
}
