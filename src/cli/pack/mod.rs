//! `terrella pack`: imagery packs.

mod build;

use super::Common;
use clap::{Args, Subcommand};

/// What `pack` takes.
#[derive(Debug, Args)]
pub struct PackArgs {
    #[command(subcommand)]
    command: PackCommand,
}

#[derive(Debug, Subcommand)]
enum PackCommand {
    /// Build a pack from maps of the whole Earth
    Build(build::BuildArgs),
}

/// Runs what was asked for.
pub fn run(args: &PackArgs, common: &Common) -> anyhow::Result<()> {
    match &args.command {
        PackCommand::Build(args) => build::run(args, common),
    }
}
