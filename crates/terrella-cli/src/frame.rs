//! `terrella frame`

#[cfg(feature = "measure")]
mod reference;

use super::interruption::do_first;
use super::picture_args::PictureArgs;
use super::progress::Bars;
use super::scene_args::{SatelliteArgs, SceneArgs, open_flight};
use super::values;
use super::{Common, reject_usage};
use clap::Args;
use clap::error::ErrorKind;
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella_play::{Flight, Progress, StillRequest, night_note, write_still};

/// The subcommand, for messages about its usage.
const NAME: &str = "frame";

/// Arguments of `terrella frame`.
#[derive(Debug, Args)]
pub struct FrameArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SatelliteArgs,
    /// Image to write; with --format exr, OUT.exr
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    /// Time in UTC, for example 2018-01-15T12:30:00Z, "2018-01-15 12:30" or 2018-01-15, or now [default: the scene's start]
    #[arg(long, value_name = "TIME", value_parser = values::instant)]
    at: Option<Epoch>,
    /// Width and height in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// Also write linear light before exposure and tone mapping: 32-bit floats, where a white surface that faces the Sun in space is 1,
    /// as a NumPy array of height × width × 3 or as OpenEXR
    #[arg(long, value_name = "OUT.npy|OUT.exr")]
    radiance: Option<PathBuf>,
    /// Also write the raw frame of the scene's [sensor]: digital numbers as 16-bit greyscale PNG or TIFF, or as a NumPy array; a JSON file
    /// of the same name holds all parameters, the seed and the pose
    #[arg(long, value_name = "OUT.png|OUT.tiff|OUT.npy")]
    raw: Option<PathBuf>,
    /// Write ground truth per pixel into this folder: position, range, Sun, land, clouds, shadow, limb and normal, each as a NumPy array,
    /// and all as OpenEXR
    #[arg(long, value_name = "DIR")]
    truth: Option<PathBuf>,
    /// Write statistics of the image (times, memory, features, camera, Sun) to this file
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    #[command(flatten)]
    pictures: PictureArgs,
    #[cfg(feature = "measure")]
    #[command(flatten)]
    reference: reference::ReferenceArgs,
    /// Draw only the edges of the surface's triangles
    #[arg(long)]
    wireframe: bool,
}

/// Draws the image. If there is no graphics adapter and none was named, the reference renderer draws it.
pub fn run(args: &FrameArgs, common: &Common) -> anyhow::Result<()> {
    reject_conflicts(args, common);
    let scene = args.scene.load(&args.satellites.satellite)?;
    args.satellites.reject_scenes(NAME, &scene);
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
    #[cfg(feature = "measure")]
    if args.reference.is_chosen() {
        return reference::draw(args, &flight, &bars);
    }
    let request = StillRequest {
        epoch: args.at,
        size: args.size,
        adapter: common.adapter.as_deref(),
        output: &args.output,
        radiance: args.radiance.as_deref(),
        raw: args.raw.as_deref(),
        truth: args.truth.as_deref(),
        stats: args.stats.as_deref(),
        pictures: args.pictures.settings(),
        wireframe: args.wireframe,
    };
    match write_still(&flight, &request, &bars) {
        #[cfg(feature = "measure")]
        Err(error) if reference::stands_in(args, common, &error) => {
            tracing::warn!("{error}. The reference renderer draws instead, slowly");
            reference::draw(args, &flight, &bars)
        }
        done => Ok(done?),
    }
}

/// Exits, as clap does, if options conflict.
fn reject_conflicts(args: &FrameArgs, common: &Common) {
    #[cfg(feature = "measure")]
    if let Some(message) = reference::conflict(args, common) {
        reject(message);
    }
    #[cfg(not(feature = "measure"))]
    let _ = common;
    if let Some(raw) = &args.raw {
        let page = raw.with_extension("json");
        let others = [
            Some(&args.output),
            args.radiance.as_ref(),
            args.stats.as_ref(),
        ];
        if others
            .into_iter()
            .flatten()
            .any(|other| other == raw || *other == page)
        {
            reject(
                "--raw, or the .json of the same name, is the file of another option; give the raw frame another name",
            );
        }
    }
    if args.wireframe && args.raw.is_some() {
        reject("--raw conflicts with --wireframe, which draws edges without light");
    }
    if args.wireframe && args.truth.is_some() {
        reject("--truth conflicts with --wireframe, which draws edges without ground");
    }
}

fn reject(message: &str) -> ! {
    reject_usage(NAME, ErrorKind::ArgumentConflict, message)
}
