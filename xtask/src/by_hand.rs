//! `cargo xtask soak` and `cargo xtask fuzz`: long tests that are run by hand, outside the suite.

use crate::cargo;
use crate::process;

/// Sends 100 000 packets to a live feed, one in twenty of them corrupt, and checks its memory and replies.
///
/// # Errors
/// The build or a test failed.
pub fn soak() -> anyhow::Result<()> {
    let mut command = cargo::cargo();
    command.args(["test", "--release", "--locked", "--test", "live", "--"]);
    command.args([
        "--ignored",
        "--nocapture",
        "a_long_feed_with_5_percent_garbage",
    ]);
    process::run(&mut command)
}

/// Runs the bodies of the fuzz targets on new inputs, some seconds each; all targets if none is named. Prints rows for `fuzz/RESULTS.md`.
///
/// # Errors
/// The build failed, a target does not exist, or an input caused a failure; the input is in `fuzz/findings`.
pub fn fuzz(seconds: f64, seed: Option<u64>, targets: &[String]) -> anyhow::Result<()> {
    let mut command = cargo::cargo();
    command.args(["test", "--release", "--locked", "--test", "input", "--"]);
    command.args(["--ignored", "--nocapture", "all_targets_for_a_time"]);
    command.env("TERRELLA_FUZZ_SECONDS", seconds.to_string());
    command.env("TERRELLA_FUZZ_TARGETS", targets.join(","));
    if let Some(seed) = seed {
        command.env("TERRELLA_FUZZ_SEED", seed.to_string());
    }
    process::run(&mut command)
}
