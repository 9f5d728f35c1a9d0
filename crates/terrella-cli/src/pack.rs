//! `terrella pack`: imagery packs, one file for each of its commands.

mod build;
mod fetch;
mod info;
mod options;
mod preview;
mod verify;

use super::{Common, print};
use clap::{Args, Subcommand};
use std::path::Path;
use std::time::Instant;
use terrella_imagery::pack::Manifest;

/// Arguments of `terrella pack`.
#[derive(Debug, Args)]
pub struct PackArgs {
    #[command(subcommand)]
    command: PackCommand,
}

#[derive(Debug, Subcommand)]
enum PackCommand {
    /// Build a pack from maps of the whole Earth
    Build(Box<build::BuildArgs>),
    /// Download maps from public servers and build a pack from them; beside `elements fetch` no other command uses the network
    Fetch(Box<fetch::FetchArgs>),
    /// List the contents of a pack: maps, levels, sizes, attribution
    Info(info::InfoArgs),
    /// Read every tile of a pack and list the corrupt ones
    ///
    /// Checks that each tile is there, its length, checksum and contents. The exit code is 1 if a tile is corrupt; files that do not
    /// belong to the pack are listed and ignored.
    Verify(verify::VerifyArgs),
    /// Write a contact sheet: each map, and one block of it at every level
    Preview(preview::PreviewArgs),
}

/// Runs one of the commands for packs.
pub fn run(args: &PackArgs, common: &Common) -> anyhow::Result<()> {
    match &args.command {
        PackCommand::Build(args) => build::run(args, common),
        PackCommand::Fetch(args) => fetch::run(args, common),
        PackCommand::Info(args) => info::run(args),
        PackCommand::Verify(args) => verify::run(args, common),
        PackCommand::Preview(args) => preview::run(args, common),
    }
}

/// Reports a pack that was built since `begun`.
fn report_built(folder: &Path, manifest: &Manifest, begun: Instant, common: &Common) {
    tracing::info!(pack = %folder.display(), name = manifest.name, "built");
    if common.quiet {
        return;
    }
    let levels = manifest.layers.iter().flat_map(|entry| &entry.levels);
    let files = levels.flat_map(|level| level.tiles.iter().flatten().flatten());
    let (count, total) = files.fold((0_u64, 0), |(count, total), file| {
        (count + 1, total + file.bytes)
    });
    eprintln!(
        "{}: {} maps, {count} tiles, {}, {:.1} s",
        folder.display(),
        manifest.layers.len(),
        bytes(total),
        begun.elapsed().as_secs_f64()
    );
}

/// A number of bytes for people, in powers of ten.
fn bytes(count: u64) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", count as f64 / 1e6),
        _ => format!("{:.2} GB", count as f64 / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::bytes;

    #[test]
    fn bytes_have_the_unit_that_fits() {
        let texts = [0, 999, 1_000, 27_540, 1_500_000, 1_020_000_000].map(bytes);
        assert_eq!(
            texts,
            ["0 B", "999 B", "1.0 kB", "27.5 kB", "1.5 MB", "1.02 GB"]
        );
    }
}
