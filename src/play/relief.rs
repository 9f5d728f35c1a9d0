//! A scene's heights.

use super::error::PlayError;
use crate::GroundOptions;
use crate::elevation::{Denoise, GridLimits, Ground, open_heights_denoised};
use crate::imagery::find_textures;
use crate::scene::ReliefTable;
use std::path::PathBuf;
use std::sync::Arc;

/// Reads the heights that a scene names, or the starter pack's.
pub(super) fn ground_options(table: &ReliefTable) -> Result<GroundOptions, PlayError> {
    let ground = read_ground(&table.elevation, table.sea_floor, table.denoise)?;
    let ground = Arc::new(ground);
    Ok(GroundOptions {
        elevation: ground,
        surface: table.settings,
        tolerance_px: table.tolerance_px,
    })
}

/// The grids of these files, or the starter pack's, over one another; with `denoise`, without single wrong heights.
pub fn read_ground(files: &[PathBuf], sea_floor: bool, denoise: bool) -> Result<Ground, PlayError> {
    let starter;
    let files = match files.is_empty() {
        true => {
            starter = [find_textures()?.join("elevation.png")];
            &starter
        }
        false => files,
    };
    let denoise = denoise.then(Denoise::default);
    let mut grids = Vec::new();
    for file in files {
        let heights = open_heights_denoised(file, &GridLimits::default(), denoise.as_ref())?;
        let stats = heights.grid.stats();
        tracing::info!(
            "heights from {}: {:.0} to {:.0} m, {:.0} MB",
            file.display(),
            stats.range.low_m,
            stats.range.high_m,
            stats.bytes as f64 / 1e6
        );
        if stats.holes > 0 {
            let (holes, left) = (stats.holes, stats.left_holes);
            tracing::warn!(
                "{}: {holes} samples have no data; {left} of them are left to what lies beneath",
                file.display()
            );
        }
        match heights.denoised {
            Some(found) if found.replaced > 0 => tracing::warn!(
                "{}: {} single heights stood out by up to {:.0} m and were taken out; {} others stand with neighbours",
                file.display(),
                found.replaced,
                found.moved_m,
                found.kept
            ),
            Some(_) => tracing::info!("{}: no single height stands out", file.display()),
            None => {}
        }
        grids.push(Arc::new(heights.grid));
    }
    let ground = Ground::new(grids);
    Ok(match sea_floor {
        true => ground,
        false => ground.with_sea_surface(),
    })
}
