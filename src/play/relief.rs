//! A scene's heights.

use super::error::PlayError;
use crate::elevation::{GridLimits, Ground, open_heights};
use crate::globe::ContourDrawing;
use crate::globe::contours::PageOptions;
use crate::imagery::find_textures;
use crate::scene::ReliefTable;
use crate::{GroundOptions, Subdivision, SurfaceSettings};
use std::path::PathBuf;
use std::sync::Arc;

/// Reads the heights that a scene names, or the starter pack's.
pub(super) fn ground_options(
    table: &ReliefTable,
    subdivision: Subdivision,
) -> Result<GroundOptions, PlayError> {
    let ground = Arc::new(read_ground(&table.elevation, table.sea_floor)?);
    Ok(GroundOptions {
        elevation: ground,
        surface: match table.contours {
            ContourDrawing::Patches => table.surface.settings(subdivision),
            ContourDrawing::Cast => SurfaceSettings::CastContours(PageOptions::default()),
        },
        tolerance_px: table.tolerance_px,
    })
}

/// The grids of these files, or the starter pack's, over one another.
pub fn read_ground(files: &[PathBuf], sea_floor: bool) -> Result<Ground, PlayError> {
    let starter;
    let files = match files.is_empty() {
        true => {
            starter = [find_textures()?.join("elevation.png")];
            &starter
        }
        false => files,
    };
    let mut grids = Vec::new();
    for file in files {
        let heights = open_heights(file, &GridLimits::default())?;
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
        grids.push(Arc::new(heights.grid));
    }
    let ground = Ground::new(grids);
    Ok(match sea_floor {
        true => ground,
        false => ground.with_sea_surface(),
    })
}
