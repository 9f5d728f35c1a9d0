//! The `terrella` command: arguments, logs, error messages, exit codes. Everything else is the libraries'.

mod access;
#[cfg(feature = "measure")]
mod bench;
mod check;
mod completions;
mod coverage;
mod doctor;
#[cfg(feature = "pack")]
mod elements;
mod examples;
mod frame;
mod interruption;
mod man;
mod new;
mod orbit;
#[cfg(feature = "pack")]
mod pack;
mod picture_args;
mod play;
mod progress;
mod quiet_driver;
#[cfg(test)]
mod reference;
#[cfg(feature = "measure")]
mod report;
mod scene_args;
mod serve;
mod suggestions;
#[cfg(feature = "measure")]
mod terrain;
mod values;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use terrella_play::PlayError;
use terrella_play::scene::SceneError;

/// Exit code of a bad scene, and of bad usage (clap's own).
const BAD_SCENE: u8 = 2;
/// Exit code of every other failure.
const FAILED: u8 = 1;

/// A realistic Earth seen from a satellite.
#[derive(Debug, Parser)]
#[command(name = "terrella", version, about, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 success, 2 invalid scene or usage, 3 slower than the baseline (bench), 1 any other failure, \
    130 interrupted by Ctrl-C (SIGINT), 143 by SIGTERM, 129 by SIGHUP."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

/// Options of every command.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Global options")]
struct Common {
    /// Log more to standard error; -vv logs debug messages. RUST_LOG sets the level of each module
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
    /// Print errors only, without progress bars
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Render with the best graphics adapter whose name contains NAME; `terrella doctor` lists them
    #[arg(long, global = true, value_name = "NAME")]
    adapter: Option<String>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Play a scene in a window, or render it to frames or video
    Play(play::PlayArgs),
    /// Render the camera images and depth maps that Basilisk simulations request, without a display
    Serve(serve::ServeArgs),
    /// Render one image of a scene
    Frame(frame::FrameArgs),
    /// Benchmark frames of a scene at twelve altitudes, each against its floor: the lower bound of its cost
    #[cfg(feature = "measure")]
    Bench(bench::BenchArgs),
    /// Write a new scene file that explains every key
    New(new::NewArgs),
    /// Validate a scene and list what it uses and ignores
    Check(check::CheckArgs),
    /// Print positions of a scene's satellites, or write their ephemerides and elements
    Orbit(orbit::OrbitArgs),
    /// Print when ground stations and satellites have access to each other
    Access(access::AccessArgs),
    /// Print how the sensors of satellites cover the ground: share, revisit times and gaps, as a table or a map
    Coverage(coverage::CoverageArgs),
    /// List graphics adapters, their capabilities, and the features that each cannot run
    Doctor,
    /// Measure error against run time and write a page with tables, charts and images
    #[cfg(feature = "measure")]
    Report(report::ReportArgs),
    /// Benchmark terrain structures (quadtree, contours, patches) on elevation data: triangles saved, speed, storage
    #[cfg(feature = "measure")]
    Terrain(terrain::TerrainArgs),
    /// Build, inspect and verify imagery packs: maps larger than memory, cut into tiles
    #[cfg(feature = "pack")]
    Pack(pack::PackArgs),
    /// Download orbital elements of satellites by catalogue number or group
    #[cfg(feature = "pack")]
    Elements(elements::ElementsArgs),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArgs),
    /// Print a man page
    Man(man::ManArgs),
}

impl Command {
    /// Whether the command uses a graphics adapter.
    fn draws(&self) -> bool {
        match self {
            Self::New(_) | Self::Check(_) | Self::Orbit(_) => false,
            Self::Access(_) | Self::Coverage(_) => false,
            Self::Completions(_) | Self::Man(_) => false,
            #[cfg(feature = "pack")]
            Self::Pack(_) | Self::Elements(_) => false,
            Self::Play(_) | Self::Serve(_) | Self::Frame(_) | Self::Doctor => true,
            #[cfg(feature = "measure")]
            Self::Bench(_) | Self::Report(_) | Self::Terrain(_) => true,
        }
    }
}

fn main() -> ExitCode {
    // Bad usage ends here with clap's message and exit code 2.
    let cli = parse(vizard_args(std::env::args_os()));
    log_to_stderr(&cli.common);
    if cli.command.draws() {
        quiet_driver::quieten();
    }
    interruption::listen();
    let common = &cli.common;
    let done = match &cli.command {
        Command::Play(args) => play::run(args, common),
        Command::Serve(args) => serve::run(args, common),
        Command::Frame(args) => frame::run(args, common),
        #[cfg(feature = "measure")]
        Command::Bench(args) => bench::run(args, common),
        Command::New(args) => new::run(args, common),
        Command::Check(args) => check::run(args, common),
        Command::Orbit(args) => orbit::run(args, common),
        Command::Access(args) => access::run(args, common),
        Command::Coverage(args) => coverage::run(args, common),
        Command::Doctor => doctor::run(common),
        #[cfg(feature = "measure")]
        Command::Report(args) => report::run(args, common),
        #[cfg(feature = "measure")]
        Command::Terrain(args) => terrain::run(args, common),
        #[cfg(feature = "pack")]
        Command::Pack(args) => pack::run(args, common),
        #[cfg(feature = "pack")]
        Command::Elements(args) => elements::run(args, common),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
    };
    interruption::wait_for_end();
    let asked = interruption::exit_code();
    match done {
        Ok(()) => asked.map_or(ExitCode::SUCCESS, ExitCode::from),
        Err(error) => {
            let mut stderr = std::io::stderr().lock();
            // No one can be informed if standard error is closed.
            let _ = writeln!(stderr, "error: {}", message(&error));
            ExitCode::from(asked.unwrap_or_else(|| exit_code(&error)))
        }
    }
}

/// The command line as it is declared, with examples.
fn command() -> clap::Command {
    examples::added_to(Cli::command())
}

/// Ends the program, as clap does, with the usage of this command.
fn reject_usage(name: &str, kind: ErrorKind, message: impl Display) -> ! {
    let mut root = command();
    // Names the usage of commands after the program.
    root.build();
    let mut own = root.find_subcommand(name).cloned().unwrap_or(root);
    own.error(kind, message).exit()
}

/// Reads the arguments. Help, and bad usage with its suggestions, end the program.
fn parse(args: Vec<OsString>) -> Cli {
    let matches = command().try_get_matches_from(args);
    let matches = matches.unwrap_or_else(|error| suggestions::added_to(error).exit());
    Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}

/// The arguments, with those of Basilisk's scripts for their viewer (`--args -directComm tcp://localhost:5556`, or `-noDisplay`) translated to
/// ours.
fn vizard_args(args: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut args: Vec<_> = args.collect();
    let is = |index: usize, word: &str| args.get(index).is_some_and(|arg| arg == word);
    let at = if is(1, "--args") { 2 } else { 1 };
    let command = match () {
        () if is(at, "-directComm") => "play",
        () if is(at, "-noDisplay") => "serve",
        () => return args,
    };
    args.splice(1..=at, [command.into(), "--listen".into()]);
    args
}

/// The error and its causes on one line. Most messages already include their cause; none is repeated.
fn message(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1) {
        let cause = cause.to_string();
        if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

fn exit_code(error: &anyhow::Error) -> u8 {
    let bad_scene = error.chain().any(|cause| {
        let play = cause.downcast_ref::<PlayError>();
        cause.is::<SceneError>() || play.is_some_and(PlayError::is_bad_scene)
    });
    if bad_scene {
        return BAD_SCENE;
    }
    #[cfg(feature = "measure")]
    if let Some(code) = bench::exit_code(error) {
        return code;
    }
    FAILED
}

fn log_to_stderr(common: &Common) {
    use tracing_subscriber::EnvFilter;
    let default = match (common.quiet, common.verbose) {
        (true, _) => "error",
        // winit warns of displays without per-display settings, which work.
        (false, 0) => "warn,winit=error",
        // wgpu's own messages are for its developers.
        (false, 1) => "warn,winit=error,terrella=info",
        (false, _) => "info,terrella=debug",
    };
    let asked = std::env::var("RUST_LOG");
    // Show module names to users who select log levels by module.
    let names_parts = common.verbose > 1 || asked.is_ok();
    let filter = match asked {
        Ok(directives) => EnvFilter::try_new(&directives).unwrap_or_else(|error| {
            eprintln!("warning: RUST_LOG={directives:?} is not understood: {error}");
            EnvFilter::new(default)
        }),
        Err(_) => EnvFilter::new(default),
    };
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(names_parts)
        .without_time()
        .init();
}

/// Prints to standard output; a reader that has gone away (`| head`) is not a failure.
fn print(text: &str) -> anyhow::Result<()> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_hold_together() {
        command().debug_assert();
    }

    #[test]
    fn the_viewers_own_arguments_are_understood() {
        let put = |args: &[&str]| {
            let put = vizard_args(args.iter().map(OsString::from));
            put.iter()
                .map(|arg| arg.to_string_lossy().into_owned())
                .collect::<Vec<_>>()
        };
        let live = ["terrella", "play", "--listen", "tcp://localhost:5556"];
        let address = "tcp://localhost:5556";
        assert_eq!(put(&["terrella", "--args", "-directComm", address]), live);
        assert_eq!(put(&["terrella", "-directComm", address]), live);
        let headless = ["terrella", "serve", "--listen", address];
        assert_eq!(put(&["terrella", "-noDisplay", address]), headless);
        for args in [live, headless] {
            Cli::try_parse_from(args).expect("good arguments");
            assert_eq!(put(&args), args);
        }
        assert_eq!(put(&["terrella"]), ["terrella"]);
    }

    #[test]
    fn causes_are_reported_once() {
        let cause = || std::io::Error::other("disk full");
        let plain = anyhow::Error::from(cause()).context("writing a.png");
        assert_eq!(message(&plain), "writing a.png: disk full");
        let named = anyhow::Error::from(cause()).context("a.png: disk full; make room");
        assert_eq!(message(&named), "a.png: disk full; make room");
    }

    #[test]
    fn a_bad_scene_is_distinguished_from_a_bad_machine() {
        let scene =
            terrella_play::scene::Scene::from_toml("[camera]\nfov_deg = 0\n", "x.toml".as_ref());
        let error = scene.expect_err("a bad scene");
        assert_eq!(exit_code(&anyhow::Error::from(error)), BAD_SCENE);
        let scene = terrella_play::scene::Scene::from_toml("[x]\n", "x.toml".as_ref());
        let error = PlayError::from(scene.expect_err("a bad scene"));
        assert_eq!(exit_code(&anyhow::Error::from(error)), BAD_SCENE);
        let lost = PlayError::DeviceLost("test".into());
        assert_eq!(exit_code(&anyhow::Error::from(lost)), FAILED);
    }
}
