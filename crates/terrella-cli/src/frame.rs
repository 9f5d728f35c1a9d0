//! `terrella frame`

use super::interruption::do_first;
use super::picture_args::PictureArgs;
use super::progress::Bars;
use super::scene_args::{SatelliteArgs, SceneArgs, open_flight};
use super::values;
use super::{Cli, Common};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, ValueEnum};
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella::internals::gpu::ContextError;
use terrella_measure::reference::{ReferenceRequest, SAMPLES, write_reference_still};
use terrella_play::{Flight, PlayError, Progress, StillRequest, night_note, write_still};

/// Rays along each side of a pixel where none are asked for.
const DEFAULT_SAMPLES: u32 = 4;

/// Arguments of `terrella frame`.
#[derive(Debug, Args)]
pub struct FrameArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SatelliteArgs,
    /// The picture to write; with --format exr, OUT.exr
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    /// The instant, for example 2018-01-15T12:30:00Z, or now, instead of the scene's start
    #[arg(long, value_name = "RFC3339", value_parser = values::instant)]
    at: Option<Epoch>,
    /// Width and height in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// Write its light too, before exposure and tone curve: 32-bit floats, a white sheet that faces the Sun in space is 1;
    /// a NumPy array of height × width × 3, or OpenEXR
    #[arg(long, value_name = "OUT.npy|OUT.exr")]
    radiance: Option<PathBuf>,
    /// Write what is where each pixel looks into this folder: place, range, Sun, land, clouds, shadow, limb and normal, each a NumPy
    /// array, and all as OpenEXR
    #[arg(long, value_name = "DIR")]
    truth: Option<PathBuf>,
    /// Write statistics of the picture (times, memory, features, eye, Sun) to this file
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    #[command(flatten)]
    pictures: PictureArgs,
    /// Renderer: a graphics adapter, or the slow and exact one that adapters are compared with
    #[arg(long, value_enum, default_value_t = Renderer::Gpu)]
    renderer: Renderer,
    /// With --renderer reference: N × N rays a pixel, 1 to 16. Default: 4
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(
        i64::from(*SAMPLES.start())..=i64::from(*SAMPLES.end())
    ))]
    samples: Option<u32>,
    /// Draw only the edges of the surface's triangles
    #[arg(long)]
    wireframe: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Renderer {
    /// The best graphics adapter, or the one that --adapter names
    Gpu,
    /// Rays on the processor, to double precision; needs no adapter
    Reference,
}

/// Draws the picture. Where there is no graphics adapter at all, and none was asked for by name, the reference draws.
pub fn run(args: &FrameArgs, common: &Common) -> anyhow::Result<()> {
    refuse_conflicts(args, common);
    let scene = args.scene.load(&args.satellites.satellite)?;
    args.satellites.refuse_scenes(&scene);
    let flight = open_flight(scene, Flight::open)?;
    if let Some(simulation) = flight.simulation() {
        do_first(simulation.stopper());
    }
    let bars = Bars::new(common.quiet);
    if args.at.is_none()
        && let Some(note) = night_note(&flight)
    {
        bars.say(&note);
    }
    if args.renderer == Renderer::Gpu {
        let request = StillRequest {
            epoch: args.at,
            size: args.size,
            adapter: common.adapter.as_deref(),
            output: &args.output,
            radiance: args.radiance.as_deref(),
            truth: args.truth.as_deref(),
            stats: args.stats.as_deref(),
            pictures: args.pictures.settings(),
            wireframe: args.wireframe,
        };
        match write_still(&flight, &request, &bars) {
            Err(PlayError::Context(error @ ContextError::NoAdapter))
                if common.adapter.is_none()
                    && !args.wireframe
                    && args.radiance.is_none()
                    && args.pictures.first_given().is_none()
                    && args.truth.is_none() =>
            {
                tracing::warn!("{error}. The reference renderer draws instead, slowly");
            }
            done => return Ok(done?),
        }
    }
    let request = ReferenceRequest {
        epoch: args.at,
        size: args.size,
        samples: args.samples.unwrap_or(DEFAULT_SAMPLES),
        output: &args.output,
        stats: args.stats.as_deref(),
    };
    Ok(write_reference_still(&flight, &request, &bars)?)
}

/// Ends the program, as clap does, where options have no meaning together.
fn refuse_conflicts(args: &FrameArgs, common: &Common) {
    let refuse = |message: &str| -> ! {
        Cli::command()
            .error(ErrorKind::ArgumentConflict, message)
            .exit()
    };
    match args.renderer {
        Renderer::Gpu if args.samples.is_some() => refuse(
            "--samples is for --renderer reference; a graphics adapter takes samples under [output] in the scene",
        ),
        Renderer::Reference if args.wireframe => {
            refuse("--wireframe is for a graphics adapter; the reference renderer has no triangles")
        }
        Renderer::Reference if args.radiance.is_some() => refuse(
            "--radiance is for a graphics adapter; the reference renderer writes a picture alone",
        ),
        Renderer::Reference if args.pictures.first_given().is_some() => refuse(
            "--format, --alpha, --supersample and --shutter are for a graphics adapter; the reference renderer takes --samples",
        ),
        Renderer::Reference if args.truth.is_some() => refuse(
            "--truth is for a graphics adapter; the reference renderer writes a picture alone",
        ),
        Renderer::Gpu if args.wireframe && args.truth.is_some() => {
            refuse("--truth has no meaning with --wireframe, which draws edges and no ground")
        }
        Renderer::Reference if common.adapter.is_some() => {
            refuse("--adapter has no meaning with --renderer reference, which uses none")
        }
        _ => {}
    }
}
