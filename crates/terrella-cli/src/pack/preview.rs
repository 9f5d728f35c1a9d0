//! `terrella pack preview`

use crate::Common;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use terrella_imagery::pack::Pack;
use terrella_imagery::tile::Storage;
use terrella_pack::preview;
use terrella_play::{PendingFile, written_picture};

/// Arguments of `terrella pack preview`.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// The pack's folder
    dir: PathBuf,
    /// Image to write
    #[arg(short, long, value_name = "SHEET.png")]
    output: PathBuf,
    /// Format of the tiles to show [default: the pack's first]
    #[arg(long, value_name = "KIND")]
    storage: Option<StorageName>,
}

/// Formats of tiles.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum StorageName {
    /// Uncompressed texels
    Plain,
    /// BC7, BC5 and BC4 blocks
    Bc,
}

/// Writes the contact sheet. Bad tiles are magenta on it and logged as warnings.
pub fn run(args: &PreviewArgs, common: &Common) -> anyhow::Result<()> {
    let begun = Instant::now();
    let pack = Arc::new(Pack::open(&args.dir)?);
    let file = PendingFile::create(&args.output, "contact sheets", "png")?;
    let storage = args.storage.map(|name| match name {
        StorageName::Plain => Storage::Plain,
        StorageName::Bc => Storage::Bc,
    });
    let (sheet, errors) = preview(pack, storage)?;
    for error in errors {
        tracing::warn!("{error}");
    }
    let sheet = image::DynamicImage::ImageRgb8(sheet).into_rgba8();
    file.write_png(&sheet)?;
    if !common.quiet {
        let line = written_picture(&args.output, sheet.dimensions(), begun.elapsed());
        eprintln!("{line}");
    }
    Ok(())
}
