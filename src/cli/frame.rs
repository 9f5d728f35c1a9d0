//! `terrella frame`

use super::Common;
use super::progress::Bars;
use super::values;
use clap::Args;
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella::play::{Flight, StillRequest, write_still};
use terrella::scene::Scene;

/// Arguments of `terrella frame`.
#[derive(Debug, Args)]
pub struct FrameArgs {
    /// The scene file
    scene: PathBuf,
    /// The picture to write
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    /// The instant, for example 2018-01-15T12:30:00Z, instead of the scene's start
    #[arg(long, value_name = "RFC3339", value_parser = values::instant)]
    at: Option<Epoch>,
    /// Width and height in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// Write the picture's numbers (times, blocks, memory, eye, Sun) to this file
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
}

/// Runs it.
pub fn run(args: &FrameArgs, common: &Common) -> anyhow::Result<()> {
    let flight = Flight::open(Scene::load(&args.scene)?)?;
    let request = StillRequest {
        epoch: args.at,
        size: args.size,
        adapter: common.adapter.as_deref(),
        output: &args.output,
        stats: args.stats.as_deref(),
    };
    Ok(write_still(&flight, &request, &Bars::new(common.quiet))?)
}
