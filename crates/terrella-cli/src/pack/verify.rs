//! `terrella pack verify`

use super::{Common, bytes, print};
use crate::progress::Bars;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use terrella_imagery::pack::{VerifyReport, verify};
use terrella_play::Progress;

/// Limit on listed files that do not belong to the pack.
const MAX_SHOWN_STRANGERS: usize = 20;

/// Arguments of `terrella pack verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// The pack's folder
    dir: PathBuf,
}

/// Reads every tile and prints the bad ones. A bad tile is a failure.
pub fn run(args: &VerifyArgs, common: &Common) -> anyhow::Result<()> {
    let bars = Bars::new(common.quiet);
    let report = verify(&args.dir, |done, total| match done {
        0 => bars.begin("verifying", Some(total)),
        _ => bars.step(),
    })?;
    bars.end();
    let text = describe(&report);
    if report.is_good() {
        return if common.quiet { Ok(()) } else { print(&text) };
    }
    print(&text)?;
    anyhow::bail!(
        "{}: {} of {} tiles are corrupt; build the pack again",
        args.dir.display(),
        report.bad.len(),
        report.tiles
    )
}

fn describe(report: &VerifyReport) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for tile in &report.bad {
        let _ = writeln!(text, "corrupt   {}: {}", tile.path.display(), tile.cause);
    }
    for path in report.strangers.iter().take(MAX_SHOWN_STRANGERS) {
        let path = path.display().to_string();
        let _ = writeln!(text, "unknown   {}", path.escape_debug());
    }
    let more = report
        .stranger_count
        .saturating_sub(MAX_SHOWN_STRANGERS as u64);
    if more > 0 {
        let _ = writeln!(text, "unknown   and {more} more");
    }
    let good = report.tiles - report.bad.len() as u64;
    let (tiles, size) = (report.tiles, bytes(report.bytes));
    let _ = writeln!(text, "{good} of {tiles} tiles are good, {size} in all");
    text
}
