//! `terrella pack info`

use super::{bytes, print};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use terrella_imagery::pack::{HeightIndex, HeightKind, HeightsEntry, LayerEntry, Manifest, Pack};

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
    let index = pack.height_index()?;
    // Writing to a string cannot fail.
    let _ = describe(&mut text, pack.manifest(), index.as_ref());
    print(&text)
}

fn describe(
    text: &mut String,
    manifest: &Manifest,
    index: Option<&HeightIndex>,
) -> std::fmt::Result {
    let storages: Vec<_> = manifest.storages.iter().map(|s| s.name()).collect();
    writeln!(text, "{}", manifest.name)?;
    for line in &manifest.attribution {
        writeln!(text, "  {line}")?;
    }
    writeln!(text, "  tiles kept as {}", storages.join(" and "))?;
    for entry in &manifest.layers {
        describe_layer(text, manifest, entry)?;
    }
    if let Some(heights) = &manifest.heights {
        describe_heights(text, heights, index)?;
    }
    let files = manifest.layers.iter().flat_map(|entry| &entry.levels);
    let files = files.flat_map(|level| level.tiles.iter().flatten().flatten());
    let (mut count, mut total) = (0_u64, 0);
    for file in files {
        count += 1;
        total += file.bytes;
    }
    for record in index.iter().flat_map(|index| index.records()) {
        count += 1;
        total += record.file.bytes;
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

fn describe_heights(
    text: &mut String,
    entry: &HeightsEntry,
    index: Option<&HeightIndex>,
) -> std::fmt::Result {
    write!(text, "\nheights  from {}", entry.sources.join("; "))?;
    match entry.kind {
        HeightKind::I16 { scale_m, .. } => writeln!(text, ", in steps of {scale_m:.3} m")?,
        HeightKind::F32 => writeln!(text, ", in floating-point numbers")?,
    }
    let records = index.map_or(&[][..], HeightIndex::records);
    for (level, tiles) in (0..).zip(records.chunk_by(|a, b| a.place.level == b.place.level)) {
        let total = tiles.iter().map(|record| record.file.bytes).sum();
        let [low_m, high_m] = [
            tiles
                .iter()
                .map(|record| record.low_m)
                .fold(f32::INFINITY, f32::min),
            tiles
                .iter()
                .map(|record| record.high_m)
                .fold(f32::NEG_INFINITY, f32::max),
        ];
        let (round, columns) = (entry.round(level), entry.columns_of(level));
        writeln!(
            text,
            "  level {}  {round:>10} round the Earth  {} of {} tiles of {}  {}  {low_m:.0} m to {high_m:.0} m",
            u32::from(level) + 1,
            tiles.len(),
            u64::from(columns) * u64::from(columns / 2),
            entry.side,
            bytes(total)
        )?;
    }
    Ok(())
}
