//! A scene's elevation data.

use super::error::PlayError;
use crate::scene::{PackTable, ReliefTable};
use std::path::PathBuf;
use std::sync::Arc;
use terrella::GroundOptions;
use terrella_ground::elevation::{
    Denoise, Elevation, GridLimits, Ground, HeightGrid, HeightStreamOptions, StreamedGround,
    check_heights, height_files, height_set, open_heights_denoised,
};
use terrella_imagery::find_textures;
use terrella_imagery::pack::Pack;

/// Reads the elevation files that a scene names, or the starter pack's; elevation data of its imagery pack is streamed.
pub(super) fn ground_options(
    table: &ReliefTable,
    pack: Option<&PackTable>,
) -> Result<GroundOptions, PlayError> {
    let over = read_grids(&named_heights(table)?, table.denoise)?;
    let over = over_the_sea(over, table.sea_floor);
    let elevation: Arc<dyn Elevation> = match (table.pack_heights_mb, pack) {
        (Some(megabytes), Some(pack)) => {
            let pack = Pack::open(&pack.folder)?;
            let tiles = pack.height_tiles()?;
            let options = HeightStreamOptions {
                memory_bytes: (1e6 * megabytes) as u64,
                ..HeightStreamOptions::default()
            };
            Arc::new(StreamedGround::new(Arc::new(tiles), over, &options)?)
        }
        _ => Arc::new(over),
    };
    Ok(GroundOptions {
        elevation,
        surface: table.settings,
        tolerance_px: table.tolerance_px,
    })
}

/// The elevation files that a scene names; by default the starter pack's, unless its imagery pack has elevation data.
fn named_heights(table: &ReliefTable) -> Result<Vec<PathBuf>, PlayError> {
    let named = match table.pack_heights_mb {
        Some(_) => table.elevation.clone(),
        None => or_the_starter_packs(&table.elevation)?,
    };
    let sets = named.iter().map(|path| height_set(path));
    Ok(sets.collect::<Result<Vec<_>, _>>()?.concat())
}

fn or_the_starter_packs(files: &[PathBuf]) -> Result<Vec<PathBuf>, PlayError> {
    match files.is_empty() {
        true => Ok(vec![find_textures()?.join("elevation.png")]),
        false => Ok(files.to_owned()),
    }
}

/// The files that [`ground_options`] reads, except the tiles of a pack.
pub(super) fn relief_files(table: &ReliefTable) -> Result<Vec<PathBuf>, PlayError> {
    let named = named_heights(table)?;
    Ok(named.iter().flat_map(|file| height_files(file)).collect())
}

/// Rejects elevation files with invalid headers or sidecars.
pub(super) fn check_ground(table: &ReliefTable) -> Result<(), PlayError> {
    if table.pack_heights_mb.is_some() && table.elevation.is_empty() {
        return Ok(());
    }
    for file in &named_heights(table)? {
        check_heights(file, &GridLimits::default())?;
    }
    Ok(())
}

/// The grids of these files, or the starter pack's, layered; with `denoise`, isolated outliers are removed.
pub fn read_ground(files: &[PathBuf], sea_floor: bool, denoise: bool) -> Result<Ground, PlayError> {
    let grids = read_grids(&or_the_starter_packs(files)?, denoise)?;
    Ok(over_the_sea(grids, sea_floor))
}

fn read_grids(files: &[PathBuf], denoise: bool) -> Result<Vec<Arc<HeightGrid>>, PlayError> {
    let denoise = denoise.then(Denoise::default);
    let mut grids = Vec::new();
    for file in files {
        let heights = open_heights_denoised(file, &GridLimits::default(), denoise.as_ref())?;
        let stats = heights.grid.stats();
        tracing::info!(
            "elevation from {}: {:.0} to {:.0} m, {:.0} MB",
            file.display(),
            stats.range.low_m,
            stats.range.high_m,
            stats.bytes as f64 / 1e6
        );
        if stats.holes > 0 {
            let (holes, left) = (stats.holes, stats.left_holes);
            tracing::warn!(
                "{}: {holes} samples have no data; {left} of them are filled from the data beneath",
                file.display()
            );
        }
        match heights.denoised {
            Some(found) if found.replaced > 0 => tracing::warn!(
                "{}: {} outliers of up to {:.0} m were removed; {} others agree with their neighbours",
                file.display(),
                found.replaced,
                found.moved_m,
                found.kept
            ),
            Some(_) => tracing::info!("{}: no outliers", file.display()),
            None => {}
        }
        grids.push(Arc::new(heights.grid));
    }
    Ok(grids)
}

fn over_the_sea(grids: Vec<Arc<HeightGrid>>, sea_floor: bool) -> Ground {
    let ground = Ground::new(grids);
    match sea_floor {
        true => ground,
        false => ground.with_sea_surface(),
    }
}
