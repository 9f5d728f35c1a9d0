//! `terrella bench`

use super::progress::{Bars, stop_on_interrupt};
use super::values;
use super::{Common, print};
use clap::Args;
use std::num::NonZeroU32;
use std::path::PathBuf;
use terrella::internals::measure::bench::{BenchRequest, run_bench};
use terrella::internals::play::Flight;
use terrella::scene::Scene;

/// Arguments of `terrella bench`.
#[derive(Debug, Args)]
#[command(
    after_help = "The scene's Earth and camera are flown round at twelve heights, from 1 km to the Moon's distance, along \
    the equator and along a path inclined by 51.6°, with the Sun of the scene's start. Each frame is timed beside its \
    floor: a pass with the same texture samples on the same pixels that computes nothing. Compare their \
    ratio, not milliseconds. With a pack, tiles are waited for before a frame is timed.\n\n\
    With --baseline a row fails where its frame over floor is larger than the baseline's by more than --tolerance; a \
    baseline of another scene, size, number of frames or adapter is refused.\n\n\
    Ctrl-C ends the run early: the files then hold the complete rows and say that they are partial.\n\n\
    Exit codes: 0 done, 2 bad scene or bad usage, 3 slower than the baseline, 1 any other failure or interrupted."
)]
pub struct BenchArgs {
    /// The scene file
    scene: PathBuf,
    /// Write the whole report to this file, for --baseline and other programs
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
    /// Write the rows to this file
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Write charts (SVG) into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Compare with an earlier run's JSON
    #[arg(long, value_name = "OLD.json")]
    baseline: Option<PathBuf>,
    /// With --baseline: how much slower a row may be, 0.25 being a quarter
    #[arg(long, value_name = "PART", default_value_t = DEFAULT_TOLERANCE, value_parser = values::part, requires = "baseline")]
    tolerance: f64,
    /// Frames to time for each row and each feature
    #[arg(long, value_name = "N", default_value_t = DEFAULT_FRAMES, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Width and height in pixels, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
}

/// Keeps a run of 1280 × 720 on two cores without a GPU within three minutes.
const DEFAULT_FRAMES: u32 = 24;
/// More than a row of the same program differed between two runs on two cores that six times as many programs wanted.
const DEFAULT_TOLERANCE: f64 = 0.35;

/// Benchmarks the scene, prints the tables and fails where a row is slower than the baseline.
pub fn run(args: &BenchArgs, common: &Common) -> anyhow::Result<()> {
    let flight = Flight::open_without_listening(Scene::load(&args.scene)?)?;
    flight.refuse_live(
        "frames are timed at instants of the scene",
        "take a scene of another source",
    )?;
    let request = BenchRequest {
        // The range above keeps it from zero.
        frames: NonZeroU32::new(args.frames).unwrap_or(NonZeroU32::MIN),
        size: args.size,
        adapter: common.adapter.as_deref(),
        json: args.json.as_deref(),
        csv: args.csv.as_deref(),
        plots: args.plots.as_deref(),
        baseline: args.baseline.as_deref(),
        tolerance: args.tolerance,
    };
    stop_on_interrupt();
    let run = run_bench(&flight, &request, &Bars::new(common.quiet))?;
    print(&run.to_table())?;
    Ok(run.verdict()?)
}
