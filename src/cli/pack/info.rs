//! `terrella pack info`

use super::{bytes, print};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use terrella::internals::imagery::pack::{LayerEntry, Manifest, Pack};

/// Arguments of `terrella pack info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The pack's folder
    dir: PathBuf,
}

/// Prints the pack's contents.
pub fn run(args: &InfoArgs) -> anyhow::Result<()> {
    let pack = Pack::open(&args.dir)?;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = describe(&mut text, pack.manifest());
    print(&text)
}

fn describe(text: &mut String, manifest: &Manifest) -> std::fmt::Result {
    let storages: Vec<_> = manifest.storages.iter().map(|s| s.name()).collect();
    writeln!(text, "{}", manifest.name)?;
    for line in &manifest.attribution {
        writeln!(text, "  {line}")?;
    }
    writeln!(text, "  tiles kept as {}", storages.join(" and "))?;
    for entry in &manifest.layers {
        describe_layer(text, manifest, entry)?;
    }
    let files = manifest.layers.iter().flat_map(|entry| &entry.levels);
    let files = files.flat_map(|level| level.tiles.iter().flatten().flatten());
    let (mut count, mut total) = (0_u64, 0);
    for file in files {
        count += 1;
        total += file.bytes;
    }
    writeln!(text, "\n{count} files, {}", bytes(total))
}

fn describe_layer(text: &mut String, manifest: &Manifest, entry: &LayerEntry) -> std::fmt::Result {
    write!(text, "\n{}  from {}", entry.layer.name(), entry.source)?;
    if let Some(exaggeration) = entry.exaggeration {
        write!(text, ", slopes exaggerated {exaggeration} times")?;
    }
    writeln!(text)?;
    for (level, number) in entry.levels.iter().zip(1..) {
        let shape = level.shape;
        let map = format!("{} × {}", shape.map_width(), shape.map_height());
        write!(
            text,
            "  level {number}  {:>4} per block  {map:>15}",
            shape.block_pixels()
        )?;
        let present = level.tiles.first().into_iter().flatten().flatten().count();
        match shape.parts {
            1 => write!(text, "  {present:>3} blocks")?,
            parts => write!(
                text,
                "  {present:>3} parts of {} ({parts} × {parts} a block)",
                shape.pixels
            )?,
        }
        for (storage, files) in manifest.storages.iter().zip(&level.tiles) {
            let total = files.iter().flatten().map(|file| file.bytes).sum();
            write!(text, "  {} {}", storage.name(), bytes(total))?;
        }
        writeln!(text)?;
    }
    Ok(())
}
