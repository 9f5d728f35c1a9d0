//! `terrella bench`

use super::interruption::stop_by_itself;
use super::progress::Bars;
use super::scene_args::SettingArgs;
use super::values;
use super::{BAD_SCENE, Common, print};
use clap::Args;
use std::num::NonZeroU32;
use std::path::PathBuf;
use terrella_measure::bench::{BenchError, BenchRequest, run_bench};
use terrella_play::Flight;
use terrella_play::scene::Scene;

/// Exit code of a benchmark that is slower than its baseline.
const SLOWER: u8 = 3;

/// Arguments of `terrella bench`.
#[derive(Debug, Args)]
#[command(
    after_help = "Flies the scene's camera at twelve altitudes, from 1 km to the Moon's distance, along the equator and along a path \
    inclined by 51.6°, with the Sun of the scene's start. Each frame is timed against its floor: a pass that takes the same texture \
    samples at the same places and computes no light. Compare their ratio, not milliseconds. With a pack, a frame is timed once its \
    tiles have loaded.\n\n\
    With --baseline, a row is slower if its whole confidence interval (95 % for all rows together) lies beyond --smallest-effect. \
    Frames are compared view by view. Use --repeats 3 or more for both runs, so that the interval includes the variation between \
    runs. A baseline of another scene, size, number of frames or adapter is rejected.\n\n\
    Ctrl-C, SIGTERM or SIGHUP ends the run early; the files then hold the complete rows and are marked as partial.\n\n\
    Exit codes: 0 success, 2 invalid scene or usage, 3 slower than the baseline, 1 any other failure, 130, 143 or 129 \
    interrupted by SIGINT, SIGTERM or SIGHUP."
)]
pub struct BenchArgs {
    /// Scene file
    scene: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
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
    /// With --baseline: smallest slowdown that counts, as a fraction: 0.05 is 5 %
    #[arg(long, value_name = "PART", default_value_t = SMALLEST_EFFECT, value_parser = values::part, requires = "baseline")]
    smallest_effect: f64,
    /// Number of frames timed for each row and each feature in each run
    #[arg(long, value_name = "N", default_value_t = DEFAULT_FRAMES, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Number of runs over all rows and features; their spread is reported
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeats: u32,
    /// Width and height in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
}

/// Keeps a run of 1280 × 720 on two cores without a GPU within three minutes.
const DEFAULT_FRAMES: u32 = 24;
/// Less than anyone sees, and more than the same program differs by from build to build.
const SMALLEST_EFFECT: f64 = 0.05;

/// Benchmarks the scene, prints the tables and fails where a row is slower than the baseline.
pub fn run(args: &BenchArgs, common: &Common) -> anyhow::Result<()> {
    let flight =
        Flight::open_without_listening(Scene::load_with(&args.scene, &args.settings.set)?)?;
    flight.reject_live(
        "frames are timed at times of the scene",
        "use a scene with another source",
    )?;
    let request = BenchRequest {
        // The ranges above keep them from zero.
        frames: NonZeroU32::new(args.frames).unwrap_or(NonZeroU32::MIN),
        repeats: NonZeroU32::new(args.repeats).unwrap_or(NonZeroU32::MIN),
        arguments: std::env::args_os()
            .skip(1)
            .map(|argument| argument.to_string_lossy().into_owned())
            .collect(),
        size: args.size,
        adapter: common.adapter.as_deref(),
        json: args.json.as_deref(),
        csv: args.csv.as_deref(),
        plots: args.plots.as_deref(),
        baseline: args.baseline.as_deref(),
        smallest_effect: args.smallest_effect,
    };
    stop_by_itself();
    let run = run_bench(&flight, &request, &Bars::new(common.quiet))?;
    print(&run.to_table())?;
    Ok(run.verdict()?)
}

/// The exit code of a benchmark's own errors.
pub fn exit_code(error: &anyhow::Error) -> Option<u8> {
    let mut causes = error.chain().filter_map(|cause| cause.downcast_ref());
    causes.find_map(|error: &BenchError| match error {
        error if error.is_bad_scene() => Some(BAD_SCENE),
        error if error.is_slower() => Some(SLOWER),
        _ => None,
    })
}
