//! `terrella pack preview`

use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::sync::Arc;
use terrella::imagery::pack::{Pack, preview};
use terrella::imagery::tile::Storage;
use terrella::play::PendingFile;

/// Arguments of `terrella pack preview`.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// The pack's folder
    dir: PathBuf,
    /// The picture to write
    #[arg(short, long, value_name = "SHEET.png")]
    output: PathBuf,
    /// Which of its tiles to show, instead of the first kind it holds
    #[arg(long, value_name = "KIND")]
    storage: Option<StorageName>,
}

/// How tiles are kept.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum StorageName {
    /// Uncompressed texels
    Plain,
    /// BC7, BC5 and BC4 blocks
    Bc,
}

/// Runs it. Bad tiles are magenta on the sheet and told as warnings.
pub fn run(args: &PreviewArgs) -> anyhow::Result<()> {
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
    Ok(file.write_png(&sheet)?)
}
