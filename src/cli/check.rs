//! `terrella check`

use super::{Common, print};
use clap::Args;
use std::path::PathBuf;
use terrella::frames::rfc3339;
use terrella::play::Flight;
use terrella::scene::Scene;

/// Arguments of `terrella check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The scene file
    scene: PathBuf,
}

/// Runs it.
pub fn run(args: &CheckArgs, common: &Common) -> anyhow::Result<()> {
    let flight = Flight::open(Scene::load(&args.scene)?)?;
    if common.quiet {
        return Ok(());
    }
    let mut text = flight.scene().summary();
    if let Some(feed) = flight.feed() {
        let (first, last) = feed.validity();
        text.push_str(&format!(
            "\nsatellite\n  {:<14} {}\n  {:<14} {} to {}\n",
            "name",
            feed.name(),
            "elements hold",
            rfc3339(first),
            rfc3339(last)
        ));
    }
    print(&text)
}
